"""One model's program with a name for everything, ready to be written in a language.

Every symbol gets one identifier, valid in the language, and keeps its unit and what the
model calls it for the comments. Values of parameters become defaults; one without a
value is handed on as not a number, so that forgetting it shows.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy

from bondgraph.equations.deriving.derivation import derive
from bondgraph.reporting.export.calculation import Calculation, calculation
from bondgraph.reporting.export.identifiers import Identifiers, identifier
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import t as time_symbol

LINE = 88


@dataclass(frozen=True, slots=True)
class Named:
    """A variable of the program: its identifier, its name in the model, its unit."""

    identifier: str
    label: str
    unit: str
    value: float | None = None

    @property
    def comment(self) -> str:
        """What a reader wants to know of it."""
        label = "" if self.label == self.identifier else f"{self.label} "
        return f"{label}[{self.unit}]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """A calculation with names.

    Parameters
    ----------
    title, name
        What the model is called, and its identifier.
    names
        The identifier of every symbol that occurs.
    """

    title: str
    name: str
    calculation: Calculation
    states: tuple[Named, ...]
    inputs: tuple[Named, ...]
    outputs: tuple[Named, ...]
    parameters: tuple[Named, ...]
    names: Mapping[sympy.Symbol, str]

    def leaves(self) -> dict[sympy.Symbol, tuple[str, int]]:
        """Return which vector (x, u, p or z) holds a symbol, and where."""
        equations = self.calculation.equations
        vectors = {
            "x": [state.symbol for state in equations.states],
            "u": self.calculation.inputs,
            "p": equations.parameters,
            "z": equations.unknowns,
        }
        return {
            symbol: (vector, i)
            for vector, symbols in vectors.items()
            for i, symbol in enumerate(symbols)
        }


def make_program(
    graph: FinishedGraph, *, name: str | None, reserved: Iterable[str]
) -> Program:
    """Return the program of `graph` with names that are none of `reserved`.

    Raises
    ------
    CausalConflictError, EquationError
        If the graph has no equations.
    """
    equations = derive(graph)
    planned = calculation(equations)
    reserved = frozenset(reserved)
    called = Identifiers(reserved).new(identifier(name or graph.name))
    taken = Identifiers({*reserved, called})
    states = [state.symbol for state in equations.states]
    rates = [state.rate for state in equations.states]
    symbols = dict.fromkeys(
        (
            *equations.parameters, *states, *planned.inputs, *equations.unknowns,
            *rates, *planned.assigned,
        )
    )  # fmt: skip
    names = {symbol: taken.new(symbol.name) for symbol in symbols}
    names[time_symbol] = "t"
    members = graph.parameters.members
    return Program(
        title=graph.name,
        name=called,
        calculation=planned,
        states=tuple(
            Named(names[s.symbol], s.symbol.name, s.unit) for s in equations.states
        ),
        inputs=tuple(
            Named(names[u], u.name, unit)
            for u, unit in zip(planned.inputs, planned.input_units, strict=True)
        ),
        outputs=tuple(
            Named(taken.new(o.name), o.name, o.unit) for o in equations.outputs
        ),
        parameters=tuple(
            Named(names[symbol], m.name, m.unit, m.value)
            for symbol, m in zip(equations.parameters, members, strict=True)
        ),
        names=names,
    )


def wrapped(line: str, *, continuation: str = "") -> str:
    """Return a line broken at spaces where it is too long, the rest indented.

    `continuation` ends every line but the last. The line must hold no text in quotes.
    """
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    parts: list[str] = []
    while len(line) > LINE:
        at = line.rfind(" ", len(indent), LINE - len(continuation))
        if at < 0:
            break
        parts.append(line[:at] + continuation)
        line = indent + line[at + 1 :]
    return "\n".join((*parts, line))


def one_line(text: str) -> str:
    """Return `text` as one line of printable characters, for a comment."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
