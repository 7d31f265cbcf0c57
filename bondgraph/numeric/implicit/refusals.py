"""Refusals of the implicit route, in the words of the graph."""

from typing import NoReturn

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bondgraph.errors import EquationError
from bondgraph.numeric.implicit.system import ImplicitSystem
from bondgraph.structure.elements import EffortSource, FlowSource, letter

Index = NDArray[np.int64]

MOST_NAMED = 12


def refuse_conflict(
    system: ImplicitSystem, owners: Index, sources: csr_array
) -> NoReturn:
    """Refuse rows that would fix what sources impose."""
    nodes = system.places.graph.nodes
    own = [nodes[i] for i in np.unique(owners).tolist()]
    imposed = [n for n in own if isinstance(n, EffortSource | FlowSource)]
    named = _named([f"{letter(n)} {n.name!r}" for n in imposed or own])
    raise EquationError(
        f"Sources of {system.name!r} contradict each other: {named}.",
        tuple(n.name for n in imposed or own),
        "Remove one of them, or put an R or a storage between them.",
    )


def refuse_undetermined(system: ImplicitSystem, columns: Index) -> NoReturn:
    """Refuse efforts and flows that nothing determines."""
    bonds = system.places.graph.bonds
    n = len(bonds)
    found = np.flatnonzero(np.isin(system.columns, columns))
    words = [
        f"the {'effort' if k < n else 'flow'} of bond {bonds[k % n].name!r}"
        for k in found.tolist()
    ]
    raise EquationError(
        f"{system.name!r} does not determine {_named(words)}.",
        tuple(dict.fromkeys(bonds[k % n].name for k in found.tolist())),
        "A constraint is given twice or a ring has unit gain: remove one of the "
        "elements there, or put an R or a storage between them.",
    )


def refuse_input_rate(system: ImplicitSystem, owners: Index) -> NoReturn:
    """Refuse a storage that would need the second derivative of an input."""
    nodes = system.places.graph.nodes
    own = [nodes[i] for i in np.unique(owners).tolist()]
    named = _named([f"{letter(n)} {n.name!r}" for n in own])
    raise EquationError(
        f"The equations of {system.name!r} need the second derivative of an input, "
        f"through {named}.",
        tuple(n.name for n in own),
        "Put an R or a C (an I) between the source and the storages.",
    )


def refuse_kink(system: ImplicitSystem, rows: Index) -> None:
    """Refuse a point where the laws of these rows, if any, have no slope."""
    if len(rows):
        nodes = system.places.graph.nodes
        names = tuple(nodes[i].name for i in np.unique(system.owners[rows]))
        raise EquationError(
            f"The law of {', '.join(names[:6])} has no value or no "
            f"derivative at this point.",
            names,
            "Choose a point away from the kink or pole of the law.",
        )


def _named(words: list[str]) -> str:
    more = len(words) - MOST_NAMED
    return ", ".join(words[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
