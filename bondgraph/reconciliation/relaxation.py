"""A box of all variables, made smaller, and a linear programme around its solutions.

`contracted` takes from every range what an equation leaves no room for. `relax` then
bounds each link between two variables by straight lines: a chord on one side of a curve
and tangents on the other, or lines of the extreme slopes where it bends both ways. If
the linear programme has no solution the box has none, and its least cost is a bound on
theirs.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from bondgraph.reconciliation.forms import Linear, Linked
from bondgraph.reconciliation.functions import Range
from bondgraph.reconciliation.problem import FloatArray, Problem

_ROUNDS = 8
_INFEASIBLE = 2  # scipy's word for it
_FARTHEST = 1e100  # no value beyond is looked at
_TOLERANCE = 1e-9  # relative width by which ranges may miss each other


@dataclass(frozen=True, slots=True, eq=False)
class Cost:
    """What is made least: weighted distances from `origin`, plus a linear part.

    Over the quantities only.
    """

    origin: FloatArray
    weights: FloatArray
    linear: FloatArray

    def at(self, point: FloatArray) -> float:
        """Return the cost of a point."""
        here = point[: len(self.origin)]
        distance = np.abs(here - self.origin) @ self.weights
        return float(distance + here @ self.linear)


@dataclass(frozen=True, slots=True, eq=False)
class Relaxed:
    """The cheapest point of a relaxation; `doubt` is how loose it is per variable."""

    point: FloatArray
    cost: float
    doubt: FloatArray


class EmptyBoxError(Exception):
    """A range became empty: nothing in the box meets the equations."""


class _Ranges:
    """Ranges that only shrink."""

    def __init__(self, low: FloatArray, high: FloatArray) -> None:
        self.low, self.high = np.maximum(low, -_FARTHEST), np.minimum(high, _FARTHEST)
        self.gained = 0.0

    def of(self, index: int) -> Range:
        return float(self.low[index]), float(self.high[index])

    def cut(self, index: int, limits: Range) -> None:
        low, high = self.of(index)
        a, b = max(low, limits[0]), min(high, limits[1])
        if a > b:
            if a - b > _TOLERANCE * (1 + abs(a) + abs(b)) * 1e-2:
                raise EmptyBoxError
            a = b = (a + b) / 2
        width = high - low
        if width > 0:
            self.gained = max(self.gained, 1 - (b - a) / width)
        self.low[index], self.high[index] = a, b

    def meet(self, form: Linear, result: int | None) -> None:
        """Cut every range in ``form - result = 0``."""
        terms = form.terms if result is None else (*form.terms, (result, -1.0))
        ends = [sorted(c * end for end in self.of(k)) for k, c in terms]
        for place, (index, coefficient) in enumerate(terms):
            # Summed afresh each time: a difference from the whole sum would lose a
            # small number beside a range of many powers of ten.
            others = ends[:place] + ends[place + 1 :]
            least = form.constant + sum(a for a, _ in others)
            most = form.constant + sum(b for _, b in others)
            rest = sorted((-least / coefficient, -most / coefficient))
            size = abs(form.constant) + sum(max(abs(a), abs(b)) for a, b in others)
            slack = 1e-14 * size / abs(coefficient)
            if math.isfinite(slack):
                self.cut(index, (rest[0] - slack, rest[1] + slack))


def contracted(
    problem: Problem, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Return the box without what the equations exclude, None if nothing is left."""
    ranges = _Ranges(low, high)
    try:
        for _ in range(_ROUNDS):
            ranges.gained = 0.0
            _forward(problem, ranges)
            for equation in problem.equations:
                ranges.meet(equation, None)
            _backward(problem, ranges)
            if ranges.gained < 0.05:
                break
    except EmptyBoxError:
        return None
    return ranges.low, ranges.high


def _forward(problem: Problem, ranges: _Ranges) -> None:
    for index, definition in problem.definitions:
        if isinstance(definition, Linked):
            values = definition.function.values(ranges.of(definition.argument))
            ranges.cut(index, values)
        else:
            ranges.meet(definition, index)


def _backward(problem: Problem, ranges: _Ranges) -> None:
    for index, definition in reversed(problem.definitions):
        if not isinstance(definition, Linked):
            ranges.meet(definition, index)
        elif definition.function.arguments is not None:
            allowed = definition.function.arguments(ranges.of(index))
            ranges.cut(definition.argument, allowed)


