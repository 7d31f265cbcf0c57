"""What `separability` answers: angles between places, classes, and sensors to add."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class SeparabilityStatus(StrEnum):
    """What the sensors can tell apart; the value is the sentence to show."""

    ALL = "These sensors can tell all places apart, even for free signals."
    CLASSES = (
        "Within some classes of places a free signal at one looks exactly like another "
        "at another; only the law it follows can tell them apart."
    )
    NONE = "To these sensors a free signal looks the same wherever it acts."


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorProposal:
    """A sensor that is not there, and what it would tell apart.

    Parameters
    ----------
    quantity, place, unit
        ``flow`` of a 1-junction or ``effort`` of a 0-junction.
    splits
        The class of places that it would split.
    into
        The classes it would become.
    angle
        Least angle, in degrees, between members of different classes then.
    """

    quantity: str
    place: str
    unit: str
    splits: tuple[str, ...]
    into: tuple[tuple[str, ...], ...]
    angle: float

    @property
    def statement(self) -> str:
        """The proposal in words."""
        parts = " from ".join(" or ".join(part) for part in self.into)
        return f"Measuring the {self.quantity} at {self.place} would tell {parts}."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Separability:
    """Which places can be told apart by which sensors.

    Parameters
    ----------
    places
        Names, in the order of `angles`.
    angles
        In degrees, the largest over frequencies and operating points between what a
        free signal at one place and one at another do to the outputs, in units of
        their noise. 0: whatever one does, the other can do too. Free parameters are
        finitely many and a free signal is not, so they do not change it.
    classes
        Places closer together than one degree, as far as these recordings show.
    structural_classes
        Places that the structure of the equations does not isolate from each other,
        whatever the values (Dulmage-Mendelsohn; parameters taken as known).
    undetectable
        Places at which a signal reaches no redundancy at all.
    proposals
        Sensors that would split a class, the clearest first.
    """

    status: SeparabilityStatus
    places: tuple[str, ...]
    angles: Array
    classes: tuple[tuple[str, ...], ...]
    structural_classes: tuple[tuple[str, ...], ...]
    undetectable: tuple[str, ...]
    proposals: tuple[SensorProposal, ...]
    reasons: tuple[str, ...]

    def angle(self, one: str, other: str) -> float:
        """Return the angle between two places, in degrees."""
        i, j = self.places.index(one), self.places.index(other)
        return float(self.angles[i, j])

    def class_of(self, place: str) -> tuple[str, ...]:
        """Return the places that `place` cannot be told from, itself among them."""
        return next(members for members in self.classes if place in members)
