"""The cheapest solution in a box, or a proof that there is none: branch and bound.

A box whose relaxation has no solution is dropped. In the others a local search tries to
turn the relaxation's point into a solution; the box is halved where its relaxation is
loosest, until the cheapest solution found costs no more than any box could.
"""

import heapq
import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from bondgraph.reconciliation.forms import Linked
from bondgraph.reconciliation.problem import FloatArray, Problem
from bondgraph.reconciliation.relaxation import Cost, Programme, contracted, relax

MOST_BOXES = 300
"""Boxes looked at before a search gives up and says so."""

_GAP = 1e-3  # relative cost that is not worth another box
_LEAST_GAP = 1e-7
_MEETS = 1e-6  # of a half-width: what counts as inside a rounding interval
_STEPS = 12  # of the local search
_CHEAP_STEPS = 3  # of them towards the cheapest point, before any solution is found


class Found(StrEnum):
    """What a search ended in."""

    SOLUTION = "solution"
    NONE = "none"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """The cheapest point found; `proven` if no box could hold a cheaper one."""

    found: Found
    point: FloatArray | None = None
    cost: float = math.inf
    proven: bool = False


def cheapest(problem: Problem, low: FloatArray, high: FloatArray, cost: Cost) -> Answer:
    """Return the cheapest solution between `low` and `high`."""
    tree = _Tree(problem, cost, (low, high))
    boxes = [(-math.inf, 0, low, high)]
    looked, open_ = 0, False
    while boxes and looked < MOST_BOXES:
        bound, _, low, high = heapq.heappop(boxes)
        if not tree.worth(bound):
            boxes.clear()
            break
        looked += 1
        halves = tree.halves(low, high)
        if halves is None:
            open_ = True  # as small as rounding allows, and still not decided
            continue
        for k, (least, a, b) in enumerate(halves):
            heapq.heappush(boxes, (least, 2 * looked + k, a, b))
    done = not boxes and not open_
    if tree.best is not None:
        return Answer(Found.SOLUTION, tree.best, tree.least, proven=done)
    return Answer(Found.NONE if done else Found.UNDECIDED)


class _Tree:
    """The cheapest solution so far, and what one box adds to it."""

    def __init__(
        self, problem: Problem, cost: Cost, ends: tuple[FloatArray, FloatArray]
    ) -> None:
        self._problem, self._cost, self._ends = problem, cost, ends
        self.best: FloatArray | None = None
        self.least = math.inf

    def worth(self, bound: float) -> bool:
        """Return whether a box with this bound can hold a cheaper solution."""
        if self.best is None:
            return True
        return bound < self.least - max(_GAP * abs(self.least), _LEAST_GAP)

    def halves(
        self, low: FloatArray, high: FloatArray
    ) -> list[tuple[float, FloatArray, FloatArray]] | None:
        """Return the halves that are worth looking at; None if it cannot be halved."""
        smaller = contracted(self._problem, low, high)
        if smaller is None:
            return []
        low, high = smaller
        relaxed = relax(self._problem, low, high, self._cost)
        if relaxed is None or not self.worth(relaxed.cost):
            return []
        point = _solution_near(self._problem, relaxed.point, self._ends, self._cost)
        if point is not None and self._cost.at(point) < self.least:
            self.best, self.least = point, self._cost.at(point)
            if not self.worth(relaxed.cost):
                return []
        place = int(np.argmax(relaxed.doubt))
        middle = (low[place] + high[place]) / 2
        if relaxed.doubt[place] < 1e-13 or not low[place] < middle < high[place]:
            return None
        halves = []
        for a, b in ((low[place], middle), (middle, high[place])):
            first, last = low.copy(), high.copy()
            first[place], last[place] = a, b
            halves.append((relaxed.cost, first, last))
        return halves


@dataclass(frozen=True, slots=True, eq=False)
class _Tangents:
    """Values of all variables at a point of the quantities, and their slopes."""

    values: FloatArray
    slopes: FloatArray


