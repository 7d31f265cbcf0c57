"""Where the nodes of a bond graph sit on paper.

Junctions and two-ports form the backbone: columns are distances from one end of the
longest path, so power runs left to right; the longest path keeps one row, side
branches take the nearest free row. One-ports fan out above and below their junction,
as in hand-drawn figures, with a source to the left of the first junction and the load
to the right of the last. Every step is linear or nearly so in the number of bonds.
"""

import unicodedata
from collections import defaultdict, deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from bondgraph.structure.elements import EffortSource, FlowSource, Node
from bondgraph.structure.graph import FinishedGraph, is_one_port

FAN = 84.0  # centre to centre, junction to the one-ports above or below it
BOND = 58.0  # shortest visible bond along a row
SLOT_GAP = 16.0  # between neighbours of a fan
ASIDE = 6.0  # from a node to a fan that leaves room for a bond beside it
ROW_GAP = 34.0
MARGIN = 28.0


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle by its centre and full size, in pixels, y downwards."""

    x: float
    y: float
    width: float
    height: float

    def overlaps(self, other: "Box") -> bool:
        """Return whether the two rectangles share area."""
        return (
            abs(self.x - other.x) < (self.width + other.width) / 2
            and abs(self.y - other.y) < (self.height + other.height) / 2
        )


@dataclass(frozen=True, slots=True)
class Layout:
    """The boxes of all nodes by name, and the size of the sheet."""

    boxes: Mapping[str, Box]
    width: float
    height: float


def text_width(text: str, size: float) -> float:
    """Return a width in pixels that `text` surely fits in at font size `size`."""
    wide = sum(unicodedata.east_asian_width(c) in "WF" for c in text)
    capitals = sum(c.isupper() or c in "mw%@" for c in text)
    return size * (0.56 * len(text) + 0.44 * wide + 0.16 * capitals)


@dataclass(slots=True)
class _Fan:
    """The one-ports of one backbone node, by the side they are drawn on."""

    left: list[str] = field(default_factory=list)
    right: list[str] = field(default_factory=list)
    above: list[str] = field(default_factory=list)
    below: list[str] = field(default_factory=list)
    aside: int = 0  # -1 or 1: above and below are moved left or right of the node


class _Backbone:
    """Junctions and two-ports with their neighbours, columns and rows."""

    def __init__(self, graph: FinishedGraph) -> None:
        nodes = graph.by_name
        partners: defaultdict[str, list[str]] = defaultdict(list)
        for bond in graph.bonds:
            partners[bond.tail].append(bond.head)
            partners[bond.head].append(bond.tail)
        self.hosted: dict[str, list[str]] = {
            node.name: []
            for node in graph.nodes
            if not (is_one_port(node) and _has_host(node, nodes, partners))
        }
        for node in graph.nodes:
            if node.name not in self.hosted:
                self.hosted[partners[node.name][0]].append(node.name)
        self.neighbours = {
            name: [n for n in partners[name] if n in self.hosted]
            for name in self.hosted
        }
        self.forward = {(b.tail, b.head) for b in graph.bonds}
        self.driven = {
            name
            for name, hung in self.hosted.items()
            if any(isinstance(nodes[h], EffortSource | FlowSource) for h in hung)
        }
        self.column: dict[str, int] = {}
        self.row: dict[str, int] = {}
        for name in self.hosted:
            if name not in self.column:
                self._place_component(name)

    def _reach(self, start: str) -> tuple[dict[str, int], dict[str, str]]:
        """Return distances and predecessors from `start`, breadth first."""
        distance, parent = {start: 0}, {}
        queue = deque([start])
        while queue:
            name = queue.popleft()
            for other in self.neighbours[name]:
                if other not in distance:
                    distance[other] = distance[name] + 1
                    parent[other] = name
                    queue.append(other)
        return distance, parent

    def _place_component(self, seed: str) -> None:
        distance, _ = self._reach(seed)
        one_end = _farthest(distance)
        distance, parent = self._reach(one_end)
        path = [_farthest(distance)]
        while path[-1] in parent:
            path.append(parent[path[-1]])
        if self._as_start(path) > self._as_start(path[::-1]):
            distance, parent = self._reach(path[0])
        self.column.update(distance)
        rows = _rows(distance, parent)
        floor = max(self.row.values(), default=-1) + 1 - min(rows.values())
        self.row.update({name: row + floor for name, row in rows.items()})

    def _as_start(self, path: Sequence[str]) -> tuple[bool, int]:
        """Return how well the first node of `path` serves as the left end.

        A source there counts most, then how many bonds carry power rightwards.
        """
        rightwards = sum(step in self.forward for step in pairwise(path))
        return path[0] in self.driven, rightwards


def _has_host(
    node: Node, nodes: Mapping[str, Node], partners: Mapping[str, Sequence[str]]
) -> bool:
    """Return whether a one-port hangs on something drawn in the backbone.

    Of two one-ports bonded to each other, the first by name carries the second.
    """
    (partner,) = partners[node.name]
    return not is_one_port(nodes[partner]) or node.name > partner


def _farthest(distance: Mapping[str, int]) -> str:
    return max(distance, key=distance.__getitem__)


def _rows(distance: Mapping[str, int], parent: Mapping[str, str]) -> dict[str, int]:
    """Return a row for each node: every longest downward path keeps to one row."""
    depth = dict.fromkeys(distance, 0)
    children: defaultdict[str, list[str]] = defaultdict(list)
    for child in reversed(tuple(distance)):
        if child in parent:
            depth[parent[child]] = max(depth[parent[child]], depth[child] + 1)
    for child in distance:
        if child in parent:
            children[parent[child]].append(child)
    rows: dict[str, int] = {}
    taken: defaultdict[int, set[int]] = defaultdict(set)
    queue = deque([next(iter(distance))])
    while queue:
        head = queue.popleft()
        span = range(distance[head], distance[head] + depth[head] + 1)
        row = _free_row(rows.get(parent.get(head, ""), 0), span, taken)
        taken[row].update(span)
        name: str | None = head
        while name is not None:
            rows[name] = row
            following = sorted(children[name], key=lambda n: -depth[n])
            queue.extend(following[1:])
            name = following[0] if following else None
    return rows


def _free_row(near: int, span: range, taken: Mapping[int, set[int]]) -> int:
    """Return the row closest to `near` that is free over `span`."""
    step = 0
    while True:
        for row in (near + step, near - step):
            if row not in taken or taken[row].isdisjoint(span):
                return row
        step += 1


def _fan(backbone: _Backbone, name: str, sources: set[str]) -> _Fan:
    """Choose the side of each one-port of `name`."""
    fan = _Fan()
    rest = list(backbone.hosted[name])
    column, row = backbone.column[name], backbone.row[name]
    around = [
        (backbone.column[n] - column, backbone.row[n] - row)
        for n in backbone.neighbours[name]
    ]
    driving = [n for n in rest if n in sources]
    if driving and not any(dc <= 0 for dc, _ in around):
        fan.left = driving[:1]
        rest.remove(driving[0])
    # On a node with neighbours, the last one-port ends the row as the load does.
    if rest and not any(dc >= 0 for dc, _ in around) and (around or len(rest) > 1):
        fan.right = [rest.pop()]
    up_free = not any(dr < 0 for _, dr in around)
    down_free = not any(dr > 0 for _, dr in around)
    if up_free and down_free:
        fan.above, fan.below = rest[::2], rest[1::2]
    elif down_free:
        fan.below = rest
    else:
        fan.above = rest
    if not up_free and not down_free:
        crossing = sum(dc for dc, dr in around if dr < 0)
        fan.aside = -1 if crossing >= 0 else 1
    return fan


@dataclass(slots=True)
class _Extent:
    """Half sizes around a backbone node: of its row and of its fans."""

    row_left: float
    row_right: float
    fan_left: float = 0.0
    fan_right: float = 0.0


def _extent(fan: _Fan, name: str, sizes: Mapping[str, tuple[float, float]]) -> _Extent:
    half = sizes[name][0] / 2
    left = sum(sizes[n][0] + BOND for n in fan.left)
    right = sum(sizes[n][0] + BOND for n in fan.right)
    spans = [_fan_span(fan, s, sizes) for s in (fan.above, fan.below) if s]
    if not spans:
        return _Extent(half + left, half + right)
    return _Extent(
        half + left, half + right, -min(a for a, _ in spans), max(b for _, b in spans)
    )


def _fan_span(
    fan: _Fan, side: Sequence[str], sizes: Mapping[str, tuple[float, float]]
) -> tuple[float, float]:
    """Return where one side of a fan starts and ends, relative to its node."""
    width = sum(sizes[n][0] for n in side) + SLOT_GAP * (len(side) - 1)
    centre = fan.aside * (width / 2 + ASIDE)
    return centre - width / 2, centre + width / 2


def _column_centres(backbone: _Backbone, extents: Mapping[str, _Extent]) -> list[float]:
    """Return x of each column, as tight as rows and fans allow."""
    members: defaultdict[int, list[str]] = defaultdict(list)
    for name, column in backbone.column.items():
        members[column].append(name)
    row_edge = 0.0
    fan_edge: defaultdict[int, float] = defaultdict(float)
    centres: list[float] = []
    for column in range(len(members)):
        x = 0.0
        for name in members[column]:
            own = extents[name]
            start = 0.0 if column == 0 else row_edge + BOND
            fan_start = fan_edge[backbone.row[name]]
            fan_start += SLOT_GAP if fan_start else 0.0
            x = max(x, start + own.row_left, fan_start + own.fan_left)
        for name in members[column]:
            own, row = extents[name], backbone.row[name]
            row_edge = max(row_edge, x + own.row_right)
            fan_edge[row] = max(fan_edge[row], x + own.fan_right)
        centres.append(x)
    return centres


def _row_centres(
    backbone: _Backbone,
    fans: Mapping[str, _Fan],
    sizes: Mapping[str, tuple[float, float]],
) -> list[float]:
    """Return y of each row, leaving room for the fans above and below it."""
    count = max(backbone.row.values()) + 1
    up, down = [0.0] * count, [0.0] * count
    for name, fan in fans.items():
        row = backbone.row[name]
        half = max(sizes[n][1] for n in (name, *fan.left, *fan.right)) / 2
        above = (FAN + sizes[n][1] / 2 for n in fan.above)
        below = (FAN + sizes[n][1] / 2 for n in fan.below)
        up[row] = max(up[row], half, *above)
        down[row] = max(down[row], half, *below)
    centres: list[float] = []
    edge = 0.0
    for row in range(count):
        centres.append(edge + up[row])
        edge = centres[-1] + down[row] + ROW_GAP
    return centres


def lay_out(graph: FinishedGraph, sizes: Mapping[str, tuple[float, float]]) -> Layout:
    """Return the place of every node.

    Parameters
    ----------
    graph
        Any finished graph: a chain, a tree, with rings, or in several pieces.
    sizes
        Width and height of every node's box, in pixels.
    """
    backbone = _Backbone(graph)
    sources = {n.name for n in graph.nodes if isinstance(n, EffortSource | FlowSource)}
    fans = {name: _fan(backbone, name, sources) for name in backbone.hosted}
    extents = {name: _extent(fan, name, sizes) for name, fan in fans.items()}
    xs = _column_centres(backbone, extents)
    ys = _row_centres(backbone, fans, sizes)
    boxes: dict[str, Box] = {}
    for name, fan in fans.items():
        x, y = xs[backbone.column[name]], ys[backbone.row[name]]
        boxes[name] = Box(x, y, *sizes[name])
        boxes.update(_fan_boxes(boxes[name], fan, sizes))
    return _on_sheet({node.name: boxes[node.name] for node in graph.nodes})


def _fan_boxes(
    centre: Box, fan: _Fan, sizes: Mapping[str, tuple[float, float]]
) -> Iterable[tuple[str, Box]]:
    for side, direction in ((fan.left, -1), (fan.right, 1)):
        for name in side:
            reach = centre.width / 2 + BOND + sizes[name][0] / 2
            yield name, Box(centre.x + direction * reach, centre.y, *sizes[name])
    for side, direction in ((fan.above, -1), (fan.below, 1)):
        left = centre.x + (_fan_span(fan, side, sizes)[0] if side else 0.0)
        for name in side:
            width, height = sizes[name]
            yield name, Box(left + width / 2, centre.y + direction * FAN, width, height)
            left += width + SLOT_GAP


def _on_sheet(boxes: Mapping[str, Box]) -> Layout:
    """Return the boxes moved to positive coordinates with a margin."""
    left = min(b.x - b.width / 2 for b in boxes.values()) - MARGIN
    top = min(b.y - b.height / 2 for b in boxes.values()) - MARGIN
    right = max(b.x + b.width / 2 for b in boxes.values()) + MARGIN
    bottom = max(b.y + b.height / 2 for b in boxes.values()) + MARGIN
    moved = {
        name: Box(b.x - left, b.y - top, b.width, b.height) for name, b in boxes.items()
    }
    return Layout(moved, right - left, bottom - top)
