"""Reading Parquet and MAT: other people's formats through their own libraries.

Whatever those libraries raise over a damaged file becomes one refusal that names it.
Neither format runs code when it is read.
"""

import math
import re
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bondgraph.errors import MissingExtraError, RecordingError
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.files import check_unpacked, digest
from bondgraph.recordings.repairs import AbstractTable

MOST_COLUMNS_LISTED = 64
"""A matrix with more rows (columns) than this is not a table of channels that way."""

ROWS = 1 << 20
"""Rows of a Parquet file held at a time."""

_ELEMENT = re.compile(r"^([\w/.]+)\((:|\d+),(:|\d+)\)$")


class ParquetTable(AbstractTable):
    """The content of a Parquet file whose columns are named ``name [unit]``."""

    def __init__(self, path: Path) -> None:
        try:
            import pyarrow.parquet as pq  # noqa: PLC0415
        except ImportError as error:
            raise MissingExtraError(
                f"Reading {str(path)!r} needs pyarrow.",
                ("pyarrow",),
                "Install bondgraph-workbench[data].",
            ) from error
        self.source, self._path = str(path), path
        self.sha256 = digest(path)
        try:
            self._file: Any = pq.ParquetFile(path)
            self.headers = tuple(self._file.schema_arrow.names)
        except Exception as error:
            raise damaged(self.source, "Parquet", error) from error

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the columns numbered `indices`; nan stands for a null."""
        count = self._file.metadata.num_rows
        check_unpacked(self._path, count * len(indices))
        try:
            columns = [np.empty(count) for _ in indices]
        except (ValueError, MemoryError) as error:
            raise damaged(self.source, "Parquet", error) from error
        filled = 0
        for block in self.blocks(indices):
            size = min(block[0].size, count - filled)
            for column, values in zip(columns, block, strict=True):
                column[filled : filled + size] = values[:size]
            filled += block[0].size
        if filled != count:
            found = ValueError(f"{filled} rows, and it says {count}")
            raise damaged(self.source, "Parquet", found)
        return columns

    def blocks(self, indices: Sequence[int]) -> Iterator[list[FloatArray]]:
        """Yield the columns numbered `indices` row group by row group."""
        import pyarrow as pa  # noqa: PLC0415

        headers = [self.headers[index] for index in indices]
        for header in headers:
            kind = self._file.schema_arrow.field(header).type
            numeric = pa.types.is_integer(kind) or pa.types.is_floating(kind)
            if not numeric and not pa.types.is_boolean(kind):
                raise not_numbers(self.source, header, str(kind))
        try:
            for batch in self._file.iter_batches(ROWS, columns=headers):
                yield [_floats(batch.column(header), pa) for header in headers]
        except Exception as error:
            raise damaged(self.source, "Parquet", error) from error


def _floats(column: Any, pa: Any) -> FloatArray:
    values = column.cast(pa.float64()).to_numpy(zero_copy_only=False)
    return np.asarray(values, dtype=np.float64)


class MatTable(AbstractTable):
    """The variables of a MAT file, version 4 to 7.2 (7.3 is an `Hdf5Table`).

    A matrix is offered column by column and row by row, as ``x(:,2)`` and ``x(1,:)``.
    """

    has_units = False

    def __init__(self, path: Path) -> None:
        from scipy.io import whosmat  # noqa: PLC0415

        self.source = str(path)
        self.sha256 = digest(path)
        self._path = path
        self._read: dict[str, Any] = {}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                found = whosmat(str(path), appendmat=False)
        except NotImplementedError as error:
            raise damaged(self.source, "MAT 7.3", error) from error
        except Exception as error:
            raise damaged(self.source, "MAT", error) from error
        self.headers = tuple(
            offer for name, shape, _ in found for offer in offers(name, shape)
        )
        self._sizes = {name: math.prod(shape) for name, shape, _ in found}

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the variables numbered `indices`."""
        columns = [self._vector(self.headers[index]) for index in indices]
        check_lengths(self.source, [self.headers[i] for i in indices], columns)
        return columns

    def row(self, i: int) -> str:
        """Return the number of a sample as MATLAB counts, from 1."""
        return f"sample {i + 1}"

    def _vector(self, header: str) -> FloatArray:
        name, part = split_offer(header)
        value = self._variable(name)
        if not isinstance(value, np.ndarray) or value.dtype.kind not in "biuf":
            kind = "complex" if np.iscomplexobj(value) else "not an array of numbers"
            raise not_numbers(self.source, header, kind)
        if part is None and max(value.shape, default=0) != value.size:
            raise is_matrix(self.source, name, value.shape)
        if part is not None:
            value = value[part]
        return np.asarray(value, dtype=np.float64).ravel()

    def _variable(self, name: str) -> Any:
        from scipy.io import loadmat  # noqa: PLC0415

        if name not in self._read:
            check_unpacked(self._path, self._sizes[name])
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error")
                    found = loadmat(
                        str(self._path), appendmat=False, variable_names=[name]
                    )
                self._read[name] = found[name]
            except Exception as error:
                raise damaged(self.source, "MAT", error) from error
        return self._read[name]


def offers(name: str, shape: tuple[int, ...]) -> list[str]:
    """Return what a variable can be read as: itself, or one column or row of it."""
    if len(shape) != 2 or 1 in shape:
        return [name]
    rows, columns = (n if n <= MOST_COLUMNS_LISTED else 0 for n in shape)
    by_column = [f"{name}(:,{j + 1})" for j in range(columns)]
    return [name, *by_column, *(f"{name}({i + 1},:)" for i in range(rows))]


def split_offer(header: str) -> tuple[str, tuple[slice | int, slice | int] | None]:
    """Return the variable that an offer names, and the part of it, None for all."""
    match = _ELEMENT.match(header)
    if match is None:
        return header, None
    if match[2] == ":":
        return match[1], (slice(None), int(match[3]) - 1)
    return match[1], (int(match[2]) - 1, slice(None))


def check_lengths(
    source: str, headers: Sequence[str], columns: Sequence[FloatArray]
) -> None:
    """Refuse channels that have different numbers of samples."""
    for header, column in zip(headers, columns, strict=True):
        if column.size != columns[0].size:
            raise RecordingError(
                f"{header!r} of {source!r} has {column.size} "
                f"values and {headers[0]!r} has {columns[0].size}.",
                (source, header),
                "Channels of one recording have one value per sample each.",
            )


def is_matrix(source: str, name: str, shape: tuple[int, ...]) -> RecordingError:
    """Return the refusal of a whole matrix as one channel."""
    return RecordingError(
        f"{name!r} of {source!r} is a {'x'.join(map(str, shape))} array.",
        (source, name),
        f"Name one column or row of it, as {name}(:,1) or {name}(1,:).",
    )


def damaged(source: str, kind: str, error: Exception) -> RecordingError:
    """Return the refusal of a file that its library cannot read."""
    reason = " ".join(str(error).split())[:120] or type(error).__name__
    return RecordingError(
        f"{source!r} cannot be read as {kind} ({reason}).",
        (source,),
        "It may be cut short or of another kind; save it again.",
    )


def not_numbers(source: str, header: str, kind: str) -> RecordingError:
    """Return the refusal of a column that holds something else."""
    return RecordingError(
        f"{header!r} of {source!r} is not a column of numbers ({kind}).",
        (source, header),
        "Convert it to numbers, or leave it out with channels=(...).",
    )
