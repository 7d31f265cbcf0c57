"""The search: physics is added one piece at a time until nothing more is supported.

Each round hands the improved model on. What an addition makes needless is taken out
again. An addition that leaves nothing of what was there is its rival, and is given up,
but where it does far better in its place; so does what would add too little beside it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.decision import Rule
from bondgraph.diagnosis.evidence.gain import MERE_SHAPE, beside_earlier
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.between_samples import (
    finely_stepped,
    held_as_fits,
    simulated_as,
)
from bondgraph.diagnosis.search.beyond_noise import left_beside, within
from bondgraph.diagnosis.search.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.exchange import Exchanged, Reached, exchanged
from bondgraph.diagnosis.search.one_round import (
    Round,
    Setting,
    chosen_in,
    one_round,
)
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.removal import Pruned, fitted_with, pruned, swallowed
from bondgraph.diagnosis.search.together import explained, two_rounds
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.parameters import Parameter

Array = NDArray[np.float64]
Made = tuple[tuple[Round, ...], FittedModel, tuple[Hypothesis, ...]]
"""Rounds as they are made, the model after them, and what that has."""

NAMES_TWO = 0.8
"""Two laws with names leave less than this share of what a curve leaves, to be told in
its place: two wrong ones come near to any curve.
"""

ENDED_EARLY = 0.9
"""A fit that leaves less than this share of the cost shows that another ended early."""


def search(
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
) -> list[Round]:
    """Add supported physics piece by piece; the last round has found nothing more.

    Parameters
    ----------
    recordings
        Those that the base model was fitted to.
    noise
        Residual per output that noise excuses, 0 where it is not known: what lies
        within it is not searched for physics.
    """
    rounds: list[Round] = []
    gains: list[float] = []
    current, authored = base, base.graph.parameters
    added: tuple[Hypothesis, ...] = ()
    while True:
        number = len(rounds) + 1
        if number > options.most_findings or within(current, noise, options.rule):
            return [*rounds, Round(current)]
        if rounds and shop.limit.passed:
            return [*rounds, Round(current, cut_short=True)]
        # Where a named law has explained nearly all, a free curve would only bend it.
        much = left_beside(base, current, noise) > options.rule.materiality
        setting = Setting(current, recordings, noise, options, number, added, much)
        found = one_round(setting, shop)
        nested = _better_without(current, found)
        if nested is not None:
            shop.progress(f"round {number}: again, from a better fit of the model")
            current, base = nested, (base if rounds else nested)
            continue
        done = shop.limit.undone
        shop.progress(f"round {number}: trying without what was added before")
        reached = Reached(base, current, added, noise)
        found, fitted, added = _made(reached, found, authored, options.rule)
        one: Made = ((found,), fitted, added)
        made, fitted, added = _or_two(setting, reached, one, authored, shop)
        if not made:
            short = found.cut_short or shop.limit.undone > done
            return [*rounds, replace(found, cut_short=short)]
        rounds += made
        current = finely_stepped(fitted, noise)
        if options.either_hold:
            current = held_as_fits(current)
        now = current.problem
        if (now.solver, now.hold) != (base.problem.solver, base.problem.hold):
            base = simulated_as(base, now.solver, now.hold)
        gains += [one.chosen.gain.value for one in made if one.chosen is not None]
        if beside_earlier(gains)[-1] < MERE_SHAPE:
            return [*rounds, Round(current)]


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


def _made(
    reached: Reached, found: Round, authored: Mapping[str, Parameter], rule: Rule
) -> tuple[Round, FittedModel, tuple[Hypothesis, ...]]:
    """Return the round as it is made, the model after it and what that has.

    What was chosen is added, takes an earlier one's place or is given up.
    """
    newcomers = found.judged
    if found.chosen is not None:
        left = _left_with([found.chosen.candidate], reached, authored, rule)
        if isinstance(left, Pruned):
            return replace(found, removed=left.removed), left.fitted, left.kept
        newcomers, found = (found.chosen,), _given_up(found, left)
    instead = None
    if not found.cut_short:
        instead = exchanged(reached, newcomers, found.tried, rule)
    if instead is None:
        return found, reached.current, reached.added
    return _in_place(found, instead), instead.fitted, instead.kept


def _or_two(
    setting: Setting,
    reached: Reached,
    one: Made,
    authored: Mapping[str, Parameter],
    shop: Workshop,
) -> Made:
    """Return what was made of a round, or two laws where it found none with a name."""
    ((found,), _, _) = one
    if found.chosen is not None and found.chosen.physics != CURVE:
        return one
    two = _two_made(setting, reached, found, authored, shop)
    left, left_by_two = 1.0 - explained(one[0]), 1.0 - explained(two[0])
    instead = found.chosen is None or left_by_two < NAMES_TWO * left
    return two if instead else one


def _two_made(
    setting: Setting,
    reached: Reached,
    found: Round,
    authored: Mapping[str, Parameter],
    shop: Workshop,
) -> Made:
    """Return the same where two laws are added at once; no rounds where none are."""
    two, rule = two_rounds(setting, found, shop), setting.options.rule
    if two:
        left = _left_with(chosen_in(two), reached, authored, rule)
        if isinstance(left, Pruned):
            made = (*two[:-1], replace(two[-1], removed=left.removed))
            return made, left.fitted, left.kept
    return (), reached.current, reached.added


def _left_with(
    candidates: Sequence[Candidate],
    reached: Reached,
    authored: Mapping[str, Parameter],
    rule: Rule,
) -> Pruned | str:
    """Return the model with additions, or what was there of which they leave nothing.

    Parameters
    ----------
    candidates
        What is added, one upon the other; the last one's model has them all.
    """
    together = (*reached.added, *(one.hypothesis for one in candidates))
    fitted = candidates[-1].fitted
    left = pruned(reached.first, reached.current, fitted, together, rule)
    lost = None
    if reached.added:
        lost = swallowed(reached.current, left.fitted, left.kept[:-1], authored)
    return left if lost is None else lost


def _in_place(found: Round, instead: Exchanged) -> Round:
    """Return the round with the law that has taken an earlier one's place."""
    new = instead.better
    others = (
        j
        for j in found.judged
        if j.candidate.hypothesis is not new.candidate.hypothesis
    )
    return replace(
        found,
        judged=(new, instead.rival, *others),
        chosen=new,
        probability=instead.probability,
        removed=(instead.rival.candidate.hypothesis,),
    )


def _given_up(found: Round, lost: str) -> Round:
    """Return the round without its choice, which stands in for what was there."""
    reason = f"leaves nothing of {lost}, and came after it"
    judged = tuple(
        replace(j, support=Support.REFUTED, reason=reason) if j is found.chosen else j
        for j in found.judged
    )
    return replace(found, judged=judged, chosen=None, probability=None)
