"""A curve in place of a first law of which no number is told.

Such a law lends its form to something else, and what is found beside it mends that:
what evaporates from a hot part is nearly a heat capacity without end amid a path, and a
second store. A curve that leaves about as much is likelier than all of these.
"""

from collections.abc import Sequence
from dataclasses import replace

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search.revising.curve_beside import (
    BetterCurve,
    drawn_beside,
    held_against,
)
from bondgraph.diagnosis.search.revising.hollow import ends_as_nothing
from bondgraph.diagnosis.search.revising.one_relation import AS_MUCH
from bondgraph.diagnosis.search.round_found import Round, made_in
from bondgraph.diagnosis.work.workers import Workshop


def in_place_of_hollow(rounds: Sequence[Round], shop: Workshop) -> BetterCurve | None:
    """Return the curve to tell in place of all that was found with a name, if any.

    One that came as near as the first law with few knots, at any place, and that leaves
    about as much as all of them once it is drawn finely.
    """
    made, first = made_in(rounds), rounds[0]
    if not made or made[0] is not first.chosen:
        return None
    named = all(one.physics != CURVE for one in made)
    if not named or not ends_as_nothing(rounds[-1].base, made[0].candidate):
        return None
    for curve, fine in drawn_beside(first, made[0], first.judged, shop):
        held = held_against(made[-1], rounds, 0, fine)
        if held.times >= AS_MUCH:
            return replace(held, curve=curve)
    return None
