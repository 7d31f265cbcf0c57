"""The law of a storing port in the direction that is wanted, and what it reads."""

from collections.abc import Mapping

import sympy

from bondgraph.equations.algebra.rational import solved
from bondgraph.equations.deriving.inversion import Laws
from bondgraph.errors import EquationError
from bondgraph.structure import signals
from bondgraph.structure.elements import Inertance, Node, Storage, letter
from bondgraph.structure.fields import StorageField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import PortVariable

ZERO, ONE = sympy.S.Zero, sympy.S.One


def port_law(
    graph: FinishedGraph, laws: Laws, name: str, *, wants_stored: bool
) -> tuple[sympy.Expr, Mapping[sympy.Symbol, str]]:
    """Return the law of a storing port and where the variables in it are found.

    Parameters
    ----------
    name
        The element, or ``field[1]``.
    wants_stored
        True for the momentum (displacement) in terms of flows (efforts), False for the
        flow (effort) in terms of momenta (displacements).

    Raises
    ------
    EquationError
        If there is no formula.
    """
    node = graph.node(name.split("[", maxsplit=1)[0])
    if isinstance(node, StorageField):
        number = int(name[len(node.name) + 1 : -1])
        law = _field_law(node, number, wants_stored=wants_stored)
    else:
        assert isinstance(node, Storage)
        inertance = isinstance(node, Inertance)
        stored, co = (signals.p, signals.f) if inertance else (signals.q, signals.e)
        law = laws.explicit(node, stored if wants_stored else co)
    if law is None:
        wanted = "what it stores" if wants_stored else "its flow or effort"
        raise EquationError(
            f"The law of {letter(node)} {name!r} has no formula for {wanted}.",
            (node.name,),
            "Write it the other way round.",
        )
    variables = [s for s in law.free_symbols if signals.is_port_variable(s)]
    return law, {x: port_place(node, x) for x in sorted(variables, key=str)}


def _field_law(
    field: StorageField, number: int, *, wants_stored: bool
) -> sympy.Expr | None:
    """Return the law of one port of a field, linear ones in either direction."""
    relations = field.relations
    if (relations[0].output == field.stored[0]) == wants_stored:
        return relations[number - 1].expression
    arguments = [relation.argument for relation in relations]
    rows, right = [], []
    for relation in relations:
        row = {x: relation.expression.diff(x) for x in arguments}
        if any(
            signals.is_port_variable(s) for x in row.values() for s in x.free_symbols
        ):
            return None
        rows.append({x: slope for x, slope in row.items() if slope != 0})
        rest = relation.expression.xreplace(dict.fromkeys(arguments, ZERO))
        right.append({relation.output: ONE, ONE: -rest})
    answer = solved(rows, arguments, right)[arguments[number - 1]]
    return sympy.Add(*(x * key for key, x in answer.items()))


def port_place(node: Node, variable: sympy.Symbol) -> str:
    """Return the port, ``field[1]`` or the element, that a law's variable is of."""
    if isinstance(variable, PortVariable) and isinstance(node, StorageField):
        return node.port(variable.number)
    return node.name
