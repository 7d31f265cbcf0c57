"""Sympy expressions as Python text that makes the same expression again.

Sympy's own string of an expression is made for reading: run as Python, its ``3/2`` is
a float and its ``sign`` an unknown name. Here functions carry the prefix ``sympy.``,
fractions stay exact, and every text is run once before it is handed out.
"""

import keyword
import math
import textwrap
from collections.abc import Iterable, Mapping

import sympy
from sympy.printing.precedence import PRECEDENCE, precedence
from sympy.printing.str import StrPrinter

from bondgraph.errors import EquationError
from bondgraph.structure import signals
from bondgraph.structure.signals import (
    PORT_VARIABLES,
    PortVariable,
    Signal,
    parameters_in,
    signals_in,
)

WIDTH = 88
INDENT = "    "
SHOWN = 80
"""Characters of a law in a sentence."""

SIGNAL_MAKERS = ("effort", "flow", "momentum", "displacement")


def quoted(text: str) -> str:
    """Return `text` as a Python string literal, in double quotes where possible."""
    literal = repr(text)
    if literal.startswith("'") and '"' not in literal and "\\" not in literal:
        return f'"{literal[1:-1]}"'
    return literal


def number(value: float | None) -> str:
    """Return a number as Python text that reads back exactly."""
    if value is None:
        return "None"
    if math.isinf(value):
        return "math.inf" if value > 0 else "-math.inf"
    return repr(float(value))


def call(function: str, arguments: Iterable[str], *, depth: int = 1) -> str:
    """Return a call, one argument per line where it is too long for one line.

    It is meant to stand `depth` levels of indentation deep.
    """
    listed = list(arguments)
    line = f"{function}({', '.join(listed)})"
    if depth * len(INDENT) + len(line) <= WIDTH:
        return line
    lines = "".join(f"{INDENT}{argument},\n" for argument in listed)
    return f"{function}(\n{lines})"


def variable_names(parameters: Iterable[str], taken: Iterable[str]) -> dict[str, str]:
    """Return a Python variable for each parameter, clashing with nothing in `taken`."""
    used = set(taken)
    names: dict[str, str] = {}
    for parameter in parameters:
        name = "".join(c if c.isalnum() or c == "_" else "_" for c in parameter)
        if not name.isidentifier() or keyword.iskeyword(name):
            name = f"{name}_" if name.isidentifier() else f"_{name}"
        while name in used:
            name += "_"
        used.add(name)
        names[parameter] = name
    return names


