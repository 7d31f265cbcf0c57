"""Expressions in the words of a programming language.

One printer per language, with the functions that our own simulation knows and the same
values at the edges: ``sign(0) = 0``, ``Heaviside(0) = 0``. Numbers are written so that
they read back exactly.
"""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import sympy
from sympy.logic import boolalg
from sympy.printing.precedence import PRECEDENCE, precedence
from sympy.printing.str import StrPrinter

from bondgraph.errors import EquationError

HALF = sympy.Rational(1, 2)
_SAME_EVERYWHERE = {
    name: name
    for name in "sin cos tan asin acos atan sinh cosh tanh exp log sqrt atan2".split()
}


class SourcePrinter(StrPrinter):  # type: ignore[misc]
    """Prints an expression in one language; a language sets what is its own.

    Parameters
    ----------
    names
        The identifier or access text of each symbol.
    """

    functions: ClassVar[Mapping[str, str]] = _SAME_EVERYWHERE
    logic: ClassVar[tuple[str, str, str]] = ("&&", "||", "!")
    power: ClassVar[str] = "^"

    def __init__(self, names: Mapping[sympy.Symbol, str]) -> None:
        super().__init__()
        self._names = names

    def select(self, condition: str, one: str, other: str) -> str:
        """Return the text that chooses between two values."""
        raise NotImplementedError

    def _call(self, name: str, *arguments: str) -> str:
        return f"{self.functions.get(name, name)}({', '.join(arguments)})"

    def _folded(self, name: str, texts: Sequence[str]) -> str:
        """Return calls of a function of two arguments that take in all of `texts`."""
        first, *rest = texts
        for other in rest:
            first = self._call(name, first, other)
        return first

    def _print_Symbol(self, symbol: sympy.Symbol) -> str:
        return self._names[symbol]

    _print_Dummy = _print_Symbol  # noqa: N815

    def _print_Float(self, number: sympy.Float) -> str:
        return repr(float(number))

    def _print_Integer(self, number: sympy.Integer) -> str:
        return repr(float(number)) if abs(number.p) >= 10**15 else f"{number.p}.0"

    # The name after _print_ is sympy's: it is the type that is printed.
    _print_One = _print_Integer  # noqa: N815
    _print_Zero = _print_Integer  # noqa: N815
    _print_NegativeOne = _print_Integer  # noqa: N815

    def _print_Rational(self, number: sympy.Rational) -> str:
        return f"{number.p}.0/{number.q}.0"

    _print_Half = _print_Rational  # noqa: N815

    def _print_NumberSymbol(self, number: sympy.Basic) -> str:
        return repr(float(number))

    _print_Pi = _print_NumberSymbol  # noqa: N815
    _print_Exp1 = _print_NumberSymbol  # noqa: N815

    def _print_Mul(self, product: sympy.Mul) -> str:
        """Print the factors above and below one fraction bar."""
        above: list[sympy.Expr] = []
        below: list[sympy.Expr] = []
        for factor in product.args:
            if factor.is_Pow and factor.exp.is_number and factor.exp.is_negative:
                below.append(factor.base**-factor.exp)
            elif factor.is_Rational and not factor.is_Integer:
                above += [sympy.Integer(factor.p)]
                below += [sympy.Integer(factor.q)]
            else:
                above.append(factor)
        sign = ""
        if above and above[0] == -1:
            sign, above = "-", above[1:]
        level = PRECEDENCE["Mul"]
        upper = "*".join(self.parenthesize(x, level) for x in above) or "1.0"
        lower = "*".join(self.parenthesize(x, level) for x in below)
        if not lower:
            return sign + upper
        single = len(below) == 1 and not below[0].is_Mul
        return f"{sign}{upper}/{lower}" if single else f"{sign}{upper}/({lower})"

    def _print_Pow(self, power: sympy.Pow, rational: bool = False) -> str:
        base, exponent = power.base, power.exp
        if exponent.is_number and exponent.is_negative:
            inverse = sympy.Pow(base, -exponent)
            return f"1.0/{self.parenthesize(inverse, PRECEDENCE['Pow'])}"
        if base == sympy.E:
            return self._call("exp", self._print(exponent))
        if exponent == HALF:
            return self._call("sqrt", self._print(base))
        return self.raised(base, exponent)

    def raised(self, base: sympy.Expr, exponent: sympy.Expr) -> str:
        """Return the text of a power with any other exponent."""
        below = self.parenthesize(base, PRECEDENCE["Pow"] + 1)
        above = self.parenthesize(exponent, PRECEDENCE["Pow"] + 1)
        if exponent.is_Integer:
            above = str(exponent.p)
        return f"{below}{self.power}{above}"

    def _print_Function(self, call: sympy.Basic) -> str:
        name = type(call).__name__
        if name not in _SAME_EVERYWHERE:
            raise EquationError(
                f"The function {name} has no number form.",
                (name,),
                "Write the law with + - * / powers, exp, log, trigonometric and "
                "hyperbolic functions, Abs, sign, Min, Max or Piecewise.",
            )
        return self._call(name, *(self._print(a) for a in call.args))

    def emptyPrinter(self, expr: object) -> str:
        """Refuse what is no expression of real numbers."""
        raise EquationError(
            f"{expr} is not a real number.",
            (str(expr),),
            "Look for a division by zero, or a root or logarithm of a negative number.",
        )

    def _print_ImaginaryUnit(self, unit: object) -> str:
        return self.emptyPrinter(unit)

    _print_ComplexInfinity = _print_ImaginaryUnit  # noqa: N815
    _print_NaN = _print_ImaginaryUnit  # noqa: N815
    _print_Infinity = _print_ImaginaryUnit  # noqa: N815
    _print_NegativeInfinity = _print_ImaginaryUnit  # noqa: N815

    def _print_exp(self, call: sympy.Basic) -> str:
        return self._call("exp", self._print(call.args[0]))

    def _print_Abs(self, call: sympy.Basic) -> str:
        return self._call("abs", self._print(call.args[0]))

    def _print_sign(self, call: sympy.Basic) -> str:
        return self._call("sign", self._print(call.args[0]))

    def _print_Max(self, call: sympy.Basic) -> str:
        texts = [self._print(a) for a in _sorted(call)]
        return self._folded("max", texts)

    def _print_Min(self, call: sympy.Basic) -> str:
        texts = [self._print(a) for a in _sorted(call)]
        return self._folded("min", texts)

    def _print_Heaviside(self, call: sympy.Basic) -> str:
        return self.select(f"{self._print(call.args[0])} > 0.0", "1.0", "0.0")

    def _print_Piecewise(self, pieces: sympy.Piecewise) -> str:
        *cases, (last, condition) = pieces.args
        if condition != sympy.true:
            raise EquationError(
                f"{pieces} is undefined where no case holds.",
                (str(pieces),),
                "Close the Piecewise with a case (expression, True).",
            )
        text: str = self._print(last)
        for value, condition in reversed(cases):
            text = self.select(self._print(condition), self._print(value), text)
        return text

    def _print_Relational(self, relation: sympy.Basic) -> str:
        if relation.rel_op in ("==", "!="):
            raise EquationError(
                f"{relation} compares real numbers for equality.",
                (str(relation),),
                "Compare with < or > instead.",
            )
        left, right = (
            self.parenthesize(side, precedence(relation))
            for side in (relation.lhs, relation.rhs)
        )
        return f"{left} {relation.rel_op} {right}"

    def _print_And(self, expression: boolalg.And) -> str:
        return f" {self.logic[0]} ".join(
            f"({self._print(a)})" for a in _sorted(expression)
        )

    def _print_Or(self, expression: boolalg.Or) -> str:
        return f" {self.logic[1]} ".join(
            f"({self._print(a)})" for a in _sorted(expression)
        )

    def _print_Not(self, expression: boolalg.Not) -> str:
        return f"{self.logic[2]}({self._print(expression.args[0])})"


