"""Tendons are slender bars: what they carry is limited by buckling, not by strength.

The knee torque is carried by two parallel bars, one pulled and one pushed, whose ends
turn in spherical bearings (figure 3.1), so each is a pin-ended Euler column.
"""

import math
from dataclasses import dataclass

from flegx_models.characterisation.errors import CharacterisationError


def tendon_force(torque: float, *, spacing: float, angle: float) -> float:
    """Return the axial force in each of two tendons, N (eq. 3.1 and 3.2).

    F = T / (b cos θ): both forces have the lever arm b/2 cos θ.

    Parameters
    ----------
    torque
        Joint torque T, N·m.
    spacing
        Distance b between the tendons' fixing points, m.
    angle
        Joint angle θ from the position where the lever arm is longest, rad.

    Raises
    ------
    CharacterisationError
        If the tendons have no lever arm at this angle.
    """
    arm = spacing * math.cos(angle)
    if arm <= 0:
        raise CharacterisationError(
            f"At {angle:.3g} rad the tendons have no lever arm.",
            ("angle",),
            "Give an angle between -π/2 and π/2 and a positive spacing.",
        )
    return torque / arm


def spacing_for(torque: float, *, force: float, angle: float) -> float:
    """Return the spacing b, m, at which the tendons carry `force` (eq. 3.2)."""
    return torque / (force * math.cos(angle))


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundColumn:
    """A round bar under axial force.

    Parameters
    ----------
    length
        Between the end bearings, m.
    youngs_modulus
        Pa.
    end_factor
        n of eq. 3.3: 1 for two pinned ends, 4 for two clamped ends.
    """

    length: float
    youngs_modulus: float
    end_factor: float = 1.0

    def critical_force(self, radius: float) -> float:
        """Return the buckling force n π² E I / L², N, with I = π r⁴/4 (3.3, 3.4)."""
        second_moment = math.pi * radius**4 / 4
        return (
            self.end_factor
            * math.pi**2
            * self.youngs_modulus
            * second_moment
            / self.length**2
        )

    def smallest_radius(self, force: float, *, safety: float) -> float:
        """Return the radius, m, at which `safety` times `force` buckles it (3.5).

        r = (4 S F L² / (n π³ E))^(1/4). Eq. 3.5 is this with n = 1.
        """
        fourth_power = (
            4
            * safety
            * force
            * self.length**2
            / (self.end_factor * math.pi**3 * self.youngs_modulus)
        )
        return math.sqrt(math.sqrt(fourth_power))

    def safety(self, force: float, *, radius: float) -> float:
        """Return the critical force over `force`."""
        return self.critical_force(radius) / force

    def slenderness(self, radius: float) -> float:
        """Return L over the radius of gyration r/2.

        Euler's formula holds above about π √(E / yield stress), roughly 90 for steel.
        """
        return self.length / (radius / 2)
