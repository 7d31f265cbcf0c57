"""The choices of a simulation-error fit, all of them objects."""

from dataclasses import dataclass, field

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
    """

    horizon: Horizon = field(default_factory=Automatic)
    strategy: Strategy = field(default_factory=GrowingWindows)
    starts: Starts = field(default_factory=OneStart)
    loss: Loss = field(default_factory=SquaredError)
    noise: Noise = field(default_factory=WhiteNoise)
    solver: Solver = field(default_factory=Sdirk2)
    hold: Hold = Hold.FIRST
    iterations: int = 60
