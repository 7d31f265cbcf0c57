"""The judge of a machine: its raw equations, solved densely, nothing eliminated.

The equations (an effort and a flow per bond, balances and laws as drawn) are those of
the tests' `catalogue.raw_equations`. Linear machines are solved here as one dense
complex system at a frequency s; of nonlinear ones the balances and laws must hold at a
point, and go on holding as time passes.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy.linalg import lapack

from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import parameter_symbol, t

TESTS = str(Path(__file__).parents[2] / "tests")
if TESTS not in sys.path:
    sys.path.append(TESTS)
Raw: Any = import_module("catalogue.raw_equations").Raw

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Point = dict[sympy.Symbol, float]
FREQUENCY = 0.71 + 0.83j
"""A frequency s that is no pole but by accident."""


STUCK = 1e-9
"""A dry contact slower than this may stick."""

STEP = 1e-6


@dataclass(frozen=True, slots=True)
class Curved:
    """The nonlinear part of a raw equation: a function of these symbols.

    The last argument stands for every ``sign(dry)`` in it, if there is one.
    """

    symbols: tuple[sympy.Symbol, ...]
    function: Callable[..., float]
    dry: tuple[int, ...] = ()

    def at(self, point: Point, sign: float | None = None) -> float:
        """Return the value at a point, dry contacts with another `sign` if given."""
        values = [point[x] for x in self.symbols]
        moving = float(np.sign(values[self.dry[0]])) if self.dry else 0.0
        return self.function(*values, moving if sign is None else sign)


@dataclass(frozen=True, slots=True)
class Law:
    """One raw equation: its constant coefficients, and what is nonlinear in it."""

    slopes: dict[sympy.Symbol, float]
    offset: float
    curved: Curved | None = None

    def left(self, point: Point) -> float:
        """Return what is left of it at a point; a dry contact at rest may stick."""
        linear = sum(slope * point[x] for x, slope in self.slopes.items())
        linear += self.offset
        if self.curved is None:
            return linear
        if not self.sticks(point):
            return linear + self.curved.at(point)
        low, high = sorted(linear + self.curved.at(point, sign) for sign in (-1, 1))
        return 0.0 if low <= 0.0 <= high else min(low, high, key=abs)

    def sticks(self, point: Point) -> bool:
        """Whether a dry contact in it is at rest."""
        if self.curved is None or not self.curved.dry:
            return False
        return abs(point[self.curved.symbols[self.curved.dry[0]]]) < STUCK


class RawSystem:
    """The raw equations of a graph with numbers for its parameters.

    Columns are the efforts, the flows and the stored p or q (`labels`).
    """

    def __init__(self, graph: FinishedGraph, values: dict[str, float]) -> None:
        self.raw = Raw(graph)
        self.labels = [*self.raw.stored]
        stored = [self.raw.stored[label] for label in self.labels]
        self.columns = [*self.raw.efforts, *self.raw.flows, *stored]
        self.place = {x: j for j, x in enumerate(self.columns)}
        self.inputs = [parameter_symbol(u.name) for u in graph.inputs]
        numbers = {parameter_symbol(name): x for name, x in values.items()}
        variables = {*self.columns, *self.inputs}
        self.laws = [_law(g, numbers, variables) for g in self.raw.constraints]
        self.linear = all(law.curved is None for law in self.laws)

    # Linear machines ------------------------------------------------------------------

    def solved_at(self, u: Complex) -> tuple[Complex, float]:
        """Return e, f and stored for input amplitudes u, and the reciprocal condition.

        Each storage contributes ``s x = e`` (or f).
        """
        matrix = np.zeros((len(self.columns), len(self.columns)), complex)
        right = np.zeros(len(self.columns), complex)
        amplitude = dict(zip(self.inputs, u, strict=True))
        for i, law in enumerate(self.laws):
            for x, slope in law.slopes.items():
                if x in self.place:
                    matrix[i, self.place[x]] += slope
                else:
                    right[i] -= slope * amplitude[x]
        first = len(self.laws)
        for k, label in enumerate(self.labels):
            matrix[first + k, self.place[self.raw.stored[label]]] = -FREQUENCY
            rate = self.raw.stored_rates[label].as_coefficients_dict()
            for x, slope in rate.items():
                matrix[first + k, self.place[x]] += float(slope)
        matrix, right = _balanced(matrix, right)
        factors, pivots, zero_pivot = lapack.zgetrf(matrix)
        if zero_pivot:
            return right, 0.0
        condition, _ = lapack.zgecon(factors, np.linalg.norm(matrix, 1))
        solution, _ = lapack.zgetrs(factors, pivots, right)
        return solution, float(condition)

    # Nonlinear machines ---------------------------------------------------------------

    def residuals(self, point: Point) -> Array:
        """Return what is left of every balance and law at a point."""
        return np.array([law.left(point) for law in self.laws])

    def sticks(self, point: Point) -> bool:
        """Whether a dry contact is at rest."""
        return any(law.sticks(point) for law in self.laws)

    def slopes(self, point: Point) -> Array:
        """Return the slopes of all laws along e and f at a point."""
        width = len(self.raw.efforts) + len(self.raw.flows)
        matrix = np.zeros((len(self.laws), width))
        for i, law in enumerate(self.laws):
            for x, slope in law.slopes.items():
                if self.place.get(x, width) < width:
                    matrix[i, self.place[x]] += slope
            for x in () if law.curved is None else law.curved.symbols:
                if self.place.get(x, width) < width:
                    assert law.curved is not None
                    ends = (
                        law.curved.at(point | {x: point[x] + side * STEP})
                        for side in (1, -1)
                    )
                    matrix[i, self.place[x]] += float(np.subtract(*ends)) / (2 * STEP)
        return matrix

    def drift(
        self,
        point: Point,
        input_rates: Point,
        step: float = 1e-5,
    ) -> Array:
        """Return how fast the residuals change when stores, inputs and time move on.

        Efforts and flows stay: their part is ``slopes @ rates``.
        """
        rates = {t: 1.0, **input_rates}
        for label in self.labels:
            rate = self.raw.stored_rates[label].xreplace(point)
            rates[self.raw.stored[label]] = float(rate)
        before, after = (
            {x: v + side * step * rates.get(x, 0.0) for x, v in point.items()}
            for side in (-1.0, 1.0)
        )
        return (self.residuals(after) - self.residuals(before)) / (2.0 * step)


def _law(expression: sympy.Expr, numbers: Point, variables: set[sympy.Symbol]) -> Law:
    """Return a raw equation split into constant coefficients and what is curved."""
    slopes: dict[sympy.Symbol, float] = {}
    offset, curved = 0.0, []
    for term in sympy.Add.make_args(expression):
        factor, found = 1.0, []
        for part in sympy.Mul.make_args(term):
            if part.is_Number:
                factor *= float(part)
            elif part in numbers:
                factor *= numbers[part]
            else:
                found.append(part)
        if not found:
            offset += factor
        elif len(found) == 1 and found[0] in variables:
            slopes[found[0]] = slopes.get(found[0], 0.0) + factor
        else:
            curved.append(term)
    if not curved:
        return Law(slopes, offset)
    return Law(slopes, offset, _curved(sympy.Add(*curved).xreplace(numbers)))


def _curved(expression: sympy.Expr) -> Curved:
    symbols = tuple(sorted(expression.free_symbols, key=str))
    signs = {s.args[0] for s in expression.atoms(sympy.sign)}
    # A negative half arrow gives sign(-f), which is -sign(f) already.
    dry = tuple(symbols.index(x) for x in signs)
    assert len(dry) <= 1
    plain = sympy.Symbol("sign_of_dry")
    flat = expression.xreplace({sympy.sign(x): plain for x in signs})
    function = sympy.lambdify([*symbols, plain], flat, "math")
    return Curved(symbols, function, dry)


def _balanced(matrix: Complex, right: Complex) -> tuple[Complex, Complex]:
    """Return the rows scaled to a largest entry of one."""
    size = np.max(np.abs(matrix), axis=1)
    size[size == 0.0] = 1.0
    return matrix / size[:, None], right / size
