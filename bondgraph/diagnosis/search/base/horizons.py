"""Over how long a recording is simulated from one state: to search, and at the end.

A search needs many windows, the parameters need long ones.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.evidence.left_out import LEAST_CHUNKS, MOST_CHUNKS
from bondgraph.diagnosis.search.base.short_runs import keeps_what_windows_show
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.automatic import remembered
from bondgraph.fitting.estimate import (
    FitSettings,
    FittedModel,
    accumulates,
    choose_horizon,
    first_guess,
    fit_model,
    prepare,
    weigh,
)
from bondgraph.fitting.horizon import (
    SHORTEST,
    Automatic,
    Horizon,
    WholeRecordings,
    Windows,
    cut,
)
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.long_runs import simulate_whole
from bondgraph.fitting.settling import settle
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.windows import windows
from bondgraph.structure.graph import FinishedGraph

SETTLE_ITERATIONS, ITERATIONS = 25, 60
SHORT_RUN = 8 * SHORTEST
"""Samples of a run that need not be cut where there are enough of them."""

SAME = 1.02
"""Errors within this factor are the same."""


def search_settings(
    graph: FinishedGraph, recordings: Sequence[BoundRecording], settings: FitSettings
) -> FitSettings:
    """Return the settings with a horizon for searching, where it is automatic.

    A plant on which errors accumulate is cut into as many windows as there are chunks:
    long enough that what is missing stands out of the noise, and independent, so that
    drift within one window says nothing about another. Many short runs, such as steps
    from rest, are windows as they are. An unstable plant is cut into more, over which a
    fit can hold on to it.
    """
    if not isinstance(settings.horizon, Automatic):
        return settings
    model = prepare(graph)
    horizon: Horizon = WholeRecordings()
    if accumulates(graph, model, recordings, settings):
        samples = max(_window(recordings), SHORTEST)
        horizon = Windows(remembered(graph, model, recordings, settings, samples))
    return replace(settings, horizon=horizon)


def _window(recordings: Sequence[BoundRecording]) -> int:
    """Return the samples of as many windows as there are chunks, or of short runs."""
    stretches = [len(window) for run in recordings for window in windows(run)]
    if len(stretches) >= LEAST_CHUNKS and max(stretches) <= SHORT_RUN:
        return max(stretches)
    return sum(len(recording) for recording in recordings) // MOST_CHUNKS


def sharpened(
    fitted: FittedModel,
    recordings: Sequence[BoundRecording],
    options: Options,
    base: FittedModel,
) -> FittedModel:
    """Return the final model refitted over the horizon that suits it.

    The search needs many windows; the parameters need windows over which measurement
    noise, not what still is left out, makes the residual. Where whole recordings are
    then simulated worse than before, where what its windows show is lost, or where the
    refit has not left its start because no simulation from there ends, the search's own
    fit is kept: it knows its numbers.

    Parameters
    ----------
    base
        The model without additions, fitted to the windows of the search.
    """
    settings = replace(
        options.settings, solver=fitted.problem.solver, hold=fitted.problem.hold
    )
    graph = fitted.graph.with_parameters(fitted.values)
    if isinstance(settings.horizon, Automatic):
        model = fitted.problem.model
        horizon = choose_horizon(graph, model, recordings, settings)
        settings = replace(settings, horizon=horizon)
    final = fit_model(graph, recordings, settings)
    if not np.isfinite(final.optimum.cost):
        return fitted
    before, after = (
        simulate_whole(one, recordings).score.nrmse for one in (fitted, final)
    )
    better = after <= SAME * before and keeps_what_windows_show(final, fitted, base)
    return final if better else fitted


def refitted(
    fitted: FittedModel, recordings: Sequence[BoundRecording], settings: FitSettings
) -> FittedModel:
    """Return the model fitted to recordings, from the values that it has at least.

    A fit that begins anew may end early where its values were hard to find, over a
    sharp edge for instance. So it is begun as well from the states that the model
    passes at the begin of each window when it runs through whole recordings, with the
    outputs weighed as they were: beside an angle of many turns and what it varies by,
    a pump's ripple is as good a turn further.
    """
    graph = fitted.graph.with_parameters(fitted.values)
    anew = fit_model(graph, recordings, settings)
    before = fitted.problem
    problem = replace(anew.problem, sigma=before.sigma, correlation=before.correlation)
    theta = np.array([fitted.values[name] for name in problem.free_names])
    whole = replace(problem, shots=cut(recordings, WholeRecordings()))
    if not np.array_equal(whole.shots.time, problem.shots.time):
        return anew  # Windows have left samples out.
    begin = first_guess(whole, theta)
    _, along = settle(whole, theta, begin, SETTLE_ITERATIONS)
    states = along.states[list(problem.shots.edges[:-1])]
    if not np.isfinite(states).all():
        return anew
    optimum = minimise(problem, theta, states, iterations=ITERATIONS)
    problem, optimum = weigh(problem, optimum, settings)
    known = replace(anew, problem=problem, optimum=optimum)
    return min((anew, known), key=_unlikely)


def _unlikely(fitted: FittedModel) -> float:
    """Return minus twice the logarithm of the likelihood, but for a constant."""
    problem = fitted.problem
    scales = 2.0 * float(problem.measured @ np.log(problem.sigma))
    return fitted.optimum.cost + scales
