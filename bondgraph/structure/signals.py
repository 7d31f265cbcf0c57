"""Symbols that a law or a measurement may use.

Port variables ``e f p q`` stand for the element's own effort, flow, momentum and
displacement, those of a field's ports are numbered (``ports("q", 2)`` gives q[1] and
q[2]); ``t`` is time. A `Signal` stands for a variable at another named place
of the graph (a junction, a one-port element, or a bond), which is how modulation and
measurements are written. Every other symbol in an expression is a parameter.
"""

from typing import Any, Self

import sympy

from bondgraph.errors import StructureError
from bondgraph.structure.domains import Quantity

e, f, p, q, t = sympy.symbols("e f p q t", real=True)
PORT_VARIABLES = frozenset({e, f, p, q})


class Signal(sympy.Symbol):  # type: ignore[misc]
    """The effort, flow, momentum or displacement at a named place.

    Signs follow the half arrow of the bond (for an element: positive power flows into
    an I, C or R and out of a source; for a junction: its common variable).
    """

    __slots__ = ("place", "quantity")
    place: str
    quantity: Quantity

    def __new__(cls, quantity: Quantity | str, place: str) -> Self:
        """Return the symbol; equal arguments give equal symbols."""
        quantity = Quantity(quantity)
        symbol: Self = sympy.Symbol.__xnew__(cls, f"{quantity}({place})", real=True)
        symbol.quantity = quantity
        symbol.place = place
        return symbol

    def __getnewargs_ex__(self) -> tuple[tuple[str, str], dict[str, Any]]:
        return (self.quantity.value, self.place), {}

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.quantity.value, self.place)

    def _hashable_content(self) -> tuple[Any, ...]:
        return (*super()._hashable_content(), self.quantity.value, self.place)

    def _sympystr(self, printer: object) -> str:
        return f'{self.quantity}("{self.place}")'


class PortVariable(sympy.Symbol):  # type: ignore[misc]
    """The effort, flow, momentum or displacement of one port of a field.

    ``letter`` is one of e, f, p, q; ``number`` counts the ports from 1.
    """

    __slots__ = ("letter", "number")
    letter: str
    number: int

    def __new__(cls, letter: str, number: int) -> Self:
        """Return the symbol; equal arguments give equal symbols."""
        if letter not in {"e", "f", "p", "q"}:
            raise StructureError(
                f"A port has no variable {letter!r}.", (letter,), "Use e, f, p or q."
            )
        symbol: Self = sympy.Symbol.__xnew__(cls, f"{letter}[{number}]", real=True)
        symbol.letter = letter
        symbol.number = number
        return symbol

    def __getnewargs_ex__(self) -> tuple[tuple[str, int], dict[str, Any]]:
        return (self.letter, self.number), {}

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.letter, self.number)

    def _hashable_content(self) -> tuple[Any, ...]:
        return (*super()._hashable_content(), self.letter, self.number)


def port(letter: str, number: int) -> PortVariable:
    """Return the variable ``letter[number]`` of a field's port."""
    return PortVariable(letter, number)


def ports(letter: str, count: int) -> tuple[PortVariable, ...]:
    """Return the variables ``letter[1] … letter[count]`` of a field's ports."""
    return tuple(PortVariable(letter, i + 1) for i in range(count))


def is_port_variable(symbol: sympy.Symbol) -> bool:
    """Return whether `symbol` stands for an element's own effort, flow, p or q."""
    return symbol in PORT_VARIABLES or isinstance(symbol, PortVariable)


def effort(place: str) -> Signal:
    """Return the symbol of the effort at `place`."""
    return Signal(Quantity.EFFORT, place)


def flow(place: str) -> Signal:
    """Return the symbol of the flow at `place`."""
    return Signal(Quantity.FLOW, place)


def momentum(place: str) -> Signal:
    """Return the symbol of the momentum (integral of effort) at `place`."""
    return Signal(Quantity.MOMENTUM, place)


def displacement(place: str) -> Signal:
    """Return the symbol of the displacement (integral of flow) at `place`."""
    return Signal(Quantity.DISPLACEMENT, place)


def parameter_symbol(name: str) -> sympy.Symbol:
    """Return the symbol that stands for the parameter called `name`."""
    return sympy.Symbol(name, real=True)


def as_expression(value: object) -> sympy.Expr:
    """Return a number or an expression as sympy's; text is never evaluated.

    Raises
    ------
    StructureError
        If it is neither.
    """
    try:
        # Not strict, sympy would run text as Python.
        expression: sympy.Expr = sympy.sympify(value, strict=True)
    except sympy.SympifyError as error:
        raise StructureError(
            f"{value!r} is not an expression.",
            (repr(value),),
            "Write it with symbols, as in c*f with c = sympy.Symbol('c').",
        ) from error
    return expression


def canonical(expression: object) -> sympy.Expr:
    """Return `expression` with every free symbol replaced by its canonical twin.

    A user may write ``sympy.symbols("c f")``; symbols are matched by name, so that the
    assumptions they were made with never matter.

    Raises
    ------
    StructureError
        If it is not an expression.
    """
    sympified = as_expression(expression)
    by_name = {symbol.name: symbol for symbol in (*PORT_VARIABLES, t)}
    twins = {
        symbol: by_name.get(symbol.name, parameter_symbol(symbol.name))
        for symbol in sympified.free_symbols
        if not isinstance(symbol, Signal | PortVariable)
    }
    strangers = {symbol: twin for symbol, twin in twins.items() if twin != symbol}
    return sympified.xreplace(strangers)


def signals_in(expression: sympy.Expr) -> tuple[Signal, ...]:
    """Return the signals that `expression` reads, sorted by name."""
    found = (s for s in expression.free_symbols if isinstance(s, Signal))
    return tuple(sorted(found, key=lambda s: s.name))


def parameters_in(expression: sympy.Expr) -> tuple[str, ...]:
    """Return the names of the parameters that `expression` reads, sorted."""
    return tuple(
        sorted(
            symbol.name
            for symbol in expression.free_symbols
            if not isinstance(symbol, Signal)
            and not is_port_variable(symbol)
            and symbol != t
        )
    )