def _tangents(problem: Problem, point: FloatArray) -> _Tangents:
    """Return every variable and its slopes with respect to the quantities.

    Raises
    ------
    ValueError
        If a formula has no value or slope there.
    """
    with np.errstate(all="ignore"):
        found = _chained(problem, point)
    if not (np.isfinite(found.values).all() and np.isfinite(found.slopes).all()):
        raise ValueError("the formulas have no slopes here")
    return found


def _chained(problem: Problem, point: FloatArray) -> _Tangents:
    count = len(problem.quantities)
    values = point.astype(float).copy()
    slopes = np.zeros((len(values), count))
    slopes[:count] = np.eye(count)
    for index, definition in problem.definitions:
        if isinstance(definition, Linked):
            x = float(values[definition.argument])
            values[index] = definition.function.value(x)
            slope = definition.function.slope(x)
            slopes[index] = slope * slopes[definition.argument]
        else:
            values[index] = definition.constant
            slopes[index] = 0.0
            for k, coefficient in definition.terms:
                values[index] += coefficient * values[k]
                slopes[index] += coefficient * slopes[k]
    return _Tangents(values, slopes)


def _solution_near(
    problem: Problem,
    start: FloatArray,
    ends: tuple[FloatArray, FloatArray],
    cost: Cost,
) -> FloatArray | None:
    """Return the cheapest solution that successive linear programmes come upon."""
    count = len(problem.quantities)
    low, high = (end[:count] for end in ends)
    found: FloatArray | None = None
    point = start
    for number in range(_STEPS):
        try:
            point = _consistent(problem, point)
            here = _tangents(problem, point)
        except (ValueError, OverflowError, ZeroDivisionError):
            return found  # a step left the formulas' domain
        if _inside(problem, point, (low, high)):
            if found is not None and cost.at(point) > cost.at(found) - _LEAST_GAP:
                return found
            found = point
        programme = Programme(low, high)
        for value, slope in _equations(problem, here):
            terms = tuple((j, float(x)) for j, x in enumerate(slope) if x)
            programme.add(terms, float(slope @ point[:count]) - value, equal=True)
        # Cheapest points may alternate between two corners, each just outside the
        # other's solutions; from then on the nearest point is taken.
        stuck = found is None and number >= _CHEAP_STEPS
        step = (
            programme.cheapest(_nearest_to(point[:count], high - low))
            if stuck
            else programme.cheapest(cost)
        )
        if step is None:
            return found
        point = np.concatenate([step[0], start[count:]])
    return found


def _nearest_to(point: FloatArray, width: FloatArray) -> Cost:
    weights = np.where(width > 0, 1 / np.where(width > 0, width, 1.0), 0.0)
    return Cost(point, weights, np.zeros(len(point)))


def _equations(problem: Problem, here: _Tangents) -> list[tuple[float, FloatArray]]:
    """Return the value of each equation and its slopes by the quantities."""
    found = []
    for equation in problem.equations:
        value, slope = equation.constant, np.zeros(here.slopes.shape[1])
        for index, coefficient in equation.terms:
            value += coefficient * float(here.values[index])
            slope = slope + coefficient * here.slopes[index]
        found.append((value, slope))
    return found


def _consistent(problem: Problem, point: FloatArray) -> FloatArray:
    """Return `point` with the results that its parameters give, by Newton's steps.

    Raises
    ------
    ValueError
        If a formula has no value there.
    """
    point = point.copy()
    for _ in range(_STEPS):
        moved = 0.0
        for k, (value, slope) in enumerate(
            _equations(problem, _tangents(problem, point)), start=problem.first_result
        ):
            step = value / float(slope[k])
            point[k] -= step
            moved = max(moved, abs(step) / (1 + abs(float(point[k]))))
        if moved < 1e-12:
            return point
    raise ValueError("the formulas have no value here")


def _inside(
    problem: Problem, point: FloatArray, ends: tuple[FloatArray, FloatArray]
) -> bool:
    low, high = ends
    slack = np.full(len(low), 1e-12)
    for k in range(problem.first_result, len(low)):
        inside = problem.quantities[k].inside
        slack[k] = _MEETS * (inside[1] - inside[0]) / 2
    here = point[: len(low)]
    return bool((here >= low - slack).all() and (here <= high + slack).all())
