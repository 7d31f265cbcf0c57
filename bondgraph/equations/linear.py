"""Linear systems ``ẋ = A x + B u, y = C x + D u`` with symbolic parameters.

The matrices come from the chain rule through the sorted assignments; the unknowns are
solved for in a field of rational functions. Where an input is differentiated (a source
that sets a storage), ``B_rate`` and ``D_rate`` multiply u̇.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from bondgraph.equations.chain_rule import Row, propagate, row_of, seeded
from bondgraph.equations.operating_point import OperatingPoint
from bondgraph.equations.rational import RationalField, in_lowest_terms, solved
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.steady_state import SteadyState
from bondgraph.equations.transfer_function import TransferFunction, s
from bondgraph.errors import EquationError, did_you_mean

MOST_STATES = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearSystem:
    """``ẋ = A x + B u + B_rate u̇`` and ``y = C x + D u + D_rate u̇``.

    ``states``, ``inputs`` and ``outputs`` are the names of the rows and columns. For a
    nonlinear model x, u and y are deviations from the operating point.
    """

    name: str
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    A: sympy.ImmutableSparseMatrix
    B: sympy.ImmutableSparseMatrix
    C: sympy.ImmutableSparseMatrix
    D: sympy.ImmutableSparseMatrix
    B_rate: sympy.ImmutableSparseMatrix
    D_rate: sympy.ImmutableSparseMatrix

    def transfer_function(
        self,
        output: str | None = None,
        input: str | None = None,  # noqa: A002
    ) -> TransferFunction:
        """Return the transfer function from `input` to `output`.

        Either may be left out where there is only one.

        Raises
        ------
        EquationError
            If there is no such signal, or too many states for a closed form.
        """
        row = _chosen(output, self.outputs, "output", self.name)
        column = _chosen(input, self.inputs, "input", self.name)
        between = self._between(row, column)
        if len(between) > MOST_STATES:
            raise EquationError(
                f"{len(between)} states lie between {self.inputs[column]!r} and "
                f"{self.outputs[row]!r}; a closed form of more than {MOST_STATES} is "
                f"unreadable.",
                (self.name,),
                "Put numbers in: make a StateSpace of the model.",
            )
        A = [[self.A[i, j] for j in between] for i in between]
        B = [self.B[i, column] for i in between]
        B_rate = [self.B_rate[i, column] for i in between]
        C = [self.C[row, i] for i in between]
        direct = (self.D[row, column], self.D_rate[row, column])
        numerator, denominator = _polynomials(A, B, B_rate, C, direct)
        return TransferFunction(
            input=self.inputs[column],
            output=self.outputs[row],
            numerator_coefficients=numerator,
            denominator_coefficients=denominator,
        )

    def _between(self, row: int, column: int) -> list[int]:
        """Return the states that the input reaches and that reach the output."""
        forward: dict[int, list[int]] = {}
        backward: dict[int, list[int]] = {}
        for i, j in self.A.todok():
            forward.setdefault(j, []).append(i)
            backward.setdefault(i, []).append(j)
        inputs = {*self.B.todok(), *self.B_rate.todok()}
        started = [i for i, j in inputs if j == column]
        ended = [j for i, j in self.C.todok() if i == row]
        return sorted(_reached(started, forward) & _reached(ended, backward))


def _reached(start: list[int], edges: Mapping[int, list[int]]) -> set[int]:
    seen: set[int] = set()
    pending = list(start)
    while pending:
        node = pending.pop()
        if node not in seen:
            seen.add(node)
            pending.extend(edges.get(node, ()))
    return seen


def _chosen(name: str | None, names: tuple[str, ...], kind: str, model: str) -> int:
    if name is None and len(names) == 1:
        return 0
    if name in names:
        return names.index(name)
    problem = (
        f"{model!r} has {len(names)} {kind}s; say which one."
        if name is None
        else f"{model!r} has no {kind} {name!r}."
    )
    raise EquationError(problem, (name or model,), did_you_mean(name or "", names))


def _polynomials(
    A: list[list[sympy.Expr]],
    B: list[sympy.Expr],
    B_rate: list[sympy.Expr],
    C: list[sympy.Expr],
    direct: tuple[sympy.Expr, sympy.Expr],
) -> tuple[tuple[sympy.Expr, ...], tuple[sympy.Expr, ...]]:
    """Return numerator and denominator coefficients without a common factor.

    ``c adj(sI - A) b = det(sI - A + b c) - det(sI - A)``, after the input's rate has
    been moved into the state (x - B_rate u).
    """
    n = len(A)
    flat = [x for row in A for x in row]
    field = RationalField([*flat, *B, *B_rate, *C, *direct])
    domain = field.domain
    if not n:
        denominator = [domain.one]
        numerator = [field.element(direct[1]), field.element(direct[0])]
        return _without_common_factor(field, numerator, denominator)
    a = field.matrix(A, n)
    b, b_rate = (field.matrix([[x] for x in column], 1) for column in (B, B_rate))
    c = field.matrix([C], n)
    b = b + a * b_rate
    through = field.element(direct[0]) + (c * b_rate).to_list()[0][0]
    rate_through = field.element(direct[1])
    denominator = a.charpoly()
    difference = (a - b * c).charpoly()
    numerator = [domain.zero, domain.zero]
    numerator += [x - y for x, y in zip(difference[1:], denominator[1:], strict=True)]
    for i, x in enumerate(denominator):
        numerator[i] += rate_through * x
        numerator[i + 1] += through * x
    return _without_common_factor(field, numerator, denominator)


def _without_common_factor(
    field: RationalField, numerator: Sequence[Any], denominator: Sequence[Any]
) -> tuple[tuple[sympy.Expr, ...], tuple[sympy.Expr, ...]]:
    """Return the coefficients in lowest terms, without fractions inside."""
    parts = [_stripped(numerator), _stripped(denominator)]
    if field.symbols:
        parts = _without_fractions(field, parts)
        domain = field.domain.get_ring()
    else:
        domain = field.domain
    top, bottom = (
        sympy.Poly([domain.to_sympy(c) for c in part], s, domain=domain)
        for part in parts
    )
    if _share_a_root(top, bottom):
        top, bottom = top.cancel(bottom, include=True)
    return tuple(
        tuple(field.restored(c) for c in part.all_coeffs()) for part in (top, bottom)
    )  # type: ignore[return-value]


def _stripped(coefficients: Sequence[Any]) -> list[Any]:
    found = list(coefficients)
    while len(found) > 1 and not found[0]:
        found.pop(0)
    return found


def _without_fractions(field: RationalField, parts: list[list[Any]]) -> list[list[Any]]:
    """Return the coefficients times their common denominator, over their content."""
    ring = field.domain.get_ring()
    common = ring.one
    for c in (c for part in parts for c in part):
        common = ring.lcm(common, c.denom)
    whole = [[ring.exquo(common, c.denom) * c.numer for c in part] for part in parts]
    content = ring.zero
    for c in sorted((c for part in whole for c in part if c), key=len):
        content = ring.gcd(content, c)
        if content == 1:
            return whole
    return [[ring.exquo(c, content) for c in part] for part in whole]


def _share_a_root(top: sympy.Poly, bottom: sympy.Poly) -> bool:
    """Return whether the two have a common factor in s, tried at arbitrary numbers.

    At numbers the greatest common divisor takes microseconds, with symbols minutes; a
    common factor shows at every choice of numbers.
    """
    symbols = sorted(top.free_symbols | bottom.free_symbols, key=str)
    primes = iter(sympy.primerange(100, 10**6))
    numbers = {x: sympy.Rational(next(primes), 97) for x in symbols if x != s}
    top, bottom = (
        sympy.Poly([c.xreplace(numbers) for c in part.all_coeffs()], s, domain="QQ")
        for part in (top, bottom)
    )
    return bool(top.is_zero or top.gcd(bottom).degree() > 0)


def linearise(
    equations: StateEquations, at: Mapping[str, object] | SteadyState | None = None
) -> LinearSystem:
    """Return the linear system around an operating point.

    Parameters
    ----------
    at
        Values (numbers or expressions of parameters) of states, inputs and ``t`` by
        name at the operating point, zero where not named, or what `steady_state`
        found. A linear model needs none.

    Raises
    ------
    EquationError
        If a law has no derivative at the operating point (a kink whose two sides
        differ, a jump).
    """
    evaluate = OperatingPoint(equations, at)
    one = sympy.S.One
    states = [state.symbol for state in equations.states]
    leaves = (*states, *equations.inputs, *equations.input_rates)
    rates = [state.rate for state in equations.states]
    rows = seeded((*leaves, *equations.unknowns), one)
    early, late = equations.around_rates()
    propagate(rows, early, evaluate)
    for rate, expression in zip(rates, equations.rates, strict=True):
        rows[rate] = row_of(expression, rows, evaluate)
    propagate(rows, late, evaluate)
    residuals = [row_of(r, rows, evaluate) for r in equations.residuals]
    solutions = _solve(residuals, equations.unknowns)
    _refuse_jumps(equations, evaluate, rows)
    found = [
        _smooth(
            _without_unknowns(rows[state.rate], solutions),
            evaluate,
            f"the rate of {state.symbol}",
        )
        for state in equations.states
    ]
    outputs = [
        _smooth(
            _without_unknowns(row_of(o.expression, rows, evaluate), solutions),
            evaluate,
            f"the output {o.name!r}",
        )
        for o in equations.outputs
    ]
    return LinearSystem(
        name=equations.name,
        states=tuple(x.name for x in states),
        inputs=tuple(u.name for u in equations.inputs),
        outputs=tuple(o.name for o in equations.outputs),
        A=_matrix(found, states),
        B=_matrix(found, equations.inputs),
        C=_matrix(outputs, states),
        D=_matrix(outputs, equations.inputs),
        B_rate=_matrix(found, equations.input_rates),
        D_rate=_matrix(outputs, equations.input_rates),
    )


def _refuse_jumps(
    equations: StateEquations, at: OperatingPoint, rows: Mapping[sympy.Symbol, Row]
) -> None:
    expressions = {str(a.symbol): a.expression for a in equations.assignments}
    expressions |= {o.name: o.expression for o in equations.outputs}
    expressions |= dict(
        zip(map(str, equations.unknowns), equations.residuals, strict=True)
    )
    for name, expression in expressions.items():
        if any(symbol in rows for symbol in expression.free_symbols):
            at.refuse_jump(expression, name)


def _smooth(row: Row, at: OperatingPoint, of: str) -> Row:
    return {leaf: at.smooth(value, of) for leaf, value in row.items()}


def _solve(
    residuals: list[Row], unknowns: tuple[sympy.Symbol, ...]
) -> dict[sympy.Symbol, Row]:
    known = set(unknowns)
    matrix = [{k: v for k, v in row.items() if k in known} for row in residuals]
    right = [{k: -v for k, v in row.items() if k not in known} for row in residuals]
    return solved(matrix, unknowns, right)


def _without_unknowns(row: Row, solutions: Mapping[sympy.Symbol, Row]) -> Row:
    total: dict[sympy.Symbol, list[sympy.Expr]] = {}
    for key, value in row.items():
        for leaf, factor in solutions.get(key, {key: sympy.S.One}).items():
            total.setdefault(leaf, []).append(value * factor)
    return {leaf: in_lowest_terms(terms) for leaf, terms in total.items()}


def _matrix(
    rows: list[Row], columns: Sequence[sympy.Symbol]
) -> sympy.ImmutableSparseMatrix:
    place = {symbol: j for j, symbol in enumerate(columns)}
    entries = {
        (i, place[symbol]): value
        for i, row in enumerate(rows)
        for symbol, value in row.items()
        if symbol in place and value != 0
    }
    return sympy.ImmutableSparseMatrix(len(rows), len(columns), entries)