class Programme:
    """A linear programme over one box, its variables scaled to 0…1."""

    def __init__(self, low: FloatArray, high: FloatArray) -> None:
        self._low, self._width = low, high - low
        self._rows: list[tuple[FloatArray, float, bool]] = []

    def add(
        self, terms: tuple[tuple[int, float], ...], limit: float, *, equal: bool
    ) -> None:
        """Demand ``Σ coefficient · variable <= limit``, or equality."""
        row = np.zeros(len(self._low))
        for index, coefficient in terms:
            row[index] += coefficient * float(self._width[index])
            limit -= coefficient * float(self._low[index])
        size = float(np.abs(row).max(initial=0.0))
        if size > 0 and math.isfinite(size) and math.isfinite(limit):
            self._rows.append((row / size, limit / size, equal))

    def cheapest(self, cost: Cost) -> tuple[FloatArray, float] | None:
        """Return the cheapest point and its cost, None if there is none."""
        size, count = len(self._low), len(cost.origin)
        far = np.flatnonzero(cost.weights)
        columns = size + len(far)
        above = [np.pad(r, (0, len(far))) for r, _, equal in self._rows if not equal]
        limits = [b for _, b, equal in self._rows if not equal]
        for k, index in enumerate(far):
            for sign in (1.0, -1.0):
                row = np.zeros(columns)
                row[index] = sign * self._width[index]
                row[size + k] = -1.0
                above.append(row)
                limits.append(sign * float(cost.origin[index] - self._low[index]))
        ties = [np.pad(r, (0, len(far))) for r, _, equal in self._rows if equal]
        objective = np.zeros(columns)
        objective[:count] = cost.linear * self._width[:count]
        objective[size:] = cost.weights[far]
        answer = linprog(
            objective,
            np.array(above) if above else None,
            limits if above else None,
            np.array(ties) if ties else None,
            [b for _, b, equal in self._rows if equal] if ties else None,
            bounds=[(0.0, 1.0)] * size + [(0.0, None)] * len(far),
            method="highs",
        )
        if answer.status == _INFEASIBLE:
            return None
        if answer.x is None:  # the solver gave up, which proves nothing
            return self._low + self._width / 2, -math.inf
        point = self._low + self._width * answer.x[:size]
        return point, float(objective @ answer.x + cost.linear @ self._low[:count])


def relax(
    problem: Problem, low: FloatArray, high: FloatArray, cost: Cost
) -> Relaxed | None:
    """Return the cheapest point of the relaxation, None if there is none."""
    programme = Programme(low, high)
    doubt = np.zeros(len(low))
    for equation in problem.equations:
        programme.add(equation.terms, -equation.constant, equal=True)
    for index, definition in problem.definitions:
        if isinstance(definition, Linear):
            terms = (*definition.terms, (index, -1.0))
            programme.add(terms, -definition.constant, equal=True)
        else:
            limits = float(low[definition.argument]), float(high[definition.argument])
            doubt[definition.argument] += _bound(programme, index, definition, limits)
    found = programme.cheapest(cost)
    return None if found is None else Relaxed(*found, doubt)


def _bound(programme: Programme, index: int, link: Linked, limits: Range) -> float:
    """Enclose a link by lines over `limits`; return how far they are apart."""
    function, argument = link.function, link.argument
    low, high = limits
    if high <= low:
        return 0.0
    first, last = function.value(low), function.value(high)
    chord = (last - first) / (high - low)
    bend = function.bend
    if not bend:
        steep = function.slopes(limits)
        for at, value, (down, up) in (
            (low, first, steep),
            (high, last, steep[::-1]),
        ):
            _line(programme, (index, argument), (at, value, down), below=True)
            _line(programme, (index, argument), (at, value, up), below=False)
        return (steep[1] - steep[0]) * (high - low)
    _line(programme, (index, argument), (low, first, chord), below=bend < 0)
    middle = (low + high) / 2
    for at in (low, middle, high):
        tangent = (at, function.value(at), function.slope(at))
        _line(programme, (index, argument), tangent, below=bend > 0)
    away = abs(function.value(middle) - (first + last) / 2)
    return away / max(abs(first), abs(last), abs(last - first), 1e-300)


def _line(
    programme: Programme,
    variables: tuple[int, int],
    line: tuple[float, float, float],
    *,
    below: bool,
) -> None:
    """Demand that the linked variable lies above the line, or below it.

    `below` says where the line lies.
    """
    index, argument = variables
    at, value, slope = line
    sign = 1.0 if below else -1.0
    programme.add(
        ((argument, sign * slope), (index, -sign)),
        sign * (slope * at - value),
        equal=False,
    )
