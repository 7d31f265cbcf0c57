"""Which stored quantities are states where not all can be.

In the author's order, after the author's wishes; but a storage whose law has no inverse
is sooner a state than one that can easily follow others.
"""

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.implicit.system import ImplicitSystem
from bondgraph.structure import signals
from bondgraph.structure.elements import Compliance, Inertance, Node
from bondgraph.structure.fields import StorageField
from bondgraph.structure.graph import Wanted
from bondgraph.structure.relations import inverse

Index = NDArray[np.int64]

WISHED, NO_INVERSE, INVERTIBLE, LINEAR, UNWISHED = range(5)


def dependent_first(system: ImplicitSystem) -> Index:
    """Return all stored quantities, those first that may become dependent first."""
    n, n_storages = system.n_states, system.n_storages
    rank = np.full(n, LINEAR)
    rank[n_storages:] = WISHED  # an integral that a signal reads is always a state
    nodes = system.places.graph.nodes
    owners = system.storage_owners
    bent = np.zeros(len(nodes), bool)
    for group in system.laws:
        if not group.linear:
            bent[system.owners[group.rows]] = True
    for k in np.flatnonzero(bent[owners]).tolist():
        rank[k] = _rank(nodes[owners[k]])
    for k, wanted in _wishes(system):
        rank[k] = WISHED if wanted else UNWISHED
    order: Index = np.lexsort((-np.arange(n), -rank))
    return order


def _rank(node: Node) -> int:
    if not isinstance(node, Inertance | Compliance):
        return NO_INVERSE
    relation = node.relation
    stored = signals.p if isinstance(node, Inertance) else signals.q
    if relation.output == stored:
        return INVERTIBLE
    found = inverse(relation.expression, relation.argument, relation.output)
    return NO_INVERSE if found is None else INVERTIBLE


def _wishes(system: ImplicitSystem) -> list[tuple[int, bool]]:
    """Return the storages that the author has a wish for: whether to be a state."""
    graph = system.places.graph
    if not graph.preferences:
        return []
    wanted = {p.element: p.wanted for p in graph.preferences}
    found = []
    owners = system.storage_owners
    for k, i in enumerate(owners.tolist()):
        node = graph.nodes[i]
        momentum = system.state_names[k].startswith("p_")
        port = system.storages[k] - system.places.first[i] + 1
        name = node.port(int(port)) if isinstance(node, StorageField) else node.name
        integral = Wanted.GIVES_FLOW if momentum else Wanted.GIVES_EFFORT
        if name in wanted:
            found.append((k, wanted[name] in {Wanted.INTEGRAL, integral}))
    return found
