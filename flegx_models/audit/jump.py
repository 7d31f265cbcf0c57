"""Chapter 6 and the demand of section 2.1.2: what drive, squat and counterweight can.

Whether the leg leaves the ground is a matter of simulation (`flegx_models.jump`,
docs/jump.md); here is what follows from the printed numbers alone.
"""

import math
from collections.abc import Iterator

from flegx_models import models
from flegx_models.audit.records import Remark
from flegx_models.gains import derived
from flegx_models.jump.leg_graph import leg_parameters
from flegx_models.jump.worm import irreversible_worm
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_audit import AUDITED
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CONTROL
from flegx_models.parameters_datasheets import DATASHEETS

_RPM = 2 * math.pi / 60


def remarks() -> Iterator[Remark]:
    """Yield what the drive gives, how high a squat carries, and the rope's inertia."""
    yield _drive()
    yield from _height()
    yield _inertia_of_the_counterweight()


def _drive() -> Remark:
    """Say what the drive of tables 2.1 to 2.3 gives of what section 2.1.2 demands."""
    d, asked = DATASHEETS.values_by_name(), AUDITED.values_by_name()
    torque = CHAPTER_3.values_by_name()["T_knee_max"]
    worm = irreversible_worm()
    ideal = d["motor_nominal_torque"] * worm.ratio
    efficiency = d["gearhead_maximum_efficiency"] * worm.efficiency
    peak = d["gearhead_intermittent_torque"] * d["K_worm_gear"] * worm.efficiency
    speed = d["motor_nominal_speed"] / worm.ratio / _RPM
    allowed = d["gearhead_intermittent_speed"] / worm.ratio / _RPM
    return Remark(
        where="section 2.1.2",
        statement=f"A jump of 5 cm is said to need more than {torque:g} N·m and "
        f"{asked['speed_demanded'] / _RPM:g} rpm. The motor's nominal torque is "
        f"{ideal:.0f} N·m at the joint without losses; a worm that cannot be driven "
        f"back has an efficiency of {100 * worm.efficiency:.0f} % at most, and with "
        f"the gearhead's {100 * d['gearhead_maximum_efficiency']:.0f} % "
        f"{ideal * efficiency:.0f} N·m are left, {peak:.0f} N·m at the gearhead's "
        f"intermittent limit. The nominal speed gives {speed:.1f} rpm, the gearhead's "
        f"highest input speed {allowed:.1f}.",
    )


def _height() -> Iterator[Remark]:
    """Say how high the squat's end speed carries, and what 5 cm would take."""
    c, p = CONTROL.values_by_name(), leg_parameters().values_by_name()
    g, lever = p["g"], 2 * p["L"] * math.sin(-c["hip_landing"])
    speed = lever * c["hip_speed"]
    mass = p["m_motors_support"] + p["m_upperleg"] + p["m_lowerleg_link"]
    hung = c["m_counterweight"]
    left = (mass - hung) / (mass + hung)
    height = AUDITED.values_by_name()["height_demanded"]
    needed = math.sqrt(2 * g * height) / lever
    yield Remark(
        where="section 6.2",
        statement=f"0.75 rad/s at the hip are {speed:.3f} m/s of the support: without "
        f"any loss a height of {1e3 * speed**2 / (2 * g):.1f} mm, and with 5 kg on the "
        f"rope, which leave {left:.2f} of the fall's acceleration, "
        f"{1e3 * speed**2 / (2 * g * left):.1f} mm. "
        f"5 cm take {needed:.1f} rad/s, {needed / _RPM:.0f} rpm. So friction is not "
        f"the only thing that keeps the leg low: the planned squat is slow.",
    )


def _inertia_of_the_counterweight() -> Remark:
    mass = RECONCILED["m_motors_support"].value or 0.0
    hung = CONTROL["m_counterweight"].value or 0.0
    light, plain, heavy = (
        derived(
            models.lowerleg_stance(RECONCILED.with_values({"m_motors_support": m}))
        )[0]
        for m in (mass - hung, mass, mass + hung)
    )
    return Remark(
        where="section 6.2",
        statement=f"The counterweight is said to ask for a slight reduction of the "
        f"controllers' gain. As if the support were 5 kg lighter it is "
        f"{100 * (plain / light - 1):+.0f} % (lower leg); but a mass on a rope is "
        f"accelerated too, the plant's gain falls from {plain:.2f} to {heavy:.2f}, and "
        f"the controller's has to rise by {100 * (plain / heavy - 1):.0f} %.",
    )
