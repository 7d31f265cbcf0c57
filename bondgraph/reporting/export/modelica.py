"""A model as one Modelica 3 class that needs no library.

Its equations are the sorted assignments as they are; unknowns and dependent storages
are left to the Modelica compiler, which is there to solve them. Inputs and outputs are
connectors in the causal sense, so that the class can be a component of another.
"""

import re
from collections.abc import Iterable

import sympy

from bondgraph.reporting.export.printing import ModelicaPrinter
from bondgraph.reporting.export.program import (
    Named,
    Program,
    make_program,
    one_line,
    wrapped,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import t as time_symbol

RESERVED = tuple(
    (
        "algorithm and annotation assert block break class connect connector "
        "constant constrainedby der discrete each else elseif elsewhen "
        "encapsulated end enumeration equation expandable extends external "
        "false final flow for function if import impure in initial inner input "
        "loop model not operator or outer output package parameter partial "
        "protected public pure record redeclare replaceable return stream then "
        "true type when while within "
        # built-in types, functions and variables
        "Real Integer Boolean String StateSelect AssertionLevel Clock "
        "Connections time sin cos tan asin acos atan atan2 sinh cosh tanh exp "
        "log log10 sqrt abs sign max min div mod rem ceil floor integer delay "
        "cardinality homotopy semiLinear spatialDistribution getInstanceName "
        "pre edge change reinit sample terminal terminate noEvent smooth "
        "inStream actualStream ndims size scalar vector matrix transpose "
        "outerProduct identity diagonal zeros ones fill linspace sum product "
        "symmetric cross skew cat promote e t "
    ).split()
)


def to_modelica(graph: FinishedGraph, *, name: str | None = None) -> str:
    """Return the text of a Modelica model.

    Parameters
    ----------
    name
        Name of the class; the model's name otherwise.

    Raises
    ------
    EquationError
        If a law has no number form.
    """
    program = make_program(graph, name=name, reserved=RESERVED)
    lines = [
        f"model {program.name} {_quoted(one_line(program.title))}",
        "  // Written by bondgraph from the bond graph of that name; SI units.",
        *_declarations(program),
        "equation",
        *_equations(program),
        f"end {program.name};",
    ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    escaped = one_line(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _declaration(prefix: str, v: Named, *, start: bool = False) -> str:
    """Return the declaration of one variable with unit, value and what it is."""
    unit = modelica_unit(v.unit)
    changes = [f'unit="{unit}"'] if unit else []
    changes += ["start=0.0", "fixed=true"] if start else []
    value = "" if v.value is None else f" = {float(v.value)!r}"
    modified = f"({', '.join(changes)})" if changes else ""
    comments = [] if v.label == v.identifier else [v.label]
    comments += [] if unit else [f"[{v.unit}]"]
    comment = f" {_quoted(' '.join(comments))}" if comments else ""
    return f"  {prefix}Real {v.identifier}{modified}{value}{comment};"


def _declarations(program: Program) -> Iterable[str]:
    planned = program.calculation
    n = len(planned.equations.inputs)
    yield from (_declaration("parameter ", v) for v in program.parameters)
    yield from (_declaration("input ", v) for v in program.inputs[:n])
    yield from (_declaration("output ", v) for v in program.outputs)
    yield from (_declaration("", v, start=True) for v in program.states)
    hidden = [
        *(_declaration("", v) for v in program.inputs[n:]),
        *(
            f"  Real {program.names[z]} {_quoted(reason)};"
            for z, reason in zip(
                planned.equations.unknowns, planned.equations.reasons, strict=True
            )
        ),
        *(
            f"  Real {program.names[a.symbol]}{_reason(a.reason)};"
            for a in planned.equations.assignments
        ),
    ]
    if hidden:
        yield "protected"
        yield from hidden


def _reason(text: str) -> str:
    return f" {_quoted(text)}" if text else ""


def _equations(program: Program) -> Iterable[str]:
    equations = program.calculation.equations
    names = {**program.names, time_symbol: "time"}
    names |= {s.rate: f"der({names[s.symbol]})" for s in equations.states}
    printer = ModelicaPrinter(names)

    def line(left: str, right: sympy.Expr) -> str:
        return wrapped(f"  {left} = {printer.doprint(right)};")

    n = len(equations.inputs)
    rate_of = dict(zip(equations.input_rates, equations.inputs, strict=True))
    for rate in program.calculation.inputs[n:]:
        yield f"  {names[rate]} = der({names[rate_of[rate]]});"
    for assignment in equations.assignments:
        yield line(names[assignment.symbol], assignment.expression)
    for state, rate in zip(equations.states, equations.rates, strict=True):
        yield line(names[state.rate], rate)
    for residual in equations.residuals:
        yield line("0.0", residual)
    for output, v in zip(equations.outputs, program.outputs, strict=True):
        yield line(v.identifier, output.expression)


_FACTOR = re.compile(r"([A-Za-z%Ω°]+)(?:\^|\*\*)?(-?\d+)?")


def modelica_unit(unit: str) -> str:
    """Return a unit as Modelica writes it (``N.m.s/rad``), empty where it cannot.

    Products are points, exponents follow the unit, and one bar at most.
    """
    powers = _powers(unit.replace("·", "*").replace(" ", ""))
    if powers is None:
        return ""
    above = [_power(word, n) for word, n in powers.items() if n > 0]
    below = [_power(word, -n) for word, n in powers.items() if n < 0]
    upper = ".".join(above) or "1"
    if not below:
        return upper
    lower = ".".join(below)
    return f"{upper}/{lower}" if len(below) == 1 else f"{upper}/({lower})"


def _power(word: str, exponent: int) -> str:
    spelled = {"ohm": "Ohm", "Ω": "Ohm", "°C": "degC"}.get(word, word)
    return spelled if exponent == 1 else f"{spelled}{exponent}"


def _powers(text: str) -> dict[str, int] | None:
    """Return the exponent of each unit in a product of units, None if it is none."""
    powers: dict[str, int] = {}
    for sign, part in _split(text):
        inner = part[1:-1] if part.startswith("(") and part.endswith(")") else None
        if part in ("", "1"):
            continue
        if inner is not None:
            found = _powers(inner)
            if found is None:
                return None
        else:
            match = _FACTOR.fullmatch(part)
            if match is None:
                return None
            found = {match[1]: int(match[2] or 1)}
        for word, exponent in found.items():
            powers[word] = powers.get(word, 0) + sign * exponent
    return {word: n for word, n in powers.items() if n}


def _split(text: str) -> list[tuple[int, str]]:
    """Return the factors of a product with 1, those behind a bar with -1."""
    parts, depth, start, sign = [], 0, 0, 1
    for i, character in enumerate(text.replace("**", "^")):
        depth += (character == "(") - (character == ")")
        if character in "*/" and depth == 0:
            parts.append((sign, text.replace("**", "^")[start:i]))
            start, sign = i + 1, -1 if character == "/" else 1
    return [*parts, (sign, text.replace("**", "^")[start:])]
