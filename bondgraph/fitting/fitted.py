"""`FittedModel`: a graph with the problem it was fitted in and the optimum found."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.horizon import Horizon
from bondgraph.fitting.levenberg_marquardt import Optimum
from bondgraph.fitting.noise import AutoregressiveNoise, WhiteNoise
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.settings import FitSettings
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedModel:
    """A graph with the problem it was fitted in and the optimum found.

    ``horizon`` is the one used (never `Automatic`).
    """

    graph: FinishedGraph
    problem: FitProblem
    optimum: Optimum
    horizon: Horizon

    @property
    def parameters(self) -> Array:
        """All parameter values, in the numeric model's order."""
        return self.problem.with_parameters(self.optimum.theta)

    @property
    def free_names(self) -> tuple[str, ...]:
        """Names of the fitted parameters, in the order of ``optimum.theta``."""
        names = self.problem.model.parameter_names
        return tuple(names[i] for i in self.problem.free)

    @property
    def settings(self) -> FitSettings:
        """The choices to fit a variant of this model in the same way."""
        coloured = bool(self.problem.correlation.any())
        return FitSettings(
            horizon=self.horizon,
            loss=self.problem.loss,
            noise=AutoregressiveNoise() if coloured else WhiteNoise(),
            solver=self.problem.solver,
            hold=self.problem.hold,
        )

    @property
    def values(self) -> dict[str, float]:
        """All parameter values by name."""
        names = self.problem.model.parameter_names
        return dict(zip(names, map(float, self.parameters), strict=True))

    def residuals(self) -> Array:
        """Return measured minus simulated, (n, ny), in the outputs' units."""
        residuals: Array = self.optimum.linearisation.residuals * self.problem.sigma
        return residuals
