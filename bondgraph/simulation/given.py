"""What a run is given, checked once for all routes: times, samples, states.

A number that is not finite must be refused by its own name: further in, it would be
blamed on the model, or keep a compiled loop running for ever.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondgraph.errors import BondGraphError, EquationError, did_you_mean

Array = NDArray[np.float64]


def increasing(time: ArrayLike) -> Array:
    """Return the samples of time as an array.

    Raises
    ------
    EquationError
        If they are not finite numbers that increase.
    """
    grid = real_numbers(time, "time", "The samples of time")
    if grid.ndim != 1 or len(grid) < 1:
        raise EquationError(
            f"The samples of time have the shape {grid.shape}.",
            ("time",),
            "Give a list of at least one.",
        )
    bad = np.flatnonzero(~np.isfinite(grid))
    if bad.size:
        raise EquationError(
            f"Sample {bad[0]} of time is {grid[bad[0]]:g}.",
            ("time",),
            "Give finite seconds; leave out what has no time.",
        )
    if not np.all(np.diff(grid) > 0.0):
        raise EquationError(
            "The samples of time do not increase.", ("time",), "Sort them."
        )
    return grid


def input_samples(value: ArrayLike, time: Array, name: str, ways: str) -> Array:
    """Return the samples of one input, or its one constant value.

    Parameters
    ----------
    ways
        In what ways an input may be given, for the refusal of another shape.

    Raises
    ------
    EquationError
        If they are not finite real numbers, or do not fit the time.
    """
    values = real_numbers(value, name, f"The input {name!r}")
    if values.shape not in {(), (len(time),)}:
        raise EquationError(
            f"The input {name!r} has the shape {values.shape}, and there are "
            f"{len(time)} samples.",
            (name,),
            ways,
        )
    samples: Array = np.broadcast_to(values, (len(time),))
    refuse_not_finite(samples, time, name)
    return samples


def refuse_not_finite(samples: Array, time: Array, name: str) -> None:
    """Raise EquationError if an input has a sample that is nan or infinite."""
    bad = np.flatnonzero(~np.isfinite(samples))
    if bad.size:
        raise EquationError(
            f"The input {name!r} is {samples[bad[0]]:g} at {time[bad[0]]:g} s.",
            (name,),
            "Give a finite number at every sample; fill a gap, or run up to it.",
        )


def initial_states(
    initial: Mapping[str, float],
    names: Sequence[str],
    model: str,
    refusal: type[BondGraphError] = EquationError,
) -> Array:
    """Return the initial states in the model's order; those not named are zero.

    Raises
    ------
    BondGraphError
        If a name is unknown or a value is not a finite number.
    """
    for name in initial:
        if name not in names:
            raise refusal(
                f"{model!r} has no state {name!r}.", (name,), did_you_mean(name, names)
            )
    refuse_no_numbers(initial, "The initial value of", refusal)
    return np.array([float(initial.get(name, 0.0)) for name in names])


def refuse_no_numbers(
    values: Mapping[str, float], what: str, refusal: type[BondGraphError]
) -> None:
    """Raise `refusal` if a value by name is not one finite number."""
    for name, value in values.items():
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if isinstance(value, str) or not math.isfinite(number):
            raise refusal(
                f"{what} {name!r} is {value!r}.", (name,), "Give one finite number."
            )


def real_numbers(value: Any, name: str, what: str) -> Array:
    """Return an array of floats, or refuse complex numbers, words and the like."""
    try:
        given = np.asarray(value)
        if given.dtype.kind in "biufO":
            return given.astype(np.float64)
    except (TypeError, ValueError):
        pass  # a ragged list, or objects that are no numbers
    raise EquationError(
        f"{what} is not made of real numbers.", (name,), "Give numbers in SI units."
    )
