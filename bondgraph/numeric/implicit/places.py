"""A graph as index arrays: which bond sits where, and with which sign.

Bond b has its effort in column b and its flow in column n_bonds + b. A port's own
variables follow its element's convention (power into an I, C or R, out of a source);
where the half arrow points the other way, the variable that the neighbouring junction
balances changes sign. Everything is computed for all nodes at once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from bondgraph.structure.elements import (
    Node,
    OneJunction,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph

Index = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Places:
    """The incidence of a graph.

    Parameters
    ----------
    kinds
        Each kind of node in the graph, and for every node the number of its kind.
    bond_at, towards
        The bonds at node i are ``bond_at[first[i]:first[i + 1]]``, in the author's
        order; ``towards`` is 1 where the half arrow points to the node, else -1.
    beside_zero
        Aligned with ``bond_at``: whether the node at the other end is a 0-junction.
    wire
        For every effort and flow column the number of its wire: efforts at one
        0-junction are one wire, and flows at one 1-junction.
    """

    graph: FinishedGraph
    index: dict[str, int]
    kinds: tuple[type[Node], ...]
    kind: Index
    first: Index
    bond_at: Index
    towards: Index
    beside_zero: NDArray[np.bool_]
    wire: Index
    n_wires: int

    @property
    def n_bonds(self) -> int:
        """Number of bonds."""
        return len(self.wire) // 2

    def owners(self, incidences: Index) -> Index:
        """Return the node of each incidence."""
        found: Index = np.searchsorted(self.first, incidences, side="right") - 1
        return found

    def of_kind(self, *kinds: type[Node]) -> Index:
        """Return the numbers of the nodes of these kinds, in the author's order."""
        wanted = [k for k, kind in enumerate(self.kinds) if kind in kinds]
        found: Index = np.flatnonzero(np.isin(self.kind, wanted))
        return found

    def port_signs(
        self, incidence: Index, *, outward: bool = False
    ) -> tuple[Index, Index]:
        """Return the signs of a port's own effort and flow against its bond's."""
        sign = -self.towards[incidence] if outward else self.towards[incidence]
        beside_zero = self.beside_zero[incidence]
        return np.where(beside_zero, 1, sign), np.where(beside_zero, sign, 1)

    def bond_label(self, bond: int) -> str:
        """Return the name of the one-port at a bond, else both its ends."""
        ends = self.graph.bonds[bond]
        for end in (ends.tail, ends.head):
            i = self.index[end]
            junction = self.kinds[self.kind[i]] in {ZeroJunction, OneJunction}
            if self.first[i + 1] - self.first[i] == 1 and not junction:
                return end
        return f"{ends.tail}_{ends.head}"


def places_of(graph: FinishedGraph) -> Places:
    """Return the incidence of `graph`; cost linear in its size."""
    n_nodes, n_bonds = len(graph.nodes), len(graph.bonds)
    index = {node.name: i for i, node in enumerate(graph.nodes)}
    types = [type(node) for node in graph.nodes]
    kinds = tuple(dict.fromkeys(types))
    code = {kind: k for k, kind in enumerate(kinds)}
    kind = np.fromiter((code[t] for t in types), np.int64, n_nodes)
    ends = np.empty((n_bonds, 2), np.int64)
    ends[:, 0] = [index[bond.tail] for bond in graph.bonds]
    ends[:, 1] = [index[bond.head] for bond in graph.bonds]
    order = np.argsort(ends.ravel(), kind="stable")
    first = np.zeros(n_nodes + 1, np.int64)
    np.cumsum(np.bincount(ends.ravel(), minlength=n_nodes), out=first[1:])
    bond_at, at_head = np.divmod(order, 2)
    towards = 2 * at_head - 1
    other = ends[bond_at, 1 - at_head]

    def is_kind(*wanted: type[Node]) -> NDArray[np.bool_]:
        return np.array([k in wanted for k in kinds], bool)[kind]

    zero, one = is_kind(ZeroJunction), is_kind(OneJunction)
    node_at = ends.ravel()[order]
    wire, n_wires = _wires(bond_at, node_at, (zero, one), n_bonds)
    return Places(
        graph=graph,
        index=index,
        kinds=kinds,
        kind=kind,
        first=first,
        bond_at=bond_at,
        towards=towards,
        beside_zero=zero[other],
        wire=wire,
        n_wires=n_wires,
    )


def _wires(
    bond_at: Index,
    node_at: Index,
    junctions: tuple[NDArray[np.bool_], NDArray[np.bool_]],
    n_bonds: int,
) -> tuple[Index, int]:
    """Return the wire of every effort and flow column, and how many there are."""
    rows, columns = [], []
    starts = np.flatnonzero(np.diff(node_at, prepend=-1))
    leader = np.repeat(starts, np.diff(starts, append=len(node_at)))
    for offset, junction in zip((0, n_bonds), junctions, strict=True):
        here = np.flatnonzero(junction[node_at])
        rows.append(offset + bond_at[leader[here]])
        columns.append(offset + bond_at[here])
    pairs = (np.concatenate(rows), np.concatenate(columns))
    links = coo_array(
        (np.ones(len(pairs[0]), np.int8), pairs), shape=(2 * n_bonds, 2 * n_bonds)
    )
    n_wires, wire = connected_components(links, directed=False)
    return wire.astype(np.int64), int(n_wires)
