"""The choices of a simulation-error fit, all of them objects."""

from dataclasses import dataclass, field
from typing import Any

from bondgraph.choices import refuse_other, refuse_other_count
from bondgraph.errors import FitError
from bondgraph.fitting.horizon import Automatic, Horizon
from bondgraph.fitting.loss import Loss, SquaredError
from bondgraph.fitting.noise import Noise, WhiteNoise
from bondgraph.fitting.starts import OneStart, Starts
from bondgraph.fitting.strategy import GrowingWindows, Strategy
from bondgraph.simulation.solvers import Hold, Sdirk2, Solver


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """Choices of a simulation-error fit; the defaults suit sampled machines.

    Parameters
    ----------
    horizon
        How long to simulate from each estimated initial state.
    strategy
        How to come near the optimum: what the first fits are made of.
    starts
        From how many start values.
    loss
        What a residual costs; a robust one for recordings with outliers.
    noise
        Whether residuals are weighed as white or as coloured noise.
    solver, hold
        How to step, and how inputs behave between samples.
    iterations
        Limit of the optimiser.

    Raises
    ------
    FitError
        If a choice is none of its family: a word such as ``"huber"``, or a solver with
        steps of its own, which gives no sensitivities.
    """

    horizon: Horizon = field(default_factory=Automatic)
    strategy: Strategy = field(default_factory=GrowingWindows)
    starts: Starts = field(default_factory=OneStart)
    loss: Loss = field(default_factory=SquaredError)
    noise: Noise = field(default_factory=WhiteNoise)
    solver: Solver = field(default_factory=Sdirk2)
    hold: Hold = Hold.FIRST
    iterations: int = 60

    def __post_init__(self) -> None:
        for name, family in _FAMILIES.items():
            refuse_other(getattr(self, name), family, f"The {name} of a fit", FitError)
        what = "The limit of iterations of a fit"
        refuse_other_count(self.iterations, 0, what, FitError)


_FAMILIES: dict[str, Any] = {
    "horizon": Horizon,
    "strategy": Strategy,
    "starts": Starts,
    "loss": Loss,
    "noise": Noise,
    "solver": Solver,
    "hold": Hold,
}
