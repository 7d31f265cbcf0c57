"""A machine as the simulator knows it, and what a user would know of it.

The simulator's side is three compiled functions and numbers. The user's side is the
text of a base model with gaps for values, the names of inputs and outputs, and the
names of places, which both sides share.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Number:
    """A parameter of a machine.

    ``free`` is one that the base model has with a wrong value and open bounds; others
    are in the base model with their true value, or, with ``hidden``, not at all.
    """

    name: str
    value: float
    unit: str = "1"
    free: bool = False
    hidden: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where a law can hang.

    Parameters
    ----------
    row
        The place's flow in the machine's flows; empty at a place that stores.
    cell
        Index of the store whose effort the place has, or -1.
    load
        Index of the effort it transmits, for friction that grows with it.
    gain
        Effort there per unit of the typical input, for choosing sizes of laws.
    """

    name: str
    row: tuple[float, ...] = ()
    cell: int = -1
    load: int = 0
    gain: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """An output: its name, unit, noise (rms) and quantisation step."""

    name: str
    unit: str
    noise: float
    step: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """A controller in the loop: ``feed + kp (reference - y) - kd dy/dt``, limited.

    ``channel`` is the output that it reads.
    """

    kp: float
    kd: float
    channel: int = 0
    derivative_time: float = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """How a machine is excited.

    Parameters
    ----------
    size, offset
        Of the first input (open loop) or of the reference (closed loop).
    band
        Lowest and highest frequency in Hz.
    limit
        Largest command.
    resolution
        Step of the command; 0 for none.
    loop
        The controller, or None for an open loop.
    others
        Size and offset of every further input, or of its reference where a loop of
        ``other_loops`` drives it.
    """

    size: float
    band: tuple[float, float]
    limit: float
    offset: float = 0.0
    resolution: float = 0.0
    loop: Loop | None = None
    others: tuple[tuple[float, float], ...] = ()
    other_loops: tuple[Loop, ...] = ()

    @property
    def loops(self) -> tuple[Loop, ...]:
        """The controllers of the first inputs, one after the other."""
        return () if self.loop is None else (self.loop, *self.other_loops)


@dataclass(frozen=True, slots=True, kw_only=True)
class Site:
    """An effect at a place: the word, the place, and how it enters.

    ``sets`` gives machine parameters for an amplitude and the scales of the base
    motion, for effects that the machine's own equations hold; otherwise the word's law
    is hung on the place. ``largest`` is the amplitude beyond which it makes no sense.
    """

    word: str
    place: str
    sets: Callable[[float, Mapping[str, float]], Mapping[str, float]] | None = None
    law: str = ""
    largest: float = 0.6
    variant: str = ""
    silent: bool = False
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine: equations, numbers, places, sensors, excitation and base model.

    Parameters
    ----------
    forces, masses, readings
        Compiled; see `benchmarks.concealed.stepping`.
    coordinates, stores
        How many q (and flows v) and how many z.
    start
        z at the first sample, or None for zeros.
    rate, fine
        Samples per second and small steps per sample.
    samples
        Of one recording.
    model
        Text of the base model with ``{name}`` for every value, ``{name_bounds}`` for
        bounds.
    window
        Samples simulated from one state when models are compared; 0 for all. A machine
        that integrates its input has to be compared over short stretches.
    aliases
        Other names of the user's model for the same place.
    linear
        Whether the base model is linear, so that signal paths commute.
    variants
        Other equations with the same places, for effects that add coordinates.
    """

    name: str
    domains: tuple[str, ...]
    forces: Any
    masses: Any
    readings: Any
    coordinates: int
    stores: int = 0
    numbers: tuple[Number, ...]
    places: tuple[Place, ...]
    inputs: tuple[tuple[str, str], ...]
    sensors: tuple[Sensor, ...]
    drive: Drive
    rate: float
    samples: int
    fine: int
    model: str
    sites: tuple[Site, ...]
    start: tuple[float, ...] = ()
    window: int = 0
    aliases: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    linear: bool = False
    variants: Mapping[str, "Machine"] = field(default_factory=dict)

    @property
    def values(self) -> dict[str, float]:
        """The nominal values by name, in order."""
        return {number.name: number.value for number in self.numbers}

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the parameters that the base model may fit."""
        return tuple(number.name for number in self.numbers if number.free)

    def place(self, name: str) -> Place:
        """Return the place called `name`."""
        return next(place for place in self.places if place.name == name)

    def index(self, name: str) -> int:
        """Return where the parameter `name` stands among the numbers."""
        return [number.name for number in self.numbers].index(name)
