"""The shape of a drawing: the right angles at every node, the bends in every bond.

Tamassia's network flow: around a node the corners make four quarter turns, around a
face they make a closed polygon, and among all such shapes the one is taken with the
fewest bends and the least turning where a path should run straight ("On embedding a
graph in the grid with the minimum number of bends", SIAM J. Comput. 16 (1987) 421).
The corner of a dart is the one at its head, on its left.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bondgraph.reporting.layout.planar import PlanarMap
from bondgraph.reporting.layout.programme import whole_minimum

INDIFFERENT = 0.01  # cost of a quarter turn where none is wished for


@dataclass(slots=True)
class Wishes:
    """How the corners should be, and what it costs if they are not.

    Attributes
    ----------
    quarters
        By dart, the quarter turns wished for in its corner; together four at a node.
    weight
        By dart, the cost of each quarter turn more or fewer.
    bend
        By edge, the cost of a bend.
    """

    quarters: dict[int, int] = field(default_factory=dict)
    weight: dict[int, float] = field(default_factory=dict)
    bend: dict[int, float] = field(default_factory=dict)


def square_off(graph: PlanarMap, outer: int, wishes: Wishes) -> list[int]:
    """Give the map a shape, and return the direction of every dart.

    Bends become nodes of their own. Directions count quarter turns from east,
    counterclockwise.

    Parameters
    ----------
    graph
        A connected map with at most four bonds at a node; its bends are put in.
    outer
        A dart with the outside on its left.
    wishes
        What is wished for.
    """
    corners, bends = _solve(graph, outer, wishes)
    for dart, count in bends.items():
        for _ in range(count):
            _bend_left(graph, corners, dart)
    return _directions(graph, corners)


def _solve(
    graph: PlanarMap, outer: int, wishes: Wishes
) -> tuple[list[int], Mapping[int, int]]:
    """Return the quarters in each dart's corner, and the left bends along darts."""
    darts = len(graph.origin)
    faces = graph.faces()
    face_of = np.zeros(darts, dtype=int)
    wished = np.array([wishes.quarters.get(d, 1) for d in range(darts)])
    balance = [4 - sum(wished[d ^ 1] for d in out) for out in graph.around]
    for k, face in enumerate(faces):
        face_of[face] = k
        closing = -4 if outer in face else 4
        balance.append(closing - int(np.sum(2 - wished[face])))
    every = np.arange(darts)
    node_row = np.array(graph.origin)[every ^ 1]
    face_row = len(graph.around) + face_of
    weight = np.array([wishes.weight.get(d, INDIFFERENT) for d in range(darts)])
    bend = np.array([wishes.bend.get(d >> 1, 1.0) for d in range(darts)])
    # Columns: quarters more, quarters fewer, left bends; each adds to two balances.
    rows = (node_row, face_row, node_row, face_row, face_row, face_row[every ^ 1])
    columns = (every, every, darts + every, darts + every, *[2 * darts + every] * 2)
    signs = np.repeat([1.0, -1.0, -1.0, 1.0, 1.0, -1.0], darts)
    limits = np.concatenate([4.0 - wished, wished - 1.0, np.full(darts, np.inf)])
    found = whole_minimum(
        np.concatenate([weight, weight, bend]),
        (signs, np.concatenate(rows), np.concatenate(columns)),
        np.array(balance, dtype=float),
        upper=limits,
        exact=True,
    )
    more, fewer, left = found.reshape(3, darts)
    corners = wished + more - fewer
    return corners.tolist(), {d: int(left[d]) for d in range(darts) if left[d]}


def _bend_left(graph: PlanarMap, corners: list[int], dart: int) -> None:
    """Put a left bend into the edge of `dart`."""
    graph.cut(dart)
    # The rest of the edge has the old corner; its way back turns right here.
    corners += [corners[dart], 3]
    corners[dart] = 1


def _directions(graph: PlanarMap, corners: Sequence[int]) -> list[int]:
    following = graph.following()
    direction = [-1] * len(corners)
    direction[0] = 0
    stack = [0]
    while stack:
        dart = stack.pop()
        here = direction[dart]
        ahead = (here + 2 - corners[dart]) % 4
        for other, turn in ((dart ^ 1, (here + 2) % 4), (following[dart], ahead)):
            if direction[other] < 0:
                direction[other] = turn
                stack.append(other)
            assert direction[other] == turn, "angles around a node or face do not close"
    return direction
