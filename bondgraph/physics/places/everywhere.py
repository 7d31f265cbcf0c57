"""All places of a graph, in the author's order."""

from collections.abc import Collection, Iterator
from itertools import combinations, product

from bondgraph.physics.places.apart import motions_apart, motions_beside
from bondgraph.physics.places.base import Place
from bondgraph.physics.places.bond import BondPlace
from bondgraph.physics.places.channels import InputPlace, OutputPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import junction_place
from bondgraph.physics.places.pair import ApartPair, MotionPair, PairPlace, StockPair
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.places.source import ActuatorPlace, actuators
from bondgraph.structure.domains import ELECTRICAL
from bondgraph.structure.edits import carries_signals_only
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Gyrator,
    Inertance,
    Junction,
    Node,
    OneJunction,
    Resistance,
    Transformer,
    ZeroJunction,
)
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.nodes import WithLaw


def all_places(graph: FinishedGraph, scales: Scales) -> tuple[Place, ...]:
    """Return every place of `graph` where physics may have been left out.

    Parameters
    ----------
    graph
        The model; every place knows it.
    scales
        Typical sizes of its signals, for start values.
    """
    machine = [j.name for j in machine_junctions(graph)]
    return (
        *(junction_place(graph, name, scales) for name in machine),
        *_bonds(graph, scales),
        *(
            ElementPlace(graph, node.name, scales)
            for node in graph.elements
            if isinstance(node, WithLaw) and _touches(graph, node.name, machine)
        ),
        *(ActuatorPlace(graph, name, scales) for name in actuators(graph)),
        *_pairs(graph, scales, machine),
        *(InputPlace(graph, source.name, scales) for source in graph.inputs),
        *(OutputPlace(graph, m.name, scales) for m in graph.measurements),
    )


def machine_junctions(graph: FinishedGraph) -> tuple[Junction, ...]:
    """Return the junctions of the machine: those of signals are no places."""
    return tuple(j for j in graph.junctions if not carries_signals_only(graph, j.name))


def _touches(graph: FinishedGraph, element: str, junctions: Collection[str]) -> bool:
    return any(b.other(element) in junctions for b in graph.bonds_at(element))


def _bonds(graph: FinishedGraph, scales: Scales) -> Iterator[BondPlace]:
    """Yield the bonds that tie two motions together: of rods, shafts, gears, rollers.

    What hangs on a 0-junction is tied by an effort, and gives way there already.
    """
    for bond in graph.bonds:
        name = _name_of(graph, bond)
        if name is not None:
            yield BondPlace(graph, name, scales, bond)


def _name_of(graph: FinishedGraph, bond: Bond) -> str | None:
    """Return what the user calls a bond that may be split, None for others."""
    tail, head = graph.node(bond.tail), graph.node(bond.head)
    if isinstance(tail, OneJunction) and isinstance(head, OneJunction):
        return tail.name
    if isinstance(tail, Transformer) and isinstance(head, OneJunction):
        # Of a gear's two bonds the outer one: compliance of either is the other's.
        others = (b.other(tail.name) for b in graph.bonds_at(tail.name))
        rigid = all(isinstance(graph.node(o), OneJunction) for o in others)
        return tail.name if rigid else None
    if isinstance(tail, OneJunction) and isinstance(head, Inertance):
        return head.name if _moves_anyway(graph, tail.name, head.name) else None
    if isinstance(tail, FlowSource) and isinstance(head, OneJunction):
        return tail.name
    return None


def _moves_anyway(graph: FinishedGraph, junction: str, inertia: str) -> bool:
    """Return whether a junction has a motion of its own without one of its inertias.

    What hangs there without any inertia is part of that inertia, not tied to it. An
    inductance is never so: a current may go past it.
    """
    others = (n for n in _neighbours(graph, junction) if n.name != inertia)
    moving = Inertance | FlowSource | Transformer | Gyrator | OneJunction
    if graph.domain_at(junction) == ELECTRICAL:
        moving |= Resistance
    return any(isinstance(node, moving) for node in others)


def _pairs(
    graph: FinishedGraph, scales: Scales, junctions: Collection[str]
) -> Iterator[PairPlace]:
    """Yield pairs of stocks that no resistance joins, and of motions that nothing does.

    Of one domain each; of a stock and a room or a supply, held from outside; and of
    motions that only a third one joins.
    """
    stocks = [name for name in junctions if _is_stock(graph, name)]
    outside = [name for name in junctions if _is_held(graph, name)]
    for first, second in (*combinations(stocks, 2), *product(stocks, outside)):
        alike = graph.domain_at(first) == graph.domain_at(second)
        if alike and not _resisted(graph, first, second):
            yield StockPair(graph, first, scales, second)
    for first, second in motions_apart(graph, junctions):
        yield ApartPair(graph, first, scales, second)
    for first, second in motions_beside(graph, junctions):
        yield MotionPair(graph, first, scales, second)


def _is_stock(graph: FinishedGraph, junction: str) -> bool:
    nodes = _neighbours(graph, junction)
    stores = any(isinstance(node, Compliance) for node in nodes)
    return stores and isinstance(graph.node(junction), ZeroJunction)


def _is_held(graph: FinishedGraph, junction: str) -> bool:
    """Return whether a source holds the effort that a 0-junction shares."""
    held = any(isinstance(node, EffortSource) for node in _neighbours(graph, junction))
    return held and isinstance(graph.node(junction), ZeroJunction)


def _resisted(graph: FinishedGraph, first: str, second: str) -> bool:
    """Return whether a 1-junction with an R stands between the two."""
    ends = {n.name for n in _neighbours(graph, first) if isinstance(n, OneJunction)}
    ends &= {n.name for n in _neighbours(graph, second)}
    return any(
        isinstance(node, Resistance)
        for between in ends
        for node in _neighbours(graph, between)
    )


def _neighbours(graph: FinishedGraph, name: str) -> tuple[Node, ...]:
    return tuple(graph.node(b.other(name)) for b in graph.bonds_at(name))
