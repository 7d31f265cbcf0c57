"""Colour by a value per place, and what it says in words."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from bondgraph.errors import StructureError, did_you_mean
from bondgraph.reporting.wording import number_words
from bondgraph.structure.graph import FinishedGraph


@dataclass(frozen=True, slots=True)
class Colouring:
    """A value per place, from no colour at the least to full colour at the greatest.

    Parameters
    ----------
    values
        By junction or element; no colour is at 0 or at the least value below it.
    caption
        What the values are, for the legend.
    unit
        Their unit.
    """

    values: Mapping[str, float]
    caption: str = ""
    unit: str = ""

    def shares(self) -> dict[str, float]:
        """Return how much colour each place has, from 0 to 1."""
        low, high = self._range()
        span = (high - low) or 1.0
        return {place: (value - low) / span for place, value in self.values.items()}

    def written(self, place: str) -> str:
        """Return the value of a place in words."""
        return f"{number_words(self.values[place], 3)} {self.unit}".strip()

    def tooltip(self, place: str) -> str:
        """Return the value of a place with what it means."""
        return f"{self.caption} {self.written(place)}".strip()

    def scale(self) -> str:
        """Return what the colours mean, for the legend."""
        low, high = (number_words(bound, 3) for bound in self._range())
        return f"{low} to {high} {self.unit} {self.caption}".replace("  ", " ").strip()

    def _range(self) -> tuple[float, float]:
        return min(0.0, *self.values.values()), max(0.0, *self.values.values())


class _Blame(Colouring):
    """Shares of the error, in per cent; full colour is all of it."""

    def shares(self) -> dict[str, float]:
        return dict(self.values)

    def written(self, place: str) -> str:
        return f"{self.values[place]:.0%}"

    def tooltip(self, place: str) -> str:
        return f"{self.written(place)} of the error"

    def scale(self) -> str:
        return "0 to 100 % of the error could arise there"


def colouring_of(
    graph: FinishedGraph,
    colour: Colouring | None,
    blame: Mapping[str, float] | None,
) -> Colouring | None:
    """Return the colouring of a picture, checked against its graph.

    Raises
    ------
    StructureError
        If a place is unknown, a value not finite, a blame not between 0 and 1, or both
        a colouring and a blame are given.
    """
    if blame:
        if colour is not None:
            raise StructureError(
                "A picture has one colour, and was given a colouring and a blame.",
                (),
                "Leave one of them out.",
            )
        colour = _Blame(dict(blame))
    if colour is None or not colour.values:
        return None
    check_places(graph, colour.values)
    for name, value in colour.values.items():
        if isinstance(colour, _Blame) and not 0.0 <= value <= 1.0:
            raise StructureError(
                f"The blame of {name!r} is {value}.", (name,), "Give a share, 0 to 1."
            )
        if not math.isfinite(value):
            raise StructureError(
                f"The value of {name!r} is {value}.", (name,), "Give a finite number."
            )
    return colour


def check_places(
    graph: FinishedGraph, names: Iterable[str], *, sensors: bool = False
) -> None:
    """Refuse names that no junction or element of the graph has, nor a sensor if so."""
    known = {*graph.by_name, *(m.name for m in graph.measurements if sensors)}
    for name in sorted(names):
        if name not in known:
            raise StructureError(
                f"There is no {name!r} in {graph.name!r} to colour or mark.",
                (name,),
                did_you_mean(name, known),
            )
