"""A first look over windows, or over shorter ones where no one law explains those.

A rotor that its own detents catch now here and now there is soon anywhere: each law
sends it elsewhere, and left-out windows are predicted no better with the right one.
Over an eighth of them it cannot get lost, and what is missing shows as well.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.base.beginnings import base_fit
from bondgraph.diagnosis.search.base.beyond_noise import explainable, within
from bondgraph.diagnosis.search.looks import Look, explains, look
from bondgraph.diagnosis.search.one_round import MUCH
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.round_found import accepted
from bondgraph.diagnosis.search.trials.surrogates import NEAR
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.horizon import SHORTEST, Automatic, Windows
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]


def first_look(
    graph: FinishedGraph,
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
) -> Look:
    """Return what a look finds, a nearer one where no one law explains anything.

    Parameters
    ----------
    graph, base
        The model as its author knows it, and as fitted over the windows of the search.
    noise
        Residual per output that noise excuses, 0 where it is not known.
    """
    if not _may_be_nearer(base, noise, options):
        return look(base, recordings, noise, options, shop)
    first = look(base, recordings, noise, options, shop, another=True)
    if accepted(first.rounds) or shop.limit.passed:
        return first
    shop.progress("a nearer look, over shorter windows")
    nearer = _fitted_nearer(graph, base, recordings, noise, options)
    if nearer is not None:
        seen = look(nearer, recordings, noise, options, shop)
        if explains(seen, recordings):
            return seen
    return look(base, recordings, noise, options, shop)


def _may_be_nearer(base: FittedModel, noise: Array, options: Options) -> bool:
    """Return whether a model leaves much of windows that may be shorter."""
    if not isinstance(options.settings.horizon, Automatic):
        return False
    if not isinstance(base.horizon, Windows) or base.problem.shots.timeless:
        return False
    return _samples(base) >= SHORTEST and explainable(base, noise) > MUCH


def _samples(base: FittedModel) -> int:
    """Return how long a shorter window is."""
    return int(base.problem.shots.lengths.max()) // NEAR


def _fitted_nearer(
    graph: FinishedGraph,
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
) -> FittedModel | None:
    """Return the model fitted over shorter windows, where it leaves more than noise."""
    settings = replace(base.settings, horizon=Windows(_samples(base)))
    try:
        nearer = base_fit(graph, recordings, settings, noise, options)
    except FitError:
        return None
    return None if within(nearer, noise, options.rule) else nearer
