"""Jumps of held inputs, where a model reads how fast an input changes.

A dependent store takes its share of a step at once: a compliance in series with a
driven one, an inertia that a source of flow moves. Between samples such an input is
held, so its rate is zero; at the sample it is infinite. Each jump is therefore crossed
by a ramp that ends at the sample and lasts a thousandth of what goes before.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.simulation.shots import Shooting, Shots

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
SHARE = 1e-3
"""Of the time between two samples, that the ramp to the second one lasts."""


def ramped(time: Array, inputs: Array, edges: tuple[int, ...]) -> tuple[Shots, Rows]:
    """Return held inputs as straight lines with a ramp before every jump.

    Parameters
    ----------
    time, inputs, edges
        As those of `Shots`. A window begins after its first jump.

    Returns
    -------
    tuple
        The windows with a row more before every jump, and where each sample is.
    """
    jumps = np.flatnonzero(np.any(np.diff(inputs, axis=0), axis=1)) + 1
    jumps = jumps[~np.isin(jumps, edges)]
    begin = time[jumps] - SHARE * (time[jumps] - time[jumps - 1])
    rows = np.arange(len(time)) + np.searchsorted(jumps, np.arange(len(time)), "right")
    n = len(time) + len(jumps)
    own = np.insert(time, jumps, begin)
    held = np.insert(inputs, jumps, inputs[jumps - 1], axis=0)
    ends = tuple(int(e + np.searchsorted(jumps, e, "left")) for e in edges)
    return Shots(own, held, np.zeros((n, 0)), ends), rows


def at_samples(shot: Shooting, rows: Rows) -> Shooting:
    """Return what was simulated at the samples alone."""
    slopes = shot.sensitivities
    return replace(
        shot,
        outputs=shot.outputs[rows],
        states=shot.states[rows],
        sensitivities=slopes[rows] if len(slopes) else slopes,
        modes=None if shot.modes is None else shot.modes[rows],
        since=None if shot.since is None else shot.since[rows],
    )
