"""Reading Parquet and MAT: other people's formats through their own libraries.

Whatever those libraries raise over a damaged file becomes one refusal that names it.
Neither format runs code when it is read.
"""

import io
import re
import warnings
from collections.abc import Sequence
from hashlib import sha256
from typing import Any, cast

import numpy as np

from bondgraph.errors import MissingExtraError, RecordingError
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.repairs import AbstractTable

MOST_COLUMNS_LISTED = 64
"""A matrix with more rows (columns) than this is not a table of channels that way."""

_ELEMENT = re.compile(r"^(\w+)\((:|\d+),(:|\d+)\)$")


class ParquetTable(AbstractTable):
    """The content of a Parquet file whose columns are named ``name [unit]``."""

    def __init__(self, content: bytes, source: str) -> None:
        try:
            import pyarrow.parquet as pq  # noqa: PLC0415
        except ImportError as error:
            raise MissingExtraError(
                f"Reading {source!r} needs pyarrow.",
                ("pyarrow",),
                "Install bondgraph-workbench[data].",
            ) from error
        self.source = source
        self.sha256 = sha256(content).hexdigest()
        try:
            self._file: Any = pq.ParquetFile(io.BytesIO(content))
            self.headers = tuple(self._file.schema_arrow.names)
        except Exception as error:
            raise _damaged(source, "Parquet", error) from error

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the columns numbered `indices`; nan stands for a null."""
        import pyarrow as pa  # noqa: PLC0415

        columns = []
        for index in indices:
            header = self.headers[index]
            kind = self._file.schema_arrow.field(index).type
            numeric = pa.types.is_integer(kind) or pa.types.is_floating(kind)
            if not numeric and not pa.types.is_boolean(kind):
                raise _not_numbers(self.source, header, str(kind))
            try:
                table = self._file.read(columns=[header])
                values = table.column(0).cast(pa.float64())
                columns.append(np.asarray(values.to_numpy(), dtype=np.float64))
            except Exception as error:
                raise _damaged(self.source, "Parquet", error) from error
        return columns


class MatTable(AbstractTable):
    """The variables of a MAT file, version 4 to 7.2.

    A matrix is offered column by column and row by row, as ``x(:,2)`` and ``x(1,:)``.
    """

    has_units = False

    def __init__(self, content: bytes, source: str) -> None:
        from scipy.io import whosmat  # noqa: PLC0415

        self.source = source
        self.sha256 = sha256(content).hexdigest()
        self._content = content
        self._read: dict[str, Any] = {}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                found = whosmat(cast(Any, io.BytesIO(content)))
        except NotImplementedError as error:
            raise RecordingError(
                f"{source!r} is a MAT file of version 7.3, which is HDF5.",
                (source,),
                'Save it in MATLAB with save(..., "-v7"), or as CSV.',
            ) from error
        except Exception as error:
            raise _damaged(source, "MAT", error) from error
        self.headers = tuple(
            h for name, shape, _ in found for h in _offers(name, shape)
        )

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the variables numbered `indices`."""
        columns = [self._vector(self.headers[index]) for index in indices]
        for index, column in zip(indices, columns, strict=True):
            if column.size != columns[0].size:
                raise RecordingError(
                    f"{self.headers[index]!r} of {self.source!r} has {column.size} "
                    f"values and {self.headers[indices[0]]!r} has {columns[0].size}.",
                    (self.source, self.headers[index]),
                    "Channels of one recording have one value per sample each.",
                )
        return columns

    def row(self, i: int) -> str:
        """Return the number of a sample as MATLAB counts, from 1."""
        return f"sample {i + 1}"

    def _vector(self, header: str) -> FloatArray:
        element = _ELEMENT.match(header)
        name = header if element is None else element[1]
        value = self._variable(name)
        if not isinstance(value, np.ndarray) or value.dtype.kind not in "biuf":
            kind = "complex" if np.iscomplexobj(value) else "not an array of numbers"
            raise _not_numbers(self.source, header, kind)
        if element is None and max(value.shape, default=0) != value.size:
            raise RecordingError(
                f"{name!r} of {self.source!r} is a "
                f"{'x'.join(map(str, value.shape))} array.",
                (self.source, name),
                f"Name one column or row of it, as {name}(:,1) or {name}(1,:).",
            )
        if element is not None:
            row, column = element[2], element[3]
            value = value[:, int(column) - 1] if row == ":" else value[int(row) - 1]
        return np.asarray(value, dtype=np.float64).ravel()

    def _variable(self, name: str) -> Any:
        from scipy.io import loadmat  # noqa: PLC0415

        if name not in self._read:
            file = cast(Any, io.BytesIO(self._content))
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error")
                    found = loadmat(file, variable_names=[name])
                self._read[name] = found[name]
            except Exception as error:
                raise _damaged(self.source, "MAT", error) from error
        return self._read[name]


def _offers(name: str, shape: tuple[int, ...]) -> list[str]:
    """Return what a MAT variable can be read as."""
    if len(shape) != 2 or 1 in shape:
        return [name]
    rows, columns = (n if n <= MOST_COLUMNS_LISTED else 0 for n in shape)
    by_column = [f"{name}(:,{j + 1})" for j in range(columns)]
    return [name, *by_column, *(f"{name}({i + 1},:)" for i in range(rows))]


def _damaged(source: str, kind: str, error: Exception) -> RecordingError:
    reason = " ".join(str(error).split())[:120] or type(error).__name__
    return RecordingError(
        f"{source!r} cannot be read as {kind} ({reason}).",
        (source,),
        "It may be cut short or of another kind; save it again.",
    )


def _not_numbers(source: str, header: str, kind: str) -> RecordingError:
    return RecordingError(
        f"{header!r} of {source!r} is not a column of numbers ({kind}).",
        (source, header),
        "Convert it to numbers, or leave it out with channels=(...).",
    )
