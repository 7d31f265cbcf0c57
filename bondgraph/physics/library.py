"""The list of all physics that a diagnosis considers, from plain to particular.

Where two laws predict equally well, the one listed first is told first.
"""

from bondgraph.physics.actuation import (
    DeadZone,
    InputNonlinearity,
    InputScale,
    Saturation,
)
from bondgraph.physics.bias import ConstantBias
from bondgraph.physics.contact import AddedCompliance, Backlash, SeriesCompliance
from bondgraph.physics.coupling import (
    Drag,
    GyroscopicCoupling,
    SharedInertia,
    Tie,
)
from bondgraph.physics.drag import QuadraticDrag, SpeedLimit
from bondgraph.physics.dynamics import Delay, Lag
from bondgraph.physics.friction import (
    CoulombFriction,
    DirectionDependentFriction,
    StribeckFriction,
    ViscousFriction,
    VoltageDrop,
)
from bondgraph.physics.hypothesis import AbstractPhysics
from bondgraph.physics.hysteresis import BoucWenHysteresis, DahlHysteresis
from bondgraph.physics.in_time import ParameterDrift
from bondgraph.physics.induction import InducedCurrent
from bondgraph.physics.inertia import AddedInertia, SaturatingInertia
from bondgraph.physics.leakage import Bypass, Leak, Slip
from bondgraph.physics.load import LoadDependentFriction
from bondgraph.physics.lost_motion import LostMotion
from bondgraph.physics.modes import FlexibleMode
from bondgraph.physics.moments import DisturbanceStep, ParameterStep
from bondgraph.physics.one_way import DirectionDependentDamping, OneWayPassage
from bondgraph.physics.orifice import Clamp, Overflow, SquareLaw, SquareRootOrifice
from bondgraph.physics.position import (
    Cogging,
    EndStop,
    Gravity,
    HardeningSpring,
    Spring,
)
from bondgraph.physics.ratio import Eccentricity
from bondgraph.physics.relaxation import StoreAmid, StoreBehind
from bondgraph.physics.sensing import SensorBias, SensorNonlinearity, SensorScale
from bondgraph.physics.thermal import (
    Radiation,
    TemperatureDependentGyrator,
    TemperatureDependentResistance,
)
from bondgraph.physics.unknown import UnknownRelation
from bondgraph.physics.viscoelastic import RelaxingSpring
from bondgraph.physics.wiring import InputSwap, SensorSwap

LIBRARY: tuple[AbstractPhysics, ...] = (
    ViscousFriction(),
    CoulombFriction(),
    VoltageDrop(),
    LoadDependentFriction(),
    DirectionDependentFriction(),
    DirectionDependentDamping(),
    StribeckFriction(),
    QuadraticDrag(),
    ConstantBias(),
    Gravity(),
    Spring(),
    HardeningSpring(),
    AddedInertia(),
    AddedCompliance(),
    StoreBehind(),
    StoreAmid(),
    RelaxingSpring(),
    InducedCurrent(),
    Leak(),
    Bypass(),
    SquareLaw(),
    SquareRootOrifice(),
    Overflow(),
    Clamp(),
    OneWayPassage(),
    Radiation(),
    EndStop(),
    SeriesCompliance(),
    FlexibleMode(),
    Drag(),
    Tie(),
    SharedInertia(),
    GyroscopicCoupling(),
    Backlash(),
    DahlHysteresis(),
    BoucWenHysteresis(),
    Cogging(),
    Eccentricity(),
    SaturatingInertia(),
    TemperatureDependentResistance(),
    TemperatureDependentGyrator(),
    ParameterDrift(),
    ParameterStep(),
    DisturbanceStep(),
    SpeedLimit(),
    SensorBias(),
    SensorScale(),
    SensorSwap(),
    InputScale(),
    InputSwap(),
    Lag(),
    Delay(),
    Slip(),  # of a filtered reading it says much the same, and is rarer
    Saturation(),
    DeadZone(),
    LostMotion(),
    InputNonlinearity(),
    SensorNonlinearity(),
    UnknownRelation(),
)
