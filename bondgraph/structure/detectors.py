"""Sensors as things that hang on a junction: De, Df, Dp and Dq take no power.

Each becomes a `Measurement` named like the sensor, with the unit of its domain.
"""

from dataclasses import dataclass
from typing import ClassVar

from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import Named


@dataclass(frozen=True, slots=True)
class EffortDetector(Named):
    """De: reads the effort of a 0-junction or one-port."""

    quantity: ClassVar[Quantity] = Quantity.EFFORT
    letter: ClassVar[str] = "De"
    _kind: ClassVar[str] = "a sensor"


@dataclass(frozen=True, slots=True)
class FlowDetector(Named):
    """Df: reads the flow of a 1-junction or one-port."""

    quantity: ClassVar[Quantity] = Quantity.FLOW
    letter: ClassVar[str] = "Df"
    _kind: ClassVar[str] = "a sensor"


@dataclass(frozen=True, slots=True)
class MomentumDetector(Named):
    """Dp: reads the momentum (integral of effort) of a 0-junction or one-port."""

    quantity: ClassVar[Quantity] = Quantity.MOMENTUM
    letter: ClassVar[str] = "Dp"
    _kind: ClassVar[str] = "a sensor"


@dataclass(frozen=True, slots=True)
class DisplacementDetector(Named):
    """Dq: reads the displacement (integral of flow) of a 1-junction or one-port."""

    quantity: ClassVar[Quantity] = Quantity.DISPLACEMENT
    letter: ClassVar[str] = "Dq"
    _kind: ClassVar[str] = "a sensor"


Detector = EffortDetector | FlowDetector | MomentumDetector | DisplacementDetector
De, Df, Dp, Dq = EffortDetector, FlowDetector, MomentumDetector, DisplacementDetector
