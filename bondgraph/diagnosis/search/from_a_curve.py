"""From a curve: where it is told in place of named laws the search begins anew.

A curve that no law with a name comes near to, one that leaves noise alone where they
leave much, one that a law and a curve beside it are two pieces of, and one that leaves
about as much as a law of which no number is told.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.evidence.leftover import noise_floor
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.curve_beside import (
    BetterCurve,
    told_if_fine,
    told_instead,
    with_curve,
)
from bondgraph.diagnosis.search.revising.hollow_first import in_place_of_hollow
from bondgraph.diagnosis.search.revising.one_relation import AS_MUCH, one_relation
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.recordings.binding import BoundRecording


def from_a_curve(
    rounds: Sequence[Round],
    recordings: Sequence[BoundRecording],
    options: Options,
    shop: Workshop,
) -> list[Round] | None:
    """Return rounds that end with a curve in place of laws with a name, if any do."""
    said, least = "again, from a curve that no law with a name comes near to", 1.0
    curve = told_instead(rounds, options.rule)
    if curve is None:
        curve = all_there_is(rounds, recordings, options, shop)
    if curve is None:
        said, least = "again, from a curve in place of a law that it mends", AS_MUCH
        curve = one_relation(rounds)
    if curve is None and not shop.limit.passed:
        said = "again, from a curve in place of a law of which no number is told"
        curve = in_place_of_hollow(rounds, shop)
    if curve is None or shop.limit.passed:
        return None
    shop.progress(said)
    return with_curve(rounds, curve, options.rule, shop, least)


def all_there_is(
    rounds: Sequence[Round],
    recordings: Sequence[BoundRecording],
    options: Options,
    shop: Workshop,
) -> BetterCurve | None:
    """Return a curve that leaves noise alone where named laws leave much, if any."""
    if shop.limit.passed:
        return None
    floor = np.fromiter(noise_floor(recordings).values(), np.float64)
    return told_if_fine(rounds, floor, options.rule, shop)
