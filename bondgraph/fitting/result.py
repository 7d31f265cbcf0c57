"""What a fit answers: status, estimates, and what the data cannot identify."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from bondgraph.structure.graph import FinishedGraph


class FitStatus(StrEnum):
    """How a fit ended; the value is the sentence to show."""

    CONVERGED = "The fit converged."
    NO_FREE_PARAMETERS = "Nothing was fitted: every parameter is exact."
    ITERATION_LIMIT = "The fit stopped at its iteration limit before it converged."
    SIMULATION_FAILED = "The model could not be simulated at the start values."


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """One parameter before and after a fit.

    ``std`` is the standard deviation of the estimate, robust to coloured residuals
    (sandwich over windows); None where the data say nothing about the parameter.
    """

    name: str
    value: float
    std: float | None
    unit: str
    start: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """How far a simulation is from recordings.

    ``rmse`` per output channel, in its unit; ``nrmse`` is the root mean square over
    channels of rmse over the channel's standard deviation (0 perfect, 1 the mean).
    """

    nrmse: float
    rmse: Mapping[str, float]


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

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of the parameter called `name`."""
        return next(e for e in self.estimates if e.name == name)
