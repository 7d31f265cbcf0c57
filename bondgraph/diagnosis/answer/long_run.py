"""Whether whole recordings agree with what their windows say.

The initial state of every window is free, and takes what acts more slowly than a window
lasts. A model that leaves only noise over each of them may be far off over a recording,
whatever values its parameters have: then nobody can say that nothing is missing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from bondgraph.diagnosis.evidence.leftover import (
    SLOWLY,
    residual_over_noise,
    residual_over_spread,
    too_large,
)
from bondgraph.diagnosis.records import Comparison
from bondgraph.fitting.estimate import FittedModel, fit_model
from bondgraph.fitting.horizon import WholeRecordings, Windows
from bondgraph.fitting.long_runs import goes_on_growing
from bondgraph.recordings.binding import BoundRecording

LOST = 1.0
"""A model that misses as much as there is to be seen is lost."""


def off_in_the_long_run(
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    floor: Mapping[str, float],
) -> str | None:
    """Return what to say where only windows are explained, and not recordings.

    A plant on which the least disturbance goes on growing says nothing in the long run.
    """
    if not isinstance(base.horizon, Windows) or goes_on_growing(base, recordings):
        return None
    settings = replace(base.settings, horizon=WholeRecordings())
    graph = base.graph.with_parameters(base.values)
    whole = fit_model(graph, recordings, settings)
    worst = too_large(whole, floor, SLOWLY)
    if worst is None:
        return None
    share, ratio = residual_over_spread(whole), residual_over_noise(whole, floor)
    return (
        f"Over windows of {_seconds(base):.3g} s, each from a state of its own, the "
        "model leaves hardly more than noise. But over whole recordings, refitted to "
        f"them, it misses {worst} by {100 * share[worst]:.2g} % of what it varies by, "
        f"{ratio[worst]:.1f} times its noise: a slow disturbance that was not "
        "recorded, or slow physics that no law tried here describes."
    )


def lost_over_whole(
    final: FittedModel, recordings: Sequence[BoundRecording], trained: Comparison
) -> tuple[str, ...]:
    """Return a note on an unstable plant, of which whole recordings tell nothing.

    Parameters
    ----------
    trained
        Whole training recordings, before and after.
    """
    windowed = isinstance(final.horizon, Windows)
    if (
        not windowed
        or trained.after.nrmse < LOST
        or not goes_on_growing(final, recordings)
    ):
        return ()
    return (
        "In this model the least disturbance goes on growing: without the machine's "
        "controller no whole recording can be simulated, and the errors over whole "
        f"recordings say nothing. It is judged over windows of {_seconds(final):.3g} "
        "s, each from a state of its own.",
    )


def _seconds(base: FittedModel) -> float:
    """Return how long the longest window lasts."""
    time, edges = base.problem.shots.time, base.problem.shots.edges
    return max(float(time[stop - 1] - time[start]) for start, stop in pairwise(edges))
