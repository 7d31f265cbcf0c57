"""Structural isolability: which missing signals break different redundancies.

The equations are a bipartite graph of equations and unknowns; each virtual source adds
the equation that it is zero. Where there are more equations than unknowns (the over-
determined part of the Dulmage-Mendelsohn decomposition) lie all analytical redundancy
relations. A place is detectable if its equation lies there; it is isolable from another
if it still does when the other's equation is taken away (Krysander and Frisk, "Sensor
Placement for Fault Diagnosis", IEEE Trans. SMC A 38, 2008).
"""

from collections.abc import Sequence

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.diagnosis.virtual.sources import VirtualSource, equations_with_sources
from bondgraph.equations.state_equations import StateEquations
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import parameter_symbol

Incidence = NDArray[np.bool_]


def isolability(
    graph: FinishedGraph, sources: Sequence[VirtualSource]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which places are detectable, and which from which isolable.

    Returns
    -------
    detectable, isolable
        (L,) and (L, L); ``isolable[i, j]`` says that i can be told from j.
    """
    incidence = _incidence(equations_with_sources(graph, sources), sources)
    first = incidence.shape[0] - len(sources)
    mine = first + np.arange(len(sources))
    detectable = overdetermined(incidence)[mine]
    isolable = np.zeros((len(sources), len(sources)), dtype=bool)
    for j, row in enumerate(mine):
        kept = incidence.copy()
        kept[row] = False
        isolable[:, j] = overdetermined(kept)[mine]
    return detectable, isolable


def overdetermined(incidence: Incidence) -> NDArray[np.bool_]:
    """Return which equations (rows) lie in the over-determined part.

    Those that an alternating path reaches from an equation that a largest matching
    leaves out. Empty rows are no equations.
    """
    from scipy.sparse import csr_array  # noqa: PLC0415
    from scipy.sparse.csgraph import maximum_bipartite_matching  # noqa: PLC0415

    column_of = maximum_bipartite_matching(csr_array(incidence), perm_type="column")
    row_of = np.full(incidence.shape[1], -1)
    matched = np.flatnonzero(column_of >= 0)
    row_of[column_of[matched]] = matched
    pending = [int(i) for i in np.flatnonzero(column_of < 0) if incidence[i].any()]
    reached = np.zeros(len(incidence), dtype=bool)
    while pending:
        row = pending.pop()
        if reached[row]:
            continue
        reached[row] = True
        following = row_of[np.flatnonzero(incidence[row])]
        pending.extend(int(r) for r in following if r >= 0)
    return reached


def _incidence(
    equations: StateEquations, sources: Sequence[VirtualSource]
) -> Incidence:
    """Return which equation has which unknown; the sources' equations come last."""
    values = [parameter_symbol(source.parameter) for source in sources]
    states = [s.symbol for s in equations.states]
    rates = [s.rate for s in equations.states]
    assigned = [a.symbol for a in equations.assignments]
    unknowns = [*states, *rates, *equations.unknowns, *assigned, *values]
    index = {symbol: i for i, symbol in enumerate(unknowns)}
    rows: list[set[sympy.Symbol]] = [
        {a.symbol} | a.expression.free_symbols for a in equations.assignments
    ]
    pairs = zip(rates, equations.rates, strict=True)
    rows += [{rate} | expression.free_symbols for rate, expression in pairs]
    rows += [{x, rate} for x, rate in zip(states, rates, strict=True)]
    rows += [residual.free_symbols for residual in equations.residuals]
    rows += [output.expression.free_symbols for output in equations.outputs]
    rows += [{value} for value in values]
    incidence = np.zeros((len(rows), len(unknowns)), dtype=bool)
    for i, symbols in enumerate(rows):
        for symbol in symbols:
            if symbol in index:
                incidence[i, index[symbol]] = True
    return incidence
