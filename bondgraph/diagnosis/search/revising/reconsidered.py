"""Reconsidering: what came first is chosen again, beside all that was found since.

A law that explained little when it was chosen was the one that lay nearest to what all
that was missing showed together. Once the rest has been found, a round is made without
it: what that chooses takes its place, where the model fits as well. The same law, if
chosen again, is as probable as it is there, where nothing found since hides it. So is a
choice made again that was made beside a law that has been taken out since.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.considered import Setting
from bondgraph.diagnosis.search.one_round import one_round
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.plainer import as_good
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.diagnosis.search.round_found import Round, accepted, chosen_in
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.errors import BondGraphError
from bondgraph.fitting.fitted import FittedModel
from bondgraph.recordings.binding import BoundRecording

Array = NDArray[np.float64]
LITTLE = 0.3
"""What explained less of the error than this when it was chosen is chosen again."""

UNSURE = 0.5
"""And what was less probable than not: what was found since may have hidden it."""


def reconsidered(
    rounds: Sequence[Round],
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
) -> list[Round]:
    """Return the rounds, and one more for each early law that another replaces.

    The last round, which has found nothing more, stays the last. The law that was found
    last was chosen beside all others already, if that took none of them out.
    """
    kept = list(rounds)
    stayed = accepted(rounds)
    for found in stayed:
        chosen = found.chosen
        last = found is stayed[-1]
        doubtful = (_in_doubt(found) and not last) or _beside_wrong(rounds, found)
        if shop.limit.passed or chosen is None or not doubtful:
            continue
        shop.progress(f"choosing again at {chosen.place}, beside what was found since")
        again = _again(kept, found, recordings, noise, options, shop)
        if again is not None:
            one, fitted = again
            kept = [*kept[:-1], one, replace(kept[-1], base=fitted)]
    return kept


def _in_doubt(found: Round) -> bool:
    """Return whether what a round chose explained little, or was hardly probable."""
    assert found.chosen is not None
    unsure = found.probability is not None and found.probability < UNSURE
    return unsure or found.chosen.gain.value < LITTLE


def _beside_wrong(rounds: Sequence[Round], found: Round) -> bool:
    """Return whether a round chose beside a law that is not there any more."""
    at = next(i for i, one in enumerate(rounds) if one is found)
    earlier = {id(one.hypothesis) for one in chosen_in(rounds[:at])}
    # What took another's place was judged as that was, beside all else.
    own = () if found.without is not None else found.removed
    later = [law for one in rounds[at + 1 :] for law in one.removed]
    taken_out = {id(law) for law in (*own, *later)}
    return bool(earlier & taken_out)


def _again(
    rounds: Sequence[Round],
    found: Round,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
) -> tuple[Round, FittedModel] | None:
    """Return the round that chooses in place of a law, and the model with its choice.

    None where the law and how sure it is stay. A fit to the same law that has not come
    as far as the model had says no less how sure it is; the model stays.
    """
    assert found.chosen is not None
    before, current = found.chosen, rounds[-1].base
    law = before.candidate.hypothesis
    others = tuple(
        one.hypothesis for one in chosen_in(rounds) if one.hypothesis is not law
    )
    try:
        without = fitted_with(rounds[0].base, current, others, {})
    except BondGraphError:
        return None  # What was found later sits on it.
    setting = Setting(
        without, recordings, noise, options, len(rounds), others, curves=False
    )
    seen = one_round(setting, shop)
    chosen = seen.chosen
    if chosen is None or seen.cut_short:
        return None
    same = (chosen.physics, chosen.place) == (before.physics, before.place)
    known = 1.0 if found.probability is None else found.probability
    surer = (seen.probability or 0.0) > known
    unchanged = chosen.candidate.hypothesis.told_by == law.told_by
    fits = as_good(chosen.candidate.fitted, current, options.rule)
    if not (fits or unchanged) or (same and not surer):
        return None
    left = without.optimum.cost / rounds[0].base.optimum.cost
    again = replace(seen, removed=(*seen.removed, law), without=left)
    return again, chosen.candidate.fitted if fits else current
