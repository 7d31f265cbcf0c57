"""What one round of search has found, and what of all rounds is kept."""

from collections.abc import Sequence
from dataclasses import dataclass

from bondgraph.diagnosis.candidates import Candidate, Promised, Rejected
from bondgraph.diagnosis.evidence.gain import beside_earlier
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis


@dataclass(frozen=True, slots=True)
class Round:
    """What one round of search found.

    Parameters
    ----------
    base
        The model the round started from.
    tried, independent
        How many hypotheses were considered, and to how many independent ones they
        amount.
    judged, promised, rejected
        Candidates judged on left-out data, what every hypothesis promised, and those
        that could not be tried or determined.
    chosen
        The one accepted, if any.
    probability
        Of its physics being the best of those judged.
    without
        Where it was chosen beside later ones, too: the share of the first model's error
        that the others leave.
    removed
        What earlier rounds had added and is needless beside it.
    cut_short
        Whether time ran out before all had been tried.
    before
        Left-out errors without any of those judged, where these were judged one by one.
    """

    base: FittedModel
    tried: int = 0
    independent: float = 0.0
    judged: tuple[Judged, ...] = ()
    promised: tuple[Promised, ...] = ()
    rejected: tuple[Rejected, ...] = ()
    chosen: Judged | None = None
    probability: float | None = None
    without: float | None = None
    removed: tuple[Hypothesis, ...] = ()
    cut_short: bool = False
    before: LeftOutErrors | None = None


def accepted(rounds: Sequence[Round]) -> list[Round]:
    """Return the rounds whose addition was made and not taken out by a later one."""
    removed = {id(hypothesis) for found in rounds for hypothesis in found.removed}
    return [
        found
        for found in rounds
        if found.chosen is not None
        and id(found.chosen.candidate.hypothesis) not in removed
    ]


def shares_of(rounds: Sequence[Round], remaining: float = 1.0) -> list[float]:
    """Return for each round that chose how far that is more than the others' shape.

    Parameters
    ----------
    remaining
        The share of the first model's error that all leave beyond noise, where known.
    """
    chosen = [found for found in rounds if found.chosen is not None]
    gains = [found.chosen.gain.value for found in chosen if found.chosen is not None]
    return beside_earlier(gains, [found.without for found in chosen], remaining)


def supported_in(rounds: Sequence[Round]) -> frozenset[tuple[str, ...]]:
    """Return what tells the laws that left-out data supported in any round."""
    return frozenset(
        judged.candidate.hypothesis.told_by
        for found in rounds
        for judged in found.judged
        if judged.support is Support.SUPPORTED
    )


def made_in(rounds: Sequence[Round]) -> list[Judged]:
    """Return what was accepted as it was judged, in the order of the rounds."""
    kept = (found.chosen for found in accepted(rounds))
    return [chosen for chosen in kept if chosen is not None]


def chosen_in(rounds: Sequence[Round]) -> list[Candidate]:
    """Return what was accepted, in the order of the rounds."""
    return [chosen.candidate for chosen in made_in(rounds)]
