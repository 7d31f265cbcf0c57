"""What a model leaves of the windows of a search, each begun anew.

A fit over long windows may lose what was found in short ones: a rotor that is fed at
the edge of its cogging goes anywhere in the long run, and a fit to that lets go of it.
"""

from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.search.base.begun import initial_states
from bondgraph.fitting.estimate import FittedModel, first_guess
from bondgraph.fitting.problem import linearise_windows
from bondgraph.fitting.settling import settle

FOUND = 0.5
"""A model that explains less of windows than this share has nothing to lose there."""

KEPT = 0.75
"""Of what was found in windows a model has to explain this share still."""


def keeps_what_windows_show(
    final: FittedModel, seen: FittedModel, base: FittedModel
) -> bool:
    """Return whether a final model still explains what another explains in windows.

    Parameters
    ----------
    seen
        The model that was found in the windows.
    base
        The one without additions, fitted to these windows.
    """
    optimum = base.optimum
    windows = linearise_windows(base.problem, optimum.theta, optimum.initial)
    least, before = left_of_windows(seen, base), float(np.sum(windows.cost))
    if least > (1.0 - FOUND) * before:
        return True
    return left_of_windows(final, base) <= before - KEPT * (before - least)


def left_of_windows(fitted: FittedModel, base: FittedModel) -> float:
    """Return the cost of a model over the windows of another, its states fitted."""
    there = base.problem
    problem = replace(
        fitted.problem,
        shots=there.shots,
        sigma=there.sigma,
        correlation=there.correlation,
    )
    theta = fitted.optimum.theta
    begun = (
        initial_states(base, problem.model.state_names),
        first_guess(problem, theta),
    )
    costs = [settle(problem, theta, initial)[1].cost for initial in begun]
    return float(np.sum(np.fmin(*costs)))
