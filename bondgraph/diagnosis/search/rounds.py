"""The search: physics is added one piece at a time until nothing more is supported.

Each round hands the improved model on. What an addition makes needless is taken out
again; an addition that leaves nothing of what was there is its rival, and is given up.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.gain import MERE_SHAPE, beside_earlier
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.between_samples import (
    finely_stepped,
    held_as_fits,
    simulated_as,
)
from bondgraph.diagnosis.search.beyond_noise import left_beside, within
from bondgraph.diagnosis.search.one_round import (
    Round,
    Setting,
    chosen_in,
    one_round,
)
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.removal import pruned, swallowed
from bondgraph.diagnosis.search.together import two_rounds
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.recordings.binding import BoundRecording

Array = NDArray[np.float64]


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
        done = shop.limit.undone
        made = (found,) if found.chosen else two_rounds(setting, found, shop)
        if not made:
            short = found.cut_short or shop.limit.undone > done
            return [*rounds, replace(found, cut_short=short)]
        candidates = chosen_in(made)
        added = (*added, *(candidate.hypothesis for candidate in candidates))
        shop.progress(f"round {number}: trying without what was added before")
        left = pruned(base, current, candidates[-1].fitted, added, options.rule)
        if rounds:
            lost = swallowed(current, left.fitted, left.kept[:-1], authored)
            if lost is not None:
                return [*rounds, _given_up(found, lost)]
        rounds += [*made[:-1], replace(made[-1], removed=left.removed)]
        current, added = finely_stepped(left.fitted, noise), left.kept
        if options.either_hold:
            current = held_as_fits(current)
        now = current.problem
        if (now.solver, now.hold) != (base.problem.solver, base.problem.hold):
            base = simulated_as(base, now.solver, now.hold)
        gains += [one.chosen.gain.value for one in made if one.chosen is not None]
        if beside_earlier(gains)[-1] < MERE_SHAPE:
            return [*rounds, Round(current)]


def _given_up(found: Round, lost: str) -> Round:
    """Return the round without its choice, which stands in for what was there."""
    reason = f"leaves nothing of {lost}, and came after it"
    judged = tuple(
        replace(j, support=Support.REFUTED, reason=reason) if j is found.chosen else j
        for j in found.judged
    )
    return replace(found, judged=judged, chosen=None, probability=None)
