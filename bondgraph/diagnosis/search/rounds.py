"""The search: physics is added one piece at a time until nothing more is supported.

Each round hands the improved model on. What an addition makes needless is taken out
again. An addition that leaves nothing of what was there is its rival, and is given up,
but where it does far better in its place; so does what would add too little beside it.
Where all laws with a name only come near to what a curve shows, it goes on from that,
and from two laws at once where these do better than all that was found one by one.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.gain import MERE_SHAPE
from bondgraph.diagnosis.search.base.between_samples import finely_stepped
from bondgraph.diagnosis.search.base.beyond_noise import left_beside, within
from bondgraph.diagnosis.search.base.weighed import weighed_anew
from bondgraph.diagnosis.search.considered import Setting
from bondgraph.diagnosis.search.from_a_curve import all_there_is, from_a_curve
from bondgraph.diagnosis.search.making import Made, made_of, or_two
from bondgraph.diagnosis.search.one_round import one_round
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.exchange import Reached
from bondgraph.diagnosis.search.revising.fitted_anew import fitted_anew
from bondgraph.diagnosis.search.revising.one_relation import one_relation, pieces_of
from bondgraph.diagnosis.search.revising.otherwise_held import held_as_found
from bondgraph.diagnosis.search.revising.pair_instead import pair_instead
from bondgraph.diagnosis.search.revising.reconsidered import reconsidered
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.diagnosis.search.round_found import (
    Round,
    chosen_in,
    shares_of,
    supported_in,
)
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.fitting.either_hold import held_as_fits
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.fine_steps import simulated_as
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.recordings.binding import BoundRecording

Array = NDArray[np.float64]
ENDED_EARLY = 0.9
"""A fit that leaves less than this share of the cost shows that another ended early."""

SAMPLES_PER_FINDING = 30
"""Fewer samples than so many times the findings tell no more than one that bends."""


def search(
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
    *,
    another: bool = False,
) -> list[Round]:
    """Add supported physics piece by piece; the last round has found nothing more.

    Parameters
    ----------
    recordings
        Those that the base model was fitted to.
    noise
        Residual per output that noise excuses, 0 where it is not known: what lies
        within it is not searched for physics.
    another
        Whether it ends where no one law explains anything: no two are tried at once.
    """
    start = Reached(base, base, (), noise)
    rounds = _searched([], start, recordings, options, shop, another=another)
    begun = from_a_curve(rounds, recordings, options, shop)
    if begun is None:
        begun = pair_instead(rounds, recordings, noise, options, shop)
    if begun is None and one_relation(rounds):
        begun = rounds[:-2]  # Two relations after all: the curve is drawn beside it.
    if begun is not None:
        *before, last = chosen_in(begun)
        added = tuple(one.hypothesis for one in before)
        at = Reached(begun[0].base, begun[-1].base, added, noise)
        reached = _handed_on(at, last.fitted, (*added, last.hypothesis), options)
        rounds = _searched(begun, reached, recordings, options, shop)
    return reconsidered(rounds, recordings, noise, options, shop)


def _searched(
    begun: Sequence[Round],
    reached: Reached,
    recordings: Sequence[BoundRecording],
    options: Options,
    shop: Workshop,
    *,
    another: bool = False,
) -> list[Round]:
    """Return the rounds of a search that goes on from those that were made already.

    From none it ends where a curve mends a law: it may have to begin anew.
    """
    rounds, noise, authored = list(begun), reached.noise, reached.first.graph.parameters
    samples = len(reached.first.problem.shots.time)
    most = min(options.most_findings, max(samples // SAMPLES_PER_FINDING, 1))
    while True:
        number, base, current = len(rounds) + 1, reached.first, reached.current
        if number > most or within(current, noise, options.rule):
            return [*rounds, Round(current)]
        if rounds and shop.limit.passed:
            return [*rounds, Round(current, cut_short=True)]
        # Where a named law has explained nearly all, a free curve would only bend it.
        much = left_beside(base, current, noise) > options.rule.materiality
        setting = Setting(
            current, recordings, noise, options, number, reached.added, much,
            supported_in(rounds), () if begun else pieces_of(rounds),
        )  # fmt: skip
        found = one_round(setting, shop)
        if options.recordings_decide_hold and not shop.limit.passed:
            setting, reached, found = held_as_found(
                setting, reached, found, lambda other: one_round(other, shop)
            )
            base, current = reached.first, reached.current
        nested = _better_without(current, found)
        if nested is not None:
            shop.progress(f"round {number}: again, from a better fit of the model")
            first = base if rounds else nested
            reached = replace(reached, first=first, current=nested)
            continue
        done = shop.limit.undone
        shop.progress(f"round {number}: trying without what was added before")
        found, fitted, added = made_of(reached, found, authored, options.rule)
        if found.chosen is None and (
            another
            if not rounds
            # One relation is likelier than what was found and two laws beside it.
            else all_there_is([*rounds, found], recordings, options, shop)
        ):
            return [*rounds, found]
        one: Made = ((found,), fitted, added)
        made, fitted, added = or_two(setting, reached, one, authored, shop)
        if not made:
            short = found.cut_short or shop.limit.undone > done
            return [*rounds, replace(found, cut_short=short)]
        if not shop.limit.passed:
            made, fitted = fitted_anew(made, fitted, setting)
        rounds += made
        reached = _handed_on(reached, fitted, added, options)
        if _needs_no_more(rounds, begun):
            return [*rounds, Round(reached.current)]


def _needs_no_more(rounds: Sequence[Round], begun: Sequence[Round]) -> bool:
    """Return whether the last round only mends what was found, by shape or a curve."""
    mended = not begun and one_relation(rounds) is not None
    return mended or shares_of(rounds)[-1] < MERE_SHAPE


def _handed_on(
    reached: Reached,
    fitted: FittedModel,
    added: tuple[Hypothesis, ...],
    options: Options,
) -> Reached:
    """Return what the search has come to: stepped, held, weighed as it now asks."""
    weighed = weighed_anew(fitted, reached.noise)
    base, current = reached.first, finely_stepped(weighed, reached.noise)
    if options.recordings_decide_hold:
        current = held_as_fits(current)
    now = current.problem
    if (now.solver, now.hold) != (base.problem.solver, base.problem.hold):
        base = simulated_as(base, now.solver, now.hold)
    return Reached(base, current, added, reached.noise)


def _better_without(current: FittedModel, found: Round) -> FittedModel | None:
    """Return a clearly better fit of the model itself, where an addition has led to it.

    A fit that ended too early makes discoveries of its own misfit: each addition gives
    it another way on. So the model is fitted from where the chosen one has ended, too.
    """
    if found.chosen is None or found.cut_short:
        return None
    nested = fitted_with(current, found.chosen.candidate.fitted, (), {})
    better = nested.optimum.cost < ENDED_EARLY * current.optimum.cost
    return nested if better else None
