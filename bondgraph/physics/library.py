"""The list of all physics that a diagnosis considers, from plain to particular.

Where two laws predict equally well, the one listed first is told first.
"""

from bondgraph.physics.fields import (
    AddedInertia,
    ConstantBias,
    Gravity,
    HardeningSpring,
    QuadraticDrag,
    Spring,
)
from bondgraph.physics.friction import (
    CoulombFriction,
    DirectionDependentFriction,
    LoadDependentFriction,
    StribeckFriction,
    ViscousFriction,
)
from bondgraph.physics.hypothesis import AbstractPhysics
from bondgraph.physics.leakage import (
    ConstantFlow,
    Leak,
    SquareLaw,
    SquareRootOrifice,
)
from bondgraph.physics.unknown import UnknownRelation

LIBRARY: tuple[AbstractPhysics, ...] = (
    ViscousFriction(),
    CoulombFriction(),
    LoadDependentFriction(),
    DirectionDependentFriction(),
    StribeckFriction(),
    QuadraticDrag(),
    ConstantBias(),
    Gravity(),
    Spring(),
    HardeningSpring(),
    AddedInertia(),
    Leak(),
    SquareLaw(),
    SquareRootOrifice(),
    ConstantFlow(),
    UnknownRelation(),
)
