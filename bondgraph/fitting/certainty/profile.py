"""Profile likelihood: how far one parameter can move while all others follow.

The covariance describes a parabola. Where a parameter enters nonlinearly, or hardly at
all, the cost is none: it may rise slowly to one side, or never. A profile holds the
parameter at one value after another and refits everything else; the 95 % interval is
where the rise of the cost stays below that of a normal estimate (Venzon and Moolgavkar,
Applied Statistics 37, 1988; Raue et al., Bioinformatics 25, 2009). The rise is counted
in variances as robust as the estimate's own, so coloured residuals do not narrow it.
"""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import FitError, did_you_mean
from bondgraph.fitting.certainty.uncertainty import Uncertainty, uncertainty
from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.result import FitResult

Array = NDArray[np.float64]
FARTHEST = 100.0
"""A side is open when even this many times the value (or std) costs too little."""

ITERATIONS = 25
CLOSE = 0.01
MOST_POINTS = 40
REFINEMENTS = 6


class ProfileStatus(StrEnum):
    """What bounds a parameter; the value is the sentence to show."""

    BOUNDED = "The recordings bound it on both sides."
    OPEN_ABOVE = "The recordings bound it from below only."
    OPEN_BELOW = "The recordings bound it from above only."
    OPEN = "The recordings do not bound it."
    BETTER_ELSEWHERE = "The fit had not ended: another value fits better."


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """How the cost rises as one parameter moves and all others follow.

    Parameters
    ----------
    values, rise
        The curve: values of the parameter, ascending, and the rise of the cost there,
        in squared standard deviations of a normal estimate.
    threshold
        The rise at the ends of a 95 % interval.
    interval
        Its ends; None on a side that is open, or closed only by the parameter's bound.
    """

    status: ProfileStatus
    name: str
    unit: str
    estimate: float
    values: tuple[float, ...]
    rise: tuple[float, ...]
    threshold: float
    interval: tuple[float | None, float | None]


@dataclass(frozen=True, slots=True)
class _Point:
    value: float
    root: float
    optimum: Optimum


def profile(fit: FitResult | FittedModel, name: str) -> Profile:
    """Return the profile of one fitted parameter.

    Parameters
    ----------
    fit
        A fit, as `bondgraph.fit` returned it.
    name
        Of a free parameter.

    Raises
    ------
    FitError
        If the parameter was not fitted, or the result does not carry its fit.
    """
    fitted = fit.fitted if isinstance(fit, FitResult) else fit
    if fitted is None:
        raise FitError(
            "The result does not carry the fit it came from.",
            (name,),
            "Profile the result of fit(), or the FittedModel.",
        )
    if name not in fitted.free_names:
        raise FitError(
            f"{name!r} was not fitted.", (name,), did_you_mean(name, fitted.free_names)
        )
    known = uncertainty(fitted.problem, fitted.optimum)
    return _profile(fitted, name, known)


def _profile(fitted: FittedModel, name: str, known: Uncertainty) -> Profile:
    index = fitted.free_names.index(name)
    walk = _Walk(fitted, index, known)
    below, low = walk.side(-1.0)
    above, high = walk.side(1.0)
    points = sorted([*below, walk.origin, *above], key=lambda point: point.value)
    values = tuple(point.value for point in points)
    rise = tuple(math.copysign(point.root**2, point.root) for point in points)
    worse = min(rise) < -0.1
    return Profile(
        status=ProfileStatus.BETTER_ELSEWHERE if worse else _status(low, high),
        name=name,
        unit=fitted.graph.parameters[name].unit,
        estimate=walk.origin.value,
        values=values,
        rise=rise,
        threshold=walk.limit**2,
        interval=(low, high),
    )


def _status(low: float | None, high: float | None) -> ProfileStatus:
    if low is None:
        return ProfileStatus.OPEN if high is None else ProfileStatus.OPEN_BELOW
    return ProfileStatus.OPEN_ABOVE if high is None else ProfileStatus.BOUNDED


