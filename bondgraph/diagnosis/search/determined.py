"""Whether the data determine what a hypothesis adds.

A law whose own numbers nothing determines explains the data by something else that it
can also be: hysteresis over a distance never travelled is a spring. It is left aside in
favour of what it stands for.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.search.candidates import Candidate, Rejected
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.uncertainty import uncertainty

REASON = "these recordings do not determine its parameters"


def undetermined_directions(fitted: FittedModel) -> int:
    """Return how many combinations of the parameters the recordings say nothing of."""
    return len(uncertainty(fitted.problem, fitted.optimum).null)


def determined(
    base: FittedModel, candidates: Sequence[Candidate]
) -> tuple[list[Candidate], tuple[Rejected, ...]]:
    """Return the candidates that add nothing undetermined, and the others."""
    if not candidates:
        return [], ()
    known = undetermined_directions(base)
    kept: list[Candidate] = []
    others: list[Rejected] = []
    for candidate in candidates:
        if undetermined_directions(candidate.fitted) > known:
            others.append(Rejected(candidate.hypothesis, REASON))
        else:
            kept.append(candidate)
    return kept, tuple(others)
