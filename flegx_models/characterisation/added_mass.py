"""A mass on the tip of a strip lowers its first frequency: the accelerometer's own.

A strip that bends in its first mode moves like a spring k = 3 E I / L³ with a share of
its mass at the tip. The thesis takes the share 0.23. The share that follows from the
static shape is 33/140 = 0.2357 (Rayleigh: an upper bound of the frequency), and the one
that gives the exact frequency without tip mass is 3/λ₁⁴ = 0.2427, so that eq. 3.20 is
2.7 % high. Given a measured frequency, the share drops out of the *corrected* one, and
what remains is how well the equivalent mass is known.
"""

import math

from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.parameters_chapter3 import CHAPTER_3

THESIS_SHARE = CHAPTER_3.values_by_name()["added_mass_share"]
"""The share of the strip's mass in eq. 3.19."""

RAYLEIGH_SHARE = 33 / 140
"""∫ (x²(3L - x)/(2L³))² dx / L: the strip moves in the shape of eq. 3.6."""

EXACT_SHARE = 3 / 1.8751040687119611**4
"""3/λ₁⁴, with λ₁ the first root of 1 + cos λ cosh λ: exact without tip mass."""


def loaded_frequency(
    stiffness: float, *, equivalent_mass: float, tip_mass: float = 0.0
) -> float:
    """Return f = √(k / (M + m_eq)) / 2π, Hz (eq. 3.19; M = 0: eq. 3.20).

    Parameters
    ----------
    stiffness
        k at the tip, N/m.
    equivalent_mass
        m_eq, the share of the strip's mass that moves with the tip, kg.
    tip_mass
        M, kg.
    """
    return math.sqrt(stiffness / (tip_mass + equivalent_mass)) / (2 * math.pi)


def equivalent_mass(stiffness: float, *, frequency: float) -> float:
    """Return m_eq = k / (2π f)², kg, from a frequency in Hz (before eq. 3.21)."""
    return stiffness / (2 * math.pi * frequency) ** 2


def tip_mass_between(
    equivalent: float, *, unloaded_frequency: float, loaded_frequency: float
) -> float:
    """Return the tip mass, kg, that lowers one frequency to the other (eq. 3.19).

    M = m_eq ((f₁/f)² - 1). The thesis does not print its accelerometer's mass; this is
    the one its eq. 3.21 needs.

    Raises
    ------
    CharacterisationError
        If the loaded frequency is not the lower one.
    """
    if not 0 < loaded_frequency <= unloaded_frequency:
        raise CharacterisationError(
            f"A tip mass cannot change {unloaded_frequency:g} Hz to "
            f"{loaded_frequency:g} Hz.",
            ("loaded_frequency",),
            "Give the lower frequency as the loaded one.",
        )
    ratio = unloaded_frequency / loaded_frequency
    return equivalent * (ratio - 1) * (ratio + 1)


def corrected_frequency(
    frequency: float, *, equivalent_mass: float, tip_mass: float
) -> float:
    """Return the frequency, Hz, that `tip_mass` makes of a measured one (eq. 3.21).

    f √(m_eq / (m_eq + M)): the measured frequency stands for the strip's stiffness.
    """
    return frequency * math.sqrt(equivalent_mass / (equivalent_mass + tip_mass))
