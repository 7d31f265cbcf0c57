"""Steady states: where every rate vanishes, in symbols where the equations are affine.

A state that nothing reads back (the angle of a free shaft) is not asked to stand still:
it may keep any value, or grow at a constant rate, and the answer says so. Equations
that leave states free give a family of steady states; equations that contradict each
other are answered with the combination of rates that cannot vanish.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import sympy

from bondgraph.equations.algebra.pieces import is_in_pieces
from bondgraph.equations.algebra.rational import RationalField
from bondgraph.equations.deriving.sorting import replaced
from bondgraph.equations.reduction import ReducedEquations
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError, did_you_mean

ZERO, ONE = sympy.S.Zero, sympy.S.One


class SteadyStatus(StrEnum):
    """How the search for a steady state ended; the value is the sentence to show."""

    FOUND = "A steady state, the only one near."
    FAMILY = "One of a family of steady states."
    MOVING = "Steady, but for states that grow at a constant rate."
    NOT_FOUND = "No steady state was found."


@dataclass(frozen=True, slots=True, kw_only=True)
class SteadyState:
    """A steady state, or why there is none; `linearise` and `state_space` take it.

    Parameters
    ----------
    values
        States, unknowns and inputs by name: numbers, or expressions of parameters.
    free
        States whose value is a choice (made by ``hold`` or the guess).
    growth
        Rates of the states that do not stand still.
    reason
        In words, why it is not FOUND.
    """

    name: str
    status: SteadyStatus
    values: Mapping[str, sympy.Expr] = field(default_factory=dict)
    free: tuple[str, ...] = ()
    growth: Mapping[str, sympy.Expr] = field(default_factory=dict)
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether there is a steady state to use."""
        return self.status is not SteadyStatus.NOT_FOUND

    def __getitem__(self, name: str) -> sympy.Expr:
        try:
            return self.values[name]
        except KeyError:
            raise EquationError(
                f"The steady state of {self.name!r} has no {name!r}.",
                (name,),
                did_you_mean(name, self.values),
            ) from None

    def __str__(self) -> str:
        lines = [f"{self.name}: {self.status.value}"]
        lines += [f"  {name} = {_short(value)}" for name, value in self.values.items()]
        lines += [
            f"  d({name})/dt = {_short(rate)}" for name, rate in self.growth.items()
        ]
        if self.free:
            lines.append(f"  free: {', '.join(self.free)}")
        return "\n".join([*lines, f"  {self.reason}"] if self.reason else lines)


def _short(value: sympy.Expr) -> str:
    return f"{float(value):.6g}" if value.is_Number else str(value)


def point_values(at: Mapping[str, object] | SteadyState | None) -> Mapping[str, object]:
    """Return the values of an operating point by name.

    Raises
    ------
    EquationError
        If it is a steady state that was not found.
    """
    if not isinstance(at, SteadyState):
        return {} if at is None else at
    if not at.found:
        raise EquationError(
            f"There is no steady state of {at.name!r} to linearise at: {at.reason}",
            (at.name,),
            "Give a point by hand: at={name: value}.",
        )
    return at.values


def drifting(
    equations: StateEquations, expressions: Iterable[sympy.Expr]
) -> tuple[str, ...]:
    """Return the states that none of `expressions` (rates and residuals) reads."""
    read = set().union(*(e.free_symbols for e in expressions))
    return tuple(s.symbol.name for s in equations.states if s.symbol not in read)


def affine_steady_state(
    reduced: ReducedEquations,
    inputs: Mapping[str, sympy.Expr | None],
    hold: Mapping[str, sympy.Expr],
    guess: Mapping[str, sympy.Expr],
) -> SteadyState | None:
    """Return the steady state in symbols, or None where the equations are not affine.

    Parameters
    ----------
    inputs
        Values of all inputs; None for one that is to be found.
    hold
        Values of states that are given.
    guess
        Values of states that turn out to be free; zero where not named.
    """
    equations = reduced.equations
    rest = {state.rate: ZERO for state in equations.states}
    rest.update(dict.fromkeys(equations.input_rates, ZERO))
    given = {u: inputs[u.name] for u in equations.inputs}
    put = {**rest, **{u: value for u, value in given.items() if value is not None}}
    states = {state.symbol.name: state.symbol for state in equations.states}
    put.update((states[name], value) for name, value in hold.items())
    forces = [replaced(force, rest) for force in reduced.forces]
    loose = drifting(equations, [*forces, *reduced.residuals])
    moved = [j for j, name in enumerate(states) if name in loose]
    if any(
        j in moved and value != (1 if i == j else 0)
        for (i, j), value in reduced.mass.todok().items()
    ):
        return None  # the rate of a drifting state is felt elsewhere
    wanted = [x for name, x in states.items() if name not in {*loose, *hold}]
    wanted += [u for u, value in given.items() if value is None]
    wanted += list(reduced.unknowns)
    rows = {
        state.symbol.name: replaced(force, put)
        for state, force in zip(equations.states, forces, strict=True)
        if state.symbol.name not in loose
    }
    rows |= {
        str(z): replaced(replaced(r, rest), put)
        for z, r in zip(reduced.unknowns, reduced.residuals, strict=True)
    }
    form = _affine(list(rows.values()), wanted)
    if form is None:
        return None
    chosen = {x: guess.get(str(x), ZERO) for x in wanted}
    solved = _solved(list(rows), chosen, *form)
    if isinstance(solved, str):
        return SteadyState(
            name=equations.name, status=SteadyStatus.NOT_FOUND, reason=solved
        )
    values, free = solved
    put |= values
    put |= {states[name]: hold.get(name, guess.get(name, ZERO)) for name in loose}
    return described(
        equations,
        values={
            **{name: put[x] for name, x in states.items()},
            **{u.name: put[u] for u in equations.inputs},
            **{
                z.name: put[z] if z in put else replaced(reduced.solutions[z], put)
                for z in equations.unknowns
            },
        },
        loose=loose,
        free=tuple(str(x) for x in free),
        rates={
            state.symbol.name: replaced(force, put)
            for state, force in zip(equations.states, forces, strict=True)
        },
    )


