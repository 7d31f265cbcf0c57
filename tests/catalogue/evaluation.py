"""Numbers for a graph: the record of its equations evaluated in its own order."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy

from bondgraph import FinishedGraph, derive
from bondgraph.equations.state_equations import StateEquations
from bondgraph.structure.domains import Quantity
from bondgraph.structure.signals import t
from catalogue.cases import somewhere

Values = dict[sympy.Symbol, float]


def leaves(equations: StateEquations) -> set[sympy.Symbol]:
    """Return the symbols whose values may be chosen freely."""
    chosen = {t, *equations.inputs, *equations.input_rates, *equations.parameters}
    return chosen | {state.symbol for state in equations.states}


def evaluated(equations: StateEquations, put: Mapping[sympy.Symbol, float]) -> Values:
    """Return the value of every symbol, the unknowns found by damped Newton steps."""
    fixed: Values = dict(put)
    early, late = equations.around_rates()
    steps = [(a.symbol, a.expression) for a in early]
    steps += [
        (s.rate, x) for s, x in zip(equations.states, equations.rates, strict=True)
    ]
    steps += [(a.symbol, a.expression) for a in (*late, *equations.further)]
    moving = []  # what depends on the unknowns; the rest is evaluated once
    for symbol, expression in steps:
        reduced = sympy.sympify(expression.xreplace(fixed))
        if reduced.free_symbols:
            moving.append((symbol, reduced))
        else:
            fixed[symbol] = number(reduced, {})
    residuals = [r.xreplace(fixed) for r in equations.residuals]

    def walk(z: np.ndarray) -> tuple[Values, np.ndarray]:
        at: Values = dict(zip(equations.unknowns, map(float, z), strict=True))
        for symbol, expression in moving:
            at[symbol] = number(expression, at)
        return fixed | at, np.array([number(r, at) for r in residuals])

    size = len(equations.unknowns)
    z = np.full(size, 0.1)
    at, left = walk(z)
    for _ in range(60):
        if not size or np.max(np.abs(left)) < 1e-11:
            break
        nudges = 1e-6 * np.eye(size)
        slopes = np.array([(walk(z + h)[1] - walk(z - h)[1]) / 2e-6 for h in nudges]).T
        step = np.linalg.solve(slopes, left)
        for damping in 0.5 ** np.arange(12):
            at, left_there = walk(z - damping * step)
            if np.linalg.norm(left_there) < np.linalg.norm(left):
                break
        z, left = z - damping * step, left_there
    assert not size or np.max(np.abs(left)) < 1e-9, "the residuals were not solved"
    return at


def number(expression: sympy.Expr, at: Mapping[sympy.Symbol, float]) -> float:
    """Return the value of `expression`; not a number where it has none."""
    value = sympy.sympify(expression.xreplace(at))
    return float(value) if value.is_real else float("nan")


@dataclass(frozen=True)
class Observed:
    """What a graph does at one point: its rates, outputs and port variables."""

    equations: StateEquations
    at: Values

    def signal(self, quantity: Quantity | str, place: str) -> float:
        return number(self.equations.signal(quantity, place), self.at)

    @property
    def rates(self) -> dict[str, float]:
        return {s.symbol.name: self.at[s.rate] for s in self.equations.states}

    @property
    def outputs(self) -> dict[str, float]:
        return {o.name: number(o.expression, self.at) for o in self.equations.outputs}

    def power(self, place: str) -> float:
        return self.signal("effort", place) * self.signal("flow", place)


def observed(
    graph: FinishedGraph, values: Mapping[str, float] | None = None
) -> Observed:
    """Return the graph at arbitrary values of its symbols, or at those named."""
    equations = derive(graph)
    put = somewhere(leaves(equations))
    named = {symbol.name: symbol for symbol in put}
    put |= {named[n]: v for n, v in (values or {}).items() if n in named}
    return Observed(equations, evaluated(equations, put))
