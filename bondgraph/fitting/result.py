"""What a fit answers: status, estimates, and what the data cannot identify."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from bondgraph.fitting.certainty.solver_error import SolverError
from bondgraph.fitting.fitted import FittedModel
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Parameter


class FitStatus(StrEnum):
    """How a fit ended; the value is the sentence to show."""

    CONVERGED = "The fit converged."
    NO_FREE_PARAMETERS = "Nothing was fitted: every parameter is exact."
    ITERATION_LIMIT = "The fit stopped at its iteration limit before it converged."
    NO_EFFECT = (
        "Nothing was fitted: no free parameter has an effect on what was simulated."
    )
    SIMULATION_FAILED = "The model could not be simulated at the start values."


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """One parameter before and after a fit.

    ``std`` is the standard deviation of the estimate, robust to coloured residuals
    (sandwich over blocks); None where the data say nothing about the parameter.
    ``interval`` holds the true value in 95 of 100 repeats, (low, high), cut at the
    bounds; None where std is.
    """

    name: str
    value: float
    std: float | None
    unit: str
    start: float | None
    interval: tuple[float, float] | None = None

    def away_from(self, stated: Parameter) -> float | None:
        """Return how many standard deviations, of both, it ended from a stated value.

        Negative below it; None where no value is stated with a standard deviation.
        """
        if stated.value is None or not stated.std:
            return None
        return (self.value - stated.value) / math.hypot(stated.std, self.std or 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """How far a simulation is from recordings.

    ``rmse`` per output channel, in its unit; ``nrmse`` is the root mean square over
    channels of rmse over the channel's standard deviation (0 perfect, 1 the mean).
    ``unchanging`` names the channels that hold one value throughout: they have no
    spread to be relative to, and ``nrmse`` is not a number if there is no other.
    """

    nrmse: float
    rmse: Mapping[str, float]
    unchanging: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FitResult:
    """A model fitted to recordings.

    Parameters
    ----------
    model
        The graph with the estimated values.
    estimates
        One per free parameter, in the graph's order.
    score
        Of the fitted model on the recordings it was fitted to.
    unidentifiable
        Sentences such as "m and k only as k/m", empty when all is identifiable.
    window
        Seconds simulated from each estimated initial state; None for whole recordings.
    covariance
        Of the estimates, row by row in their order, in their units; its diagonal is the
        square of their ``std``. It says what the estimates know only together: products
        and ratios.
    barely_known
        Sentences on parameters that the recordings hardly determine and what they do,
        such as "J is known to ± 80 % and K to ± 75 %, but K/J to ± 2 %".
    solver_error
        What the time step costs; None where it was not asked for.
    correlation
        φ of each output's noise, where it was fitted as coloured.
    fitted
        The fit itself, for profiles and the like.
    """

    status: FitStatus
    model: FinishedGraph
    estimates: tuple[Estimate, ...]
    score: Score
    cost: float
    iterations: int
    unidentifiable: tuple[str, ...] = ()
    window: float | None = None
    covariance: tuple[tuple[float, ...], ...] = ()
    barely_known: tuple[str, ...] = ()
    solver_error: SolverError | None = None
    correlation: Mapping[str, float] = field(default_factory=dict)
    fitted: FittedModel | None = field(default=None, repr=False, compare=False)

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of the parameter called `name`."""
        return next(e for e in self.estimates if e.name == name)
