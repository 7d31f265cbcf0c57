"""Steady states of any model: in symbols where affine, else by least squares.

The numeric search solves (ẋ - rate, residual) = 0 with the exact Jacobian; its unknowns
are the states, the algebraic unknowns, the inputs to be found, and the rates of those
states that nothing reads back. What is left over is said: which rate stays.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy import sparse

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.hard_contact import refuse_hard_contact
from bondgraph.equations.reduction import reduce
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.steady_state import (
    SteadyState,
    SteadyStatus,
    affine_steady_state,
    described,
    drifting,
)
from bondgraph.errors import EquationError, did_you_mean
from bondgraph.numeric.families import family
from bondgraph.numeric.jacobian import Point, one_sided, residual
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.numeric.placing import placed
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import canonical

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Value = object
"""A number, or an expression of parameters (also as text)."""

SYMBOLIC_STATES = 40
"""Solving more states than this in symbols takes long and fills pages."""
DENSE = 400
EVALUATIONS = 300
STARTS = (1.0, 1e-3, 1e3, 1.0, 1e-3, 1e3, 1e-6, 1e6)
"""Distances from the guess at which the search is tried again, signs at random."""
TOLERANCE = 1e-9


def steady_state(
    graph: FinishedGraph,
    *,
    inputs: Mapping[str, Value | None] | None = None,
    guess: Mapping[str, float] | None = None,
    hold: Mapping[str, Value] | None = None,
) -> SteadyState:
    """Return the state in which the machine stands still under constant inputs.

    Parameters
    ----------
    inputs
        Constant values by name, numbers or expressions of parameters; 0 where not
        named; None for an input that is to be found (hold as many states then).
    guess
        Where to start the search of a nonlinear model, and where free states are put.
    hold
        States that are given a value.

    Returns
    -------
    SteadyState
        With a status: found, one of a family, steady but for states that grow, or not
        found with the reason. Values are expressions of parameters where the equations
        are affine, numbers else.

    Raises
    ------
    EquationError
        If a name is unknown, or the model depends on time or has a hard contact.
    ParameterError
        If a nonlinear model has a parameter without a value.
    """
    equations = derive(graph)
    states = [state.symbol.name for state in equations.states]
    names = [u.name for u in equations.inputs]
    for given, known in ((inputs, names), (hold, states)):
        _refuse_unknown(equations.name, given or {}, known)
    fixed = {
        name: None if value is None else canonical(value)
        for name, value in {**dict.fromkeys(names, 0), **(inputs or {})}.items()
    }
    held = {name: canonical(value) for name, value in (hold or {}).items()}
    nearby = {name: canonical(value) for name, value in (guess or {}).items()}
    model = compile_model(equations)
    if model.contacts is not None:
        refuse_hard_contact(
            equations.name, model.contacts.places, "which may hold it or not"
        )
    if model.needs_time:
        raise EquationError(
            f"{equations.name!r} depends on time, so nothing in it stands still.",
            ("t",),
            "Linearise it at a point of its motion: at={name: value, 't': time}.",
        )
    if len(states) <= SYMBOLIC_STATES:
        symbolic = affine_steady_state(reduce(equations), fixed, held, nearby)
        if symbolic is not None:
            return symbolic
    values = graph.parameters.values_by_name()
    point = {**(guess or {}), **{n: v for n, v in fixed.items() if v is not None}}
    start = placed(model, equations, values, {**point, **held})
    found = {name for name, value in fixed.items() if value is None}
    return _Search(equations, model, start, found, set(held)).answer()


def _refuse_unknown(model: str, given: Iterable[str], known: list[str]) -> None:
    for name in given:
        if name not in known:
            raise EquationError(
                f"{model!r} has no state or input {name!r}.",
                (name,),
                did_you_mean(name, known),
            )


@dataclass(frozen=True, eq=False)
class _Search:
    """One numeric search: which variables move, and the equations to meet."""

    equations: StateEquations
    model: NumericModel
    start: Point
    found: set[str]
    held: set[str]

    def answer(self) -> SteadyState:
        y0 = self._moving(self.start)
        best, why = y0, "A law is not defined where the search starts."
        draw = np.random.default_rng(0)
        for size in (0.0, *STARTS):
            y = y0 + size * draw.choice([-1.0, 1.0], len(y0))
            if not np.isfinite(self._residual(y)).all():
                continue
            best = self._searched(y)
            row, left = self._worst(best)
            if row is None:
                return self._described(self._point(best), best)
            if size == 0.0 or "stays" not in why:
                why = self._what_stays(row, left)
            if not len(y0):
                break
        return SteadyState(
            name=self.model.name, status=SteadyStatus.NOT_FOUND, reason=why
        )

    def _residual(self, y: Array) -> Array:
        return residual(self.model, self._point(y))

    def _searched(self, y0: Array) -> Array:
        from scipy.optimize import least_squares  # noqa: PLC0415  (0.1 s)

        if not len(y0):
            return y0
        dense = len(y0) <= DENSE

        def slopes_at(y: Array) -> Any:
            matrix = self._jacobian(y)
            return matrix.toarray() if dense else matrix

        found: Array = least_squares(
            self._residual,
            y0,
            jac=slopes_at,
            x_scale="jac",
            tr_solver="exact" if dense else "lsmr",
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
            max_nfev=EVALUATIONS,
        ).x
        return found

    def _worst(self, y: Array) -> tuple[int | None, float]:
        """Return the equation that is missed and by how much, or None."""
        left = self._residual(y)
        scale = abs(self._jacobian(y)) @ np.abs(y) + self._size_of_inputs(y)
        worst = np.abs(left) / (TOLERANCE * scale + 1e-12)
        if not worst.max(initial=0.0) > 1:
            return None, 0.0
        row = int(worst.argmax())
        return row, float(left[row])

    @cached_property
    def _loose(self) -> tuple[str, ...]:
        rates = {state.rate for state in self.equations.states}
        late = [*self.equations.rates, *self.equations.residuals]
        late += [a.expression for a in self.equations.assignments]
        free = set(drifting(self.equations, late)) - self.held
        # A rate that is read (by a dependent storage) must be zero.
        read = set().union(*(e.free_symbols for e in late)) & rates
        return tuple(
            s.symbol.name
            for s in self.equations.states
            if s.symbol.name in free and s.rate not in read
        )

    @cached_property
    def _columns(self) -> list[Integers]:
        """Return the indices of x, of u and of ẋ that move."""
        loose, held = set(self._loose), self.held
        names = self.model.state_names
        x = [i for i, n in enumerate(names) if n not in loose and n not in held]
        u = [i for i, n in enumerate(self.model.input_names) if n in self.found]
        rates = [i for i, n in enumerate(names) if n in loose]
        return [np.array(part, dtype=np.int64) for part in (x, u, rates)]

    def _moving(self, at: Point) -> Array:
        x, u, rates = self._columns
        return np.concatenate([at.x[x], at.unknowns, at.u[u], at.rates[rates]])

    def _point(self, y: Array) -> Point:
        x, u, rates = self._columns
        values = np.split(y, np.cumsum([len(x), self.model.n_unknowns, len(u)]))
        new_x, new_u = self.start.x.copy(), self.start.u.copy()
        new_rates = np.zeros_like(self.start.rates)
        new_x[x], new_u[u], new_rates[rates] = values[0], values[2], values[3]
        return replace(
            self.start, x=new_x, u=new_u, rates=new_rates, unknowns=values[1]
        )

    def _jacobian(self, y: Array) -> Any:
        here = one_sided(self.model, self._point(y))
        x, u, rates = self._columns
        n, unknowns = self.model.n_states, self.model.n_unknowns
        first = n + unknowns  # of the columns of x, which u follows
        chosen = [first + x, n + np.arange(unknowns), first + n + u, rates]
        return sparse.csc_array(here)[:, np.concatenate(chosen)]

    def _size_of_inputs(self, y: Array) -> Array:
        """Return what the known inputs and states contribute to each equation."""
        at = self._point(y)
        here = one_sided(self.model, at)
        known = np.concatenate([at.x, at.u, at.input_rates])
        given = here[:, here.shape[1] - len(known) :]
        size: Array = abs(given) @ np.abs(known)
        return size

    def _what_stays(self, row: int, left: float) -> str:
        n = self.model.n_states
        if row < n:
            what = f"The rate of {self.model.state_names[row]!r} stays at {-left:.3g}"
        else:
            what = (
                f"The equation of {self.equations.unknowns[row - n]} misses {left:.3g}"
            )
        return f"{what}; give a guess nearer to it, or look for a law that jumps."

    def _described(self, at: Point, y: Array) -> SteadyState:
        names = self.model.state_names
        x, u, rates = self._columns
        moving = (
            [names[i] for i in x]
            + [z.name for z in self.equations.unknowns]
            + [self.model.input_names[i] for i in u]
            + [f"d({names[i]})/dt" for i in rates]
        )

        numbers = {
            **dict(zip(names, at.x, strict=True)),
            **dict(zip(self.model.input_names, at.u, strict=True)),
            **{
                z.name: value
                for z, value in zip(self.equations.unknowns, at.unknowns, strict=True)
            },
        }
        return described(
            self.equations,
            values={name: sympy.Float(value) for name, value in numbers.items()},
            loose=self._loose,
            free=tuple(moving[i] for i in family(self._jacobian(y), y, self._residual)),
            rates={n: _zero_or(v) for n, v in zip(names, at.rates, strict=True)},
        )


def _zero_or(value: float) -> sympy.Expr:
    return sympy.S.Zero if abs(value) < 1e-12 else sympy.Float(value)
