"""Frequency and decay of a free swing, of any amplitude.

The thesis reads peaks and takes the swing for small (eq. 3.30 to 3.32). A pendulum that
swings far is slower, and loses a larger share per period; both are known exactly (to
first order in the friction), so no small angle has to be assumed.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipe, ellipk

from flegx_models.characterisation.errors import CharacterisationError

FloatArray = NDArray[np.float64]

TOP = 0.4
"""Share of a half-swing's duration, about its middle, that its parabola fits."""


def damping_factor(decrement: float) -> float:
    """Return ζ = δ/√(4π² + δ²) of a decrement per period (eq. 3.32, corrected).

    Parameters
    ----------
    decrement
        δ, the mean of log(a_i/a_{i+1}) (eq. 3.30).
    """
    return decrement / math.hypot(2 * math.pi, decrement)


def printed_damping_factor(decrement: float) -> float:
    """Return δ²/√(4π² + δ²), which eq. 3.32 prints: too small by the factor δ."""
    return decrement**2 / math.hypot(2 * math.pi, decrement)


def natural_frequency(frequency: float, *, decrement: float) -> float:
    """Return ω_n = √(4π² + δ²) f, rad/s (eq. 3.31), from the damped frequency in Hz."""
    return math.hypot(2 * math.pi, decrement) * frequency


def large_swing_factor(amplitude: float) -> float:
    """Return the period of a swing of this amplitude over that of a small one.

    2 K(sin²(θ0/2))/π = 1 + θ0²/16 + …, without friction. The thesis's small-angle
    assumption makes the inertia too large by its square: 3.5 % at 30°.

    Parameters
    ----------
    amplitude
        θ0, rad.
    """
    return float(2 / math.pi * ellipk(math.sin(amplitude / 2) ** 2))


def small_swing_amplitude(amplitude: float) -> float:
    """Return the amplitude, rad, that viscous friction lets decay exponentially.

    Friction c takes from the action J = ∮ I θ' dθ of a swing, of any amplitude, the
    share c/I per unit of time (averaged over a period; first order in c). With
    k = sin(θ0/2), J is as E(k) - (1 - k²) K(k), which is π θ0²/16 for small θ0; so
    √(16/π (E - (1 - k²) K)) is the amplitude of the small swing of the same action.

    Parameters
    ----------
    amplitude
        θ0, rad.
    """
    m = math.sin(amplitude / 2) ** 2
    return math.sqrt(16 / math.pi * float(ellipe(m) - (1 - m) * ellipk(m)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Decay:
    """Peaks of a free oscillation.

    Parameters
    ----------
    decrement, decrement_std
        δ per period, and its standard deviation from the scatter of the peaks.
    frequency, frequency_std
        Damped frequency, Hz, of small swings: the periods are corrected for amplitude.
    amplitude
        Of the first peak used, rad.
    drift
        Slope of the decrement from the first to the last period, per period. Bearings
        with dry friction lose a constant amplitude, so δ grows as the swing decays;
        zero within `drift_std` for viscous friction.
    """

    decrement: float
    decrement_std: float
    frequency: float
    frequency_std: float
    amplitude: float
    drift: float
    drift_std: float

    @property
    def natural_frequency(self) -> float:
        """ω_n, rad/s (eq. 3.31)."""
        return natural_frequency(self.frequency, decrement=self.decrement)

    @property
    def damping_factor(self) -> float:
        """The damping factor ζ, by the correct relation."""
        return damping_factor(self.decrement)


def free_decay(time: ArrayLike, angle: ArrayLike, *, smallest: float) -> Decay:
    """Return frequency and logarithmic decrement of a free oscillation (eq. 3.30).

    The equilibrium is the mean of successive half-swings, so an offset of the sensor
    does no harm. All extremes are used, each from a parabola through the samples around
    it. Amplitudes are corrected for their size (`small_swing_amplitude`), so that their
    logarithm over time is a line for viscous friction, and periods likewise
    (`large_swing_factor`).

    Parameters
    ----------
    time, angle
        Samples of a free swing, s and rad.
    smallest
        Amplitude below which peaks are not used, rad; several times the noise.

    Raises
    ------
    CharacterisationError
        If there are fewer than six extremes.
    """
    t, x = np.asarray(time, dtype=float), np.asarray(angle, dtype=float)
    at, height = _extremes(t, x, smallest)
    if len(at) < 6:
        raise CharacterisationError(
            f"The swing has only {len(at)} extremes above {smallest:g} rad.",
            ("angle",),
            "Record a longer swing, or one that starts further out.",
        )
    # Each amplitude is a swing against the mean of its two neighbours.
    swing = np.abs(height[1:-1] - (height[:-2] + height[2:]) / 2) / 2
    number = np.arange(len(swing)) / 2  # in periods
    factor = np.array([large_swing_factor(float(a)) for a in swing])
    halves = np.diff(at[1:-1]) * 2 / (factor[1:] + factor[:-1])
    elapsed = np.append(0.0, np.cumsum(halves))
    # Noise σ of an amplitude a is σ/a of its logarithm, and as much of its time.
    period, period_std = _leading(number, elapsed, swing, 1)
    small = np.log([small_swing_amplitude(float(a)) for a in swing])
    passed = (at[1:-1] - at[1]) / period
    slope, slope_std = _leading(passed, small, swing, 1)
    bend, bend_std = _leading(passed, small, swing, 2)
    return Decay(
        decrement=-slope,
        decrement_std=slope_std,
        frequency=1 / period,
        frequency_std=period_std / period**2,
        amplitude=float(swing[0]),
        drift=-2 * bend,
        drift_std=2 * bend_std,
    )


def _extremes(
    t: FloatArray, x: FloatArray, smallest: float
) -> tuple[FloatArray, FloatArray]:
    """Return times and values of successive extremes, alternating in sign."""
    centred = x - np.median(x)
    outside = np.flatnonzero(np.abs(centred) > smallest)
    last = outside[:-1][np.diff(np.sign(centred[outside])) != 0]
    first = outside[1:][np.diff(np.sign(centred[outside])) != 0]
    crossing = (t[last] + t[first]) / 2
    found = []
    for begin, end in pairwise(crossing.tolist()):
        # Chosen by time and not by height, so that noise does not choose.
        middle, reach = (begin + end) / 2, TOP * (end - begin) / 2
        z = (t - middle) / reach
        near = np.abs(z) <= 1
        if np.sum(near) < 5:
            raise CharacterisationError(
                f"A half-swing of {end - begin:.3g} s has {np.sum(near)} samples.",
                ("time",),
                "Sample at least fifty times per period.",
            )
        c, b, a = np.polynomial.polynomial.polyfit(z[near], x[near], 2)
        found.append((middle - b / (2 * a) * reach, c - b**2 / (4 * a)))
    times, values = np.array(found).reshape(-1, 2).T
    return times, values


def _leading(
    x: FloatArray, y: FloatArray, weight: FloatArray, degree: int
) -> tuple[float, float]:
    """Return a fitted polynomial's leading coefficient and its standard deviation."""
    matrix = np.vander(x, degree + 1) * weight[:, None]
    inverse = np.linalg.inv(matrix.T @ matrix)
    fit = inverse @ matrix.T @ (weight * y)
    freedom = len(x) - degree - 1
    variance = float(np.sum((weight * y - matrix @ fit) ** 2)) / freedom
    return float(fit[0]), float(np.sqrt(variance * inverse[0, 0]))
