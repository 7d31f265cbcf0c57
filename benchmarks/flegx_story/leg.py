"""The four drives of the simulated leg, and what of its physics is there.

Inertias are those of `flegx_models.parameters` (RECONCILED), but a motor is 4 % heavier
than its data sheet says and the bearings have grease: an individual machine. What is
concealed:

- **worm mesh**: friction of 0.34 of the torque that the worm passes on, and 3.15 N·m at
  the joint besides. These two are read off the thesis's tuned zeros
  (`flegx_models.tuned_zeros`); so zeros that come out like those are no evidence about
  the real leg, only that nothing is lost between recordings and controller.
- **tendons** of the knee: 500 N·m/rad. No number is printed; this one is chosen.
- **flexible link**: m_eq (2π 35 Hz)² L² with section 3.1.3's m_eq = 0.13 kg, L of the
  stance gains. In flight it carries its own modal mass, in stance the support.
- **encoder filter**: 25 Hz, twice second order (eq. 3.34, section 3.4).

In stance the worm carries the weight, which the feed-forward holds: recorded is the
torque of the motor beyond that, which is the input of the printed models.
"""

import math
from dataclasses import dataclass

from benchmarks.concealed.effects import Effect, Scales
from benchmarks.concealed.machine import Drive, Loop, Machine, Number, Place, Sensor
from benchmarks.concealed.machine import Site as Where
from benchmarks.flegx_story.train import (
    MOST,
    RATIO,
    WORM,
    forces,
    masses,
    readings,
)

FRICTION_PER_LOAD, CONSTANT_FRICTION = 0.34, 3.15  # 1; N·m at the joint
TENDON, TENDON_DAMPING = 500.0, 1.5  # N·m/rad, N·m·s/rad: chosen
LENGTH = 0.30922  # m
LINK = 0.13 * (2 * math.pi * 35.0 * LENGTH) ** 2  # N·m/rad, section 3.1.3
LINK_DAMPING = 0.5  # N·m·s/rad: chosen
LINK_INERTIA = 0.13 * LENGTH**2  # kg·m²
VISCOUS = 0.35  # N·m·s/rad, bearings with grease: chosen
CUT_OFF = 2 * math.pi * 25.0  # rad/s
MOTOR_SIDE = (1.04 * 2.1348e-5 + 9.1e-7) * RATIO**2 + 3e-5 * WORM**2  # kg·m²
TORQUE_STEP = 42.7e-3 * 20.0 / 2**14  # N·m: 14 bits over 10 A either way
TORQUE_LIMIT = 42.7e-3 * 10.0  # N·m
RATE = 200.0  # Hz

ENCODER = Sensor(
    name="theta", unit="rad", noise=math.radians(0.03), step=2 * math.pi / 2**14
)
GAUGE = Sensor(name="torque", unit="N*m", noise=0.05, step=60.0 / 2**12)
"""The torque sensor between worm gear and joint (section 2.1.3); noise chosen."""
LINK_GAUGE = Sensor(name="link", unit="N*m", noise=0.05, step=60.0 / 2**12)
"""The strain gauges of the link, read as its torque on the joint; noise chosen."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """One joint in one phase.

    Parameters
    ----------
    model
        Its name in `flegx_models.models`.
    inertia
        kg·m² that turns with the joint, before the link.
    behind
        kg·m² that the link carries: its own, or the support's.
    load
        N·m of weight that the worm carries.
    tendons
        Whether the worm moves the joint through tendons.
    strained
        Whether strain gauges sit on what the joint carries: on the flexible link,
        which in the printed models of flight is one with the joint.
    """

    model: str
    inertia: float
    behind: float
    load: float
    tendons: bool
    strained: bool = False


JOINTS = (
    Joint(model="lowerleg_flight", inertia=0.0126 - LINK_INERTIA, behind=LINK_INERTIA,
          load=0.344, tendons=True),
    Joint(model="upperleg_flight", inertia=0.1411 - LINK_INERTIA, behind=LINK_INERTIA,
          load=3.012, tendons=False),
    Joint(model="lowerleg_stance", inertia=0.0126, behind=9.39 * LENGTH**2,
          load=16.77, tendons=True, strained=True),
    Joint(model="upperleg_stance", inertia=0.1411, behind=8.53 * LENGTH**2,
          load=18.09, tendons=False),
)  # fmt: skip
"""Loads are gravity's in the middle of the tuning tests (section 6.1)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Concealed:
    """Which of the four pieces of physics a recorded leg has."""

    worm: bool = False
    tendons: bool = False
    link: bool = False
    filter: bool = False

    @property
    def name(self) -> str:
        """What is there, in a word for a folder."""
        there = [name for name in self.__slots__ if getattr(self, name)]
        return "all" if len(there) == len(self.__slots__) else "_".join(there)


