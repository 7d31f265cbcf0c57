"""Recordings from pandas and xarray objects, through the same gate as files.

A data frame's headers are the file's, ``name [unit]``; the variables of a data set have
their units in ``attrs["units"]``. Dates become seconds since the first of them.
`Recording.to_pandas` and `Recording.to_xarray` write the same.
"""

from collections.abc import Mapping, Sequence
from hashlib import sha256
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.names import join_header, split_header
from bondgraph.recordings.recording import Recording
from bondgraph.recordings.repairs import AbstractTable, Gaps, Order, Repeats
from bondgraph.recordings.table import Choices, read_table

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class FrameTable(AbstractTable):
    """Columns that are already in memory."""

    def __init__(self, columns: Sequence[tuple[str, Any]], source: str) -> None:
        self.source = source
        self.headers = tuple(header for header, _ in columns)
        self._columns = [values for _, values in columns]
        self.sha256 = ""

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the columns numbered `indices` as floats."""
        columns = [self._column(index) for index in indices]
        content = sha256()
        for index, column in zip(indices, columns, strict=True):
            if column.shape != (columns[0].size,):
                raise RecordingError(
                    f"{self.headers[index]!r} of {self.source!r} has the shape "
                    f"{column.shape} and {self.headers[indices[0]]!r} "
                    f"{columns[0].shape}.",
                    (self.source, self.headers[index]),
                    "Give every channel one value per sample.",
                )
            content.update(self.headers[index].encode())
            content.update(np.ascontiguousarray(column).data)
        self.sha256 = content.hexdigest()
        return columns

    def _column(self, index: int) -> FloatArray:
        values = np.asarray(self._columns[index])
        if values.dtype.kind not in "biufO":
            kind = str(values.dtype)
        else:
            try:
                return values.astype(np.float64)
            except (TypeError, ValueError) as error:
                kind = str(error)
        raise RecordingError(
            f"{self.headers[index]!r} of {self.source!r} is not numbers ({kind}).",
            (self.source, self.headers[index]),
            "Convert it to numbers, time to seconds.",
        )


def _seconds(dates: NDArray[Any]) -> FloatArray:
    """Return dates or durations as seconds since the first; nan for what is not one."""
    since = (dates - dates[0]).astype("timedelta64[ns]")
    whole = since.astype(np.int64).astype(np.float64) * 1e-9
    return np.where(np.isnat(since), np.nan, whole)


def from_pandas(
    frame: "pd.DataFrame",
    *,
    name: str = "frame",
    mapping: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    channels: Sequence[str] | None = None,
    time: str | None = "time",
    step: float | None = None,
    steady: bool = False,
    gaps: Gaps = "refuse",
    order: Order = "refuse",
    repeats: Repeats = "refuse",
) -> Recording:
    """Return the recording in a data frame whose columns are ``name [unit]``.

    Parameters
    ----------
    frame
        One row per sample. Its index is read as time only where it is of dates or
        durations and no column has the name of the time.
    name
        What to call it.
    mapping, units, channels, time, step, steady, gaps, order, repeats
        As in `read_recording`.

    Raises
    ------
    RecordingError
        If the frame is not a recording; see `read_recording`.
    """
    columns = [
        _without_dates(str(header), frame.iloc[:, i].to_numpy())
        for i, header in enumerate(frame.columns)
    ]
    index = frame.index.to_numpy()
    named = {split_header(header)[0] for header, _ in columns}
    if time is not None and time not in named and index.dtype.kind in "mM":
        columns.insert(0, _without_dates(time, index))
    choices = Choices(
        name=name,
        mapping=mapping or {},
        units=units or {},
        channels=None if channels is None else tuple(channels),
        time=time,
        step=step,
        steady=steady,
        gaps=gaps,
        order=order,
        repeats=repeats,
    )
    return read_table(FrameTable(columns, name), choices)


def _without_dates(header: str, values: NDArray[Any]) -> tuple[str, NDArray[Any]]:
    """Return a column with dates as seconds, where its header has no unit."""
    name, unit = split_header(header)
    if unit is None and values.dtype.kind in "mM" and values.size:
        return join_header(name, "s"), _seconds(values)
    return header, values


def from_xarray(
    data: "xr.Dataset | xr.DataArray",
    *,
    name: str | None = None,
    mapping: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    channels: Sequence[str] | None = None,
    time: str | None = "time",
    step: float | None = None,
    steady: bool = False,
    gaps: Gaps = "refuse",
    order: Order = "refuse",
    repeats: Repeats = "refuse",
) -> Recording:
    """Return the recording in a data set whose variables lie along one dimension.

    Parameters
    ----------
    data
        Variables and the time coordinate with ``attrs["units"]``; a time coordinate of
        numbers without units is in seconds only if `units` says so. Variables along
        other dimensions are left out.
    name
        What to call it; by default the array's name, or ``"data set"``.
    mapping, units, channels, time, step, steady, gaps, order, repeats
        As in `read_recording`.

    Raises
    ------
    RecordingError
        If the data are not a recording; see `read_recording`.
    """
    called = str(getattr(data, "name", None) or "data set") if name is None else name
    variables = dict(data.coords)
    if hasattr(data, "data_vars"):
        variables |= dict(data.data_vars)
    else:
        variables[getattr(data, "name", None) or "value"] = data
    along = time if time in data.dims else next(iter(data.dims), None)
    columns = [
        _without_dates(_header(str(key), variable), variable.to_numpy())
        for key, variable in variables.items()
        if variable.dims == (along,)
    ]
    choices = Choices(
        name=called,
        mapping=mapping or {},
        units=units or {},
        channels=None if channels is None else tuple(channels),
        time=time,
        step=step,
        steady=steady,
        gaps=gaps,
        order=order,
        repeats=repeats,
    )
    return read_table(FrameTable(columns, called), choices)


def _header(name: str, variable: Any) -> str:
    """Return the header that a variable's name and attributes amount to."""
    unit = variable.attrs.get("units")
    return join_header(name, unit.strip() or "1") if isinstance(unit, str) else name
