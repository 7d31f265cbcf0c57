"""A channel: one measured quantity, with its unit, in numbers that cannot change."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondgraph.errors import RecordingError, UnitError
from bondgraph.structure.units import conversion

FloatArray = NDArray[np.float64]


def read_only(values: ArrayLike) -> FloatArray:
    """Return a float64 copy of `values` that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """One measured quantity: its name, its unit and one value per sample.

    Raises
    ------
    RecordingError
        If the values are not a vector of finite numbers.
    """

    name: str
    unit: str
    values: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", read_only(self.values))
        if self.values.ndim != 1:
            raise RecordingError(
                f"Channel {self.name!r} has the shape {self.values.shape}.",
                (self.name,),
                "Give one value per sample.",
            )
        bad = np.flatnonzero(~np.isfinite(self.values))
        if bad.size:
            raise RecordingError(
                f"Channel {self.name!r} is not finite in {bad.size} samples, "
                f"first in sample {bad[0]}.",
                (self.name,),
                "Leave those samples out of all channels.",
            )

    def to(self, unit: str) -> "Channel":
        """Return the channel converted to `unit`."""
        try:
            scale, offset = conversion(self.unit, unit)
        except UnitError as error:
            raise RecordingError(
                f"Channel {self.name!r} is in {self.unit!r}, which does not convert "
                f"to {unit!r}.",
                (self.name, self.unit, unit),
                error.remedy,
            ) from error
        return Channel(self.name, unit, self.values * scale + offset)


def numbers(name: str, values: ArrayLike) -> FloatArray:
    """Return `values` as floats, or refuse them by the channel's name."""
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RecordingError(
            f"Channel {name!r} is not an array of numbers ({error}).",
            (name,),
            "Give one number per sample.",
        ) from error
