"""A tape written as LLVM assembly: straight-line code with exact sparse slopes.

Each operation becomes one or a few instructions; what is known to be zero is not
written. The same text serves one double or a vector of them, one per lane. The meaning
of every operation is that of `bondgraph.numeric.kernel.machine`, to rounding.
"""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bondgraph.numeric.tape import Op, Tape

LIBRARY = {
    Op.TAN: "tan",
    Op.SINH: "sinh",
    Op.COSH: "cosh",
    Op.ASIN: "asin",
    Op.ACOS: "acos",
    Op.ATAN: "atan",
    Op.TANH: "tanh",
    Op.SIN: "sin",
    Op.COS: "cos",
    Op.EXP: "exp",
    Op.LOG: "log",
    Op.POW: "pow",
    Op.ATAN2: "atan2",
    Op.SQRT: "llvm.sqrt",
    Op.ABS: "llvm.fabs",
}
# A divisor that many share, such as a parameter, is inverted once (one rounding more):
# a division takes as long as three products, and each step waits for several in a row.
DIVIDE = "fdiv arcp"
_INFIX = {Op.ADD: "fadd", Op.SUB: "fsub", Op.MUL: "fmul", Op.DIV: DIVIDE}
_COMPARISONS = {Op.LESS: "olt", Op.LESS_EQUAL: "ole"}

Row = Mapping[int, str]
"""Slopes of one slot: column to register; what is missing is zero."""


@dataclass(frozen=True, slots=True)
class Function:
    """The text of a function and the declarations of those it calls."""

    lines: list[str]
    called: set[str]


class Assembly:
    """Writes the instructions of one function, and remembers its registers.

    Two that write the same function have registers of different names.
    """

    def __init__(self, lanes: int = 1, registers: str = "%r") -> None:
        self.lanes = lanes
        self.registers = registers
        self.lines: list[str] = []
        self.called: set[str] = set()
        self.real = "double" if lanes == 1 else f"<{lanes} x double>"
        self.truth = "i1" if lanes == 1 else f"<{lanes} x i1>"
        self.zero, self.one = self.constant(0.0), self.constant(1.0)
        self._known: dict[str, str] = {}

    def constant(self, value: float) -> str:
        """Return the operand that stands for `value`."""
        bits = struct.unpack("<Q", struct.pack("<d", value))[0]
        return self._repeated(f"0x{bits:016X}")

    def _repeated(self, word: str) -> str:
        if self.lanes == 1:
            return word
        return "<" + ", ".join([f"double {word}"] * self.lanes) + ">"

    def spread(self, value: str) -> str:
        """Return an operand for one double as one that all lanes have."""
        if not value.startswith("%"):
            return self._repeated(value)
        first = self.write(f"insertelement {self.real} poison, double {value}, i64 0")
        every = f"<{self.lanes} x i32> zeroinitializer"
        return self.write(
            f"shufflevector {self.real} {first}, {self.real} poison, {every}"
        )

    def write(self, instruction: str) -> str:
        """Write an instruction once; return the register with its result."""
        if instruction not in self._known:
            register = f"{self.registers}{len(self._known)}"
            self.lines.append(f"  {register} = {instruction}")
            self._known[instruction] = register
        return self._known[instruction]

    def add(self, a: str, b: str) -> str:
        """Return a + b."""
        return self.write(f"fadd {self.real} {a}, {b}")

    def subtract(self, a: str, b: str) -> str:
        """Return a - b."""
        return self.write(f"fsub {self.real} {a}, {b}")

    def multiply(self, a: str, b: str) -> str:
        """Return a * b."""
        if a == self.one:
            return b
        return a if b == self.one else self.write(f"fmul {self.real} {a}, {b}")

    def divide(self, a: str, b: str) -> str:
        """Return a / b."""
        return a if b == self.one else self.write(f"{DIVIDE} {self.real} {a}, {b}")

    def negate(self, a: str) -> str:
        """Return -a."""
        return self.write(f"fneg {self.real} {a}")

    def compare(self, how: str, a: str, b: str) -> str:
        """Return the truth of a comparison, by its name in LLVM."""
        return self.write(f"fcmp {how} {self.real} {a}, {b}")

    def choose(self, condition: str, a: str, b: str) -> str:
        """Return `a` where the condition holds, else `b`."""
        chosen = f"{self.truth} {condition}, {self.real} {a}, {self.real} {b}"
        return a if a == b else self.write(f"select {chosen}")

    def call(self, name: str, *arguments: str) -> str:
        """Call a function of doubles; on vectors, the one for vectors."""
        suffix = "f64" if self.lanes == 1 else f"v{self.lanes}f64"
        if name.startswith("llvm."):
            name = f"{name}.{suffix}"
        elif self.lanes > 1:
            name = f"lanes.{name}"
        types = ", ".join([self.real] * len(arguments))
        self.called.add(f"declare {self.real} @{name}({types})")
        given = ", ".join(f"{self.real} {a}" for a in arguments)
        return self.write(f"call {self.real} @{name}({given})")

    def power(self, a: str, exponent: int) -> str:
        """Return an integer power by repeated squaring."""
        result, square = self.one, a
        while exponent:
            if exponent & 1:
                result = self.multiply(result, square)
            exponent >>= 1
            if exponent:
                square = self.multiply(square, square)
        return result


