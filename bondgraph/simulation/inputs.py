"""Inputs of a simulation: samples, constants or functions of time, by name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondgraph.errors import EquationError, did_you_mean
from bondgraph.simulation.solvers import Hold

Array = NDArray[np.float64]
InputFunction = Callable[[float], float]
NEAR = 1e-6  # of the span of time, to differentiate a function of time


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """All inputs of one run.

    Parameters
    ----------
    time, samples
        Seconds, and ``[sample, input]``; functions of time are sampled here too.
    functions
        For each input the function of time it is given by, or None.
    """

    time: Array
    samples: Array
    functions: tuple[InputFunction | None, ...]
    hold: Hold

    @property
    def sampled(self) -> bool:
        """Whether an input changes and is known by its samples only."""
        known = [j for j, function in enumerate(self.functions) if function is None]
        return bool(np.any(np.diff(self.samples[:, known], axis=0)))

    def between(self, row: int) -> Callable[[float], tuple[Array, Array]]:
        """Return u and u̇ as a function of time after sample `row`."""
        following = min(row + 1, len(self.time) - 1)
        span = self.time[following] - self.time[row]
        slope = np.zeros(self.samples.shape[1])
        if self.hold is Hold.FIRST and span > 0.0:
            slope = (self.samples[following] - self.samples[row]) / span
        step = NEAR * (self.time[-1] - self.time[0] or 1.0)

        def at(t: float) -> tuple[Array, Array]:
            u = self.samples[row] + slope * (t - self.time[row])
            rate = slope.copy()
            for j, function in enumerate(self.functions):
                if function is not None:
                    u[j] = function(t)
                    rate[j] = (function(t + step) - function(t - step)) / (2 * step)
            return u, rate

        return at


def gather_inputs(
    names: tuple[str, ...],
    time: Array,
    given: Mapping[str, ArrayLike | InputFunction],
    hold: Hold,
) -> Inputs:
    """Return the inputs of a model; those not given are zero.

    Raises
    ------
    EquationError
        If a name is unknown or samples do not fit the time.
    """
    for name in given:
        if name not in names:
            raise EquationError(
                f"There is no input {name!r}.", (name,), did_you_mean(name, names)
            )
    samples = np.zeros((len(time), len(names)))
    functions: list[InputFunction | None] = []
    for j, name in enumerate(names):
        value = given.get(name, 0.0)
        if callable(value):
            samples[:, j] = [value(t) for t in time.tolist()]
            functions.append(value)
            continue
        values = np.asarray(value, float)
        if values.shape not in {(), (len(time),)}:
            raise EquationError(
                f"The input {name!r} has the shape {values.shape}, and there are "
                f"{len(time)} samples.",
                (name,),
                "Give one value per sample, one for all, or a function of time.",
            )
        samples[:, j] = values
        functions.append(None)
    return Inputs(time=time, samples=samples, functions=tuple(functions), hold=hold)
