"""A worm gear whose friction grows with the torque it transmits.

On the thread a force N presses and f N rubs, f = tan ρ. With the lead angle λ the worm
needs, to pass on the torque T to the wheel (all torques referred to the joint),

    τ = T tan(λ + ρ)/tan λ        while the motor drives the load, T ω > 0,
    τ = T tan(λ - ρ)/tan λ        while the load drives the motor, T ω < 0,

and anything in between while it does not turn: the law is set-valued, nothing is
smoothed (Shigley's Mechanical Engineering Design, on worm gearing and power screws). f
here contains the pressure angle: it is the coefficient of the flanks over its cosine.

Section 2.1.2 says that "the direction of the power transmission is not reversible".
That holds if and only if ρ ≥ λ, so with Table 2.3's lead angle of 13°51' it is a
*number*: f ≥ tan λ = 0.247, and the efficiency tan λ / tan(λ + ρ) is 47 % at most.
"""

import math
from dataclasses import dataclass, replace

from bondgraph import BondGraphError, derive, linearise
from flegx_models.models import lowerleg_flight
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_datasheets import DATASHEETS


@dataclass(frozen=True, slots=True, kw_only=True)
class WormGear:
    """One joint's drive, everything referred to the joint.

    Parameters
    ----------
    lead_angle
        λ in rad.
    friction
        f = tan ρ, the coefficient of friction; 0 is an ideal gear.
    constant
        Dry friction in N·m that is there without load (seals, motor bearings).
    inertia
        Of motor, gearbox and worm in kg·m².
    ratio
        N, motor speed per joint speed.
    """

    lead_angle: float
    friction: float
    inertia: float
    ratio: float
    constant: float = 0.0

    def __post_init__(self) -> None:
        reach = math.pi / 2 - self.lead_angle
        if not (0 <= self.friction < math.tan(reach) and self.constant >= 0):
            raise BondGraphError(
                f"A worm with a friction of {self.friction:g} and a constant part of "
                f"{self.constant:g} N·m cannot turn.",
                ("friction", "constant"),
                f"Take 0 ≤ friction < {math.tan(reach):.3g} and constant ≥ 0.",
            )

    @property
    def driving(self) -> float:
        """Torque on the worm per torque passed on while the motor drives, ≥ 1."""
        return math.tan(self.lead_angle + self._angle) / math.tan(self.lead_angle)

    @property
    def backdriving(self) -> float:
        """The same while the load drives, ≤ 1; not positive if self-locking."""
        return math.tan(self.lead_angle - self._angle) / math.tan(self.lead_angle)

    @property
    def efficiency(self) -> float:
        """Power passed on per power put in while driving, without `constant`."""
        return 1 / self.driving

    @property
    def self_locking(self) -> bool:
        """Whether no load turns the worm: friction ≥ tan λ."""
        return self.friction >= math.tan(self.lead_angle)

    def with_friction(self, friction: float, constant: float = 0.0) -> "WormGear":
        """Return the same drive with another friction."""
        return replace(self, friction=friction, constant=constant)

    @property
    def _angle(self) -> float:
        return math.atan(self.friction)


def irreversible_worm() -> WormGear:
    """Return the worm with the least friction for which section 2.1.2 is true."""
    lead = DATASHEETS.values_by_name()["worm_lead_angle"]
    return WormGear(
        lead_angle=lead,
        friction=math.tan(lead),
        inertia=_drive_inertia(),
        ratio=_ratio(),
    )


def _ratio() -> float:
    values = RECONCILED.values_by_name()
    return values["K_gearbox"] * values["K_worm_gear"]


def _drive_inertia() -> float:
    """Return the inertia before the wheel: that of the whole joint less what follows.

    Read off the derived gain N / J of the lower leg in flight (eq. 4.7).
    """
    graph = lowerleg_flight().finish()
    values = graph.parameters.values_by_name()
    transfer = linearise(derive(graph)).transfer_function("theta", "T_motor")
    whole = _ratio() / transfer.gain_at(values)
    return whole - values["I_gear_tendons"] - values["I_lowerleg"]
