"""What of a causal assignment is shown: strokes, and colour where it is unusual."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from bondgraph.causality.records import CausalAssignment
from bondgraph.errors import StructureError, did_you_mean
from bondgraph.structure.graph import FinishedGraph


@dataclass(frozen=True, slots=True)
class CausalMarks:
    """Strokes and marks by name.

    Attributes
    ----------
    strokes
        By bond, the node at the end that receives effort.
    nodes, bonds
        By node and by bond, the class of the style sheet: ``derivative``, ``chosen``,
        ``preferred`` or ``unmet``.
    """

    strokes: Mapping[str, str] = field(default_factory=dict)
    nodes: Mapping[str, str] = field(default_factory=dict)
    bonds: Mapping[str, str] = field(default_factory=dict)


def causal_marks(
    graph: FinishedGraph, assignment: CausalAssignment | Mapping[str, str] | None
) -> CausalMarks:
    """Return what to show of an assignment, or of strokes by bond name.

    Raises
    ------
    StructureError
        If a bond or end is not one of this graph.
    """
    if not isinstance(assignment, CausalAssignment):
        strokes = dict(assignment or {})
        _check(graph, strokes)
        return CausalMarks(strokes)
    strokes = {stroke.bond.name: stroke.at for stroke in assignment.strokes}
    _check(graph, strokes)
    ports: dict[str, str] = {
        **dict.fromkeys(assignment.arbitrary, "chosen"),
        **dict.fromkeys(assignment.derivative, "derivative"),
        **dict.fromkeys((wish.element for wish in graph.preferences), "preferred"),
        **dict.fromkeys(assignment.unmet, "unmet"),
    }
    nodes, bonds = {}, {}
    for port, mark in ports.items():
        name, _, number = port.partition("[")
        if name not in graph.by_name:
            bonds[port] = mark
            continue
        nodes[name] = mark
        at = graph.bonds_at(name)
        # A field's port is called name[1]; its bonds are counted like that.
        own = (at[int(number.rstrip("]")) - 1],) if number else at
        bonds.update({bond.name: mark for bond in own})
    return CausalMarks(strokes, nodes, bonds)


def _check(graph: FinishedGraph, strokes: Mapping[str, str]) -> None:
    ends = {bond.name: (bond.tail, bond.head) for bond in graph.bonds}
    for name, end in strokes.items():
        if name not in ends:
            raise StructureError(
                f"There is no bond {name!r} in {graph.name!r} to put a stroke on.",
                (name,),
                did_you_mean(name, ends),
            )
        if end not in ends[name]:
            raise StructureError(
                f"The stroke of bond {name!r} is put at {end!r}.",
                (name, end),
                f"Put it at {ends[name][0]!r} or {ends[name][1]!r}.",
            )
