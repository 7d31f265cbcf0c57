"""How well a model does over far longer than a window, from one initial state.

Over whole recordings, where these mean something. A machine that is free to turn, or
that integrates in another way, drifts off over a whole recording whatever it is made
of: there stretches of several windows speak.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.fitting.automatic import accumulates
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.long_runs import simulate_stretches, simulate_whole
from bondgraph.recordings.binding import BoundRecording

WINDOWS = 8
"""So many windows are a stretch."""


def stretch(base: FittedModel, recordings: Sequence[BoundRecording]) -> int | None:
    """Return over how many samples models are compared; None for whole recordings."""
    problem = base.problem
    there = base.graph.with_parameters(base.values)
    if not accumulates(there, problem.model, recordings, base.settings):
        return None
    return WINDOWS * int(problem.shots.lengths.max())


def long_error(
    fitted: FittedModel, recordings: Sequence[BoundRecording], samples: int | None
) -> float:
    """Return the error (nrmse) over stretches of so many samples, or over recordings.

    Infinite where these cannot be simulated.
    """
    if samples is None:
        simulated = simulate_whole(fitted, recordings)
    else:
        simulated = simulate_stretches(fitted, recordings, samples)
    error = simulated.score.nrmse
    return error if simulated.whole and np.isfinite(error) else np.inf
