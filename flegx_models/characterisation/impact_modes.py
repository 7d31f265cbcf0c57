"""Natural frequencies, damping and mode shapes fitted to frequency responses.

Picking peaks gives a frequency to the width of a line and a damping that overlapping
modes spoil. Here the responses at all hit places are fitted together by

    H_p(s) = Σ_r [A_pr/(s - λ_r) + Ā_pr/(s - λ̄_r)] + Σ_k B_pk s^k,

poles λ_r common to all places, residues A_pr their own, and real powers B for what lies
outside the band (s⁰ and s² the stiffness and mass of higher modes, s⁻² that of lower
ones). Modes are added one at a time where the residual is largest, and all poles are
refined together by Gauss-Newton steps on the projected residual (residues eliminated:
Golub and Pereyra 1973, Kaufman 1975), weighted by the noise. The uncertainties allow
for the correlation that the exponential weight gives to neighbouring lines.

By reciprocity, residues for hits at p read at one fixed sensor are the shape at p times
the sensor's own share of the mode; a strain gauge reads shapes as well as an
accelerometer does.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.frequency_response import FrequencyResponse
from flegx_models.characterisation.pole_fit import (
    Lines,
    at_a_bound,
    covariance_of,
    next_start,
    refined,
    solve,
    squared_error,
    unknown_count,
)

FloatArray = NDArray[np.float64]

WORTH = 30.0
"""How many times more than one mode of chance a further mode must explain: correlated
lines and the choice of the best of many frequencies make chance lucky."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One natural mode.

    Parameters
    ----------
    frequency, frequency_std
        Undamped natural frequency |λ|/2π and its standard deviation, Hz.
    damping, damping_std
        Damping factor ζ = -Re λ/|λ| and its standard deviation.
    shape, shape_std
        Real shape at the places, the largest magnitude 1, and standard deviations.
    complexity
        Share of the residues' length at right angles to the real shape: 0 for
        proportional damping.
    """

    frequency: float
    frequency_std: float
    damping: float
    damping_std: float
    shape: FloatArray
    shape_std: FloatArray
    complexity: float


class ModalStatus(StrEnum):
    """How the identification ended; the value is the sentence to show."""

    CONVERGED = "All modes asked for were found."
    FEWER_MODES = "The band holds fewer modes that stand out of the noise."


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFit:
    """Modes of a band, in order of frequency.

    Parameters
    ----------
    residual
        Root mean square of the residual over its standard deviation; 1 is a fit within
        the noise. Where the noise is not known it is 1 by construction. Above 1 the
        standard deviations are enlarged by it.
    """

    status: ModalStatus
    modes: tuple[Mode, ...]
    residual: float


def identify_modes(
    responses: Sequence[FrequencyResponse],
    *,
    band: tuple[float, float],
    count: int,
    residual_powers: tuple[int, ...] = (0, 2),
) -> ModalFit:
    """Return up to `count` modes within a band from responses at several places.

    Parameters
    ----------
    responses
        One per hit place, on the same frequency lines.
    band
        Lowest and highest frequency used, Hz.
    count
        Modes wanted. Fewer are returned where a further one does not stand out.
    residual_powers
        Powers of s for what lies outside the band.

    Raises
    ------
    CharacterisationError
        If the responses do not belong together or the band is too short.
    """
    data = _stacked(responses, band, count, residual_powers)
    theta = np.empty(0)
    cost = squared_error(data, theta)
    status = ModalStatus.CONVERGED
    for _ in range(count):
        start = np.append(theta, next_start(data, theta))
        candidate = refined(data, start, tolerance=1e-6)
        lower = squared_error(data, candidate)
        freedom = 2 * data.value.size - unknown_count(data, candidate)
        chance = lower / freedom * (2 + 2 * data.value.shape[0])
        if cost - lower < WORTH * chance or at_a_bound(data, candidate):
            status = ModalStatus.FEWER_MODES
            break
        theta, cost = candidate, lower
    if len(theta):
        theta = refined(data, theta, tolerance=1e-12)
    return _answer(data, theta, status)


def modal_assurance(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Return (φ·ψ)²/(φ·φ ψ·ψ): 1 for the same shape, 0 for orthogonal ones."""
    return float(
        np.dot(first, second) ** 2 / (np.dot(first, first) * np.dot(second, second))
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """A peak of |H|: its line, Hz, and the half-power bandwidth over 2 f."""

    frequency: float
    damping: float


def pick_peaks(response: FrequencyResponse, count: int) -> tuple[Peak, ...]:
    """Return the `count` highest peaks of |H| in order of frequency.

    As the thesis reads its figures 3.15 and 3.17; good to half a line at best. The
    damping is that of the half-power points, lines interpolated; it includes what the
    exponential weight adds, σ/ω.
    """
    height = np.abs(response.value)
    inner = np.arange(1, len(height) - 1)
    tops = inner[
        (height[inner] >= height[inner - 1]) & (height[inner] > height[inner + 1])
    ]
    chosen = sorted(tops[np.argsort(height[tops])[::-1][:count]])
    return tuple(_peak(response.frequency, height, int(k)) for k in chosen)


def _peak(frequency: FloatArray, height: FloatArray, top: int) -> Peak:
    level = height[top] / np.sqrt(2)
    sides = []
    for step in (-1, 1):
        k = top
        while 0 < k < len(height) - 1 and height[k] > level:
            k += step
        share = (level - height[k - step]) / (height[k] - height[k - step])
        sides.append(frequency[k - step] + share * (frequency[k] - frequency[k - step]))
    width = float(sides[1] - sides[0])
    centre = float(frequency[top])
    return Peak(frequency=centre, damping=width / (2 * centre))


def _stacked(
    responses: Sequence[FrequencyResponse],
    band: tuple[float, float],
    count: int,
    powers: tuple[int, ...],
) -> Lines:
    kept = [response.within(*band) for response in responses]
    if not kept or any(not np.array_equal(r.s, kept[0].s) for r in kept):
        raise CharacterisationError(
            "The frequency responses are not on the same lines.",
            ("responses",),
            "Give one response per place, from records of one length and decay.",
        )
    if len(kept[0].s) < 4 * count + 2 * len(powers):
        raise CharacterisationError(
            f"The band from {band[0]:g} to {band[1]:g} Hz holds {len(kept[0].s)} "
            f"lines, too few for {count} modes.",
            ("band",),
            "Widen the band or record for longer.",
        )
    value = np.array([r.value for r in kept])
    known = all(r.std is not None for r in kept)
    std = (
        np.array([r.std for r in kept])
        if known
        else np.full(value.shape, float(np.sqrt(np.mean(np.abs(value) ** 2))))
    )
    frequency = kept[0].frequency
    spacing = float(frequency[1] - frequency[0])
    apart = (frequency[:, None] - frequency) / spacing
    weighted = kept[0].decay / spacing  # σT
    correlation = weighted / (weighted + 1j * np.pi * apart) if weighted else apart == 0
    return Lines(
        s=kept[0].s,
        value=value,
        weight=1 / std,
        powers=powers,
        known_noise=known,
        correlation=np.asarray(correlation, dtype=complex),
    )


def _answer(data: Lines, theta: FloatArray, status: ModalStatus) -> ModalFit:
    order = np.argsort(theta[::2])
    theta = np.column_stack([theta[::2], theta[1::2]])[order].ravel()
    unknowns, residuals = solve(data, theta)
    freedom = residuals.size - unknown_count(data, theta)
    variance = float(np.sum(residuals**2)) / freedom
    level = max(1.0, variance) if data.known_noise else variance
    residual = float(np.sqrt(variance)) if data.known_noise else 1.0
    if not len(theta):
        return ModalFit(status=status, modes=(), residual=residual)
    covariance = level * covariance_of(data, theta, unknowns)
    modes = []
    for r in range(len(theta) // 2):
        pole = slice(2 * r, 2 * r + 2)
        starts = len(theta) + unknowns.shape[1] * np.arange(len(unknowns)) + 2 * r
        spread = [covariance[k : k + 2, k : k + 2] for k in starts]
        modes.append(
            _mode(theta[pole], covariance[pole, pole], unknowns[:, pole], spread)
        )
    return ModalFit(
        status=status,
        modes=tuple(modes),
        residual=residual,
    )


def _mode(
    theta: FloatArray,
    covariance: FloatArray,
    unknowns: FloatArray,
    spread: list[FloatArray],
) -> Mode:
    omega, zeta = np.exp(theta)
    residues = unknowns[:, 0] + 1j * unknowns[:, 1]
    # The phase in which the residues are longest; half the phase of Σ A².
    phase = np.exp(0.5j * np.angle(np.sum(residues**2)))
    turned = residues / phase
    top = turned.real[np.argmax(np.abs(turned.real))]
    shape = turned.real / top
    direction = np.array([phase.real, phase.imag])
    std = [float(direction @ block @ direction) ** 0.5 for block in spread]
    return Mode(
        frequency=float(omega) / (2 * np.pi),
        frequency_std=float(omega) / (2 * np.pi) * float(covariance[0, 0]) ** 0.5,
        damping=float(zeta),
        damping_std=float(zeta) * float(covariance[1, 1]) ** 0.5,
        shape=shape,
        shape_std=np.array(std) / abs(float(top)),
        complexity=float(np.linalg.norm(turned.imag) / np.linalg.norm(turned)),
    )
