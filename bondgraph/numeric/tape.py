"""The gate, first half: sympy expressions become a tape of elementary operations.

A tape is single-assignment code: slots ``0 … n_variables-1`` hold the variables, the
next ones constants, and every operation writes the slot after the last. Equal
subexpressions share a slot. One compiled kernel (`bondgraph.numeric.kernel`) runs any
tape, with exact derivatives by carrying tangents through the same operations, so a new
model is ready in milliseconds and nothing is compiled for it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
import sympy
from numpy.typing import NDArray
from sympy.logic import boolalg

from bondgraph.errors import EquationError


class Op(IntEnum):
    """Elementary operations; the kernel dispatches on the number."""

    ADD = 0
    MUL = 1
    DIV = 2
    POWI = 3
    POW = 4
    SQRT = 5
    SIN = 6
    COS = 7
    TAN = 8
    EXP = 9
    LOG = 10
    TANH = 11
    ABS = 12
    SIGN = 13
    MAX = 14
    MIN = 15
    ATAN = 16
    SINH = 17
    COSH = 18
    ASIN = 19
    ACOS = 20
    LESS = 21
    LESS_EQUAL = 22
    AND = 23
    OR = 24
    NOT = 25
    SELECT = 26
    ATAN2 = 27
    SUB = 28


_UNARY = {
    sympy.sin: Op.SIN,
    sympy.cos: Op.COS,
    sympy.tan: Op.TAN,
    sympy.exp: Op.EXP,
    sympy.log: Op.LOG,
    sympy.tanh: Op.TANH,
    sympy.Abs: Op.ABS,
    sympy.sign: Op.SIGN,
    sympy.atan: Op.ATAN,
    sympy.sinh: Op.SINH,
    sympy.cosh: Op.COSH,
    sympy.asin: Op.ASIN,
    sympy.acos: Op.ACOS,
}
_FOLDED = {
    sympy.Add: Op.ADD,
    sympy.Mul: Op.MUL,
    sympy.Max: Op.MAX,
    sympy.Min: Op.MIN,
    boolalg.And: Op.AND,
    boolalg.Or: Op.OR,
}


@dataclass(frozen=True, slots=True, eq=False)
class Tape:
    """Operations as arrays; see the module's head.

    ``code[i] = (op, a, b, c)`` writes slot ``n_variables + len(constants) + i``.
    ``outputs`` are the slots of the expressions the tape was made for. ``degree`` holds
    for each output 0, 1 or 2: independent of, affine in, or nonlinear in the variables
    called active when the tape was made.
    """

    n_variables: int
    constants: NDArray[np.float64]
    code: NDArray[np.int64]
    outputs: NDArray[np.int64]
    degree: NDArray[np.int64]

    @property
    def n_slots(self) -> int:
        """How many values a run of the tape needs."""
        return self.n_variables + len(self.constants) + len(self.code)


class Recorder:
    """Writes operations once, and remembers in which slot each expression lives.

    Until the end constants have slots below zero, and operations those from 10**9.
    """

    def __init__(self, slots: Mapping[sympy.Symbol, int]) -> None:
        self.slots: dict[sympy.Basic, int] = dict(slots)
        self.constants: dict[float, int] = {}
        self.code: list[tuple[int, int, int, int]] = []
        self._known: dict[tuple[int, int, int, int], int] = {}

    def constant(self, value: float) -> int:
        """Return the slot of a constant."""
        return -1 - self.constants.setdefault(value, len(self.constants))

    def emit(self, op: Op, a: int, b: int = 0, c: int = 0) -> int:
        """Write an operation; operation k is called ``10**9 + k`` until the end."""
        key = (int(op), a, b, c)
        if key not in self._known:
            self._known[key] = 10**9 + len(self.code)
            self.code.append(key)
        return self._known[key]

    def tape(self, n_variables: int, results: Sequence[int]) -> Tape:
        """Return the tape of `results`, with all that was written and no degrees."""
        shift = n_variables + len(self.constants) - 10**9

        def final(slot: int) -> int:
            if slot < 0:
                return n_variables - 1 - slot
            return slot if slot < 10**9 else slot + shift

        code = [
            (op, final(a), b if op == _POWI else final(b), final(c))
            for op, a, b, c in self.code
        ]
        return Tape(
            n_variables=n_variables,
            constants=np.array(list(self.constants), dtype=np.float64),
            code=np.array(code, dtype=np.int64).reshape(-1, 4),
            outputs=np.array([final(slot) for slot in results], dtype=np.int64),
            degree=np.zeros(0, dtype=np.int64),
        )

    def slot(self, expression: sympy.Basic) -> int:
        """Return the slot of an expression, written where it is not yet."""
        if expression not in self.slots:
            self.slots[expression] = self._write(expression)
        return self.slots[expression]

    def _write(self, expression: sympy.Basic) -> int:
        if expression.is_Symbol:
            raise EquationError(
                f"The symbol {expression} is not a variable of this tape.",
                (str(expression),),
                "It is neither a state, an input nor a parameter.",
            )
        if expression.is_number or isinstance(expression, sympy.Number):
            return self.constant(_real(expression))
        if isinstance(expression, sympy.Pow):
            return self._power(*expression.as_base_exp())
        if isinstance(expression, sympy.Mul):
            return self._product(expression)
        if isinstance(expression, sympy.Add):
            return self._sum(expression)
        if expression.func in _FOLDED:
            return self._fold(_FOLDED[expression.func], expression.args)
        if expression.func in _UNARY:
            return self.emit(_UNARY[expression.func], self.slot(expression.args[0]))
        return self._special(expression)

    def _fold(self, op: Op, arguments: Sequence[sympy.Basic]) -> int:
        first, *rest = [self.slot(a) for a in arguments]
        for other in rest:
            first = self.emit(op, first, other)
        return first

    def _sum(self, expression: sympy.Add) -> int:
        """Write a sum, with negative terms subtracted rather than negated."""
        plus: list[sympy.Expr] = []
        minus: list[sympy.Expr] = []
        for term in expression.args:
            negative = term.could_extract_minus_sign()
            (minus if negative else plus).append(-term if negative else term)
        total = self._fold(Op.ADD, plus) if plus else self.constant(0.0)
        for term in minus:
            total = self.emit(Op.SUB, total, self.slot(term))
        return total

    def _product(self, expression: sympy.Mul) -> int:
        above: list[sympy.Expr] = []
        below: list[sympy.Expr] = []
        for factor in expression.args:
            base, exponent = factor.as_base_exp()
            if exponent.is_number and exponent.is_negative and not base.is_number:
                below.append(base**-exponent)
            else:
                above.append(factor)
        product = self._fold(Op.MUL, above) if above else self.constant(1.0)
        if below:
            product = self.emit(Op.DIV, product, self._fold(Op.MUL, below))
        return product

    def _power(self, base: sympy.Expr, exponent: sympy.Expr) -> int:
        if base == sympy.E:
            return self.emit(Op.EXP, self.slot(exponent))
        if exponent.is_Integer:
            power = int(exponent)
            if power < 0:
                return self.emit(Op.DIV, self.constant(1.0), self.slot(base**-power))
            return self.emit(Op.POWI, self.slot(base), power)
        if exponent == sympy.Rational(1, 2):
            return self.emit(Op.SQRT, self.slot(base))
        return self.emit(Op.POW, self.slot(base), self.slot(exponent))

    def _special(self, expression: sympy.Basic) -> int:
        match expression:
            case sympy.Piecewise():
                return self._piecewise(expression)
            case sympy.StrictLessThan():
                return self._compare(Op.LESS, expression.lhs, expression.rhs)
            case sympy.LessThan():
                return self._compare(Op.LESS_EQUAL, expression.lhs, expression.rhs)
            case sympy.StrictGreaterThan():
                return self._compare(Op.LESS, expression.rhs, expression.lhs)
            case sympy.GreaterThan():
                return self._compare(Op.LESS_EQUAL, expression.rhs, expression.lhs)
            case boolalg.Not():
                return self.emit(Op.NOT, self.slot(expression.args[0]))
            case boolalg.BooleanTrue() | boolalg.BooleanFalse():
                return self.constant(float(bool(expression)))
            case sympy.Heaviside():
                zero = self.constant(0.0)
                return self.emit(Op.LESS, zero, self.slot(expression.args[0]))
            case sympy.atan2():
                y, x = expression.args
                return self.emit(Op.ATAN2, self.slot(y), self.slot(x))
        raise EquationError(
            f"The function {expression.func.__name__} has no number form yet.",
            (str(expression.func),),
            "Write the law with + - * / powers, exp, log, trigonometric and hyperbolic "
            "functions, Abs, sign, Min, Max or Piecewise.",
        )

    def _compare(self, op: Op, left: sympy.Expr, right: sympy.Expr) -> int:
        return self.emit(op, self.slot(left), self.slot(right))

    def _piecewise(self, expression: sympy.Piecewise) -> int:
        *cases, (last, condition) = expression.args
        if condition != sympy.true:
            raise EquationError(
                f"{expression} is undefined where no case holds.",
                (str(expression),),
                "Close the Piecewise with a case (expression, True).",
            )
        value = self.slot(last)
        for branch, condition in reversed(cases):
            value = self.emit(Op.SELECT, self.slot(condition), self.slot(branch), value)
        return value


def _real(number: sympy.Basic) -> float:
    """Return a number without symbols as a float, or refuse it."""
    try:
        return float(number)
    except TypeError as error:
        raise EquationError(
            f"A law contains {number}, which is not a real number.",
            (str(number),),
            "Look for a division by zero, or a root or logarithm of a negative number.",
        ) from error


def record_tape(
    variables: Sequence[sympy.Symbol],
    definitions: Sequence[tuple[sympy.Symbol, sympy.Expr]],
    expressions: Sequence[sympy.Expr],
    active: Callable[[sympy.Symbol], bool],
) -> Tape:
    """Return the tape that computes `expressions`.

    Parameters
    ----------
    variables
        Symbols in slot order.
    definitions
        ``(symbol, expression)`` pairs in evaluation order; those that `expressions` do
        not need are left out.
    expressions
        What the tape computes.
    active
        Whether a variable counts for `Tape.degree`.

    Raises
    ------
    EquationError
        If an expression contains an unknown symbol or function.
    """
    recorder = Recorder({symbol: i for i, symbol in enumerate(variables)})
    for symbol, expression in _needed(definitions, expressions):
        recorder.slots[symbol] = recorder.slot(expression)
    raw = [recorder.slot(expression) for expression in expressions]
    tape = recorder.tape(len(variables), raw)
    return replace(tape, degree=degrees(tape, [active(v) for v in variables]))


def _needed(
    definitions: Sequence[tuple[sympy.Symbol, sympy.Expr]],
    expressions: Sequence[sympy.Expr],
) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """Return the definitions that `expressions` depend on, in order."""
    wanted = (
        set().union(*(e.free_symbols for e in expressions)) if expressions else set()
    )
    kept = []
    for symbol, expression in reversed(definitions):
        if symbol in wanted:
            kept.append((symbol, expression))
            wanted |= expression.free_symbols
    return kept[::-1]


def part(tape: Tape, first: int, last: int, active: Sequence[bool]) -> Tape:
    """Return the tape of the results ``first … last - 1`` alone.

    Operations and constants that they do not need are left out; `active` says for each
    variable whether it counts for the new tape's degree.
    """
    n, old = tape.n_variables, tape.code.tolist()
    start = n + len(tape.constants)
    outputs = tape.outputs[first:last].tolist()
    used = bytearray(tape.n_slots)
    for slot in outputs:
        used[slot] = 1
    for i in range(len(old) - 1, -1, -1):
        if used[start + i]:
            for slot in arguments(old[i]):
                used[slot] = 1
    kept = [k for k in range(len(tape.constants)) if used[n + k]]
    where = list(range(n)) + [0] * (tape.n_slots - n)
    for k, constant in enumerate(kept):
        where[n + constant] = n + k
    code: list[tuple[int, int, int, int]] = []
    for i, (op, a, b, c) in enumerate(old):
        if used[start + i]:
            where[start + i] = n + len(kept) + len(code)
            exponent = op == _POWI
            code.append((op, where[a], b if exponent else where[b], where[c]))
    shorter = Tape(
        n_variables=n,
        constants=tape.constants[kept],
        code=np.array(code, dtype=np.int64).reshape(-1, 4),
        outputs=np.array([where[slot] for slot in outputs], dtype=np.int64),
        degree=np.zeros(0, dtype=np.int64),
    )
    return replace(shorter, degree=degrees(shorter, active))


def arguments(operation: Sequence[int]) -> Sequence[int]:
    """Return the slots that an operation reads."""
    op, a, b, c = operation
    if op == _SELECT:
        return a, b, c
    return (a, b) if op in _BINARY else (a,)


def degrees(tape: Tape, active: Sequence[bool]) -> NDArray[np.int64]:
    """Return 0, 1 or 2 per result: constant, affine or nonlinear in what is active."""
    degree = [int(x) for x in active] + [0] * len(tape.constants)
    for op, a, b, c in tape.code.tolist():
        da = degree[a]
        if op in _ADDITIVE:
            result = max(da, degree[b])
        elif op == _MUL:
            result = min(da + degree[b], 2)
        elif op == _DIV:
            result = 2 if degree[b] else da
        elif op == _POWI:
            result = 2 if da and b > 1 else da * min(b, 1)
        elif op == _SELECT:
            result = 2 if da else max(degree[b], degree[c])
        else:
            result = 2 if da or (op in _BINARY and degree[b]) else 0
        degree.append(result)
    return np.array([degree[slot] for slot in tape.outputs], dtype=np.int64)


# Plain integers: looking a member up in an IntEnum costs more than the operation.
_MUL, _DIV, _POWI = Op.MUL.value, Op.DIV.value, Op.POWI.value
_SELECT = Op.SELECT.value
_ADDITIVE = frozenset({Op.ADD.value, Op.SUB.value})
_BINARY = _ADDITIVE | {
    op.value
    for op in (
        *(Op.MUL, Op.DIV, Op.POW, Op.MAX, Op.MIN, Op.ATAN2),
        *(Op.LESS, Op.LESS_EQUAL, Op.AND, Op.OR),
    )
}
