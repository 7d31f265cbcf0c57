"""Windows that could not be simulated, taken out before anything is computed."""

from dataclasses import replace

import numpy as np

from bondgraph.simulation.shooting import Shooting

LARGEST = 1e120
"""A window in which anything is larger failed: sums of its squares overflow."""


def without_overflow(shot: Shooting, edges: tuple[int, ...]) -> Shooting:
    """Return the windows that ran, with numbers whose squares can be summed.

    In all others the outputs are nan and the sensitivities zero: an infinity is no
    number to calculate with, and a window that failed costs infinitely whatever stands
    in it.
    """
    sensitivities = shot.sensitivities
    fine = shot.completed.copy()
    for values in (shot.outputs, sensitivities):
        if values.size and not (values.max() <= LARGEST and values.min() >= -LARGEST):
            rows = (np.abs(values) <= LARGEST).all(axis=tuple(range(1, values.ndim)))
            fine &= np.logical_and.reduceat(rows, np.array(edges[:-1]))
    if fine.all():
        return shot
    ran = np.repeat(fine, np.diff(edges))
    if len(sensitivities):  # and none where none were asked for
        sensitivities = np.where(ran[:, None, None], sensitivities, 0.0)
    return replace(
        shot,
        outputs=np.where(ran[:, None], shot.outputs, np.nan),
        sensitivities=sensitivities,
        completed=fine,
    )
