"""The verdict: nothing missing, physics missing, a curve without a name, or unclear."""

from collections.abc import Mapping, Sequence

from bondgraph.diagnosis.adequacy.records import Adequacy
from bondgraph.diagnosis.answer.doubt import is_hollow
from bondgraph.diagnosis.answer.nothing_found import without_findings
from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.evidence.numbers import ERRORS
from bondgraph.diagnosis.records import Finding, Support, Verdict
from bondgraph.diagnosis.search.remaining import MUCH_REMAINING
from bondgraph.diagnosis.search.round_found import Round, accepted
from bondgraph.fitting.estimate import FittedModel

MOST_REMAINING = 0.5
"""Findings that leave more than this share of the error have not found the cause."""

GUESS = 0.05
"""What is less probable is not told as found."""


def verdict_of(
    findings: Sequence[Finding],
    base: FittedModel,
    floor: Mapping[str, float],
    first: Round,
    remaining: float,
    checked: Adequacy | None = None,
    rule: Rule | None = None,
) -> tuple[Verdict, str]:
    """Return the verdict and the statement that goes with it.

    Parameters
    ----------
    remaining
        Share of the base model's left-out squared error that the findings leave, as
        far as it is more than noise.
    checked
        Whether what the base model leaves follows what the machine does, where known.
    rule
        By which candidates were judged; the default one when None.
    """
    told = " ".join(finding.statement for finding in findings)
    if any(finding.physics != CURVE for finding in findings):
        if remaining < MOST_REMAINING:
            return Verdict.PHYSICS_MISSING, told + _more_missing(remaining)
        return Verdict.UNEXPLAINED, (
            f"{told} That explains only {100 * (1 - remaining):.0f} % of the error on "
            "left-out data: something larger is missing that no law tried here "
            "describes, and it may be what bends the law above."
        )
    if findings:
        return Verdict.UNEXPLAINED, told
    return without_findings(base, floor, first, checked, rule or Rule())


def _more_missing(remaining: float) -> str:
    if remaining < MUCH_REMAINING:
        return ""
    return (
        f" {100 * remaining:.0f} % of the error on left-out data remains: something is "
        "missing beside it, or it only comes near to what is."
    )


def with_values(
    verdict: Verdict, statement: str, wrong: Sequence[Finding]
) -> tuple[Verdict, str]:
    """Return the verdict where stated values are contradicted as well.

    A model that is adequate only with values it was not given is not adequate.
    """
    told = " ".join(finding.statement for finding in wrong)
    match verdict:
        case Verdict.ADEQUATE:
            return (
                Verdict.PHYSICS_MISSING,
                f"{told} With it, nothing else is missing that shows.",
            )
        case Verdict.PHYSICS_MISSING | Verdict.UNEXPLAINED | Verdict.CANNOT_TELL:
            return verdict, f"{statement} {told}"


def with_undecided(verdict: Verdict, statement: str, last: Round, rule: Rule) -> str:
    """Return the statement with what would help further, but not reliably.

    Parameters
    ----------
    last
        The round that found nothing more.
    """
    near = [
        judged
        for judged in last.judged
        if judged.support is Support.UNDECIDED
        and judged.gain.value > max(ERRORS * judged.gain.std, rule.materiality)
    ]
    if verdict is not Verdict.PHYSICS_MISSING or last.chosen is not None or not near:
        return statement
    best = max(near, key=lambda judged: judged.gain.value)
    return (
        f"{statement} Beyond that these recordings do not decide: "
        f"{best.name} at {best.place} would take away {best.gain} of the "
        "error that is left, but not reliably."
    )


def without_size(
    verdict: Verdict, statement: str, findings: Sequence[Finding]
) -> tuple[Verdict, str]:
    """Return the verdict where nothing tells a single number of what was found.

    A law of which no size, no place and no time is told from none only lends its form
    to something else. What was found first decides the verdict.
    """
    hollow = [finding for finding in findings if is_hollow(finding)]
    told_something = verdict in (Verdict.PHYSICS_MISSING, Verdict.UNEXPLAINED)
    if not told_something or not hollow:
        return verdict, statement
    names = " and ".join(f"{f.name} at {f.place}" for f in hollow)
    told = (
        f"{statement} But these recordings determine no number of {names}, which may "
        "stand for something else: do not rely on it."
    )
    first = hollow[0] is findings[0]
    return (Verdict.UNEXPLAINED if first else verdict), told


def hardly_believed(
    verdict: Verdict, statement: str, findings: Sequence[Finding]
) -> tuple[Verdict, str]:
    """Return the verdict where the answer itself believes nothing of what it found."""
    sure = [one.probability for one in findings if one.probability is not None]
    if verdict is not Verdict.PHYSICS_MISSING or not sure or max(sure) >= GUESS:
        return verdict, statement
    return Verdict.CANNOT_TELL, (
        f"{statement} But that is no more than a guess: other laws do nearly as well, "
        "or much remains beside it."
    )


def cut_short(
    verdict: Verdict, statement: str, rounds: Sequence[Round]
) -> tuple[Verdict, str]:
    """Return the verdict where time ran out: what was not tried may explain it."""
    if verdict is Verdict.ADEQUATE or not any(found.cut_short for found in rounds):
        return verdict, statement
    told = "Time ran out before everything had been tried."
    if accepted(rounds):
        return verdict, f"{statement} {told}"
    nothing = "Nothing that was tried surely explains what the model leaves."
    return Verdict.CANNOT_TELL, f"{told} {nothing}"


def not_simulated(verdict: Verdict, statement: str) -> tuple[Verdict, str]:
    """Return the verdict where the improved model fails on the held-out recordings."""
    told = (
        f"{statement} But the improved model cannot be simulated through the held-out "
        "recordings, which the base model can: do not rely on it."
    )
    physics = verdict is Verdict.PHYSICS_MISSING
    return (Verdict.UNEXPLAINED if physics else verdict), told
