"""Parameters that have run away from what is stated of them, for want of a law.

A carriage that rubs is fitted as one of ten times the mass. From there the law that is
missing promises next to nothing, and a fit of it does not find the way back: it begins
where the author of the model has stated as well.
"""

from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.places.base import PROPOSED

FAR = 3.0
"""A value so many times larger or smaller than where its fit began has run away."""


def run_away(fitted: FittedModel, times: float = FAR) -> dict[str, float]:
    """Return the stated values of parameters that a fit has left by so many times.

    What a law that was found began with nobody has stated.
    """
    problem, parameters = fitted.problem, fitted.graph.parameters
    names = problem.model.parameter_names
    began = {
        names[i]: float(problem.start[i])
        for i in problem.free
        if parameters[names[i]].source != PROPOSED
    }
    return {
        name: value
        for name, value in began.items()
        if value and is_far(fitted.values[name], value, times)
    }


def is_far(value: float, stated: float, times: float = FAR) -> bool:
    """Return whether a value is so many times larger or smaller than what is stated."""
    return not 1.0 / times < value / stated < times