def described(
    equations: StateEquations,
    *,
    values: Mapping[str, sympy.Expr],
    loose: tuple[str, ...],
    free: tuple[str, ...],
    rates: Mapping[str, sympy.Expr],
) -> SteadyState:
    """Return the record of a point where all rates but those of `loose` vanish."""
    growth = {name: rates[name] for name in loose if rates[name] != 0}
    still = (*(name for name in loose if name not in growth), *free)
    status, reason = SteadyStatus.FOUND, ""
    if growth:
        status = SteadyStatus.MOVING
        reason = f"{', '.join(growth)} grows for ever, and no rate reads it."
        if outputs := _readers(equations, growth):
            reason += f" {' and '.join(outputs)} grows with it."
    elif still:
        status = SteadyStatus.FAMILY
        reason = f"{', '.join(still)} may have any value: nothing holds it."
    return SteadyState(
        name=equations.name,
        status=status,
        values=values,
        free=still,
        growth=growth,
        reason=reason,
    )


def _readers(equations: StateEquations, names: Iterable[str]) -> list[str]:
    """Return the outputs that depend on states of those names."""
    grown = {s.symbol for s in equations.states if s.symbol.name in set(names)}
    for one in equations.assignments:
        if one.expression.free_symbols & grown:
            grown.add(one.symbol)
    return [o.name for o in equations.outputs if o.expression.free_symbols & grown]


def _affine(
    expressions: list[sympy.Expr], unknowns: list[sympy.Symbol]
) -> tuple[list[list[sympy.Expr]], list[sympy.Expr]] | None:
    """Return coefficients and right sides of ``expressions = 0``, or None."""
    members = set(unknowns)
    matrix, right = [], []
    for expression in expressions:
        row = [
            expression.diff(x) if x in expression.free_symbols else ZERO
            for x in unknowns
        ]
        bent = any(entry.free_symbols & members for entry in row)
        if bent or (unknowns and is_in_pieces(expression, unknowns)):
            return None
        matrix.append(row)
        right.append(-expression.xreplace(dict.fromkeys(unknowns, ZERO)))
    return matrix, right


def _solved(
    names: list[str],
    chosen: Mapping[sympy.Symbol, sympy.Expr],
    matrix: list[list[sympy.Expr]],
    right: list[sympy.Expr],
) -> tuple[dict[sympy.Symbol, sympy.Expr], list[sympy.Symbol]] | str:
    """Return the values, free ones as chosen, or a sentence on what cannot vanish."""
    unknowns = list(chosen)
    if not names:
        return dict(chosen), unknowns
    field_ = RationalField([*(x for row in matrix for x in row), *right])
    # The unit columns on the right keep which equations each row was made from.
    rows = [
        [*row, value, *(ONE if i == k else ZERO for k in range(len(names)))]
        for i, (row, value) in enumerate(zip(matrix, right, strict=True))
    ]
    width = len(unknowns)
    reduced, pivots = field_.matrix(rows, width + 1 + len(names)).rref()
    table = reduced.to_list()
    for i, pivot in enumerate(pivots):
        if pivot == width:
            weights = [field_.expression(x) for x in table[i][width + 1 :]]
            return _contradiction(names, weights)
        if pivot > width:
            break
    values = dict(chosen)
    free = [j for j in range(width) if j not in pivots]
    for i, pivot in enumerate(pivots):
        if pivot < width:
            terms = [
                -field_.expression(table[i][j]) * chosen[unknowns[j]]
                for j in free
                if table[i][j]
            ]
            value = field_.expression(table[i][width])
            values[unknowns[pivot]] = sympy.Add(value, *terms)
    return values, [unknowns[j] for j in free]


def _contradiction(names: list[str], weights: list[sympy.Expr]) -> str:
    """Say which combination of rates stays, whatever the states."""
    lead = next(weight for weight in weights if weight != 0)
    total = sympy.Add(
        *(
            sympy.cancel(weight / lead) * sympy.Symbol(f"d({name})/dt")
            for name, weight in zip(names, weights, strict=True)
        )
    )
    return f"{total} does not vanish, whatever the states are."