class Writer:
    """Values and, where wanted, slopes of every slot of a tape."""

    def __init__(self, tape: Tape, code: Assembly, variables: list[str]) -> None:
        self.code = code
        self.values = [*variables, *(code.constant(c) for c in tape.constants.tolist())]
        self.rows: list[Row] = []
        self.tape = tape

    def write_values(self) -> None:
        """Write every operation of the tape."""
        for op, a, b, c in self.tape.code.tolist():
            self.values.append(self._value(Op(op), a, b, c))

    def write_rows(self, columns: Sequence[int]) -> None:
        """Write the slopes of every slot along the variables `columns`.

        A column that nothing asks for is called -1.
        """
        where = {v: k for k, v in enumerate(columns) if v >= 0}
        one = self.code.one
        n = self.tape.n_variables
        self.rows = [{where[i]: one} if i in where else {} for i in range(n)]
        self.rows += [{}] * len(self.tape.constants)
        first = len(self.rows)
        for i, (op, a, b, c) in enumerate(self.tape.code.tolist()):
            self.rows.append(self._row(Op(op), a, b, c, first + i))

    def _value(self, op: Op, a: int, b: int, c: int) -> str:
        code, x = self.code, self.values[a]
        if op is Op.POWI:
            return code.power(x, b)
        y = self.values[b]
        if op in _INFIX:
            return code.write(f"{_INFIX[op]} {code.real} {x}, {y}")
        if op in {Op.MAX, Op.MIN, Op.SELECT}:
            condition, left, right = self._branches(op, a, b, c)
            return code.choose(condition, self.values[left], self.values[right])
        if op in {Op.LESS, Op.LESS_EQUAL, Op.AND, Op.OR, Op.NOT}:
            return code.choose(self._truth(op, x, y), code.one, code.zero)
        if op in {Op.POW, Op.ATAN2}:
            return code.call(LIBRARY[op], x, y)
        return self._function(op, x)

    def _function(self, op: Op, x: str) -> str:
        code = self.code
        if op is Op.SIGN:
            return self._sign(x)
        value = code.call(LIBRARY[op], x)
        nan = code.constant(float("nan"))
        if op is Op.SQRT:
            return code.choose(code.compare("oge", x, code.zero), value, nan)
        if op is Op.LOG:
            return code.choose(code.compare("ogt", x, code.zero), value, nan)
        if op is Op.EXP:
            small = code.compare("olt", x, code.constant(700.0))
            return code.choose(small, value, code.constant(float("inf")))
        return value

    def _sign(self, x: str) -> str:
        code = self.code
        minus = code.choose(
            code.compare("olt", x, code.zero), code.constant(-1.0), code.zero
        )
        return code.choose(code.compare("ogt", x, code.zero), code.one, minus)

    def _truth(self, op: Op, x: str, y: str) -> str:
        code = self.code
        if op in _COMPARISONS:
            return code.compare(_COMPARISONS[op], x, y)
        if op is Op.NOT:
            return code.compare("oeq", x, code.zero)
        both = code.compare("une", x, code.zero), code.compare("une", y, code.zero)
        word = "and" if op is Op.AND else "or"
        return code.write(f"{word} {code.truth} {both[0]}, {both[1]}")

    def _branches(self, op: Op, a: int, b: int, c: int) -> tuple[str, int, int]:
        """Return a condition, the slot where it holds, and the slot where not."""
        code, x = self.code, self.values[a]
        if op is Op.SELECT:
            return code.compare("une", x, code.zero), b, c
        how = "oge" if op is Op.MAX else "ole"
        return code.compare(how, x, self.values[b]), a, b

    def _row(self, op: Op, a: int, b: int, c: int, slot: int) -> Row:
        code, left = self.code, self.rows[a]
        if op in {Op.MAX, Op.MIN, Op.SELECT}:
            condition, yes, no = self._branches(op, a, b, c)
            rows, zero = (self.rows[yes], self.rows[no]), code.zero
            return {
                k: code.choose(condition, rows[0].get(k, zero), rows[1].get(k, zero))
                for k in sorted({*rows[0], *rows[1]})
            }
        if op in {Op.SIGN, Op.LESS, Op.LESS_EQUAL, Op.AND, Op.OR, Op.NOT}:
            return {}
        right: Row = {} if op not in _TWO else self.rows[b]
        if not left and not right:
            return {}
        if op in {Op.ADD, Op.SUB}:
            return self._sum(op, left, right)
        if op is Op.DIV:
            return self._quotient(left, right, self.values[slot], self.values[b])
        by_a, by_b = self._partials(op, a, b, slot, bool(left), bool(right))
        scaled = {k: code.multiply(by_a, d) for k, d in left.items()}
        other = {k: code.multiply(by_b, d) for k, d in right.items()}
        return self._sum(Op.ADD, scaled, other)

    def _sum(self, op: Op, left: Row, right: Row) -> Row:
        code = self.code
        total = dict(left)
        for k, d in right.items():
            if k in total:
                total[k] = code.write(f"{_INFIX[op]} {code.real} {total[k]}, {d}")
            else:
                total[k] = d if op is Op.ADD else code.negate(d)
        return total

    def _quotient(self, left: Row, right: Row, value: str, below: str) -> Row:
        code = self.code
        along = {k: code.multiply(value, d) for k, d in right.items()}
        above = self._sum(Op.SUB, left, along)
        return {k: code.divide(d, below) for k, d in above.items()}

    def _partials(
        self, op: Op, a: int, b: int, slot: int, first: bool, second: bool
    ) -> tuple[str, str]:
        """Return the partial derivatives of an operation of one or two arguments."""
        code, x, value = self.code, self.values[a], self.values[slot]
        if op not in _TWO:
            return self._slope(op, x, value, b), code.zero
        y = self.values[b]
        if op is Op.MUL:
            return y, x
        if op is Op.ATAN2:
            norm = code.add(code.multiply(x, x), code.multiply(y, y))
            return code.divide(y, norm), code.divide(code.negate(x), norm)
        by_a = by_b = code.zero
        if first:
            lower = code.call("pow", x, code.subtract(y, code.one))
            steep = code.multiply(y, lower)
            by_a = code.choose(code.compare("une", y, code.zero), steep, code.zero)
        if second:
            steep = code.multiply(value, code.call("log", x))
            by_b = code.choose(code.compare("ogt", x, code.zero), steep, code.zero)
        return by_a, by_b

    def _slope(  # noqa: C901, PLR0912  (a case per function)
        self, op: Op, x: str, value: str, exponent: int
    ) -> str:
        """Return the slope of a function of one argument."""
        code = self.code
        square = code.multiply(x, x)
        match op:
            case Op.POWI if exponent == 0:
                return code.zero
            case Op.POWI:
                lower = code.power(x, exponent - 1)
                return code.multiply(code.constant(float(exponent)), lower)
            case Op.SQRT:
                tiny = code.constant(1e-150)
                larger = code.compare("ogt", tiny, value)
                below = code.choose(larger, tiny, value)
                return code.divide(code.constant(0.5), below)
            case Op.SIN:
                return code.call("cos", x)
            case Op.COS:
                return code.negate(code.call("sin", x))
            case Op.TAN:
                return code.add(code.one, code.multiply(value, value))
            case Op.EXP:
                return value
            case Op.LOG:
                positive = code.compare("ogt", x, code.zero)
                inverse = code.divide(code.one, x)
                return code.choose(positive, inverse, code.constant(float("nan")))
            case Op.TANH:
                return code.subtract(code.one, code.multiply(value, value))
            case Op.ABS:
                return self._sign(x)
            case Op.ATAN:
                return code.divide(code.one, code.add(code.one, square))
            case Op.SINH:
                return code.call("cosh", x)
            case Op.COSH:
                return code.call("sinh", x)
        root = code.call("llvm.sqrt", code.subtract(code.one, square))
        slope = code.divide(code.one, root)
        return slope if op is Op.ASIN else code.negate(slope)


_TWO = frozenset({Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.POW, Op.ATAN2})
