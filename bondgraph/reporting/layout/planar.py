"""A drawing without lengths: which bonds follow each other around every node.

Nodes are numbers. Bond k has two darts, 2k along it and 2k + 1 against it; around each
node its outgoing darts are listed counterclockwise. That is all a planar drawing is
before it has shape and size. Where the graph cannot be drawn without crossings, a
crossing becomes a node of its own, so that everything after may believe in planarity.
"""

from collections import deque
from collections.abc import Iterable, Sequence
from typing import Any

Edge = tuple[int, int]


class PlanarMap:
    """Nodes, darts, and the order of the darts around each node.

    Attributes
    ----------
    origin
        The node each dart leaves.
    around
        For each node its outgoing darts, counterclockwise.
    bond
        For each edge, what it is part of (pieces of a crossed bond share it).
    """

    def __init__(self, size: int) -> None:
        self.origin: list[int] = []
        self.around: list[list[int]] = [[] for _ in range(size)]
        self.bond: list[int | None] = []

    def add_node(self) -> int:
        """Add a node and return it."""
        self.around.append([])
        return len(self.around) - 1

    def new_edge(self, tail: int, head: int, bond: int | None) -> int:
        """Add an edge and return its dart along; the caller puts it in order."""
        self.origin += [tail, head]
        self.bond.append(bond)
        return len(self.origin) - 2

    def head(self, dart: int) -> int:
        """Return the node a dart leads to."""
        return self.origin[dart ^ 1]

    def following(self) -> list[int]:
        """Return, for every dart, the next one along the face on its left."""
        result = [0] * len(self.origin)
        for darts in self.around:
            for k, dart in enumerate(darts):
                result[dart ^ 1] = darts[k - 1]
        return result

    def faces(self) -> list[list[int]]:
        """Return the darts of every face, the face being on their left."""
        following = self.following()
        seen = [False] * len(following)
        faces = []
        for start in range(len(following)):
            face = []
            dart = start
            while not seen[dart]:
                seen[dart] = True
                face.append(dart)
                dart = following[dart]
            if face:
                faces.append(face)
        return faces

    def cut(self, dart: int) -> int:
        """Put a node on an edge and return it; `dart` now ends there."""
        middle = self.add_node()
        head = self.head(dart)
        rest = self.new_edge(middle, head, self.bond[dart >> 1])
        self.origin[dart ^ 1] = middle
        darts = self.around[head]
        darts[darts.index(dart ^ 1)] = rest ^ 1
        self.around[middle] = [dart ^ 1, rest]
        return middle


def planar_map(size: int, edges: Sequence[Edge]) -> PlanarMap:
    """Return a map of a simple graph; nodes after its own are crossings.

    Bonds that would have to cross others are few in a bond graph: the largest part
    without them is drawn first, and each of the rest takes the way that crosses least.
    """
    if not edges:
        return PlanarMap(size)
    kept, crossing = _planar_part(size, edges)
    rotation = _embedding(size, [edges[k] for k in kept])
    graph = PlanarMap(size)
    dart_of: dict[Edge, int] = {}
    for k in kept:
        tail, head = edges[k]
        dart = graph.new_edge(tail, head, k)
        dart_of[tail, head], dart_of[head, tail] = dart, dart ^ 1
    for node, others in enumerate(rotation):
        graph.around[node] = [dart_of[node, other] for other in others]
    for k in crossing:
        _insert(graph, edges[k], k)
    return graph


def _planar_part(size: int, edges: Sequence[Edge]) -> tuple[list[int], list[int]]:
    """Return the indices of edges that are drawn without crossings, and the rest."""
    everything = list(range(len(edges)))
    if _is_planar(size, edges):
        return everything, []
    tree = _spanning_tree(size, edges)
    kept, rest = list(tree), []
    chunks = deque([[k for k in everything if k not in set(tree)]])
    while chunks:
        chunk = chunks.popleft()
        if _is_planar(size, [edges[k] for k in (*kept, *chunk)]):
            kept += chunk
        elif len(chunk) == 1:
            rest += chunk
        else:
            half = len(chunk) // 2
            chunks.extendleft((chunk[half:], chunk[:half]))
    return kept, rest


def _spanning_tree(size: int, edges: Sequence[Edge]) -> list[int]:
    root = list(range(size))

    def find(node: int) -> int:
        while root[node] != node:
            root[node] = root[root[node]]
            node = root[node]
        return node

    tree = []
    for k, (tail, head) in enumerate(edges):
        one, other = find(tail), find(head)
        if one != other:
            root[one] = other
            tree.append(k)
    return tree


def _is_planar(size: int, edges: Iterable[Edge]) -> bool:
    import networkx  # noqa: PLC0415  (0.2 s, needed for rings only)

    graph: Any = networkx.Graph()
    graph.add_nodes_from(range(size))
    graph.add_edges_from(edges)
    return bool(networkx.check_planarity(graph)[0])


def _embedding(size: int, edges: Iterable[Edge]) -> list[list[int]]:
    """Return the neighbours of each node, counterclockwise."""
    import networkx  # noqa: PLC0415

    graph: Any = networkx.Graph()
    graph.add_nodes_from(range(size))
    graph.add_edges_from(edges)
    embedding: Any = networkx.check_planarity(graph)[1]
    return [list(embedding.neighbors_cw_order(n))[::-1] for n in range(size)]


def _insert(graph: PlanarMap, edge: Edge, bond: int | None) -> None:
    """Draw one more edge across as few others as possible."""
    tail, head = edge
    faces = graph.faces()
    face_of = {dart: k for k, face in enumerate(faces) for dart in face}
    crossed = _way_between(graph, faces, face_of, edge)
    here = tail
    for dart in crossed:
        middle = graph.cut(dart)
        _connect(graph, here, middle, bond)
        here = middle
    _connect(graph, here, head, bond)


def _way_between(
    graph: PlanarMap,
    faces: Sequence[Sequence[int]],
    face_of: dict[int, int],
    edge: Edge,
) -> list[int]:
    """Return the darts to cross, from a face at the tail to one at the head."""
    tail, head = edge
    goals = {face_of[dart] for dart in graph.around[head]}
    came: dict[int, tuple[int, int] | None] = {
        face_of[dart]: None for dart in graph.around[tail]
    }
    queue = deque(came)
    while queue:
        face = queue.popleft()
        if face in goals:
            crossed = []
            step = came[face]
            while step is not None:
                crossed.append(step[1])
                step = came[step[0]]
            return crossed[::-1]
        for dart in faces[face]:
            beyond = face_of[dart ^ 1]
            if beyond not in came:
                came[beyond] = (face, dart)
                queue.append(beyond)
    raise AssertionError("a connected map has a way from every face to every other")


def _connect(graph: PlanarMap, tail: int, head: int, bond: int | None) -> None:
    """Add an edge inside a face that both nodes are on."""
    following = graph.following()
    for start in graph.around[tail]:
        dart = start
        while True:
            if graph.origin[dart] == head:
                new = graph.new_edge(tail, head, bond)
                _put_before_left(graph, start, new)
                _put_before_left(graph, dart, new ^ 1)
                return
            dart = following[dart]
            if dart == start:
                break
    raise AssertionError("both ends of a piece lie on one face")


def _put_before_left(graph: PlanarMap, dart: int, new: int) -> None:
    """Put `new` into the corner on the left of an outgoing `dart`."""
    darts = graph.around[graph.origin[dart]]
    darts.insert(darts.index(dart) + 1, new)