class _PythonPrinter(StrPrinter):  # type: ignore[misc]
    """Prints an expression as Python text."""

    def __init__(self, variables: Mapping[str, str]) -> None:
        super().__init__()
        self._variables = variables

    def _print_PortVariable(self, symbol: PortVariable) -> str:
        return f'port("{symbol.letter}", {symbol.number})'

    def _print_Symbol(self, symbol: sympy.Symbol) -> str:
        return self._variables.get(symbol.name, str(symbol.name))

    def _print_Float(self, number: sympy.Float) -> str:
        if number._prec == sympy.Float(1.0)._prec:
            return repr(float(number))
        return f"sympy.{sympy.srepr(number)}"

    def _print_Rational(self, number: sympy.Rational) -> str:
        return f"sympy.Rational({number.p}, {number.q})"

    def _print_Integer(self, number: sympy.Integer) -> str:
        return str(number.p)

    def _print_Half(self, number: sympy.Rational) -> str:
        return self._print_Rational(number)

    def _print_Mul(self, product: sympy.Mul) -> str:
        """Print factors in order; a quotient of integers would become a float.

        A number times a sum would be multiplied out, so it is printed last then.
        """
        factors: list[sympy.Expr] = list(product.args)
        first, *rest = factors
        if first.is_Number and rest[0].is_Add:
            first, *rest = *rest, first
        sign = "-" if first == -1 else ""
        shown = rest if sign else [first, *rest]
        below = [a.base for a in shown if a.is_Pow and a.exp == -1]
        above = [a for a in shown if not (a.is_Pow and a.exp == -1)]
        level = precedence(product)
        upper = "*".join(self.parenthesize(a, level) for a in above) or "1"
        lower = "".join(f"/{self.parenthesize(a, PRECEDENCE['Pow'])}" for a in below)
        return sign + upper + lower

    def _print_Pow(self, power: sympy.Pow, rational: bool = False) -> str:
        base = self.parenthesize(power.base, PRECEDENCE["Pow"] + 1)
        return f"{base}**{self.parenthesize(power.exp, PRECEDENCE['Pow'])}"

    def _print_Function(self, call: sympy.Basic) -> str:
        arguments = ", ".join(self._print(a) for a in call.args)
        return f"sympy.{type(call).__name__}({arguments})"

    # The name after _print_ is sympy's: it is the type that is printed.
    _print_LatticeOp = _print_Function  # noqa: N815
    _print_Heaviside = _print_Function  # noqa: N815
    _print_Piecewise = _print_Function  # noqa: N815
    _print_Relational = _print_Function  # noqa: N815
    _print_And = _print_Function  # noqa: N815
    _print_Or = _print_Function  # noqa: N815
    _print_Not = _print_Function  # noqa: N815

    def _print_ExprCondPair(self, pair: sympy.Basic) -> str:
        value, condition = pair.args
        return f"({self._print(value)}, {self._print(condition)})"

    def _print_BooleanTrue(self, _value: sympy.Basic) -> str:
        return "True"

    def _print_BooleanFalse(self, _value: sympy.Basic) -> str:
        return "False"

    def _print_NumberSymbol(self, number: sympy.Basic) -> str:
        return f"sympy.{type(number).__name__}"

    def _print_Pi(self, _number: sympy.Basic) -> str:
        return "sympy.pi"

    def _print_Exp1(self, _number: sympy.Basic) -> str:
        return "sympy.E"

    def _print_Infinity(self, _number: sympy.Basic) -> str:
        return "sympy.oo"

    def _print_NegativeInfinity(self, _number: sympy.Basic) -> str:
        return "-sympy.oo"


def python_expression(expression: sympy.Expr, variables: Mapping[str, str]) -> str:
    """Return Python text that evaluates to `expression`.

    Parameters
    ----------
    expression
        An expression of parameters, port variables, signals and time.
    variables
        The Python variable that stands for each parameter.

    Raises
    ------
    EquationError
        If no such text can be written, as for a function sympy does not know.
    """
    text: str = _PythonPrinter(variables).doprint(expression)
    if _evaluated(text, expression, variables) != expression:
        shown = textwrap.shorten(str(expression), SHOWN, placeholder=" …")
        raise EquationError(
            f"The law {shown} cannot be written as Python text.",
            (str(expression),),
            "Write it with functions of sympy.",
        )
    return text


def _evaluated(
    text: str, expression: sympy.Expr, variables: Mapping[str, str]
) -> object:
    """Return what `text` evaluates to, or None where it uses unknown names."""
    names: dict[str, object] = {"sympy": sympy}
    names |= {name: getattr(signals, name) for name in (*SIGNAL_MAKERS, "port")}
    names |= {s.name: s for s in (*PORT_VARIABLES, signals.t)}
    names |= {
        variables[name]: signals.parameter_symbol(name)
        for name in parameters_in(expression)
    }
    try:
        return eval(text, names)  # noqa: S307  (our own text, printed above)
    except (AttributeError, NameError):
        return None


def names_needed(expression: sympy.Expr) -> set[str]:
    """Return the names of bondgraph that the Python text of `expression` uses."""
    makers = {signal.quantity.value for signal in signals_in(expression)}
    ports = {
        symbol.name
        for symbol in expression.free_symbols & {*PORT_VARIABLES, signals.t}
        if not isinstance(symbol, Signal)
    }
    if any(isinstance(symbol, PortVariable) for symbol in expression.free_symbols):
        ports.add("port")
    return makers | ports
