"""A curve beside the laws with a name: it tells whether they only come near.

Many a relation is nearly a law of the library: a damper that grows with a root is
nearly dry friction. What is left then is no noise, and a free curve at the same place
leaves far less than all that was found with a name. Where a right law was found, the
curve does not: it left 1 / 1.15 at least of what all findings left together, in each of
about a hundred diagnoses, concealed and in recordings of strangers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.evidence.judged import Judged, Rule
from bondgraph.diagnosis.evidence.leads import clearly_better
from bondgraph.diagnosis.evidence.left_out import left_out_errors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.base.beyond_noise import Array, explainable
from bondgraph.diagnosis.search.laws.finer import drawn_as_near, finest_of
from bondgraph.diagnosis.search.laws.mending import DRY
from bondgraph.diagnosis.search.pairs.together import explained
from bondgraph.diagnosis.search.round_found import Round, made_in
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.work.workers import Workshop

LEAVES_MORE = 1.5
"""Named laws that leave so many times what a curve leaves come near at most."""

FAR_MORE = 3.0
"""Those that leave so many times as much are told as the curve ..."""

NOT_ALL = 0.05
"""... where they also leave this share of what the first model left, or as much less as
the curve is better still. Not where dry friction was found by then: of a real machine
it explains most and not all, and is what its friction is called.
"""

NOISE_ALONE, FAR_FROM_IT = 0.5, 0.75
"""A curve is all there is where no more than this share of what it leaves is not noise,
and laws with names are not where this share of what they leave is not.
"""

WITHIN_REACH, IN_PLACE_OF_DRY = 0.95, 0.2
"""In place of dry friction only one that leaves no more than the second of these, for a
curve follows what dry friction of a real machine leaves, too. That costs its drawing,
and none that leaves more than the first with few knots comes down to it with many.
"""

ROWS = 10
"""Samples for each number of a curve: few are followed by any curve, noise and all."""

STILL_MORE, AS_MUCH = 2.0, 0.5
"""Where the first law was so, others only mend its shape: a second that still leaves so
many times what the curve does, for two laws that are both there leave less than any one
curve; and more that leave about as much, or more than the curve once that is finely
drawn, for one relation is likelier than three.
"""


@dataclass(frozen=True, slots=True)
class BetterCurve:
    """A curve that leaves less than all laws with a name together.

    Parameters
    ----------
    index
        Of the round that judged it.
    named
        All that was found with a name, judged on as many chunks.
    times
        How many times what it leaves the named laws leave.
    left
        The share of the first model's error that these leave.
    first_times, first_left
        The same of the law that was chosen in its place.
    rubs
        Whether dry friction had been found by then.
    laws
        How many have a name.
    """

    index: int
    curve: Judged
    named: Judged
    times: float
    left: float
    first_times: float
    first_left: float
    rubs: bool
    laws: int

    @property
    def is_told(self) -> bool:
        """Whether it is to be told in their place."""
        then = self._only_near(self.first_times, self.first_left)
        enough = AS_MUCH if self.laws > 2 else STILL_MORE
        now = self._only_near(self.times, self.left)
        return now or (then and self.times >= enough)

    def _only_near(self, times: float, left: float) -> bool:
        """Return whether a law that leaves so much only comes near to the cause."""
        least = NOT_ALL if self.rubs else NOT_ALL * FAR_MORE / times
        return times >= FAR_MORE and left >= least


def better_curve(rounds: Sequence[Round], rule: Rule) -> BetterCurve | None:
    """Return the best curve that leaves clearly less than what was found, if any.

    Where none was tried at the place of a law with a name, or a curve was found there
    itself, there is none.
    """
    held = _curves_beside(rounds)
    if not held:
        return None
    best = held[0]
    clearly = clearly_better(best.curve, best.named, rule)
    return best if clearly and best.times >= LEAVES_MORE else None


def told_instead(rounds: Sequence[Round], rule: Rule) -> BetterCurve | None:
    """Return the curve to tell in place of what was found with a name, if any.

    In place of three laws and more the one that was tried first, so in place of all.
    """
    better = better_curve(rounds, rule)
    if better is not None and better.is_told:
        return better
    if len(made_in(rounds)) > 2:
        told = [one for one in _curves_beside(rounds) if one.is_told]
        return min(told, key=lambda one: one.index, default=None)
    return None


def told_if_fine(
    rounds: Sequence[Round], floor: Array, rule: Rule, shop: Workshop
) -> BetterCurve | None:
    """Return a curve to tell in place of named laws that leave much, if any.

    One that came as near as the first of them with few knots, at any place, and leaves
    little but noise once it is drawn finely. How much of the first model's error is
    left says nothing here: where that model is far off, whatever bends it takes away
    nearly all.

    Parameters
    ----------
    floor
        Measurement noise per output, as estimated, 0 where it is not known: also where
        it does not look white to a single channel. No model comes down to what is none.
    """
    made, first = made_in(rounds), rounds[0]
    named = made and all(one.physics != CURVE for one in made)
    chosen, left = first.chosen, rounds[-1].base
    if not named or chosen is None or explainable(left, floor) <= FAR_FROM_IT:
        return None
    most, worth = NOISE_ALONE, list(first.judged)
    if any(one.physics in DRY for one in made):
        most = IN_PLACE_OF_DRY
        worth = [one for one in worth if _within_reach(one, floor)]
    all_named = _dealt_like(made[-1], chosen)
    for curve, fine in drawn_beside(first, chosen, worth, shop):
        held = held_against(all_named, rounds, 0, fine)
        all_there_is = explainable(fine.candidate.fitted, floor) <= most
        if all_there_is and clearly_better(fine, all_named, rule):
            return replace(held, curve=curve)
    return None


def drawn_beside(
    first: Round, chosen: Judged, worth: Sequence[Judged], shop: Workshop
) -> list[tuple[Judged, Judged]]:
    """Return curves that came as near as the first law, and each as drawn finely.

    Parameters
    ----------
    chosen
        What the first round chose.
    worth
        Of what it judged, what is worth drawing.
    """
    before = left_out_errors(first.base, chosen.errors.chunks.size)
    bench = Bench.of(first.base, shop, "round 1")
    worth = [one for one in worth if _has_rows(one)]
    return drawn_as_near(bench, chosen, worth, before)


def _has_rows(judged: Judged) -> bool:
    """Return whether there are samples enough for as many numbers as a curve has."""
    samples = len(judged.candidate.fitted.residuals())
    return samples >= ROWS * judged.candidate.complexity


def _within_reach(curve: Judged, floor: Array) -> bool:
    """Return whether a curve that has few knots may leave noise alone with many."""
    return explainable(curve.candidate.fitted, floor) <= WITHIN_REACH


def _curves_beside(rounds: Sequence[Round]) -> list[BetterCurve]:
    """Return the curves that were tried where a law with a name was found, best first.

    None where a curve was found itself.
    """
    made = made_in(rounds)
    drawn = {one.place for one in made if one.physics == CURVE}
    places = {one.place for one in made} - drawn
    curves = [
        (i, judged)
        for i, found in enumerate(rounds)
        for judged in found.judged
        if judged.physics == CURVE
        and judged.support is Support.SUPPORTED
        and judged.place in places
        and _has_rows(judged)
    ]
    curves.sort(key=lambda one: float(one[1].errors.chunks.sum()))
    dealt = {judged.errors.chunks.size: judged for _, judged in curves}
    named = {size: _dealt_like(made[-1], judged) for size, judged in dealt.items()}
    return [
        held_against(named[judged.errors.chunks.size], rounds, i, judged)
        for i, judged in curves
    ]


def held_against(
    named: Judged, rounds: Sequence[Round], index: int, curve: Judged
) -> BetterCurve:
    """Return a curve held against all that was found beside it."""
    named = _dealt_like(named, curve)
    times = _times(named, curve)
    first, until = rounds[index].chosen, rounds[: index + 1]
    return BetterCurve(
        index,
        curve,
        named,
        times,
        1.0 - explained(rounds),
        first_times=times if first is None else _times(first, curve),
        first_left=1.0 - explained(until),
        rubs=any(one.physics in DRY for one in made_in(until)),
        laws=len(made_in(rounds)),
    )


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
    rounds: Sequence[Round],
    better: BetterCurve,
    rule: Rule,
    shop: Workshop,
    least: float = 1.0,
) -> list[Round] | None:
    """Return the rounds up to the one that judged the curve, which it has chosen.

    Like any curve that is chosen it is drawn as finely as the data tell, and so are its
    nearest rivals. None where what was found leaves less than a share of what it leaves
    even so.

    Parameters
    ----------
    least
        That share.
    """
    found, curve = rounds[better.index], better.curve
    before = left_out_errors(found.base, curve.errors.chunks.size)
    bench = Bench.of(found.base, shop, f"round {better.index + 1}")
    drawn = finest_of(bench, curve, found.judged, before)
    chosen = next(iter(drawn.values()))
    if better.times < LEAVES_MORE and _times(better.named, chosen) < least:
        return None
    judged = tuple(drawn.get(id(one), one) for one in found.judged)
    sure = probability(chosen, judged, before, rule)
    told = replace(found, judged=judged, chosen=chosen, probability=sure, removed=())
    return [*rounds[: better.index], told]