ALL = Concealed(worm=True, tendons=True, link=True, filter=True)
ALONE = tuple(Concealed(**{name: True}) for name in Concealed.__slots__)


def machine(joint: Joint, concealed: Concealed, *, gauged: bool = False) -> Machine:
    """Return the drive of `joint` as the simulator knows it.

    ``gauged`` where the leg's torque sensor and strain gauges are recorded too.
    """
    inertias, springs, dampers = [MOTOR_SIDE], [], []
    tendons = concealed.tendons and joint.tendons
    if tendons:
        inertias.append(joint.inertia)
        springs, dampers = [TENDON], [TENDON_DAMPING]
    else:
        inertias[-1] += joint.inertia
    behind = joint.inertia
    if concealed.link:
        inertias.append(joint.behind)
        springs, dampers = [*springs, LINK], [*dampers, LINK_DAMPING]
    else:
        inertias[-1] += joint.behind
        behind += joint.behind
    numbers = (
        *_padded(inertias, MOST),
        *_padded(springs, MOST - 1),
        *_padded(dampers, MOST - 1),
        *(VISCOUS, float(tendons), behind, joint.load, CUT_OFF, joint.inertia),
    )
    return Machine(
        name=joint.model,
        domains=("rotation",),
        forces=forces,
        masses=masses,
        readings=readings,
        coordinates=len(inertias),
        stores=4 if concealed.filter else 0,
        numbers=tuple(Number(name=str(i), value=x) for i, x in enumerate(numbers)),
        places=(Place(name="worm", row=(WORM, *(0.0 for _ in inertias[1:]))),),
        inputs=(("T_motor", "N*m"),),
        sensors=sensors(joint) if gauged else (ENCODER,),
        drive=Drive(
            size=1.0,
            band=(0.3, 8.0),
            limit=TORQUE_LIMIT,
            resolution=TORQUE_STEP,
            loop=Loop(kp=0.4, kd=0.02, derivative_time=0.005),
        ),
        rate=RATE,
        samples=1500,
        fine=40,
        model="",
        sites=(),
    )


def sensors(joint: Joint) -> tuple[Sensor, ...]:
    """Return all sensors of the leg that a printed model has a place for."""
    return (ENCODER, GAUGE, LINK_GAUGE) if joint.strained else (ENCODER, GAUGE)


def effects(concealed: Concealed) -> tuple[Effect, ...]:
    """Return the friction of the worm's mesh, to be hung on the worm."""
    if not concealed.worm:
        return ()
    return (
        Effect(Where(word="load_dependent_friction", place="worm"), FRICTION_PER_LOAD),
        Effect(Where(word="coulomb_friction", place="worm"), CONSTANT_FRICTION / WORM),
    )


SCALES = {"worm": Scales(1.0, 1.0, -1.0, 1.0, 1.0)}
"""Amplitudes are in SI units here, not in shares of the motion."""


def _padded(values: list[float], length: int) -> list[float]:
    return [*values, *(0.0 for _ in range(length - len(values)))]
