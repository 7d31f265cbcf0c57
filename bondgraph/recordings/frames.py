"""Recordings from pandas data frames, through the same gate as files.

The headers are the file's, ``name [unit]``; `Recording.to_pandas` writes them.
"""

from collections.abc import Mapping, Sequence
from hashlib import sha256
from typing import TYPE_CHECKING, Any

import numpy as np

from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.recording import Recording
from bondgraph.recordings.repairs import AbstractTable, Gaps, Order, Repeats
from bondgraph.recordings.table import Choices, read_table

if TYPE_CHECKING:
    import pandas as pd


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
        One row per sample; its index is not read.
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
        (str(header), frame.iloc[:, i].to_numpy())
        for i, header in enumerate(frame.columns)
    ]
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
