"""Poles common to many frequency responses, fitted by weighted Gauss-Newton steps.

The unknowns are θ = (log ω, log ζ) of each pole; for given poles the residues and
residual terms of every place are linear and are eliminated (Golub and Pereyra 1973).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

START_DAMPING = 0.01
DAMPING_BOUNDS = (1e-6, 0.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Lines:
    """Stacked lines: ``value[place, line]`` and weights of the same shape.

    ``correlation[line, line]`` is that of white noise after the exponential weight:
    1/(1 + jπ Δ/(σT)) for lines Δ apart in a record of length T.
    """

    s: ComplexArray
    value: ComplexArray
    weight: FloatArray
    powers: tuple[int, ...]
    known_noise: bool
    correlation: ComplexArray


def _poles(theta: FloatArray) -> ComplexArray:
    """Return the poles of θ = (log ω, log ζ) per mode."""
    omega, zeta = np.exp(theta[::2]), np.exp(theta[1::2])
    return np.asarray(omega * (-zeta + 1j * np.sqrt(1 - zeta**2)))


def _basis(data: Lines, theta: FloatArray) -> FloatArray:
    """Return ``[line (real, then imaginary), unknown]`` of one place, not weighted."""
    columns = []
    for pole in _poles(theta):
        direct, mirrored = 1 / (data.s - pole), 1 / (data.s - np.conj(pole))
        columns += [direct + mirrored, 1j * (direct - mirrored)]
    scale = np.abs(data.s[-1])
    columns += [(data.s / scale) ** power for power in data.powers]
    matrix = np.array(columns).T.reshape(len(data.s), -1)
    return np.vstack([matrix.real, matrix.imag])


def solve(data: Lines, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the linear unknowns per place and the weighted residuals per place."""
    target = np.hstack([data.value.real, data.value.imag]) * np.tile(data.weight, 2)
    matrix, scale = _weighted(data, theta)
    turned = np.swapaxes(matrix, 1, 2)
    solution = np.linalg.solve(turned @ matrix, turned @ target[..., None])
    return solution[..., 0] / scale, target - (matrix @ solution)[..., 0]


def _weighted(data: Lines, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return ``[place, line, unknown]`` with columns of length 1, and the lengths."""
    matrix = _basis(data, theta) * np.tile(data.weight, 2)[..., None]
    scale = np.linalg.norm(matrix, axis=1)
    return matrix / scale[:, None, :], scale


def squared_error(data: Lines, theta: FloatArray) -> float:
    """Return the weighted squared error with the best residues."""
    return float(np.sum(solve(data, theta)[1] ** 2))


def unknown_count(data: Lines, theta: FloatArray) -> int:
    """Return how many real numbers are fitted, residues included."""
    places = len(data.value)
    return len(theta) + places * (len(theta) + len(data.powers))


def next_start(data: Lines, theta: FloatArray) -> FloatArray:
    """Return where the next mode is tried: the frequency with the largest residual."""
    residuals = solve(data, theta)[1]
    lines = len(data.s)
    power = np.sum(residuals[:, :lines] ** 2 + residuals[:, lines:] ** 2, axis=0)
    omega = float(np.abs(data.s[int(np.argmax(power))].imag))
    return np.log([omega, START_DAMPING])


def _model_slopes(data: Lines, theta: FloatArray, unknowns: FloatArray) -> FloatArray:
    """Return d (weighted model) / dθ at fixed unknowns, ``[place, line, θ]``."""
    step = 1e-6  # far below the width of a resonance, about ζ
    columns = []
    for k in range(len(theta)):
        shift = np.zeros_like(theta)
        shift[k] = step
        slope = (_basis(data, theta + shift) - _basis(data, theta - shift)) / (2 * step)
        columns.append(unknowns @ slope.T)
    return np.stack(columns, axis=-1) * np.tile(data.weight, 2)[..., None]


def _projected_slopes(data: Lines, theta: FloatArray) -> FloatArray:
    """Return the Jacobian of the projected residuals, ``[place and line, θ]``.

    Kaufman's form: the part along the unknowns' own columns is taken away.
    """
    slopes = _model_slopes(data, theta, solve(data, theta)[0])
    matrix, _ = _weighted(data, theta)
    turned = np.swapaxes(matrix, 1, 2)
    along = matrix @ np.linalg.solve(turned @ matrix, turned @ slopes)
    return (along - slopes).reshape(-1, len(theta))


def refined(data: Lines, theta: FloatArray, *, tolerance: float) -> FloatArray:
    """Return the poles with the least squared error near `theta`."""

    def residuals(x: FloatArray) -> FloatArray:
        return solve(data, x)[1].ravel()

    def slopes(x: FloatArray) -> FloatArray:
        return _projected_slopes(data, x)

    result = least_squares(
        residuals,
        theta,
        jac=slopes,
        bounds=_bounds(data, theta),
        # A relative step in ω has to resolve the width of a resonance, about ζ.
        x_scale=np.tile([START_DAMPING, 1.0], len(theta) // 2),
        xtol=tolerance,
        ftol=tolerance,
        gtol=None,
        max_nfev=100,
    )
    return np.asarray(result.x, dtype=float)


def _bounds(data: Lines, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    low, high = np.log(DAMPING_BOUNDS)
    edges = np.log(np.abs(data.s.imag[[0, -1]]))
    modes = len(theta) // 2
    return np.tile([edges[0], low], modes), np.tile([edges[1], high], modes)


def at_a_bound(data: Lines, theta: FloatArray) -> bool:
    """Return whether a pole ran to a bound: it stands for something else."""
    low, high = _bounds(data, theta)
    return bool(np.any((theta - low < 1e-3) | (high - theta < 1e-3)))


def covariance_of(data: Lines, theta: FloatArray, unknowns: FloatArray) -> FloatArray:
    """Return the covariance of all poles, then of each place's unknowns, unit noise.

    With G the Jacobian and R the lines' correlation: (GᵀG)⁻¹ GᵀRG (GᵀG)⁻¹.
    """
    slopes = _model_slopes(data, theta, unknowns)
    matrix, scale = _weighted(data, theta)
    places, lines, own = matrix.shape
    G = np.zeros((places, lines, len(theta) + places * own))
    G[:, :, : len(theta)] = slopes
    for place in range(places):
        first = len(theta) + place * own
        G[place, :, first : first + own] = matrix[place] * scale[place]
    lengths = np.linalg.norm(G, axis=(0, 1))
    G /= lengths
    flat = G.reshape(places * lines, -1)
    gram = flat.T @ flat
    half = lines // 2
    # Real and imaginary rows as one complex line: noise there is circular.
    complex_rows = G[:, :half] + 1j * G[:, half:]
    correlated = data.correlation @ complex_rows
    shape = (places * half, -1)
    middle = (complex_rows.reshape(shape).conj().T @ correlated.reshape(shape)).real
    inverse = np.linalg.inv(gram)
    return np.asarray(inverse @ middle @ inverse / np.outer(lengths, lengths))
