"""Inputs of a simulation: samples, constants or functions of time, by name.

Fixed steps know samples only: a function of time is sampled for them where the samples
are, and between two of these it is what `hold` says.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondgraph.errors import BondGraphError, EquationError, did_you_mean
from bondgraph.simulation.given import input_samples, refuse_not_finite
from bondgraph.simulation.solvers import Hold

Array = NDArray[np.float64]
InputFunction = Callable[[float], float]
NEAR = 1e-6  # of the span of time, to differentiate a function of time


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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

    def halved(self) -> "Inputs":
        """Return the inputs with a sample more in the middle of every two.

        There a function of time has its value, and samples are what `hold` says.
        """
        time = np.repeat(self.time, 2)[:-1]
        samples = np.repeat(self.samples, 2, axis=0)[:-1]
        time[1::2] = 0.5 * (self.time[:-1] + self.time[1:])
        if self.hold is Hold.FIRST:
            samples[1::2] = 0.5 * (self.samples[:-1] + self.samples[1:])
        for j, function in enumerate(self.functions):
            if function is not None:
                samples[1::2, j] = [function(t) for t in time[1::2].tolist()]
        return replace(self, time=time, samples=samples)

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
            function = _spoken_for(name, value)
            samples[:, j] = [function(t) for t in time.tolist()]
            refuse_not_finite(samples[:, j], time, name)
            functions.append(function)
            continue
        samples[:, j] = input_samples(
            value,
            time,
            name,
            "Give one value per sample, one for all, or a function of time.",
        )
        functions.append(None)
    return Inputs(time=time, samples=samples, functions=tuple(functions), hold=hold)


def _spoken_for(name: str, function: InputFunction) -> InputFunction:
    """Return the function with refusals that name the input it is for."""

    def at(t: float) -> float:
        try:
            value = function(t)
        except BondGraphError:
            raise
        except Exception as error:
            raise _no_number(
                name, t, f"raises {type(error).__name__}: {error}"
            ) from error
        if np.ndim(value) or not np.isrealobj(value) or isinstance(value, str):
            raise _no_number(name, t, f"is {value!r}")
        return float(value)

    return at


def _no_number(name: str, t: float, why: str) -> EquationError:
    return EquationError(
        f"The function of time of the input {name!r} {why} at {t:g} s.",
        (name,),
        "Give a function that takes the time in seconds and returns one number.",
    )
