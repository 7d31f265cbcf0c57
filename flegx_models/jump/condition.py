"""The state of the leg and its counterweight, with what has happened on the way."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from flegx_models.jump.instant import Choice

Array = NDArray[np.float64]


class EventKind(StrEnum):
    """What happened at an instant; the value is the word to show."""

    TOUCH_DOWN = "touch-down"
    LIFT_OFF = "lift-off"


@dataclass(frozen=True, slots=True)
class Event:
    """An event, its time in s and its impulse in N·s (zero for a separation)."""

    kind: EventKind
    time: float
    impulse: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Ledger:
    """Where the energy went since the start, in J.

    ``motors`` is what the motors put in (before the worms), the others are losses.
    """

    motors: float = 0.0
    worms: float = 0.0
    sliding: float = 0.0
    impacts: float = 0.0
    rope: float = 0.0

    @property
    def balance(self) -> float:
        """What the leg's own energy should have gained."""
        losses = self.worms + self.sliding + self.impacts + self.rope
        return self.motors - losses


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """The whole state of the machine.

    Parameters
    ----------
    q, v
        Support height, hip and knee angle, counterweight height; and their rates.
    down
        Whether the foot is on the ground.
    meshes
        Torques that the worm wheels pass on to hip and knee, N·m, over the last step.
    push, pull
        Forces of the ground up on the foot and of the rope, N, over the last step.
    """

    time: float
    q: Array
    v: Array
    down: bool
    choice: Choice
    meshes: Array = field(default_factory=lambda: np.zeros(2))
    push: float = 0.0
    pull: float = 0.0
    ledger: Ledger = field(default_factory=Ledger)
    events: tuple[Event, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Counterweight:
    """A mass on a rope over a pulley; the rope only pulls.

    ``mass`` in kg, ``stiffness`` in N/m and ``damping`` in N·s/m of the rope.
    """

    mass: float
    stiffness: float
    damping: float

    def stretch(self, q: Array) -> float:
        """Return by how much the rope is stretched, in m, not negative."""
        return max(-float(q[0] + q[3]), 0.0)

    def pull(self, q: Array, v: Array) -> tuple[float, float]:
        """Return the rope's force in N and the part of it that is damping."""
        stretch = self.stretch(q)
        if not stretch:
            return 0.0, 0.0
        elastic = self.stiffness * stretch
        force = max(elastic - self.damping * float(v[0] + v[3]), 0.0)
        return force, force - elastic
