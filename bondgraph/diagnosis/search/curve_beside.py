"""A curve beside the laws with a name: it tells whether they only come near.

Many a relation is nearly a law of the library: a damper that grows with a root is
nearly dry friction. What is left then is no noise, and a free curve at the same place
leaves far less than all that was found with a name. Where a right law was found, the
curve does not: it left 1 / 1.15 at least of what all findings left together, in each of
about a hundred diagnoses, concealed and in recordings of strangers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from bondgraph.diagnosis.evidence.decision import (
    Judged,
    Rule,
    clearly_better,
    probability,
)
from bondgraph.diagnosis.evidence.left_out import left_out_errors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.candidates import CURVE
from bondgraph.diagnosis.search.finer import as_fine_as_told
from bondgraph.diagnosis.search.round_found import Round, accepted
from bondgraph.diagnosis.search.together import explained
from bondgraph.diagnosis.work.workers import Workshop

LEAVES_MORE = 1.5
"""Named laws that leave so many times what a curve leaves come near at most."""

FAR_MORE = 3.0
"""Those that leave so many times as much are told as the curve ..."""

NOT_ALL = 0.05
"""... where they also leave this share of what the first model left, or as much less as
the curve is better still: of a real machine dry friction explains most and not all, and
is what its friction is called.
"""

STILL_MORE, AS_MUCH = 2.0, 1.0
"""Where the first law was so, others only mend its shape: a second that still leaves so
many times what the curve does, for two laws that are both there leave less than any one
curve; and more that leave as much, for one relation is likelier than three.
"""


@dataclass(frozen=True, slots=True)
class BetterCurve:
    """A curve that leaves less than all laws with a name together.

    Parameters
    ----------
    index
        Of the round that judged it.
    times
        How many times what it leaves the named laws leave.
    left
        The share of the first model's error that these leave.
    first_times, first_left
        The same of the law that was chosen in its place.
    laws
        How many there are.
    """

    index: int
    curve: Judged
    times: float
    left: float
    first_times: float
    first_left: float
    laws: int

    @property
    def is_told(self) -> bool:
        """Whether it is to be told in their place."""
        then = _only_near(self.first_times, self.first_left)
        enough = STILL_MORE if self.laws <= 2 else AS_MUCH
        return _only_near(self.times, self.left) or (then and self.times >= enough)


def _only_near(times: float, left: float) -> bool:
    """Return whether what leaves so much, and so many times a curve, is no cause."""
    return times >= FAR_MORE and left * times >= NOT_ALL * FAR_MORE


def better_curve(rounds: Sequence[Round], rule: Rule) -> BetterCurve | None:
    """Return the best curve that leaves clearly less than what was found, if any.

    Where none was tried at the place of a law with a name, or a curve was found there
    itself, there is none.
    """
    made = [one.chosen for one in accepted(rounds) if one.chosen is not None]
    drawn = {one.place for one in made if one.physics == CURVE}
    places = {one.place for one in made} - drawn
    if not places:
        return None
    last = made[-1]
    curves = [
        (i, judged)
        for i, found in enumerate(rounds)
        for judged in found.judged
        if judged.physics == CURVE
        and judged.support is Support.SUPPORTED
        and judged.place in places
    ]
    if not curves:
        return None
    index, best = min(curves, key=lambda one: float(one[1].errors.chunks.sum()))
    last = _dealt_like(last, best)
    times = _times(last, best)
    first, until = rounds[index].chosen, rounds[: index + 1]
    better = BetterCurve(
        index,
        best,
        times,
        1.0 - explained(rounds),
        first_times=times if first is None else _times(first, best),
        first_left=1.0 - explained(until),
        laws=len(made),
    )
    clearly = times >= LEAVES_MORE and clearly_better(best, last, rule)
    return better if clearly or (len(made) > 2 and better.is_told) else None


def _times(judged: Judged, curve: Judged) -> float:
    """Return how many times what a curve leaves another candidate leaves."""
    left = float(judged.errors.chunks.sum())
    return left / max(float(curve.errors.chunks.sum()), 1e-12 * left)


def _dealt_like(judged: Judged, other: Judged) -> Judged:
    """Return a candidate judged on as many chunks as another, to be compared."""
    chunks = other.errors.chunks.size
    if judged.errors.chunks.size == chunks:
        return judged
    errors = left_out_errors(judged.candidate.fitted, chunks)
    return replace(judged, errors=replace(errors, noise=judged.errors.noise))


def with_curve(
    rounds: Sequence[Round], better: BetterCurve, rule: Rule, shop: Workshop
) -> list[Round]:
    """Return the rounds up to the one that judged the curve, which it has chosen.

    Like any curve that is chosen it is drawn as finely as the data tell.
    """
    found, curve = rounds[better.index], better.curve
    before = left_out_errors(found.base, curve.errors.chunks.size)
    sure = probability(curve, found.judged, before, rule)
    bench = Bench.of(found.base, shop, f"round {better.index + 1}")
    drawn = as_fine_as_told(bench, curve, before)
    judged = tuple(drawn if one is curve else one for one in found.judged)
    told = replace(found, judged=judged, chosen=drawn, probability=sure, removed=())
    return [*rounds[: better.index], told]
