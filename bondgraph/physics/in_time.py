"""What changes in the course of a recording, whatever passes through it.

What is warm or cold from before recovers; dirt, wear or a thing that nobody records go
on. That is told from a law of what passes through only where this comes back late in a
recording as it was early: else time is as good a variable as any.
"""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.places.base import E, F
from bondgraph.physics.places.element import ElementPlace
from bondgraph.structure.signals import t

WARM_UPS = (0.03, 0.1, 0.3, 1.0)
"""Times that fits of a warm-up start from, as shares of what one recording lasts."""

MOST = 0.9
"""Of its value an element loses at most over the longest recording."""


def in_time(
    physics: AbstractPhysics, place: ElementPlace, junction: str, least: float
) -> Iterator[Hypothesis]:
    """Yield that an element changes evenly, or recovers from how it begins.

    Parameters
    ----------
    junction
        What passes there has to come back.
    least
        Seconds in which it recovers at least.
    """
    common = F if place.is_one_junction(junction) else E
    if f"{common}({junction})" in place.scales.lasting:
        yield _evenly(physics, place)
        yield _recovering(physics, place, least)


def _evenly(physics: AbstractPhysics, place: ElementPlace) -> Hypothesis:
    stretch = place.scales.stretch
    a = place.strength("drift", "1/s", (0.0, 0.2 / stretch), low=-MOST / stretch)
    law = place.usual_law * (1 + a.symbol * (t - place.scales.begin))
    words = f"{place.name} changes evenly with time, whatever passes through it"
    edit = place.replace(law, a)
    return physics.hypothesis(place, edit, law, (a,), words, also=place.junctions)


def _recovering(
    physics: AbstractPhysics, place: ElementPlace, least: float
) -> Hypothesis:
    times = tuple(share * place.scales.stretch for share in WARM_UPS)
    x = place.strength("beginning", "1", (0.0,) * 4 + (0.1,), low=-MOST)
    tau = place.shape("recovery_time", "s", times * 2, low=least)
    passed = t - place.scales.begin
    law = place.usual_law * (1 + x.symbol * sympy.exp(-passed / tau.symbol))
    words = f"{place.name} is another one as a recording begins, and recovers"
    edit = place.replace(law, x, tau)
    return physics.hypothesis(place, edit, law, (x, tau), words, also=place.junctions)
