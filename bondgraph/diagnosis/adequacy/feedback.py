"""Feedback: what a controller makes of the noise that it reads, taken from the input.

A controller that works on noisy readings puts their noise into the input. The residual
then follows the input of the same sample, and all that the input has moved, though
nothing is missing. Order in time gives that away: what is new in the residual comes
before what is new in the input. What remains to be tested is whether the residual
follows what the machine would have done without that part of the input.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.adequacy.coloured import (
    WHITE,
    Autoregression,
    chosen_order,
    correlations,
    reflections,
    whitened,
)
from bondgraph.diagnosis.virtual.chain import Chain

Array = NDArray[np.float64]
LAGS = 4
"""So many samples later than a reading a controller's answer to it is looked for."""

SURELY = 4.0
"""Standard errors from no correlation, of a few pairs of channels and lags."""

ANSWERS = 100
"""For so many samples a controlled machine answers to one reading, at most."""

SAMPLES_PER_LAG = 20
"""Of every answer that is estimated; of fewer samples nothing is said."""

COLOUR = 20
"""Order of the autoregression that an input by itself is taken for, at most."""

REPEATS = 3
LEADS = 1.5
"""Times what correlates the other way round: smooth inputs do so both ways."""


def fed_back(chain: Chain, innovations: Array) -> bool:
    """Return whether what is new in a residual leads what is new in an input.

    Parameters
    ----------
    innovations
        Of the residual, (n, ny), as `whitened` gives them.
    """
    if len(innovations) < SAMPLES_PER_LAG * LAGS:
        return False
    edges = chain.shots.edges
    commanded = [_news(u, edges) for u in chain.shots.inputs.T if np.ptp(u) > 0.0]
    return any(
        _leads(read, news, chain)
        for read in innovations.T
        for news in commanded
        if np.any(read) and np.any(news)
    )


def without_feedback(
    chain: Chain, residual: Array, input_names: Sequence[str]
) -> Chain:
    """Return the chain as driven without what answers its own residual.

    States follow to first order, each window from where it began.

    Parameters
    ----------
    residual
        What parameters and initial states cannot take, (n, ny).
    input_names
        In the order of the inputs' columns.
    """
    lags = min(ANSWERS, len(residual) // SAMPLES_PER_LAG)
    late = np.column_stack([_delayed(e, i) for e in residual.T for i in range(lags)])
    inputs = chain.shots.inputs
    driven = np.column_stack([_unanswered(u, late) for u in inputs.T])
    change = np.zeros((len(inputs), len(chain.sources)))
    places = [one.place for one in chain.sources]
    change[:, [places.index(name) for name in input_names]] = driven - inputs
    moved = np.zeros_like(chain.states)
    for k in np.flatnonzero(chain.inside):
        moved[k] = chain.phi[k] @ moved[k - 1] + chain.gamma[k] @ change[k - 1]
    shots = replace(chain.shots, inputs=driven)
    return replace(chain, shots=shots, states=chain.states + moved)


def _delayed(values: Array, lag: int) -> Array:
    return np.concatenate([np.zeros(lag), values[: len(values) - lag]])


def _unanswered(commanded: Array, late: Array) -> Array:
    """Return an input without what its least squares fit says is an answer.

    Whitened by its own colour: the reference that it follows is the noise of this fit.
    """
    if not np.ptp(commanded) > 0.0:
        return commanded
    whole = (0, len(commanded))
    left = commanded - commanded.mean()
    answer: Array = np.zeros(late.shape[1])
    for _ in range(REPEATS):
        own = _colour(left - late @ answer, whole)
        news, seen = (whitened(own, values, whole) for values in (left, late))
        fitted = np.linalg.lstsq(seen, news, rcond=None)[0]
        answer = np.asarray(fitted, dtype=np.float64)
    unanswered: Array = commanded - late @ answer
    return unanswered


def _news(values: Array, edges: tuple[int, ...]) -> Array:
    """Return what an input's past does not tell of it; zero where a window begins."""
    centred = values - values.mean()
    return whitened(_colour(centred, edges), centred, edges)


def _colour(values: Array, edges: tuple[int, ...]) -> Autoregression:
    """Return the autoregression that a signal is by itself; white where it is none."""
    if not np.any(values):
        return WHITE
    found, left = reflections(correlations(values, edges, COLOUR))
    own = found[: chosen_order(left, len(values))]
    return Autoregression(own, np.zeros_like(own))


def _leads(read: Array, news: Array, chain: Chain) -> bool:
    """Return whether readings correlate with later commands, and less with earlier."""
    later = max(abs(_correlation(read, news, chain, lag)) for lag in range(1, LAGS + 1))
    earlier = max(
        abs(_correlation(news, read, chain, lag)) for lag in range(1, LAGS + 1)
    )
    return later > LEADS * earlier and later * np.sqrt(len(read)) > SURELY


def _correlation(first: Array, then: Array, chain: Chain, lag: int) -> float:
    """Return how far one signal correlates with another so many samples later."""
    follows = np.ones(len(first) - lag, dtype=bool)
    for start in chain.shots.edges[1:-1]:
        follows[max(start - lag, 0) : start] = False
    size = float(np.linalg.norm(first) * np.linalg.norm(then))
    return float(first[:-lag][follows] @ then[lag:][follows]) / size
