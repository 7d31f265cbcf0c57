"""Making: what a round chose is added, replaces an earlier law, or is given up.

Where it found no law with a name, two are tried at once; and one law at two like places
where the first one it found, from a model that has run away, leaves much.
"""

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.base.beyond_noise import left_beside
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.considered import Setting
from bondgraph.diagnosis.search.pairs.together import explained, two_rounds
from bondgraph.diagnosis.search.revising.cancelling import cancelled
from bondgraph.diagnosis.search.revising.exchange import Exchanged, Reached, exchanged
from bondgraph.diagnosis.search.revising.removal import Pruned, pruned, swallowed
from bondgraph.diagnosis.search.round_found import Round, chosen_in
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.names import name_of
from bondgraph.structure.parameters import Parameter

Made = tuple[tuple[Round, ...], FittedModel, tuple[Hypothesis, ...]]
"""Rounds as they are made, the model after them, and what that has."""

NAMES_TWO = 0.8
"""Two laws with names leave less than this share of what a curve leaves, to be told in
its place: two wrong ones come near to any curve.
"""

MUCH_LEFT = 0.25
"""From a model that has run away, the first law that leaves more than this share may be
one that mends its numbers: two that hide each other, both gauges late, leave less.
"""


def made_of(
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


def or_two(
    setting: Setting,
    reached: Reached,
    one: Made,
    authored: Mapping[str, Parameter],
    shop: Workshop,
) -> Made:
    """Return what was made of a round, or two laws where these explain far more.

    They are tried where it found none with a name, or one that may only mend: then
    those of one kind alone. Beside what an earlier round has found they leave time for
    a curve in its place: there are many pairs, and it may only come near.
    """
    ((found,), _, _) = one
    chosen = found.chosen
    named = chosen is not None and chosen.physics != CURVE
    if named and not _may_mend(setting, found):
        return one
    with nullcontext() if setting.is_first else shop.limit.shared():
        two = _two_made(setting, reached, found, authored, shop, kindred=named)
    left, left_by_two = 1.0 - explained(one[0]), 1.0 - explained(two[0])
    instead = chosen is None or left_by_two < NAMES_TWO * left
    return two if instead else one


def _may_mend(setting: Setting, found: Round) -> bool:
    """Return whether what a round chose may only mend what has run away."""
    if found.chosen is None or not setting.is_first or not run_away(setting.base):
        return False
    fitted = found.chosen.candidate.fitted
    return left_beside(setting.base, fitted, setting.noise) > MUCH_LEFT


def _two_made(
    setting: Setting,
    reached: Reached,
    found: Round,
    authored: Mapping[str, Parameter],
    shop: Workshop,
    *,
    kindred: bool,
) -> Made:
    """Return the same where two laws are added at once; no rounds where none are."""
    two = two_rounds(setting, found, shop, kindred=kindred)
    rule = setting.options.rule
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
    """Return the model with additions, or why they are none.

    They leave nothing of what was there, or the last one cancels another at its place.

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
    if lost is not None:
        return f"leaves nothing of {lost}, and came after it"
    other = cancelled(left.fitted, left.kept)
    if other is not None:
        return f"it and {name_of(other.physics)} there cancel each other all but wholly"
    return left


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
        without=instead.without,
        removed=(instead.rival.candidate.hypothesis,),
    )


def _given_up(found: Round, reason: str) -> Round:
    """Return the round without its choice, with why it is none."""
    judged = tuple(
        replace(j, support=Support.REFUTED, reason=reason) if j is found.chosen else j
        for j in found.judged
    )
    return replace(found, judged=judged, chosen=None, probability=None)
