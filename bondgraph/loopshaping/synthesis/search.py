"""The search: sequential linear programming over the peaks, from several starts.

Margins and peaks are maxima over frequencies and plants, which have kinks where another
frequency becomes the worst. As in the nonsmooth synthesis of structured controllers
(Apkarian and Noll, "Nonsmooth H∞ synthesis", IEEE TAC 51, 2006) the problem is not
convex and its solutions are local, but every single peak is smooth. So each step
linearises all peaks near the largest at once and solves a linear programme for the
step within a trust region, with a penalty that is exact: large enough, a step that
violates a requirement never pays. Starts are drawn with a seed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.requirements import AbstractRequirement
from bondgraph.loopshaping.synthesis.excess import excess, with_controller
from bondgraph.loopshaping.synthesis.gridded import FamilyGrid
from bondgraph.loopshaping.synthesis.objectives import AbstractObjective
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

DRAWS = 300  # random controllers of which the best become starts
PENALTY = 20.0  # per unit of the largest excess
_UNSTABLE = 3.0  # what an unstable closed-loop pole adds to every excess
_STEP = 1e-6
_FAR = 0.4  # peaks lower than the largest by more than this are left out
_STEPS = 60
_WIDEST, _WIDE, _NARROW = 1.0, 0.3, 1e-6  # trust region
_SETTLED = 1e-7

IntArray = NDArray[np.intp]
Bounds = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Search:
    """A family on a grid with what is asked of it.

    The numbers searched over are ln of the crossover, then the structure's.

    Parameters
    ----------
    slack
        Per requirement, by how much more than the limit is asked.
    """

    loops: Sequence[Loop]
    grid: FamilyGrid
    requirements: Sequence[AbstractRequirement]
    objective: AbstractObjective
    bounds: Bounds
    slack: FloatArray

    def controller(self, x: FloatArray) -> ZeroPoleGain:
        """Return the controller at a point."""
        gain = self.grid.gain(math.exp(x[0]), x[1:])
        return self.grid.structure.controller(x[1:]).times(gain)

    def costs(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Return the objective, and every excess ``[row, frequency]``.

        One row per requirement and plant; not positive is allowed.
        """
        loops = self.grid.loops(math.exp(x[0]), x[1:])
        unstable = _UNSTABLE * loops.unstable()[:, None]

        def whole() -> list[Loop]:
            return with_controller(list(self.loops), self.controller(x))

        rows = np.full(
            (len(self.requirements) + 1, *loops.size.shape), -50.0
        )  # the last one asks for nothing but stability
        for k, (requirement, more) in enumerate(
            zip(self.requirements, self.slack, strict=True)
        ):
            missed = excess(requirement, loops, whole)
            missed = missed.reshape(len(missed), -1)
            rows[k, :, : missed.shape[1]] = np.clip(missed + more, -5.0, 50.0)
        rows[:-1] += unstable
        rows[-1, :, 0] = unstable[:, 0]
        return self.objective.cost(loops), rows.reshape(-1, rows.shape[-1])

    def worst(self, x: FloatArray) -> float:
        """Return the largest excess."""
        return float(self.costs(x)[1].max())

    def merit(self, x: FloatArray) -> float:
        """Return the objective plus the penalty."""
        return _merit(*self.costs(x))

    def starts(self, generator: np.random.Generator, count: int) -> list[FloatArray]:
        """Return the `count` best of random controllers, no two alike."""
        low, high = np.array(self.bounds).T
        drawn = [generator.uniform(low, high) for _ in range(DRAWS)]
        worst = [self.worst(x) for x in drawn]
        kept: list[FloatArray] = []
        for k in np.argsort(worst, kind="stable"):
            apart = [np.abs((drawn[k] - x) / (high - low)).max() for x in kept]
            if min(apart, default=1.0) > 0.1:
                kept.append(drawn[k])
            if len(kept) == count:
                break
        return kept

    def best(self, start: FloatArray) -> FloatArray:
        """Return a local solution near `start`."""
        x, reach = start, _WIDE
        here = self.costs(x)
        for _ in range(_STEPS):
            step, expected = self._step(x, *here, reach)
            if expected < _SETTLED:
                break
            there = self.costs(x + step)
            gained = _merit(*here) - _merit(*there)
            if gained > 0:
                x, here = x + step, there
            if gained > 0.75 * expected:
                reach = min(2 * reach, _WIDEST)
            elif gained < 0.25 * expected:
                reach /= 3
            if reach < _NARROW:
                break
        return x

    def _step(
        self, x: FloatArray, cost: float, rows: FloatArray, reach: float
    ) -> tuple[FloatArray, float]:
        """Return the step of the linear programme, and what it gains if all is linear.

        It starts at x, where the costs are `cost` and `rows`. Unknowns are the step and
        the largest excess t ≥ 0.
        """
        chosen = _peaks(rows)
        here = rows[chosen]
        low, high = np.array(self.bounds).T
        slopes = np.empty((len(here), len(x)))
        downhill = np.empty(len(x))
        for k in range(len(x)):
            move = _STEP if x[k] + _STEP <= high[k] else -_STEP
            moved = x.copy()
            moved[k] += move
            there, others = self.costs(moved)
            downhill[k] = (there - cost) / move
            slopes[:, k] = (others[chosen] - here) / move
        box = np.column_stack(
            [np.maximum(-reach, low - x), np.minimum(reach, high - x)]
        )
        found = linprog(
            np.append(downhill, PENALTY),
            A_ub=np.column_stack([slopes, -np.ones(len(here))]),
            b_ub=-here,
            bounds=[*map(tuple, box), (0, None)],
            method="highs",
        )
        if (
            found.status != 0 or found.x is None or found.fun is None
        ):  # slopes across a jump; a smaller region will do
            return np.zeros(len(x)), math.inf
        return np.asarray(found.x[:-1]), _merit(cost, rows) - cost - float(found.fun)


def _merit(cost: float, rows: FloatArray) -> float:
    """Return the objective plus the penalty."""
    return cost + PENALTY * max(0.0, float(rows.max()))


def _peaks(rows: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the places of the peaks of each row that are near its largest."""
    padded = np.pad(rows, ((0, 0), (1, 1)), constant_values=-np.inf)
    local = (rows >= padded[:, :-2]) & (rows >= padded[:, 2:])
    near = rows > rows.max(axis=1, keepdims=True) - _FAR
    active = rows > min(0.0, float(rows.max())) - 2.0
    row, column = np.nonzero(local & near & active)
    return row, column
