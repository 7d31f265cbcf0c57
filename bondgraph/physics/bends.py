"""What smooth curves are made of: a line, and bends at knots."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

Knots = tuple[float, ...]

WEAKLY = 3.0
"""Standard deviation of a smooth curve's level and slope amid, in its own size: told by
the recordings where these tell them, and not wholly open where another law shares them.
"""

LINES = ("slope", "level")
"""What the straight parts of a curve are called, first what a resistance takes."""


@dataclass(frozen=True)
class Part:
    """A curve that is a part of another: what it is called, and its usual size.

    ``share`` is that size for a curve that goes up and down by 1. The curve takes
    arrays and expressions.
    """

    name: str
    curve: Callable[[Any], Any]
    share: float


def parts(knots: Knots) -> tuple[list[Part], list[Part]]:
    """Return level and slope, and a bend at every knot that has two neighbours."""
    span, amid = knots[-1] - knots[0], (knots[-1] + knots[0]) / 2.0
    lines = [
        Part("level", lambda x: 0 * x + 1, WEAKLY),
        Part("slope", lambda x: x - amid, WEAKLY / span),
    ]
    bends = [
        Part(f"bend_{i}", partial(_bend, at=knots[i]), _share(knots, i, span))
        for i in range(1, len(knots) - 1)
    ]
    return lines, bends


def odd_parts(knots: Knots) -> tuple[list[Part], list[Part]]:
    """Return the slope, and bends at knots beyond zero and at their mirror images."""
    span = 2.0 * knots[-1]
    lines = [Part("slope", lambda x: x, WEAKLY / span)]
    bends = [
        Part(f"bend_{i}", partial(_two_bends, at=knots[i]), _share(knots, i, span))
        for i in range(1, len(knots) - 1)
    ]
    return lines, bends


def _share(knots: Knots, i: int, span: float) -> float:
    """Return how much the slope may change at a knot, at a roughness of 1."""
    return float(((knots[i + 1] - knots[i - 1]) / 2.0 / span) ** 0.5 / span)


def _bend(x: Any, at: float) -> Any:
    return abs(x - at) / 2


def _two_bends(x: Any, at: float) -> Any:
    return (abs(x - at) - abs(x + at)) / 2 + x


def ramp(x: Any, edge: float) -> Any:
    """Return what rises from -1 to 1 between both sides of `edge`."""
    return (abs(x + edge) - abs(x - edge)) / (2 * edge)
