"""Trees that hang on the rings of a graph, or the one tree that it is.

Seen by someone who comes from a node's parent, which lies at WEST, the deepest child
is ahead, at EAST, and the others go to the right and left in turn. A long side branch
turns at its first node, so that it runs beside the path it leaves; a short one stands
upright on it.
"""

import itertools
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

WEST, SOUTH, EAST, NORTH = range(4)  # counterclockwise
LONG_BRANCH = 3  # nodes


@dataclass(slots=True)
class Forest:
    """Trees by their nodes.

    Attributes
    ----------
    parent
        By node of a tree, the next node towards the ring or root.
    order
        The roots and nodes of the trees, from the roots outwards.
    slots
        By node in `order`, its children counterclockwise and where each should lie.
    """

    parent: dict[int, int] = field(default_factory=dict)
    order: list[int] = field(default_factory=list)
    slots: dict[int, list[tuple[int, int]]] = field(default_factory=dict)


def hanging_trees(
    size: int, edges: Sequence[tuple[int, int]], spine: Sequence[int]
) -> Forest:
    """Return the trees of a connected graph; without rings the spine is the root."""
    neighbours: list[list[int]] = [[] for _ in range(size)]
    for tail, head in edges:
        neighbours[tail].append(head)
        neighbours[head].append(tail)
    roots = _ring_nodes(neighbours) or [spine[0]]
    forest = Forest(order=list(roots))
    children: dict[int, list[int]] = {}
    reached = set(roots)
    for node in forest.order:  # grows while it is walked
        children[node] = [n for n in neighbours[node] if n not in reached]
        for child in children[node]:
            forest.parent[child] = node
        reached.update(children[node])
        forest.order += children[node]
    _arrange(forest, children, dict(itertools.pairwise(spine)))
    return forest


def _ring_nodes(neighbours: Sequence[Sequence[int]]) -> list[int]:
    """Return the nodes that are left when ends of trees are taken off, one by one."""
    degree = [len(others) for others in neighbours]
    ends = deque(node for node, count in enumerate(degree) if count <= 1)
    gone = set(ends)
    while ends:
        for other in neighbours[ends.popleft()]:
            degree[other] -= 1
            if degree[other] <= 1 and other not in gone:
                gone.add(other)
                ends.append(other)
    return [node for node in range(len(degree)) if node not in gone]


def _arrange(
    forest: Forest, children: Mapping[int, list[int]], along: Mapping[int, int]
) -> None:
    """Choose the slots of all children."""
    height = dict.fromkeys(forest.order, 0)
    for node in reversed(forest.order):
        if node in forest.parent:
            above = forest.parent[node]
            height[above] = max(height[above], height[node] + 1)
    path = {node: node for node in forest.order}
    turn = dict.fromkeys(forest.order, EAST)
    left_next: dict[int, bool] = {}
    for node in forest.order:
        kids = sorted(children[node], key=lambda n: (n != along.get(node), -height[n]))
        if not kids:
            forest.slots[node] = []
            continue
        ahead, *others = kids
        path[ahead] = path[node]
        sides = []
        for k, _ in enumerate(others):
            left = left_next.get(path[node], False) ^ bool(k % 2)
            sides.append(NORTH if left else SOUTH)
        if len(others) % 2:
            left_next[path[node]] = not left_next.get(path[node], False)
        for child, side in zip(others, sides, strict=True):
            if height[child] + 1 >= LONG_BRANCH:
                turn[child] = SOUTH if side == NORTH else NORTH
        rest = list(zip(others, sides, strict=True))
        forest.slots[node] = _slots(ahead, rest, turn[node], node in forest.parent)


def _slots(
    ahead: int, others: Iterable[tuple[int, int]], turn: int, has_parent: bool
) -> list[tuple[int, int]]:
    """Return the children counterclockwise with their directions."""
    right = [child for child, side in others if side == SOUTH]
    left = [child for child, side in others if side == NORTH]
    if len(right) + len(left) > 2:
        turn = EAST  # a row of nodes, which does not turn
    if turn == SOUTH:
        order = [ahead, *right, *left]
    elif turn == NORTH:
        order = [*right, *left, ahead]
    else:
        order = [*right, ahead, *left]
    if len(order) == 3:
        where = [SOUTH, EAST, NORTH]
    elif turn == EAST:
        where = [*[SOUTH] * len(right), EAST, *[NORTH] * len(left)]
    elif len(order) == 1:
        where = [turn]
    else:
        where = [SOUTH, EAST] if turn == SOUTH else [EAST, NORTH]
    if len(order) == 4 and not has_parent:
        order, where = [order[-1], *order[:-1]], [WEST, SOUTH, EAST, NORTH]
    return list(zip(order, where, strict=True))
