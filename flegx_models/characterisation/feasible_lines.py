"""All lines y = a u + b that points with bounded errors allow.

Nothing is known of the errors but their bounds, of y alone or of u and y (section
3.1.2, figures 3.10 to 3.12), so the answer is a set. Its *parameter uncertainty
intervals* are the smallest box around it, and the box's centre is the Chebyshev centre
in the maximum norm of the (separately scaled) parameters: no other line has a smaller
worst-case error in either parameter.

Guarantee for bounded errors of u and y
---------------------------------------
Asked are the (a, b) for which ξ_i, η_i exist with |ξ_i| ≤ μ_i, |η_i| ≤ ε_i and

    y_i - η_i = a (u_i - ξ_i) + b,        that is  y_i - a u_i - b = η_i - a ξ_i.

The products a ξ_i make this a polynomial problem in 2N + 2 unknowns; the thesis relaxes
it with SparsePOP. But for fixed a the right side ranges, independently for each i, over
exactly [-(ε_i + |a| μ_i), ε_i + |a| μ_i]: an interval, reached at corners of the error
box. So (a, b) is possible if and only if, for all i,

    |y_i - a u_i - b| ≤ ε_i + |a| μ_i.

Where a ≥ 0 (or a ≤ 0) this is linear in (a, b): the set is the union of two convex
polygons, and two linear programmes per parameter and polygon give its box exactly, to
the solver's tolerance. No relaxation, no local optimum, no order to choose.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linprog

from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.polygons import Polygon, clipped
from flegx_models.characterisation.sensor_line import Interval, Line, checked_points

FloatArray = NDArray[np.float64]


class FeasibleSetStatus(StrEnum):
    """What the set of possible lines is; the value is the sentence to show."""

    BOUNDED = "The points bound both parameters."
    UNBOUNDED = "The points do not bound the slope: the inputs differ too little."
    EMPTY = "No line passes within the error bounds of all points."


@dataclass(frozen=True, slots=True, kw_only=True)
class FeasibleLines:
    """All lines that the error bounds allow.

    Parameters
    ----------
    slope, offset
        Parameter uncertainty intervals; None where no line is possible.
    centre
        The Chebyshev centre, the middle of both intervals; None unless bounded.
    polygons
        The set itself: one convex polygon of (slope, offset) per sign of the slope.
        Where it has two, the centre need not be a possible line.
    slack
        By how much all bounds on y could shrink before no line is possible; negative
        where they are too small by that much.
    """

    status: FeasibleSetStatus
    slope: Interval | None
    offset: Interval | None
    centre: Line | None
    polygons: tuple[Polygon, ...]
    slack: float

    def contains(self, line: Line, *, tolerance: float = 1e-9) -> bool:
        """Return whether both parameters lie in their intervals."""
        if self.slope is None or self.offset is None:
            return False
        return all(
            low - tolerance * (1 + abs(low)) <= v <= high + tolerance * (1 + abs(high))
            for v, (low, high) in (
                (line.slope, self.slope),
                (line.offset, self.offset),
            )
        )


def feasible_lines(
    u: ArrayLike,
    y: ArrayLike,
    *,
    output_error: ArrayLike,
    input_error: ArrayLike = 0.0,
) -> FeasibleLines:
    """Return all lines within bounded errors of the points, exactly.

    With `input_error` zero it is the linear programme of figure 3.10, otherwise the
    errors-in-variables problem of figures 3.11 and 3.12; see the module's head for the
    proof that the answer is exact.

    Parameters
    ----------
    u, y
        The points.
    output_error, input_error
        Bounds ε of |error of y| and μ of |error of u|: one number or one per point.

    Raises
    ------
    CharacterisationError
        If there are fewer than three points, all inputs are equal or a bound is
        negative.
    """
    x, values = checked_points(u, y)
    epsilon = _bound(output_error, x, "output_error")
    mu = _bound(input_error, x, "input_error")
    # Unknowns of order one, for the solver's absolute tolerances.
    x0, x1 = float(x.mean()), float(np.ptp(x))
    y0, y1 = float(values.mean()), float(np.ptp(values)) or 1.0
    scaled = ((x - x0) / x1, (values - y0) / y1, mu / x1, epsilon / y1)
    back = np.array([[y1 / x1, 0.0], [-x0 * y1 / x1, y1]])
    origin = np.array([0.0, y0])

    signs = (1, -1) if np.any(mu > 0) else (0,)
    sets = [_half_planes(*scaled, sign=sign) for sign in signs]
    boxes = [_box(A, b, back, origin) for A, b in sets]
    slack = max(_slack(A, b) for A, b in sets) * y1
    found = [box for box in boxes if box is not None]
    if not found:
        return FeasibleLines(
            status=FeasibleSetStatus.EMPTY,
            slope=None,
            offset=None,
            centre=None,
            polygons=(),
            slack=slack,
        )
    slope, offset = (_hull([box[k] for box in found]) for k in (0, 1))
    bounded = bool(np.all(np.isfinite([*slope, *offset])))
    return FeasibleLines(
        status=(FeasibleSetStatus.BOUNDED if bounded else FeasibleSetStatus.UNBOUNDED),
        slope=slope,
        offset=offset,
        centre=Line(sum(slope) / 2, sum(offset) / 2) if bounded else None,
        polygons=tuple(
            clipped(box, A @ np.linalg.inv(back), b + A @ np.linalg.solve(back, origin))
            for box, (A, b) in zip(boxes, sets, strict=True)
            if box is not None and np.all(np.isfinite(box))
        ),
        slack=slack,
    )


def _half_planes(
    x: FloatArray, y: FloatArray, mu: FloatArray, epsilon: FloatArray, *, sign: int
) -> tuple[FloatArray, FloatArray]:
    """Return A, b of A (slope, offset) ≤ b for slopes of one sign (0: any sign)."""
    ones = np.ones_like(x)
    upper = np.column_stack([-x - sign * mu, -ones])
    lower = np.column_stack([x - sign * mu, ones])
    A = np.vstack([upper, lower])
    b = np.concatenate([epsilon - y, epsilon + y])
    if sign:
        A, b = np.vstack([A, [-sign, 0.0]]), np.append(b, 0.0)
    return A, b


def _box(
    A: FloatArray, b: FloatArray, back: FloatArray, origin: FloatArray
) -> tuple[Interval, Interval] | None:
    """Return the intervals of both parameters by four linear programmes."""
    intervals = []
    for row, shift in zip(back, origin, strict=True):
        ends = [_extreme(A, b, sign * row) for sign in (1, -1)]
        if ends[0] is None or ends[1] is None:
            return None
        intervals.append((ends[0] + float(shift), -ends[1] + float(shift)))
    return intervals[0], intervals[1]


def _extreme(A: FloatArray, b: FloatArray, cost: FloatArray) -> float | None:
    """Return the least value of cost·θ: None if nothing is possible, or -inf."""
    result = linprog(cost, A_ub=A, b_ub=b, bounds=(None, None), method="highs")
    if result.fun is not None:
        return float(result.fun)
    # HiGHS may answer "infeasible or unbounded" (4): a feasibility problem decides.
    possible = linprog(np.zeros(2), A_ub=A, b_ub=b, bounds=(None, None))
    return -np.inf if possible.status == 0 else None


def _slack(A: FloatArray, b: FloatArray) -> float:
    """Return the largest s for which the points' constraints hold with ε - s.

    The sign constraint of the slope, the last row where there is one, is not relaxed.
    """
    relaxed = np.full(len(b), 1.0)
    relaxed[len(b) - len(b) % 2 :] = 0.0
    result = linprog(
        [0.0, 0.0, -1.0],
        A_ub=np.column_stack([A, relaxed]),
        b_ub=b,
        bounds=(None, None),
        method="highs",
    )
    # Large errors of u alone may admit a line whatever ε: no bound is needed then.
    return np.inf if result.fun is None else -float(result.fun)


def _hull(intervals: list[Interval]) -> Interval:
    return min(low for low, _ in intervals), max(high for _, high in intervals)


def _bound(bound: ArrayLike, x: FloatArray, name: str) -> FloatArray:
    values = np.broadcast_to(np.asarray(bound, dtype=float), x.shape)
    if not np.all(values >= 0):
        raise CharacterisationError(
            f"The {name} has a bound below zero.",
            (name,),
            "Give magnitudes, zero or positive.",
        )
    return values
