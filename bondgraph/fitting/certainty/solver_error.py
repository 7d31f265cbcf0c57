"""What the time step costs: the fitted model run again with half the step.

The difference of the two runs is most of the error of the first: three quarters of it
for a method of order two, half of it where an event spoils the order. What matters is
how far that moves the estimates, against their standard deviations.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.uncertainty import projected
from bondgraph.fitting.levenberg_marquardt import Optimum
from bondgraph.fitting.noise import whitened
from bondgraph.fitting.overflow import without_overflow
from bondgraph.fitting.problem import FitProblem, parts
from bondgraph.simulation.shooting import shoot

Array = NDArray[np.float64]
LARGE_SHIFT = 0.5


class SolverErrorStatus(StrEnum):
    """Whether the step was fine enough; the value is the sentence to show."""

    FINE = "The time step is fine enough: half of it would not move the estimates."
    COARSE = (
        "The time step is too coarse: half of it would move an estimate by more than "
        "half its standard deviation. Smoother laws need fewer steps; more are taken "
        "with --substeps 4 or, in Python, FitSettings(solver=Sdirk2(4))."
    )
    UNKNOWN = "The error of the time step is not known: half the step failed."


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverError:
    """The error of the solver at the optimum.

    Parameters
    ----------
    rmse
        Per output, in its unit.
    shift
        Per estimate, by how many of its standard deviations the error moved it.
    """

    status: SolverErrorStatus
    rmse: Mapping[str, float]
    shift: Mapping[str, float]


def solver_error(
    problem: FitProblem,
    optimum: Optimum,
    *,
    inverse: Array,
    std: Array,
    names: tuple[str, ...],
) -> SolverError:
    """Return what half the step changes.

    Parameters
    ----------
    inverse, std
        Inverse of the cost's Hessian in the free parameters, and their standard
        deviations.
    names
        Of the free parameters.
    """
    finer = replace(problem.solver, substeps=2 * problem.solver.substeps)
    nq = len(optimum.theta)
    squared, slope = np.zeros(len(problem.sigma)), np.zeros(nq)
    for part in parts(problem, optimum.theta, optimum.initial):
        shot = shoot(
            problem.model,
            part.shots,
            parameters=problem.with_parameters(optimum.theta),
            initial=optimum.initial[part.windows],
            directions=None,
            solver=finer,
            hold=problem.hold,
        )
        shot = without_overflow(shot, part.shots.edges)
        error = (shot.outputs - part.shot.outputs) / problem.sigma
        error = np.where(np.isfinite(part.shots.outputs), error, 0.0)
        squared += (error**2).sum(axis=0)
        measured = np.isfinite(part.shots.outputs)
        white = whitened(error, problem.correlation, part.shots.edges, measured)
        slope += np.einsum("njq,nj->q", projected(problem, optimum, part), white)
    rmse = problem.sigma * np.sqrt(squared / problem.measured)
    moved = np.abs(inverse @ slope)
    shift = np.divide(moved, std, out=np.zeros(nq), where=std > 0.0)
    return SolverError(
        status=_status(rmse, shift),
        rmse=dict(zip(problem.model.output_names, map(float, rmse), strict=True)),
        shift=dict(zip(names, map(float, shift), strict=True)),
    )


def _status(rmse: Array, shift: Array) -> SolverErrorStatus:
    if not (np.isfinite(rmse).all() and np.isfinite(shift).all()):
        return SolverErrorStatus.UNKNOWN
    if len(shift) and shift.max() > LARGE_SHIFT:
        return SolverErrorStatus.COARSE
    return SolverErrorStatus.FINE
