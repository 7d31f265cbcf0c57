"""Exact bending modes of a uniform strip, clamped at one end, with a mass at the tip.

E I w'''' + (m/L) ẅ = 0 with w = w' = 0 at the clamp; at the tip no moment, and the
shear force accelerates the tip mass M. With μ = M/m the wave numbers λ/L are the roots

    1 + cos λ cosh λ + μ λ (cos λ sinh λ - sin λ cosh λ) = 0,
    ω = (λ/L)² √(E I L / m).

Without tip mass the roots give the ratios 1 : 6.27 : 17.55.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from flegx_models.characterisation.errors import CharacterisationError

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class UniformBeam:
    """A strip with its mass, clamped at x = 0.

    Parameters
    ----------
    length
        L, m.
    bending_stiffness
        E I, N·m².
    mass
        m of the whole strip, kg.
    thickness
        h, m: strain is thickness/2 times curvature.
    """

    length: float
    bending_stiffness: float
    mass: float
    thickness: float

    def __post_init__(self) -> None:
        for name in ("length", "bending_stiffness", "mass", "thickness"):
            if not getattr(self, name) > 0:
                raise CharacterisationError(
                    f"The beam's {name} is {getattr(self, name)}.",
                    (name,),
                    "Give a positive number in SI units.",
                )

    def frequencies(self, count: int, *, tip_mass: float = 0.0) -> FloatArray:
        """Return the first natural frequencies, rad/s, exact for this beam."""
        roots = wave_numbers(count, mass_ratio=tip_mass / self.mass)
        scale = math.sqrt(self.bending_stiffness / (self.mass * self.length**3))
        return roots**2 * scale

    def shape(self, mode: int, x: ArrayLike) -> FloatArray:
        """Return the shape φ of mode 1, 2, … at `x` without tip mass, φ(L) = ±2.

        Normalised to a modal mass equal to the strip's: ∫ φ² dx = L.
        """
        return _shape(mode, np.asarray(x, dtype=float) / self.length, derivative=0)

    def curvature(self, mode: int, x: ArrayLike) -> FloatArray:
        """Return φ'' of the mode, 1/m²."""
        ratio = np.asarray(x, dtype=float) / self.length
        return _shape(mode, ratio, derivative=2) / self.length**2

    def surface_strain(self, mode: int, x: ArrayLike) -> FloatArray:
        """Return the strain at `x` for a modal coordinate of 1 m: h/2 φ''."""
        return self.thickness / 2 * self.curvature(mode, x)


def wave_numbers(count: int, *, mass_ratio: float = 0.0) -> FloatArray:
    """Return the first `count` roots λ of the frequency equation (module's head).

    A growing tip mass moves root k = 1, 2, … down from the free tip's, near (k-½)π, to
    the pinned tip's, above (k-1)π, so each has an interval of its own.

    Parameters
    ----------
    mass_ratio
        μ, tip mass over strip mass, zero or positive.
    """
    if count < 1 or mass_ratio < 0:
        raise CharacterisationError(
            f"{count} modes with the mass ratio {mass_ratio:g} do not exist.",
            ("count", "mass_ratio"),
            "Ask for at least one mode, with a mass that is not negative.",
        )

    def scaled(x: float) -> float:
        # Divided by cosh x, so that high modes do not overflow.
        return (
            1 / math.cosh(min(x, 700.0))
            + math.cos(x)
            + mass_ratio * x * (math.cos(x) * math.tanh(x) - math.sin(x))
        )

    roots = []
    for k in range(1, count + 1):
        low, high = (k - 1) * math.pi, (k - 0.5) * math.pi
        # The free tip's odd roots lie up to 0.31 above (k - ½)π, its even ones below.
        roots.append(brentq(scaled, max(low, 1e-9), high + 0.4, xtol=1e-14))
    return np.array(roots)


def _shape(mode: int, ratio: FloatArray, *, derivative: int) -> FloatArray:
    """Return φ or L² φ'' of a clamped-free beam, without differences of large cosh.

    φ = cosh - cos - σ (sinh - sin) of λ x/L with σ = (cosh λ + cos λ)/(sinh λ + sin λ).
    cosh z - σ sinh z is written with decaying exponentials only.
    """
    root = float(wave_numbers(mode)[-1])
    z = root * ratio
    # σ = 1 + excess exp(-λ).
    decay = math.exp(-root)
    denominator = (1 - decay**2) / 2 + decay * math.sin(root)
    excess = (math.cos(root) - math.sin(root) + decay) / denominator
    half = excess / 2
    hyperbolic = np.exp(-z) * (1 + half * decay) - half * np.exp(z - root)
    circular = np.cos(z) - (1 + excess * decay) * np.sin(z)
    if derivative == 0:
        return hyperbolic - circular
    return root**2 * (hyperbolic + circular)
