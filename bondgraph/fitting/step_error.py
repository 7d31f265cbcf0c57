"""The error that the steps of a posed problem make, as half a step tells it."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.problem import FitProblem
from bondgraph.simulation.accuracy import halved_step_difference

Array = NDArray[np.float64]
MOST_SUBSTEPS = 16
"""Steps of a sample are not made finer than that."""


def step_error(problem: FitProblem, theta: Array, initial: Array) -> Array:
    """Return how much half the step changes each output; infinite where one fails."""
    return halved_step_difference(
        problem.model,
        problem.shots,
        parameters=problem.with_parameters(theta),
        initial=initial,
        solver=problem.solver,
        hold=problem.hold,
    )
