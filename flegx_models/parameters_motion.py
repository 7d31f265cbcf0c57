"""How far and how fast the leg moves in the thesis: the range its models are used in.

`MOTION` holds the angles of the tests (section 6.1) and of the squat (section 6.2), as
absolute angles from the vertical. The knee's printed angles are relative; the absolute
one is θ_knee + θ_hip, and in stance the opposite of the hip's (eq. 4.16).
"""

import math

from bondgraph import Parameter, ParameterSet, Published

_TESTS = "section 6.1.1: hip -40 to -50 deg"
_SQUAT = "section 6.2: the squat starts and ends at -π/6"
_KNEE = "section 6.1.1: knee 90 to 70 deg against a hip at -45 deg"
_UNIFORM = 1 / math.sqrt(3)

_Row = tuple[str, float, str, float, str]

_GIVEN: tuple[_Row, ...] = (
    ("hip_steepest", -math.radians(50), "rad", math.radians(0.5), _TESTS),
    ("hip_straightest", -math.pi / 6, "rad", 0.0, _SQUAT),
    ("knee_straightest", math.radians(25), "rad", math.radians(0.5), _KNEE),
    ("knee_steepest", math.radians(45), "rad", math.radians(0.5), _KNEE),
    ("speed", 0.75, "rad/s", 0.005, "section 6.2: hip speed at lift-off"),
)

MOTION = ParameterSet(
    tuple(
        Parameter(
            name=name,
            value=value,
            unit=unit,
            std=half * _UNIFORM,
            rounding=half,
            source=Published(f"FlegX thesis, {where}"),
        )
        for name, value, unit, half, where in _GIVEN
    )
)
"""The range of motion as printed."""
