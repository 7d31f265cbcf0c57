"""Strokes and what they force: a board with a work list and a trail.

Every kind of node allows a certain number of strokes: an effort source none, a flow
source one, a 0-junction and a transformer exactly one, a 1-junction all but one, a
gyrator none or both. A node is looked at only when one of its bonds gets a stroke, and
lists its bonds only once, when the rest is forced; so the cost is linear in bonds. The
trail lets a preference that fails be taken back.
"""

from collections import deque
from dataclasses import dataclass

from bondgraph.causality.records import CausalStep, CausalStroke, Rule
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Node,
    OneJunction,
    Transformer,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph

FREE = -1


@dataclass(frozen=True, slots=True)
class Conflict:
    """A node whose strokes cannot be right, and the bonds that say so."""

    node: int
    bonds: tuple[int, ...]


class StrokeBoard:
    """The strokes of a graph while they are being set.

    ``stroke[b]`` is the index of the node that receives effort on bond b, or FREE.
    """

    def __init__(self, graph: FinishedGraph) -> None:
        self.nodes = graph.nodes
        self.bonds = graph.bonds
        index = {node.name: i for i, node in enumerate(graph.nodes)}
        self.ends = [(index[b.tail], index[b.head]) for b in graph.bonds]
        self.at: list[list[int]] = [[] for _ in graph.nodes]
        for bond, (tail, head) in enumerate(self.ends):
            self.at[tail].append(bond)
            self.at[head].append(bond)
        self.stroke = [FREE] * len(graph.bonds)
        self.received = [0] * len(graph.nodes)
        self.open = [len(bonds) for bonds in self.at]
        self.trail: list[int] = []
        self.why: dict[int, tuple[Rule, int]] = {}
        self.visits = 0
        self._wanted = [
            _wanted(node, len(bonds))
            for node, bonds in zip(graph.nodes, self.at, strict=True)
        ]
        self._pending: deque[int] = deque()

    def other(self, bond: int, node: int) -> int:
        """Return the node at the other end of `bond`."""
        tail, head = self.ends[bond]
        return tail + head - node

    def set(self, bond: int, at: int, rule: Rule, because: int) -> None:
        """Put the stroke of `bond` at the node `at`, forced at node `because`."""
        self.stroke[bond] = at
        self.received[at] += 1
        self.trail.append(bond)
        self.why[bond] = (rule, because)
        for node in self.ends[bond]:
            self.open[node] -= 1
            self._pending.append(node)

    def undo(self, length: int) -> None:
        """Take back every stroke after the first `length`."""
        self._pending.clear()
        while len(self.trail) > length:
            bond = self.trail.pop()
            self.received[self.stroke[bond]] -= 1
            self.stroke[bond] = FREE
            del self.why[bond]
            for node in self.ends[bond]:
                self.open[node] += 1

    def propagate(self) -> Conflict | None:
        """Set every stroke that is forced; return the first conflict, if any."""
        while self._pending:
            node = self._pending.popleft()
            self.visits += 1
            if not self._force(node):
                return Conflict(node, tuple(b for b in self.at[node] if b in self.why))
        return None

    def _force(self, node: int) -> bool:
        """Set what node's constraint forces; return False if it cannot hold."""
        received, free = self.received[node], self.open[node]
        wanted = self._wanted[node]
        if wanted is None:
            return True
        if isinstance(self.nodes[node], Gyrator):
            if free != 1:
                return received != 1 or free > 0
            wanted = 2 * received
        if received > wanted or received + free < wanted:
            return False
        if free and received == wanted:
            self._fill(node, here=False)
        elif free and received + free == wanted:
            self._fill(node, here=True)
        return True

    def _fill(self, node: int, *, here: bool) -> None:
        kind = self.nodes[node]
        supplied = isinstance(kind, OneJunction) == here
        rule = Rule.SUPPLIED if supplied else Rule.LAST
        if isinstance(kind, Transformer | Gyrator):
            rule = Rule.TWO_PORT
        elif isinstance(kind, EffortSource | FlowSource):
            rule = Rule.SOURCE
        for bond in self.at[node]:
            if self.stroke[bond] == FREE:
                at = node if here else self.other(bond, node)
                self.set(bond, at, rule, node)

    def start(self, node: int) -> None:
        """Look at `node` although no bond of it has a stroke yet."""
        self._pending.append(node)

    def supplier(self, junction: int) -> int:
        """Return the bond that brings `junction` its common variable."""
        one = isinstance(self.nodes[junction], OneJunction)
        return next(
            b
            for b in self.at[junction]
            if self.stroke[b] != FREE and (self.stroke[b] == junction) != one
        )

    def supplies(self, bond: int, junction: int) -> bool:
        """Return whether `bond` brings `junction` its common variable."""
        one = isinstance(self.nodes[junction], OneJunction)
        return (self.stroke[bond] == junction) != one

    def stroke_of(self, bond: int) -> CausalStroke:
        """Return the stroke of `bond`."""
        return CausalStroke(self.bonds[bond], self.nodes[self.stroke[bond]].name)

    def step(self, bond: int, stroke: CausalStroke | None = None) -> CausalStep:
        """Return the stroke of `bond` with the rule that set it."""
        rule, because = self.why[bond]
        by = self.supplier(because) if rule is Rule.SUPPLIED else bond
        giver = self.nodes[self.other(by, because)].name
        stroke = stroke or self.stroke_of(bond)
        return CausalStep(stroke, rule, self.nodes[because], giver)

    def causes(self, bond: int) -> list[int]:
        """Return the bonds whose strokes forced that of `bond`."""
        rule, because = self.why[bond]
        if rule is Rule.SUPPLIED:
            return [self.supplier(because)]
        if rule in (Rule.LAST, Rule.TWO_PORT):
            return [b for b in self.at[because] if b != bond and b in self.why]
        return []

    def chain(self, conflict: Conflict) -> list[int]:
        """Return the bonds that led to `conflict`, in the order they were set."""
        seen: set[int] = set()
        pending = list(conflict.bonds)
        while pending:
            bond = pending.pop()
            if bond not in seen:
                seen.add(bond)
                pending.extend(self.causes(bond))
        return [bond for bond in self.trail if bond in seen]


def _wanted(node: Node, ports: int) -> int | None:
    """Return the number of strokes at `node`; None where more than one is right.

    A gyrator's number depends on its other port; 0 stands for it here.
    """
    match node:
        case EffortSource():
            return 0
        case FlowSource() | ZeroJunction() | Transformer():
            return 1
        case OneJunction():
            return ports - 1
        case Gyrator():
            return 0
        case _:
            return None
