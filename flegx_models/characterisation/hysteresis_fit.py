"""The three branches of a torque sensor from a recording of voltage and torque.

The thesis divides the samples by the voltage's last reversal and fits each group on its
own (section 3.2.1; eq. 3.22 and 3.23 are the knee's one line and its two). For
transitions that end where they meet the line, that division is only a start: all five
numbers are then fitted to the whole recording.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import isotonic_regression, least_squares

from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.sensor_line import Line, least_squares_line
from flegx_models.characterisation.torque_hysteresis import (
    Hysteresis,
    Transition,
    UntilMet,
)

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class HysteresisFit:
    """The identified branches and how well they describe the recording.

    Parameters
    ----------
    slope_std, offset_std
        Standard deviations for (rising, falling).
    transition_std
        Of the transition's slope.
    rms
        Root mean square of torque minus model over the recording, N·m.
    single_line_rms
        The same for one line through everything (eq. 3.22).
    reversals
        Sample numbers at which the voltage turns.
    """

    model: Hysteresis
    slope_std: tuple[float, float]
    offset_std: tuple[float, float]
    transition_std: float
    rms: float
    single_line_rms: float
    reversals: tuple[int, ...]


def identify_hysteresis(
    voltage: ArrayLike,
    torque: ArrayLike,
    *,
    width: float,
    voltage_noise: float,
    transition: Transition | None = None,
) -> HysteresisFit:
    """Return the three branches, first by the thesis's division of the samples.

    Samples within `width` volts after a reversal are transition points; the others are
    rising or falling. Each group has its own least squares (eq. 3.18); the transition
    has one slope and, per reversal, an offset of its own. For `UntilMet`, whose
    transitions differ in length, that is the start of a least squares of all five
    numbers over the whole recording.

    Parameters
    ----------
    voltage, torque
        Samples in the order of time, V and N·m.
    width
        V_tr, V: about as long as the transitions are.
    voltage_noise
        Bound of the voltage's noise: a turn of less than twice this is no reversal.
    transition
        The end of the transition in the returned model; `UntilMet` by default.

    Raises
    ------
    CharacterisationError
        If a direction, or the transition, has too few samples.
    """
    u, y = np.asarray(voltage, dtype=float), np.asarray(torque, dtype=float)
    if u.shape != y.shape or u.ndim != 1:
        raise CharacterisationError(
            f"There are {u.shape} voltages and {y.shape} torques.",
            ("voltage", "torque"),
            "Give two sequences of the same length.",
        )
    turns = reversals(u, threshold=2 * voltage_noise)
    direction, within, group = _divided(u, turns, width)
    lines = []
    for name, sign in (("rising", 1), ("falling", -1)):
        chosen = (direction == sign) & ~within
        if np.sum(chosen) < 3:
            raise CharacterisationError(
                f"Only {np.sum(chosen)} samples are on the {name} line.",
                (name,),
                "Sweep further in this direction, or choose a narrower transition.",
            )
        lines.append(least_squares_line(u[chosen], y[chosen]))
    slope, slope_std = _common_slope(u[within], y[within], group[within])
    model = Hysteresis(
        rising=lines[0].line,
        falling=lines[1].line,
        transition_slope=slope,
        transition=UntilMet() if transition is None else transition,
    )
    diagonals = [(r.covariance[0][0], r.covariance[1][1]) for r in lines]
    std = np.append(np.sqrt(np.ravel(diagonals)), slope_std)
    model.torque(u)  # refuses a transition that never ends
    steady = _without_jitter(u, turns)
    if isinstance(model.transition, UntilMet):
        model, std = _refined(model, steady, y)
    single = least_squares_line(u, y)
    return HysteresisFit(
        model=model,
        slope_std=(float(std[0]), float(std[2])),
        offset_std=(float(std[1]), float(std[3])),
        transition_std=float(std[4]),
        rms=_rms(y - model.torque(steady)),
        single_line_rms=_rms(y - single.line(u)),
        reversals=turns,
    )


def reversals(voltage: ArrayLike, *, threshold: float) -> tuple[int, ...]:
    """Return the samples at which the voltage turns back by more than `threshold`."""
    u = np.asarray(voltage, dtype=float)
    turns: list[int] = []
    low = high = 0
    direction = 0
    for k in range(1, len(u)):
        low = k if u[k] < u[low] else low
        high = k if u[k] > u[high] else high
        if direction >= 0 and u[high] - u[k] > threshold:
            turns += [high] if direction else []
            direction, low = -1, k
        elif direction <= 0 and u[k] - u[low] > threshold:
            turns += [low] if direction else []
            direction, high = 1, k
    return tuple(turns)


def _divided(
    u: FloatArray, turns: tuple[int, ...], width: float
) -> tuple[NDArray[np.int64], NDArray[np.bool_], NDArray[np.int64]]:
    """Return each sample's direction, whether it is a transition point, and its sweep.

    The start counts as a reversal: where the sensor comes from is not known.
    """
    edges = np.array([0, *turns, len(u) - 1])
    group = np.searchsorted(np.asarray(turns), np.arange(len(u)), side="left")
    rise = np.sign(u[edges[1:]] - u[edges[:-1]]).astype(np.int64)
    near = np.abs(u - u[edges[group]]) <= width
    start = near & (group == 0)
    return np.where(start, 0, rise[group]), near & ~start, group


def _common_slope(
    u: FloatArray, y: FloatArray, group: NDArray[np.int64]
) -> tuple[float, float]:
    """Return one slope and its standard deviation, with an offset per group."""
    names, index = np.unique(group, return_inverse=True)
    freedom = len(u) - len(names) - 1
    if freedom < 1:
        raise CharacterisationError(
            f"Only {len(u)} samples lie in {len(names)} transitions.",
            ("width",),
            "Sample more densely, or choose a wider transition.",
        )
    count = np.bincount(index)
    du = u - (np.bincount(index, u) / count)[index]
    dy = y - (np.bincount(index, y) / count)[index]
    spread = float(np.sum(du**2))
    slope = float(np.sum(du * dy)) / spread
    variance = float(np.sum((dy - slope * du) ** 2)) / freedom
    return slope, (variance / spread) ** 0.5


def _without_jitter(u: FloatArray, turns: tuple[int, ...]) -> FloatArray:
    """Return the nearest voltage that is monotone between the reversals.

    Otherwise each wiggle of the noise would start a transition of its own.
    """
    result = np.empty_like(u)
    for first, last in pairwise([0, *turns, len(u) - 1]):
        part = slice(first, last + 1)
        rises = bool(u[last] >= u[first])
        result[part] = isotonic_regression(u[part], increasing=rises).x
    return result


def _refined(
    start: Hysteresis, u: FloatArray, y: FloatArray
) -> tuple[Hysteresis, FloatArray]:
    """Return the model of least squares over the whole recording, and the stds."""

    def model(x: FloatArray) -> Hysteresis:
        a_i, b_i, a_d, b_d, slope = x.tolist()
        return replace(
            start,
            rising=Line(a_i, b_i),
            falling=Line(a_d, b_d),
            transition_slope=slope,
        )

    x0 = [
        *(start.rising.slope, start.rising.offset),
        *(start.falling.slope, start.falling.offset),
        start.transition_slope,
    ]
    scale = np.maximum(np.abs(x0), _rms(y) * 0.01)

    def error(x: FloatArray) -> FloatArray:
        return model(x).follow(u) - y

    result = least_squares(error, x0, x_scale=scale)
    slopes = np.asarray(result.jac, dtype=float)
    inverse = np.linalg.inv(slopes.T @ slopes)
    variance = 2 * float(result.cost) / (len(y) - len(x0))
    return model(result.x), np.sqrt(variance * np.diag(inverse))


def _rms(x: FloatArray) -> float:
    return float(np.sqrt(np.mean(x**2)))
