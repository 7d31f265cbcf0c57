"""From a graph and windows of recordings to a least-squares problem."""

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bondgraph.equations.deriving.derivation import derive
from bondgraph.errors import FitError
from bondgraph.fitting.natural_bounds import bounds_by_name
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.settings import FitSettings
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.recordings.spread import size
from bondgraph.simulation.engines import PAYING
from bondgraph.simulation.shooting import Shots
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
KEPT = 256
"""Of how many graphs the numeric form is kept: each is posed again and again."""


def prepare(graph: FinishedGraph) -> NumericModel:
    """Return the numeric form of a graph; graphs with equal equations share it."""
    return _prepared(_Asked.of(graph))


@dataclass(frozen=True, slots=True)
class _Asked:
    """A graph, compared by what its equations follow from: how sure numbers are is not.

    Their signs and bounds are: they choose the branch of a law that is inverted.
    """

    told: tuple[object, ...]
    graph: FinishedGraph = field(compare=False)

    @classmethod
    def of(cls, graph: FinishedGraph) -> "_Asked":
        """Return a graph with what it is compared by."""
        parameters = tuple(
            (p.name, p.unit, p.value, p.bounds) for p in graph.parameters.members
        )
        structure = (graph.name, graph.nodes, graph.bonds, graph.domains)
        return cls(
            (*structure, graph.measurements, graph.preferences, parameters), graph
        )


@lru_cache(maxsize=KEPT)
def _prepared(asked: _Asked) -> NumericModel:
    return compile_model(derive(asked.graph))


def pose(
    graph: FinishedGraph,
    model: NumericModel,
    shots: Shots,
    settings: FitSettings,
    sigma: Array | None = None,
) -> FitProblem:
    """Return the least-squares problem of fitting `graph` to windows of recordings.

    Parameters
    ----------
    sigma
        Residual scale per output; the outputs' standard deviations when None.

    Raises
    ------
    FitError
        If the model measures nothing, or as many states as it measures are free in
        every row of a steady table.
    """
    if not model.output_names:
        raise FitError(
            f"{graph.name!r} measures nothing.",
            (graph.name,),
            'Add an output with measure("name", displacement="junction").',
        )
    if shots.timeless and 0 < len(model.output_names) <= model.n_states:
        _refuse_free_rows(graph, model)
    values = graph.parameters.values_by_name()
    members = [graph.parameters[name] for name in model.parameter_names]
    free = [i for i, member in enumerate(members) if not member.exact]
    bounds = bounds_by_name(graph)
    if sigma is None:
        sigma = size(shots.outputs)
    return FitProblem(
        model=model,
        shots=shots,
        start=np.array([values[name] for name in model.parameter_names], dtype=float),
        free=np.array(free, dtype=np.int64),
        low=np.array([bounds[member.name][0] for member in members]),
        high=np.array([bounds[member.name][1] for member in members]),
        prior_std=np.array([member.std or math.inf for member in members]),
        sigma=sigma,
        solver=settings.solver,
        hold=settings.hold,
        loss=settings.loss,
        correlation=np.zeros(len(model.output_names)),
        engine=PAYING.for_parts_of(len(shots.time)),
    )


def _refuse_free_rows(graph: FinishedGraph, model: NumericModel) -> None:
    """Refuse a table each of whose rows a state of its own would explain."""
    states, outputs = model.state_names, model.output_names
    raise FitError(
        f"{graph.name!r} stores {', '.join(states)}: a state of its own in every row "
        f"of a steady table explains whatever {', '.join(outputs)} may be.",
        (graph.name, *states),
        "Leave out what stores: where nothing changes with time it takes up nothing.",
    )
