"""The error that a solver's steps make, estimated by steps of half the size."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Solver

Array = NDArray[np.float64]


def halved_step_difference(
    model: NumericModel,
    shots: Shots,
    *,
    parameters: Array,
    initial: Array,
    solver: Solver,
    hold: Hold,
) -> Array:
    """Return how much half the step changes each output, as a root mean square.

    For a method of order p that is 1 - 2^-p of the error: three quarters for `Sdirk2`.
    Windows that one of the two runs does not finish count as infinite.

    Parameters
    ----------
    parameters, initial
        As for `shoot`.

    Returns
    -------
    differences
        Shape (ny,), in the outputs' units: small against their residuals, or the fit
        sees the solver.
    """
    coarse, fine = (
        shoot(
            model,
            shots,
            parameters=parameters,
            initial=initial,
            directions=None,
            solver=chosen,
            hold=hold,
        )
        for chosen in (solver, replace(solver, substeps=2 * solver.substeps))
    )
    if not (coarse.completed.all() and fine.completed.all()):
        return np.full(len(model.output_names), np.inf)
    change = coarse.outputs - fine.outputs
    with np.errstate(over="ignore"):  # What is too large for a square is inf.
        found: Array = np.sqrt(np.mean(change**2, axis=0))
    return found
