"""Parameters and their sources as the Python text that declares them."""

import math
import textwrap
from collections.abc import Iterator

from bondgraph.reporting.python_expressions import INDENT, call, number, quoted
from bondgraph.structure.graph import FinishedGraph, used_parameters
from bondgraph.structure.linear_units import linear_units
from bondgraph.structure.parameters import (
    Assumed,
    Fitted,
    Measured,
    Parameter,
    Provenance,
    Published,
    Reconciled,
)


def parameter_lines(graph: FinishedGraph) -> Iterator[str]:
    """Yield the statements that declare the parameters of `graph`, in its order."""
    written = written_parameters(graph)
    if any(p.rounding is not None for p in written):
        # Only whole Parameter objects carry the rounding of a printed value.
        made = (call("Parameter", _keywords(p), depth=2) for p in written)
        inner = textwrap.indent(",\n".join(made), INDENT)
        yield f"graph.take(ParameterSet((\n{inner},\n)))"
        return
    for parameter in written:
        yield call("graph.parameter", _arguments(parameter))


def parameter_names_needed(graph: FinishedGraph) -> set[str]:
    """Return the names of bondgraph that `parameter_lines` uses."""
    written = written_parameters(graph)
    needed = {type(p.source).__name__ for p in written if p.source != Assumed()}
    if any(p.rounding is not None for p in written):
        needed |= {"Parameter", "ParameterSet"}
    return needed


def written_parameters(graph: FinishedGraph) -> tuple[Parameter, ...]:
    """Return the parameters to declare: ``finish()`` adds the plain last ones itself.

    A name of which nothing is known need not be declared, as long as it comes where
    ``finish()`` would put it: at the end, in the order of use.
    """
    members = graph.parameters.members
    used = used_parameters(graph.nodes, graph.measurements)
    units = linear_units(graph.nodes, graph.bonds, graph.domains)
    start = len(members)
    while start and members[start - 1] == Parameter(
        name=members[start - 1].name, unit=units.get(members[start - 1].name, "1")
    ):
        start -= 1
    tail = {member.name: None for member in members[start:]}
    return members[:start] if list(tail) == [n for n in used if n in tail] else members


def _arguments(parameter: Parameter) -> list[str]:
    """Return the arguments of ``parameter(name, value, unit, …)``."""
    arguments = [quoted(parameter.name)]
    if parameter.value is not None or parameter.unit != "1":
        arguments.append(number(parameter.value))
    if parameter.unit != "1":
        arguments.append(quoted(parameter.unit))
    return arguments + _knowledge(parameter)


def _keywords(parameter: Parameter) -> list[str]:
    """Return the arguments of ``Parameter(name=…, …)``."""
    arguments = [f"name={quoted(parameter.name)}"]
    if parameter.value is not None:
        arguments.append(f"value={number(parameter.value)}")
    if parameter.unit != "1":
        arguments.append(f"unit={quoted(parameter.unit)}")
    if parameter.rounding is not None:
        arguments.append(f"rounding={number(parameter.rounding)}")
    return arguments + _knowledge(parameter)


def _knowledge(parameter: Parameter) -> list[str]:
    """Return bounds, standard deviation and source, where they say something."""
    arguments = []
    low, high = parameter.bounds
    if (low, high) != (-math.inf, math.inf):
        arguments.append(f"bounds=({number(low)}, {number(high)})")
    if parameter.std is not None:
        arguments.append(f"std={number(parameter.std)}")
    if parameter.source != Assumed():
        arguments.append(f"source={_source(parameter.source)}")
    return arguments


def _source(source: Provenance) -> str:
    match source:
        case Assumed(reason) | Reconciled(reason):
            arguments = quoted(reason)
        case Measured(recording, method):
            pairs = {"recording": recording, "method": method}
            arguments = ", ".join(f"{k}={quoted(v)}" for k, v in pairs.items() if v)
        case Published(reference):
            arguments = quoted(reference)
        case Fitted(recordings):
            inner = ", ".join(quoted(recording) for recording in recordings)
            inner += "," if len(recordings) == 1 else ""
            arguments = f"({inner})" if recordings else ""
    return f"{type(source).__name__}({arguments})"
