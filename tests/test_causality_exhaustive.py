"""Causality held against every way in which the strokes of small graphs can be put."""

import random
from collections.abc import Iterator
from itertools import product

import pytest

from bondgraph import GY, TF, BondGraph, C, I, R, Se, Sf, assign_causality
from bondgraph.errors import CausalConflictError, StructureError
from bondgraph.structure.elements import letter
from bondgraph.structure.graph import FinishedGraph

MOST_BONDS = 8
GRAPHS = 250
Strokes = tuple[str, ...]
"""The name of the node that receives effort, per bond."""


def small_graph(seed: int) -> BondGraph:
    """Return a graph of up to five junctions, in a tree or with rings."""
    draw = random.Random(seed)
    graph = BondGraph(f"graph {seed}")
    count = draw.randint(1, 5)
    for i in range(count):
        kinds = draw.choices([Se, Sf, I, C, R], [2, 1, 4, 4, 3], k=draw.randint(0, 2))
        ports = [kind(f"x{i}_{k}") for k, kind in enumerate(kinds)]
        draw.choice([graph.one, graph.zero])(f"j{i}", *ports)
    joins = [(draw.randrange(i), i) for i in range(1, count)]
    rings = draw.choice([0, 0, 1, 1, 2]) if count > 1 else 0
    joins += [tuple(draw.sample(range(count), 2)) for _ in range(rings)]
    for k, (tail, head) in enumerate(joins):
        kind = draw.choice([None, None, TF, GY])
        between = () if kind is None else (kind(f"g{k}"),)
        graph.join(f"j{tail}", *between, f"j{head}")
    return graph


def finished() -> Iterator[FinishedGraph]:
    for seed in range(4 * GRAPHS):
        try:
            graph = small_graph(seed).finish()
        except StructureError:
            continue
        if len(graph.bonds) <= MOST_BONDS:
            yield graph


def allowed(graph: FinishedGraph) -> list[Strokes]:
    """Return all strokes that satisfy every node: what the kinds mean, nothing else."""
    found = []
    for strokes in product(*((b.tail, b.head) for b in graph.bonds)):
        for node in graph.nodes:
            ports = len(graph.bonds_at(node.name))
            received = strokes.count(node.name)
            right = {
                "Se": received == 0,
                "Sf": received == 1,
                "0": received == 1,
                "1": received == ports - 1,
                "TF": received == 1,
                "GY": received in (0, 2),
            }
            if not right.get(letter(node), True):
                break
        else:
            found.append(strokes)
    return found


def integral(graph: FinishedGraph, strokes: Strokes) -> list[bool]:
    """Return for each storage whether it is integral: an I takes effort, a C flow."""
    return [
        (strokes[i] == node.name) == (letter(node) == "I")
        for node in graph.nodes
        if letter(node) in "IC"
        for i, bond in enumerate(graph.bonds)
        if node.name in (bond.tail, bond.head)
    ]


@pytest.fixture(scope="module")
def tried() -> list[tuple[FinishedGraph, list[Strokes], Strokes | None]]:
    """Graphs, all strokes that are right, and those that were assigned, if any."""
    graphs = []
    for graph in finished():
        try:
            causality = assign_causality(graph)
        except CausalConflictError:
            graphs.append((graph, allowed(graph), None))
            continue
        strokes = tuple(stroke.at for stroke in causality.strokes)
        graphs.append((graph, allowed(graph), strokes))
        if len(graphs) == GRAPHS:
            break
    return graphs


def test_a_causality_is_found_where_there_is_one_and_only_there(tried) -> None:
    assert len(tried) == GRAPHS
    for graph, right, strokes in tried:
        assert (strokes in right) if right else strokes is None, graph.name
    assert 20 < sum(strokes is None for *_, strokes in tried) < GRAPHS - 80


def test_storages_are_integral_in_turn_wherever_the_rest_allows(tried) -> None:
    for graph, right, strokes in tried:
        if strokes is None:
            continue
        # The first storage is integral if it can be, then the second, and so on.
        best = max(integral(graph, one) for one in right)
        assert integral(graph, strokes) == best, graph.name


def test_the_strokes_are_told_in_the_order_of_bonds_with_what_they_mean(tried) -> None:
    for graph, _, strokes in tried:
        if strokes is None:
            continue
        causality = assign_causality(graph)
        assert tuple(s.bond for s in causality.strokes) == graph.bonds
        assert {step.stroke for step in causality.steps} == set(causality.strokes)
        names = [node.name for node in graph.nodes if letter(node) in "IC"]
        kept = dict(zip(names, integral(graph, strokes), strict=True))
        assert causality.integral == tuple(n for n in names if kept[n])
        assert causality.derivative == tuple(n for n in names if not kept[n])


def test_a_choice_is_told_wherever_another_was_as_good(tried) -> None:
    for graph, right, strokes in tried:
        if strokes is not None:
            states = integral(graph, strokes)
            as_good = [one for one in right if integral(graph, one) == states]
            free = assign_causality(graph).arbitrary
            assert free or as_good == [strokes], graph.name
