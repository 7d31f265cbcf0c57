"""A channel: one measured quantity, with its unit, in numbers that cannot change."""

from dataclasses import dataclass, replace

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

    Parameters
    ----------
    name, unit, values
        The values are finite, except for gaps.
    gaps
        Whether NaN stands for a sample at which the quantity was not measured.

    Raises
    ------
    RecordingError
        If the values are not a vector of finite numbers, or all of them are gaps.
    """

    name: str
    unit: str
    values: FloatArray
    gaps: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", read_only(self.values))
        if self.values.ndim != 1:
            raise RecordingError(
                f"Channel {self.name!r} has the shape {self.values.shape}.",
                (self.name,),
                "Give one value per sample.",
            )
        if self.gaps and np.isnan(self.values).all():
            raise RecordingError(
                f"Channel {self.name!r} was never measured.",
                (self.name,),
                "Leave it out.",
            )
        refused = np.isinf if self.gaps else _not_finite
        bad = np.flatnonzero(refused(self.values))
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
        return replace(self, unit=unit, values=self.values * scale + offset)

    def at(self, rows: slice | NDArray[np.intp]) -> "Channel":
        """Return the channel with the samples numbered `rows` only."""
        return replace(self, values=self.values[rows])


def _not_finite(values: FloatArray) -> NDArray[np.bool_]:
    return ~np.isfinite(values)


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
