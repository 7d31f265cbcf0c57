"""Over how long a recording is simulated from one state: to search, and at the end.

A search needs many windows, the parameters need long ones.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.answer.showing import simulate_whole
from bondgraph.diagnosis.evidence.left_out import MOST_CHUNKS
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.automatic import remembered
from bondgraph.fitting.estimate import (
    FitSettings,
    FittedModel,
    accumulates,
    choose_horizon,
    fit_model,
    prepare,
)
from bondgraph.fitting.horizon import (
    SHORTEST,
    Automatic,
    Horizon,
    WholeRecordings,
    Windows,
)
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

SAME = 1.02
"""Errors within this factor are the same."""


def search_settings(
    graph: FinishedGraph, recordings: Sequence[BoundRecording], settings: FitSettings
) -> FitSettings:
    """Return the settings with a horizon for searching, where it is automatic.

    A plant on which errors accumulate is cut into as many windows as there are chunks:
    long enough that what is missing stands out of the noise, and independent, so that
    drift within one window says nothing about another. An unstable plant is cut into
    more, over which a fit can hold on to it.
    """
    if not isinstance(settings.horizon, Automatic):
        return settings
    model = prepare(graph)
    horizon: Horizon = WholeRecordings()
    if model.n_states and accumulates(graph, model, recordings, settings):
        samples = sum(len(recording) for recording in recordings) // MOST_CHUNKS
        samples = max(samples, SHORTEST)
        horizon = Windows(remembered(graph, model, recordings, settings, samples))
    return replace(settings, horizon=horizon)


def sharpened(
    fitted: FittedModel, recordings: Sequence[BoundRecording], options: Options
) -> FittedModel:
    """Return the final model refitted over the horizon that suits it.

    The search needs many windows; the parameters need windows over which measurement
    noise, not what still is left out, makes the residual. Where whole recordings are
    then simulated worse than before, or the refit has not left its start because no
    simulation from there ends, the search's own fit is kept: it knows its numbers.
    """
    settings = replace(
        options.settings, solver=fitted.problem.solver, hold=fitted.problem.hold
    )
    graph = fitted.graph.with_parameters(fitted.values)
    if isinstance(settings.horizon, Automatic):
        model = fitted.problem.model
        horizon = choose_horizon(graph, model, recordings, settings)
        settings = replace(settings, horizon=horizon)
    refitted = fit_model(graph, recordings, settings)
    if not np.isfinite(refitted.optimum.cost):
        return fitted
    before, after = (
        simulate_whole(one, recordings).score.nrmse for one in (fitted, refitted)
    )
    return refitted if after <= SAME * before else fitted
