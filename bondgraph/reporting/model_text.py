"""A graph as the Python text that makes it, so that two versions can be diffed.

The text is a factory function ``model()`` in the language the author wrote: junctions
with their elements, joins, parameters with unit, bounds, deviation and source, and
measurements, in the author's order. Running it gives an equal graph.
"""

from collections import Counter
from collections.abc import Iterator, Mapping

import sympy

from bondgraph.errors import StructureError
from bondgraph.reporting.authoring_steps import (
    AddJunction,
    AddNode,
    AuthoringStep,
    DrawBond,
    JoinJunctions,
    PutElement,
    authoring_steps,
)
from bondgraph.reporting.differences import describe_difference
from bondgraph.reporting.parameter_text import parameter_lines, parameter_names_needed
from bondgraph.reporting.python_expressions import (
    INDENT,
    WIDTH,
    call,
    names_needed,
    python_expression,
    quoted,
    variable_names,
)
from bondgraph.structure.domains import ANALOGUE, DOMAINS, EnergyDomain
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Junction,
    Node,
    OneJunction,
    letter,
)
from bondgraph.structure.fields import MixedField, MultiPort
from bondgraph.structure.graph import (
    FinishedGraph,
    Measurement,
    used_parameters,
)
from bondgraph.structure.nodes import written_laws
from bondgraph.structure.signals import Signal, parameters_in

_TAKEN = frozenset(
    (
        *("graph", "model", "math", "sympy", "e", "f", "p", "q", "t"),
        *("effort", "flow", "momentum", "displacement", "BondGraph"),
        *("Parameter", "ParameterSet", "Assumed", "Measured", "Published", "Fitted"),
        *("Reconciled", "Se", "Sf", "I", "C", "R", "TF", "GY", "port"),
        *("IField", "CField", "ICField", "RField", "ZeroJunction", "OneJunction"),
    )
)


def to_python(graph: FinishedGraph) -> str:
    """Return the Python text of a function ``model()`` that makes the graph again.

    Parameters
    ----------
    graph
        A graph written with `BondGraph`, edited or not.

    Returns
    -------
    str
        A module that imports from ``bondgraph``, ``sympy`` and ``math`` only.

    Raises
    ------
    StructureError
        If a junction joins bonds of two energy domains.
    EquationError
        If a law cannot be written as Python text.
    """
    used = used_parameters(graph.nodes, graph.measurements)
    variables = variable_names(used, _TAKEN)
    domains = _junction_domains(graph)
    default = _commonest(domains)
    statements = [
        _opening(graph, default),
        *_symbols(graph, variables),
        *(_step(s, variables, domains, default) for s in authoring_steps(graph)),
        *parameter_lines(graph),
        *(_measurement(graph, m, variables) for m in graph.measurements),
        *(
            call("graph.prefer", (quoted(p.element), quoted(p.wanted.value)))
            for p in graph.preferences
        ),
        "return graph",
    ]
    lines = [INDENT + line for block in statements for line in block.split("\n")]
    function = "def model() -> BondGraph:\n" + "\n".join(lines) + "\n"
    return f"{_imports(graph, function)}\n\n{function}"


def _imports(graph: FinishedGraph, function: str) -> str:
    needed = {"BondGraph"} | parameter_names_needed(graph)
    needed |= {_constructor(element) for element in graph.elements}
    for step in authoring_steps(graph):
        if isinstance(step, AddNode):
            needed.add(_constructor(step.node))
    for law in _written_laws(graph):
        needed |= names_needed(law)
    for measurement in graph.measurements:
        if not isinstance(measurement.expression, Signal):
            needed |= names_needed(measurement.expression)
    text = "".join(
        f"import {module}\n\n"
        for module in ("math", "sympy")
        if f"{module}." in function
    )
    line = f"from bondgraph import {', '.join(sorted(needed))}\n"
    if len(line) > WIDTH:
        listed = "".join(f"{INDENT}{name},\n" for name in sorted(needed))
        line = f"from bondgraph import (\n{listed})\n"
    return text + line


def _opening(graph: FinishedGraph, default: EnergyDomain) -> str:
    arguments = [quoted(graph.name)]
    if default != ANALOGUE:
        arguments.append(f"domain={quoted(default.name)}")
    return call("graph = BondGraph", arguments)


def _written_laws(graph: FinishedGraph) -> tuple[sympy.Expr, ...]:
    return tuple(law for element in graph.elements for law in written_laws(element))


