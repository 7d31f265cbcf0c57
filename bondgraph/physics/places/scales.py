"""Typical sizes of signals: what start values of hypotheses are measured in."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from bondgraph.structure.domains import Quantity

REVERSED = 0.02
"""A signal that goes the other way by less than this share does not reverse."""

SLOWEST = 10.0
"""Of the longest recording: what fades in such a time hardly fades in any."""


@dataclass(frozen=True, slots=True)
class Scales:
    """Typical sizes of signals in the base model's simulation.

    Parameters
    ----------
    sizes
        Root mean square by signal name, ``effort(joint)``, or by output name.
    ranges
        Least and largest value, by the same names.
    interval
        Seconds between samples; 0 where not known.
    duration
        Seconds of the longest recording; 0 where not known.
    fitted
        What a fit has made of the parameters; empty where there was none.
    least
        Least size other than zero, by the same names, in the rows of a steady table;
        empty where there is motion between samples.
    ringing
        Frequencies at which what a fit has left rings, in rad/s, the clearest first.
    tenths
        In how many tenths of its largest size an input has been, by name; all where
        not known.
    lasting
        The signals that go on all through a recording as they began, by name; None
        where that is not known.
    begin
        When the earliest recording begins, in seconds on its own clock.
    """

    sizes: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    interval: float = 0.0
    duration: float = 0.0
    fitted: Mapping[str, float] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)
    ringing: tuple[float, ...] = ()
    tenths: Mapping[str, int] = field(default_factory=dict)
    lasting: frozenset[str] | None = None
    begin: float = 0.0

    def at(self, quantity: Quantity, place: str, default: float = 1.0) -> float:
        """Return the size of `quantity` at `place`, or `default` where unknown or 0."""
        return self.of(f"{quantity}({place})", default)

    def of(self, name: str, default: float = 1.0) -> float:
        """Return the size of the signal or output called `name`, or `default`."""
        return self.sizes.get(name, 0.0) or default

    def range_of(self, name: str, default: float = 1.0) -> tuple[float, float]:
        """Return the range of a signal or output; about ± 1.5 sizes where unknown."""
        size = self.of(name, default)
        low, high = self.ranges.get(name, (0.0, 0.0))
        return (low, high) if low < high else (-1.5 * size, 1.5 * size)

    def is_constant(self, name: str) -> bool:
        """Return whether the signal called `name` is known to hold one value."""
        low, high = self.ranges.get(name, (0.0, 1.0))
        return low == high

    def reverses(self, name: str) -> bool:
        """Return whether the signal called `name` goes both ways; also if unknown."""
        low, high = self.ranges.get(name, (-1.0, 1.0))
        return min(-low, high) > REVERSED * max(-low, high)

    @property
    def step(self) -> float:
        """The shortest time worth fitting: the sampling interval, or 1 ms."""
        return self.interval or 1e-3

    @property
    def stretch(self) -> float:
        """The time in which things happen: the duration, or 1000 steps."""
        return self.duration or 1000 * self.step

    @property
    def slowest(self) -> float:
        """The longest time worth fitting: beyond it a state is a constant."""
        return SLOWEST * self.stretch
