"""Numbers of bonds, counted as in the textbooks: along the path of power.

At each node first the bonds of its elements, in the author's order with sources first,
then every side branch to its end, then onwards along the spine.
"""

from collections.abc import Iterator, Mapping
from itertools import pairwise

from bondgraph.reporting.layout.skeleton import pieces, skeleton_of
from bondgraph.structure.elements import EffortSource, FlowSource
from bondgraph.structure.graph import FinishedGraph


def bond_numbers(graph: FinishedGraph) -> list[int]:
    """Return the number of every bond, from 1, in the order of the graph's bonds."""
    skeleton = skeleton_of(graph)
    order: dict[int, None] = {}
    ways = _ways(graph)
    for piece in pieces(graph, skeleton):
        onward = set(pairwise(piece.spine))
        seen = {piece.spine[0]}
        stack = [_from(graph, piece.spine[0], ways, onward)]
        while stack:
            step = next(stack[-1], None)
            if step is None:
                stack.pop()
                continue
            bond, other = step
            order.setdefault(bond)
            if other not in seen:
                seen.add(other)
                stack.append(_from(graph, other, ways, onward))
    numbers = [0] * len(graph.bonds)
    for number, bond in enumerate(order, start=1):
        numbers[bond] = number
    return numbers


def _ways(graph: FinishedGraph) -> Mapping[str, list[tuple[int, str]]]:
    ways: dict[str, list[tuple[int, str]]] = {node.name: [] for node in graph.nodes}
    for k, bond in enumerate(graph.bonds):
        ways[bond.tail].append((k, bond.head))
        ways[bond.head].append((k, bond.tail))
    return ways


def _from(
    graph: FinishedGraph,
    node: str,
    ways: Mapping[str, list[tuple[int, str]]],
    onward: set[tuple[str, str]],
) -> Iterator[tuple[int, str]]:
    """Return the bonds at a node in the order in which they are counted."""
    nodes = graph.by_name

    def rank(way: tuple[int, str]) -> int:
        _, other = way
        if len(ways[other]) == 1:
            return 0 if isinstance(nodes[other], EffortSource | FlowSource) else 1
        return 3 if (node, other) in onward else 2

    return iter(sorted(ways[node], key=rank))