class _Walk:
    """Holds a parameter at values further and further from its estimate."""

    def __init__(self, fitted: FittedModel, index: int, known: Uncertainty) -> None:
        problem, optimum = fitted.problem, fitted.optimum
        self._fitted, self._index = fitted, index
        at = int(problem.free[index])
        self._bounds = float(problem.low[at]), float(problem.high[at])
        self._held = replace(problem, free=np.delete(problem.free, index))
        spare = int(problem.measured.sum()) - len(optimum.initial.ravel())
        variance = optimum.cost / max(spare - len(problem.free), 1)
        # A parameter that is not known has no inflation of its own.
        inflation = max(float(known.inflation[index]), 1.0)
        self._variance = variance * (inflation if math.isfinite(inflation) else 1.0)
        self.limit = float(known.quantile[index])
        value = float(optimum.theta[index])
        self.origin = _Point(value, 0.0, self._following(optimum))
        std = float(known.std[index])
        size = abs(value) or 1.0
        usable = math.isfinite(std) and std > 0.0
        self._step = min(self.limit * std, size) if usable else 0.1 * size
        self._farthest = FARTHEST * max(size, std if usable else 0.0)

    def _following(self, optimum: Optimum) -> Optimum:
        return replace(optimum, theta=np.delete(optimum.theta, self._index))

    def at(self, value: float, near: _Point) -> _Point:
        """Refit everything else with the parameter held at `value`."""
        problem = replace(self._held, start=self._start(value))
        found = minimise(
            problem, near.optimum.theta, near.optimum.initial, iterations=ITERATIONS
        )
        # The held parameter is not free, so its prior is not in this cost.
        cost = found.cost + self._prior(value)
        rise = (cost - self._fitted.optimum.cost) / self._variance
        root = (
            math.copysign(math.sqrt(abs(rise)), rise) if rise < math.inf else math.inf
        )
        return _Point(value, root, found)

    def _start(self, value: float) -> Array:
        start = self._fitted.problem.start.astype(np.float64)
        start[self._fitted.problem.free[self._index]] = value
        return start

    def _prior(self, value: float) -> float:
        at = self._fitted.problem.free[self._index]
        problem = self._fitted.problem
        return float(((problem.start[at] - value) / problem.prior_std[at]) ** 2)

    def side(self, sign: float) -> tuple[list[_Point], float | None]:
        """Return the points on one side, and where the limit is crossed.

        A refit that jumps far above the limit has lost the valley that the parameters
        follow; a shorter step finds it again.
        """
        bound = self._bounds[int(sign > 0)]
        inside, points, step = self.origin, list[_Point](), self._step
        for _ in range(MOST_POINTS):
            value = inside.value + sign * step
            outside = value >= bound if sign > 0 else value <= bound
            value = bound if outside else value
            if value == inside.value:
                return points, None
            point = self.at(value, inside)
            if point.root > inside.root + 2.0 * self.limit:
                step /= 4.0
                continue
            points.append(point)
            if point.root >= self.limit:
                return points, self._crossing(points, inside, point)
            if outside or abs(value - self.origin.value) > self._farthest:
                return points, None
            inside, step = point, step * (1.0 if point.root > self.limit / 2 else 2.0)
        return points, None

    def _crossing(self, points: list[_Point], inside: _Point, outside: _Point) -> float:
        """Return where the root, nearly linear between two points, meets the limit."""
        for _ in range(REFINEMENTS):
            share = (self.limit - inside.root) / (outside.root - inside.root)
            value = inside.value + share * (outside.value - inside.value)
            point = self.at(value, inside)
            points.append(point)
            if abs(point.root - self.limit) <= CLOSE * self.limit:
                return point.value
            if point.root >= self.limit:
                outside = point
            else:
                inside = point
        return outside.value
