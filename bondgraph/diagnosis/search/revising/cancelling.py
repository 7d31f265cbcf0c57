"""Cancelling: two laws at one place that leave next to nothing of each other.

Two odd functions of one variable, each a thousand times as large as what is missing,
make any curve between them: a weight and a hardening spring that cancel are the first
terms of a series, and neither is there.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.probing import probe
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.structure.domains import Quantity
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import EffortSource, FlowSource, OneJunction
from bondgraph.structure.signals import Signal

CANCELS = 0.1
"""Of the larger one, what two laws together may leave at least: two that are both there
and work against each other somewhere do not all the time.
"""


def cancelled(fitted: FittedModel, kept: Sequence[Hypothesis]) -> Hypothesis | None:
    """Return an earlier law at the place of the last one that it cancels, if any.

    Parameters
    ----------
    fitted
        The model that has all of `kept`.
    """
    *earlier, last = kept
    if not isinstance(last.edit, InsertElement):
        return None
    beside = [
        one
        for one in earlier
        if one.place == last.place and isinstance(one.edit, InsertElement)
    ]
    if not beside:
        return None
    own, *others = (_given(fitted, one) for one in (last, *beside))
    for one, other in zip(beside, others, strict=True):
        if _size(own + other) < CANCELS * max(_size(own), _size(other)):
            return one
    return None


def _given(fitted: FittedModel, law: Hypothesis) -> NDArray[np.float64]:
    """Return what a law's element takes at its junction, as simulated."""
    is_one = isinstance(fitted.graph.node(law.place), OneJunction)
    answer = Signal(Quantity.EFFORT if is_one else Quantity.FLOW, law.element)
    gives = isinstance(fitted.graph.node(law.element), EffortSource | FlowSource)
    return (-1.0 if gives else 1.0) * probe(fitted, (answer,))[answer]


def _size(values: NDArray[np.float64]) -> float:
    told = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(told**2))) if told.size else np.inf
