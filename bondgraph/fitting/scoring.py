"""Fisher scoring: climbing the likelihood of innovations by its expected Hessian."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.kalman.filter_setting import Filtered, Setting, Unknowns
from bondgraph.fitting.kalman.filtering import filtered
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.truncated_inverse import truncated_inverse

Array = NDArray[np.float64]
ITERATIONS = 40
DIFFERENCE = 1e-4
LONGEST = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Climbed:
    """Where the climb ended; `information` is Fisher's, of all unknowns stacked."""

    at: Unknowns
    filtered: Filtered
    information: Array
    converged: bool


def climb(setting: Setting, at: Unknowns, here: Filtered) -> Climbed:
    """Maximise the likelihood by damped Fisher scoring."""
    damping, converged = 1e-3, False
    information, slope = _information(setting, at, here)
    for _ in range(ITERATIONS):
        raised = information + damping * np.diag(np.diag(information))
        step = truncated_inverse(raised, 1e-12) @ slope
        trial = _bounded(setting.problem, at.moved(_short(at, step)))
        new = filtered(setting, trial, here)
        gain = here.loss - new.loss
        if gain > 0.0:
            at, here, damping = trial, new, damping / 10.0
            information, slope = _information(setting, at, here)
            if gain < 1e-3 and damping < 1e-3:
                converged = True
                break
        else:
            damping *= 10.0
            if damping > 1e8:
                converged = float(slope @ step) < 1.0
                break
    return Climbed(at, here, information, converged)


def _short(at: Unknowns, step: Array) -> Array:
    """Return the step shortened so that nothing moves by more than about half."""
    own = len(at.theta)
    size = np.where(at.theta == 0.0, np.inf, np.abs(at.theta))
    reach = np.concatenate([np.abs(step[:own]) / size, np.abs(step[own:])])
    shortened: Array = step * min(1.0, LONGEST / max(float(reach.max()), 1e-300))
    return shortened


def _bounded(problem: FitProblem, at: Unknowns) -> Unknowns:
    low, high = problem.low[problem.free], problem.high[problem.free]
    return replace(at, theta=np.clip(at.theta, low, high))


def _information(setting: Setting, at: Unknowns, here: Filtered) -> tuple[Array, Array]:
    """Return Fisher's information and the slope of the log-likelihood."""
    values = at.stacked()
    size = np.where(values == 0.0, 1.0, np.abs(values))
    size[len(at.theta) :] = 1.0
    errors, spreads = [], []
    for i in range(len(values)):
        step = np.zeros(len(values))
        step[i] = DIFFERENCE * size[i]
        after = filtered(setting, at.moved(step), here)
        before = filtered(setting, at.moved(-step), here)
        width = 2.0 * step[i]
        root = np.sqrt(here.variances)
        errors.append(((after.innovations - before.innovations) / width / root).ravel())
        change = (after.variances - before.variances) / width / here.variances
        spreads.append(change.ravel())
    first, second = np.array(errors), np.array(spreads)
    white = (here.innovations / np.sqrt(here.variances)).ravel()
    information: Array = first @ first.T + 0.5 * second @ second.T
    # Where nothing was measured, the innovation and all its changes are zero.
    slope: Array = -(first @ white) - 0.5 * second @ (1.0 - white**2)
    return information, slope
