"""The reduced form ``M(x) ẋ = f(x, u)``, made on demand, for reading.

Assignments are put into one another and unknowns that enter linearly are solved for,
so that dependent storages become terms of a mass matrix M and linear loops disappear.
Unknowns that enter nonlinearly stay, with their residuals.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import sympy

from bondgraph.equations.algebra.pieces import is_in_pieces
from bondgraph.equations.algebra.rational import Row, in_lowest_terms, solved
from bondgraph.equations.deriving.sorting import replaced
from bondgraph.equations.state_equations import Output, StateEquations

ONE = sympy.S.One


@dataclass(frozen=True, slots=True, kw_only=True)
class ReducedEquations:
    """``mass · ẋ = forces``; the outputs; what could not be solved for.

    ``solutions`` gives each eliminated unknown in terms of states, rates and inputs;
    ``unknowns`` and ``residuals`` are those that enter nonlinearly.
    """

    equations: StateEquations
    mass: sympy.ImmutableSparseMatrix
    forces: tuple[sympy.Expr, ...]
    outputs: tuple[Output, ...]
    solutions: dict[sympy.Symbol, sympy.Expr]
    unknowns: tuple[sympy.Symbol, ...] = ()
    residuals: tuple[sympy.Expr, ...] = ()

    def explicit(self) -> tuple[sympy.Expr, ...]:
        """Return ẋ, from a symbolic solution of ``mass · ẋ = forces``.

        Forces enter the solution as they are, unexpanded.
        """
        rates = [state.rate for state in self.equations.states]
        rows: list[Row] = [{} for _ in rates]
        for (i, j), value in self.mass.todok().items():
            rows[i][rates[j]] = value
        keys = [sympy.Dummy() for _ in rates]
        right: list[Row] = [{key: ONE} for key in keys]
        answer = solved(rows, rates, right)
        force = dict(zip(keys, self.forces, strict=True))
        return tuple(
            sympy.Add(*(value * force[key] for key, value in answer[rate].items()))
            for rate in rates
        )


def reduce(equations: StateEquations) -> ReducedEquations:
    """Return ``M(x) ẋ = f`` with assignments inserted and linear unknowns eliminated.

    Raises
    ------
    EquationError
        If the unknowns are not determined.
    """
    inserted = _inserted(equations)
    rates = [replaced(rate, inserted) for rate in equations.rates]
    residuals = [replaced(residual, inserted) for residual in equations.residuals]
    linear = _linear_unknowns(equations.unknowns, [*rates, *residuals])
    rate_symbols = [state.rate for state in equations.states]
    kept = [i for i, z in enumerate(equations.unknowns) if z not in linear]
    used = [i for i, z in enumerate(equations.unknowns) if z in linear]
    forms = [_linear_form(residuals[i], linear) for i in used]
    sources = [sympy.Dummy() for _ in forms]
    answer = solved(
        [form for form, _ in forms],
        [equations.unknowns[i] for i in used],
        [{source: -ONE} for source in sources],
    )
    rest = dict(zip(sources, (rest for _, rest in forms), strict=True))
    solutions = {
        unknown: sympy.Add(*(value * rest[key] for key, value in row.items()))
        for unknown, row in answer.items()
    }
    mass: dict[tuple[int, int], sympy.Expr] = {}
    forces = []
    for i, rate in enumerate(rates):
        row, force = _linear_form(replaced(rate, solutions), rate_symbols)
        row = {rate_symbols.index(s): -value for s, value in row.items()}
        row[i] = ONE + row.get(i, sympy.S.Zero)
        mass.update({(i, j): in_lowest_terms([x]) for j, x in row.items()})
        forces.append(force)
    size = len(rates)
    return ReducedEquations(
        equations=equations,
        mass=sympy.ImmutableSparseMatrix(size, size, mass),
        forces=tuple(forces),
        outputs=tuple(
            Output(
                o.name, replaced(replaced(o.expression, inserted), solutions), o.unit
            )
            for o in equations.outputs
        ),
        solutions=solutions,
        unknowns=tuple(equations.unknowns[i] for i in kept),
        residuals=tuple(replaced(residuals[i], solutions) for i in kept),
    )


def _inserted(equations: StateEquations) -> dict[sympy.Symbol, sympy.Expr]:
    """Return every assigned symbol in terms of x, ẋ, z, u and parameters."""
    inserted: dict[sympy.Symbol, sympy.Expr] = {}
    for assignment in equations.assignments:
        inserted[assignment.symbol] = replaced(assignment.expression, inserted)
    return inserted


def _linear_unknowns(
    unknowns: Iterable[sympy.Symbol], expressions: list[sympy.Expr]
) -> list[sympy.Symbol]:
    """Return the unknowns that enter every expression linearly, also as a group."""
    group = list(unknowns)
    while True:
        members = set(group)
        bad: set[sympy.Symbol] = set()
        for expression in expressions:
            for symbol in sorted(expression.free_symbols & members, key=str):
                slope = expression.diff(symbol)
                if slope.free_symbols & members or is_in_pieces(expression, [symbol]):
                    bad.add(symbol)
        if not bad:
            return group
        group = [z for z in group if z not in bad]


def _linear_form(
    expression: sympy.Expr, symbols: Iterable[sympy.Symbol]
) -> tuple[Row, sympy.Expr]:
    """Return the coefficients of `symbols` in `expression`, and the rest."""
    found = [s for s in symbols if s in expression.free_symbols]
    row = {symbol: expression.diff(symbol) for symbol in found}
    rest = expression.xreplace(dict.fromkeys(found, sympy.S.Zero))
    return row, rest
