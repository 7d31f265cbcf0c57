"""From where a fit starts: a choice, as an object.

A cost with several minima is searched from several starts. They are drawn by seed, so
the answer is the same every time, and the first is always the model's own.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import FitError
from bondgraph.fitting.problem import FitProblem

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class OneStart:
    """From the values of the model."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ManyStarts:
    """From the values of the model and from others drawn around them.

    Parameters
    ----------
    count
        Number of starts, the model's own among them.
    seed
        Of the random numbers.
    factor
        A parameter is drawn between its value over and times this, evenly on a
        logarithmic scale; one that is known to ± std, from that normal distribution;
        one with value zero stays.

    Raises
    ------
    FitError
        If the count is less than one or the factor not above one.
    """

    count: int
    seed: int = 0
    factor: float = 3.0

    def __post_init__(self) -> None:
        if self.count < 1 or not self.factor > 1.0:
            raise FitError(
                f"{self.count} starts within a factor of {self.factor:g} are none.",
                (),
                "Give at least one start and a factor above one.",
            )


Starts = OneStart | ManyStarts


def start_values(starts: Starts, problem: FitProblem) -> Iterator[Array]:
    """Yield the free parameters at each start, within their bounds."""
    centre = problem.start[problem.free]
    yield centre
    if isinstance(starts, OneStart):
        return
    random = np.random.default_rng(starts.seed)
    std = problem.prior_std[problem.free]
    low, high = problem.low[problem.free], problem.high[problem.free]
    for _ in range(starts.count - 1):
        scale = starts.factor ** random.uniform(-1.0, 1.0, len(centre))
        normal = random.normal(size=len(centre))
        known = np.isfinite(std)
        drawn = np.where(
            known, centre + np.where(known, std, 0.0) * normal, centre * scale
        )
        yield np.clip(drawn, low, high)