def _sorted(expression: sympy.Basic) -> list[sympy.Basic]:
    return sorted(expression.args, key=sympy.default_sort_key)


class CPrinter(SourcePrinter):
    """C99 with ``math.h``."""

    functions: ClassVar[Mapping[str, str]] = {
        **_SAME_EVERYWHERE,
        "abs": "fabs", "max": "fmax", "min": "fmin", "sign": "sign_of",
    }  # fmt: skip

    def select(self, condition: str, one: str, other: str) -> str:
        """Return the text that chooses between two values."""
        return f"(({condition}) ? {one} : {other})"

    def raised(self, base: sympy.Expr, exponent: sympy.Expr) -> str:
        """Return a small power of a variable as a product, any other by ``pow``."""
        if base.is_Symbol and exponent in (2, 3):
            return "(" + "*".join([self._print(base)] * int(exponent)) + ")"
        return f"pow({self._print(base)}, {self._print(exponent)})"


class MatlabPrinter(SourcePrinter):
    """MATLAB and Octave, for scalars."""

    logic: ClassVar[tuple[str, str, str]] = ("&&", "||", "~")

    def select(self, condition: str, one: str, other: str) -> str:
        """Return a call of the function ``choose``, which the file defines."""
        return f"choose({condition}, {one}, {other})"


class ModelicaPrinter(SourcePrinter):
    """Modelica 3."""

    logic: ClassVar[tuple[str, str, str]] = ("and", "or", "not ")

    def select(self, condition: str, one: str, other: str) -> str:
        """Return a conditional expression."""
        return f"(if {condition} then {one} else {other})"


class PythonPrinter(SourcePrinter):
    """Python with ``import math``, for scalars; numpy only solves."""

    functions: ClassVar[Mapping[str, str]] = {
        **{name: f"math.{name}" for name in _SAME_EVERYWHERE},
        "sign": "sign_of",
    }
    logic: ClassVar[tuple[str, str, str]] = ("and", "or", "not ")
    power: ClassVar[str] = "**"

    def select(self, condition: str, one: str, other: str) -> str:
        """Return a conditional expression."""
        return f"({one} if {condition} else {other})"
