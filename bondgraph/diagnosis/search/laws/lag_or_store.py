"""A lag of an input, or a store where it enters: to most sensors they are one.

What an input gives fills a store first and passes on late. But the promise of a store
that the model does not have says little: next to none is filled within a sample, and
one of some size changes what all other numbers are. So where one of the two leads the
other is fitted as well, whatever it has promised.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import Candidate, leading
from bondgraph.diagnosis.search.trials.trying import Trial
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.dynamics import Lag
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.structure.edits import InsertElement, WrapInput
from bondgraph.structure.elements import Compliance, Inertance
from bondgraph.structure.graph import FinishedGraph


def lag_or_store(
    base: FittedModel,
    candidates: Sequence[Candidate],
    hypotheses: Sequence[Hypothesis],
) -> list[Trial]:
    """Return the fits of stores where the leading lag enters, or the other way round.

    Parameters
    ----------
    base
        The model without them.
    hypotheses
        All that was proposed.
    """
    best = leading(candidates)
    met = None if best is None else _meets(base.graph, best.hypothesis)
    if best is None or met is None:
        return []
    kept = {id(one.hypothesis) for one in candidates}
    return [
        Trial(one)
        for one in hypotheses
        if id(one) not in kept
        and type(one.edit) is not type(best.hypothesis.edit)
        and _meets(base.graph, one) == met
    ]


def _meets(graph: FinishedGraph, law: Hypothesis) -> str | None:
    """Return the junction where a lagging input or a store is; None of other laws."""
    edit = law.edit
    if isinstance(edit, WrapInput) and law.physics == Lag.word:
        (bond,) = graph.bonds_at(edit.input)
        return bond.other(edit.input)
    stores = isinstance(edit, InsertElement) and isinstance(
        edit.element, Compliance | Inertance
    )
    return law.place if stores else None