def _symbols(graph: FinishedGraph, variables: Mapping[str, str]) -> Iterator[str]:
    """Yield a line for each parameter that a written law or a measurement reads."""
    expressions = (*_written_laws(graph), *(m.expression for m in graph.measurements))
    read = {name for law in expressions for name in parameters_in(law)}
    for name, variable in variables.items():
        if name in read:
            yield f"{variable} = sympy.Symbol({quoted(name)}, real=True)"


def _step(
    step: AuthoringStep,
    variables: Mapping[str, str],
    domains: Mapping[str, EnergyDomain],
    default: EnergyDomain,
) -> str:
    """Return one authoring call."""
    match step:
        case AddJunction(junction, elements):
            method = "one" if isinstance(junction, OneJunction) else "zero"
            arguments = [quoted(junction.name)]
            arguments += [_element(element, variables) for element in elements]
            domain = domains.get(junction.name, default)
            if domain != default:
                arguments.append(f"domain={quoted(domain.name)}")
            return call(f"graph.{method}", arguments)
        case PutElement(element, junctions):
            names = ", ".join(map(quoted, junctions))
            on = f"on=({names},)" if isinstance(element, MultiPort) else f"on={names}"
            return call("graph.put", (_element(element, variables), on))
        case JoinJunctions(tail, two_port, head):
            between = () if two_port is None else (_element(two_port, variables),)
            return call("graph.join", (quoted(tail), *between, quoted(head)))
        case AddNode(node):
            own = domains.get(node.name, default)
            of = () if own == default else (f"domain={quoted(own.name)}",)
            return call("graph.add", (_element(node, variables), *of))
        case DrawBond(bond):
            ends = [quoted(bond.tail), quoted(bond.head)]
            own = domains.get(bond.name, default)
            touched = {bond.tail, bond.head} & domains.keys()
            if own != default and not touched:
                ends.append(f"domain={quoted(own.name)}")
            return call("graph.bond", ends)


def _element(element: Node, variables: Mapping[str, str]) -> str:
    laws = [python_expression(law, variables) for law in written_laws(element)]
    name = quoted(element.name)
    if isinstance(element, MultiPort):
        kinds = (
            f", kinds={quoted(element.kinds)}"
            if isinstance(element, MixedField)
            else ""
        )
        return f"{_constructor(element)}({name}, ({', '.join(laws)},){kinds})"
    if not laws:
        return f"{_constructor(element)}({name})"
    keyword = "value" if isinstance(element, EffortSource | FlowSource) else "law"
    return f"{letter(element)}({name}, {keyword}={laws[0]})"


def _constructor(element: Node) -> str:
    if isinstance(element, Junction):
        return type(element).__name__
    return letter(element) + ("Field" if isinstance(element, MultiPort) else "")


def _measurement(
    graph: FinishedGraph, measurement: Measurement, variables: Mapping[str, str]
) -> str:
    arguments = [quoted(measurement.name)]
    read = measurement.expression
    if isinstance(read, Signal):
        arguments.append(f"{read.quantity.value}={quoted(read.place)}")
        implied = graph.domain_at(read.place).unit(read.quantity)
    else:
        arguments.append(python_expression(read, variables))
        implied = "1"
    if measurement.unit != implied:
        arguments.append(f"unit={quoted(measurement.unit)}")
    return call("graph.measure", arguments)


def _junction_domains(graph: FinishedGraph) -> dict[str, EnergyDomain]:
    """Return the domain of each junction, and of each bond that touches none.

    A bond has the domain of the junction it was written at: of its tail for a plain
    bond, else of its only junction.
    """
    junctions = {junction.name for junction in graph.junctions}
    domains: dict[str, EnergyDomain] = {}
    for bond, domain in zip(graph.bonds, graph.domains, strict=True):
        junction = bond.tail if bond.tail in junctions else bond.head
        junction = junction if junction in junctions else bond.name
        if domains.setdefault(junction, domain) != domain:
            raise StructureError(
                f"The junction {junction!r} joins bonds of {domains[junction].name} "
                f"and {domain.name}.",
                (junction,),
                "Join energy domains through a TF or GY.",
            )
        if DOMAINS.get(domain.name) != domain:
            raise StructureError(
                f"The energy domain {domain.name!r} is not one of the toolkit's.",
                (domain.name,),
                f"Use one of {', '.join(DOMAINS)}.",
            )
    return domains


def _commonest(domains: Mapping[str, EnergyDomain]) -> EnergyDomain:
    counted = Counter(domain.name for domain in domains.values())
    return DOMAINS[counted.most_common(1)[0][0]]


__all__ = ["describe_difference", "to_python"]
