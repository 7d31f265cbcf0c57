"""What was considered, with its evidence, and what could not be told apart."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bondgraph.diagnosis.records import Diagnosis, Evidence, Finding, Support
from bondgraph.reporting.wording import sentence_start

SHOWN = 8
STANDING = (Support.SUPPORTED, Support.UNDECIDED, Support.REFUTED)
"""What comes first is the better way to have tried a law."""


@dataclass(frozen=True, slots=True)
class Whisker:
    """A value with its interval on a line from 0 to 100, in per cent of its length."""

    low: float
    value: float
    high: float


@dataclass(frozen=True, slots=True)
class Row:
    """A candidate with its gain drawn, and whether it is what was found."""

    evidence: Evidence
    whisker: Whisker
    found: bool


@dataclass(frozen=True, slots=True)
class Considered:
    """The candidates of a page: the best of each law at each place, and the others.

    Parameters
    ----------
    zero
        Where on the line of gains no gain is, in per cent.
    """

    shown: tuple[Row, ...]
    folded: tuple[Row, ...]
    zero: float
    held_out_known: bool


def considered(
    candidates: Sequence[Evidence], findings: Sequence[Finding] = ()
) -> Considered:
    """Return the candidates of a page, in the order given, and which were found."""
    found = {(one.physics, one.place) for one in findings}
    best = _best_of_each(candidates)[:SHOWN]
    shown = [candidates[i] for i in best]
    folded = [one for i, one in enumerate(candidates) if i not in best]
    least = min((one.gain - one.gain_std for one in candidates), default=0.0)
    low = max(min(least, 0.0), -1.0)

    def placed(one: Evidence, *, leading: bool) -> Row:
        low_end, value, high_end = (
            100 * (min(max(gain, low), 1.0) - low) / (1.0 - low)
            for gain in (one.gain - one.gain_std, one.gain, one.gain + one.gain_std)
        )
        chosen = leading and (one.physics, one.place) in found
        return Row(one, Whisker(low_end, value, high_end), chosen)

    return Considered(
        shown=tuple(placed(one, leading=True) for one in shown),
        folded=tuple(placed(one, leading=False) for one in folded),
        zero=100 * -low / (1.0 - low),
        held_out_known=any(one.held_out_nrmse is not None for one in candidates),
    )


def best_of_each(candidates: Sequence[Evidence]) -> list[Evidence]:
    """Return of each law at each place the best of the ways in which it was tried.

    The first of those that stand: one with a number too many may fit best of all and
    is refuted for it. In the order given.
    """
    return [candidates[i] for i in _best_of_each(candidates)]


def _best_of_each(candidates: Sequence[Evidence]) -> list[int]:
    """Return where the best of each stands, in order."""
    best: dict[tuple[str, str], int] = {}
    for standing in STANDING:
        for i, one in enumerate(candidates):
            if one.support is standing:
                best.setdefault((one.physics, one.place), i)
    return sorted(best.values())


def rivals(finding: Finding) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return what a finding could also be, and what is hardly supported, each once.

    A law that was tried at a place in several ways counts as its best way does.
    """
    best: dict[str, bool] = {}
    for one in finding.alternatives:
        words = f"{one.name} at {one.place}"
        best[words] = best.get(words, False) or one.support is not Support.REFUTED
    could = tuple(words for words, alive in best.items() if alive)
    return could, tuple(words for words in best if words not in could)


def not_told_apart(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return what these recordings do not decide, a sentence for each."""
    told = [sentence for one in diagnosis.findings for sentence in _of_finding(one)]
    if not diagnosis.findings:
        undecided = dict.fromkeys(
            f"{one.name} at {one.place}"
            for one in diagnosis.candidates
            if one.support is not Support.REFUTED
        )
        told += [
            f"{sentence_start(words)} would help; these recordings do not say whether "
            "it is there."
            for words in undecided
        ]
    told += [f"Not identifiable: {one}." for one in diagnosis.fit_after.unidentifiable]
    return tuple(told)


def _of_finding(finding: Finding) -> Iterator[str]:
    what = sentence_start(finding.name)
    if finding.indistinguishable_places:
        places = " or ".join(finding.indistinguishable_places)
        yield f"{what} at {finding.place} may as well sit at {places}."
    rivals = dict.fromkeys(
        f"{one.name} at {one.place}"
        for one in finding.alternatives
        if one.support is not Support.REFUTED and one.physics != finding.physics
    )
    if rivals:
        yield f"{what} at {finding.place} may as well be {' or '.join(rivals)}."


def how_sure(probability: float) -> str:
    """Return the probability of a finding in words."""
    return f"{100 * probability:.0f} of 100"
