"""Findings, with what speaks for each and what cannot be told from it."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from bondgraph.diagnosis.answer.evidence_shown import hardly_supported, shown
from bondgraph.diagnosis.answer.wording import finding_statement, listed
from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.alternatives import (
    alternatives_to,
    curves_as_good,
)
from bondgraph.diagnosis.evidence.confidence import beyond_resampling, probability
from bondgraph.diagnosis.evidence.gain import MERE_SHAPE
from bondgraph.diagnosis.evidence.judged import Judged, Rule
from bondgraph.diagnosis.evidence.leads import is_meant
from bondgraph.diagnosis.evidence.numbers import none_told
from bondgraph.diagnosis.records import Finding, Support
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.curve_beside import BetterCurve, better_curve
from bondgraph.diagnosis.search.revising.one_relation import one_relation
from bondgraph.diagnosis.search.round_found import Round, accepted, shares_of
from bondgraph.fitting.result import FitResult
from bondgraph.recordings.binding import BoundRecording

ONE_RELATION, HALF = (
    " The curve beside it goes along the same variable: the two may be one relation.",
    0.5,
)
"""What is said of a law that a curve mends, and how much of its probability is left
where two findings may be one.
"""

SAID_TWICE = " It is said twice of one place: the two may be one relation."
"""What is said where a law was found beside itself: at its place it only comes near."""

MENDS_SHAPE = (
    " It takes away little beside what was found before, and may only mend its shape."
)


def findings_of(
    rounds: Sequence[Round],
    after: FitResult,
    held_out: Sequence[BoundRecording],
    options: Options,
    left: float,
    proportion: Mapping[str, float],
) -> tuple[list[Finding], dict[str, Sequence[Judged]]]:
    """Return the findings, and for each element what the data do not tell from it.

    Parameters
    ----------
    left
        The share of the squared error that they leave beyond noise.
    proportion
        The errors of what is known only in proportion to the model's own parameters.
    """
    made, better = accepted(rounds), better_curve(rounds, options.rule)
    whole = one_relation(rounds)
    mended = None if whole is None else rounds[whole.index].chosen
    findings: list[Finding] = []
    others: dict[str, Sequence[Judged]] = {}
    laws = [one.chosen for one in made if one.chosen is not None]
    shares = shares_of(made, left)
    there = Counter((chosen.physics, chosen.place) for chosen in laws)
    for one, chosen, share in zip(made, laws, shares, strict=True):
        own = (chosen.physics, chosen.place)
        found = without_others(one, there.keys() - {own}, options.rule)
        close = alternatives_to(chosen, found.judged, options.rule)
        near = better if better and better.curve.place == chosen.place else None
        curves = curves_as_good(chosen, found.judged, options.rule)
        alike = [one.place for one in curves if one.physics == chosen.physics]
        rivals = () if alike else curves
        finding = _finding(chosen, close, alike, after, proportion)
        of_one = _of_one_relation(is_mended=chosen is mended, times=there[own])
        part = HALF if of_one else 1.0
        findings.append(
            replace(
                finding,
                statement=finding.statement
                + nearest(found)
                + comes_near(near)
                + _as_well(rivals)
                + of_one
                + (MENDS_SHAPE if share < MERE_SHAPE else ""),
                alternatives=(
                    *(shown(j, held_out) for j in close),
                    *(shown(one.curve, held_out) for one in (near,) if one),
                    *(shown(one, held_out) for one in rivals[:1]),
                    *hardly_supported(found, options, held_out),
                ),
                probability=_sure(found, share * part),
            )
        )
        others[finding.element] = close
    return findings, others


def without_others(
    found: Round, others: Collection[tuple[str, str]], rule: Rule
) -> Round:
    """Return a round without what other rounds have found, and how sure it is then.

    What was found as well is not what a finding may be instead, nor is what could not
    be told from that here.

    Parameters
    ----------
    others
        Physics and place of the other findings.
    """
    chosen = found.chosen
    assert chosen is not None
    as_well = [j for j in found.judged if (j.physics, j.place) in others]

    def is_another(judged: Judged) -> bool:
        if (judged.physics, judged.place) in others:
            return True
        own = judged is chosen or is_meant(judged, chosen, rule)
        return not own and any(is_meant(judged, one, rule) for one in as_well)

    rest = tuple(j for j in found.judged if not is_another(j))
    if len(rest) == len(found.judged) or found.before is None:
        return replace(found, judged=rest)
    sure = probability(chosen, rest, found.before, rule)
    return replace(found, judged=rest, probability=sure)


def _of_one_relation(*, is_mended: bool, times: int) -> str:
    """Return what is said of a law that may be one relation with another finding."""
    if is_mended:
        return ONE_RELATION
    return SAID_TWICE if times > 1 else ""


def _finding(
    chosen: Judged,
    close: Sequence[Judged],
    alike: Sequence[str],
    after: FitResult,
    proportion: Mapping[str, float],
) -> Finding:
    """Return what was found, where it is and how large.

    Parameters
    ----------
    close, alike
        What the data do not tell from it, and where else a curve does as well as it.
    """
    hypothesis = chosen.candidate.hypothesis
    same = [j.place for j in close if j.physics == chosen.physics]
    known = (*same, *alike, *hypothesis.also)
    ends = (chosen.place, hypothesis.other_end)
    elsewhere = (place for place in known if place not in ends)
    places = tuple(dict.fromkeys(elsewhere))
    estimates = tuple(e for e in after.estimates if e.name in hypothesis.parameters)
    scaled = tuple(
        e.name
        for e in estimates
        if none_told([(e.name, e.value, e.std)])
        and not none_told([(e.name, e.value, proportion.get(e.name))])
    )
    return Finding(
        physics=chosen.physics,
        place=chosen.place,
        element=hypothesis.element,
        statement=finding_statement(chosen, places, close, estimates, scaled),
        law=str(hypothesis.law),
        indistinguishable_places=places,
        alternatives=(),
        estimates=estimates,
        in_proportion=scaled,
        probability=None,
        domain=chosen.domain,
        other_end=hypothesis.other_end,
    )


def _sure(found: Round, believed: float) -> float | None:
    """Return how probable the choice of a round is, of which so much is believed."""
    if found.probability is None or found.chosen is None:
        return None
    return believed * beyond_resampling(found.probability, found.chosen.errors)


def nearest(found: Round) -> str:
    """Return which law with a name comes nearest to a curve, if one is supported."""
    curve = found.chosen
    assert curve is not None
    named = [
        j
        for j in found.judged
        if j.support is Support.SUPPORTED
        and j.physics != CURVE
        and j.place == curve.place
    ]
    if curve.physics != CURVE or not named:
        return ""
    best = max(named, key=lambda j: j.gain.value)
    return (
        f" Of the laws with a name {best.name} comes nearest: it takes "
        f"away {100 * best.gain.value:.0f} % of the error on left-out data, the curve "
        f"{100 * curve.gain.value:.0f} %."
    )


def _as_well(curves: Sequence[Judged]) -> str:
    """Return the sentence that what a sensor does may be done in the machine."""
    if not curves:
        return ""
    places = listed(tuple(dict.fromkeys(one.place for one in curves)), "or")
    return (
        f" A relation without a name at {places} takes away more by itself: these "
        "recordings do not tell a sensor that bends from what bends in the machine."
    )


def comes_near(better: BetterCurve | None) -> str:
    """Return the sentence that a free curve at the place leaves clearly less."""
    if better is None:
        return ""
    return (
        f" A free curve at {better.curve.place} leaves {100 / better.times:.0f} % of "
        "the error on left-out data that is left with what was found: the law comes "
        "near to what is there, and is not all of it."
    )
