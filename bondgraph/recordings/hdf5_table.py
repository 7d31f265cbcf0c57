"""Reading HDF5, and MAT files of version 7.3, which are HDF5 inside.

Every numeric dataset is offered by its path, a matrix also column by column and row by
row. Only numbers stored in the file itself are read: links to other files, references
and objects are not followed.
"""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from bondgraph.errors import MissingExtraError, RecordingError
from bondgraph.recordings.binary_tables import (
    check_lengths,
    damaged,
    is_matrix,
    not_numbers,
    offers,
    split_offer,
)
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.files import check_unpacked, digest
from bondgraph.recordings.names import join_header, split_header
from bondgraph.recordings.repairs import AbstractTable

SIGNATURE = b"\x89HDF\r\n\x1a\n"

MATLAB_HEADER = 512
"""Bytes that MATLAB writes before the HDF5 content of a MAT file."""

UNIT_ATTRIBUTES = ("units", "unit")


def is_hdf5(path: Path) -> bool:
    """Return whether a file is HDF5 by its signature, also behind a MAT header."""
    with path.open("rb") as file:
        start = file.read(MATLAB_HEADER + len(SIGNATURE))
    return start.startswith(SIGNATURE) or start[MATLAB_HEADER:].startswith(SIGNATURE)


class Hdf5Table(AbstractTable):
    """The numeric datasets of an HDF5 file; units from their ``units`` attribute.

    Parameters
    ----------
    path
        The file.
    matlab
        Whether MATLAB wrote it: arrays are then stored transposed, without units.
    """

    def __init__(self, path: Path, *, matlab: bool = False) -> None:
        try:
            import h5py  # noqa: PLC0415
        except ImportError as error:
            raise MissingExtraError(
                f"Reading {str(path)!r} needs h5py.",
                ("h5py",),
                "Install bondgraph-workbench[data].",
            ) from error
        self.source = str(path)
        self.sha256 = digest(path)
        self._path = path
        self._matlab = matlab
        self._kind = "MAT 7.3" if matlab else "HDF5"
        found: list[str] = []
        units: list[str | None] = []

        def visit(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.dtype.kind in "biuf":
                if matlab and name.startswith("#"):
                    return  # where MATLAB keeps the content of its cells
                unit = None if matlab else _unit(item)
                for offer in offers(name, self._shape(item)):
                    found.append(offer)
                    units.append(unit)

        try:
            # The walk follows hard links only, so it cannot leave the file.
            with h5py.File(path, "r") as file:
                file.visititems(visit)
        except Exception as error:
            raise damaged(self.source, self._kind, error) from error
        self.has_units = any(unit is not None for unit in units)
        self.headers = tuple(
            name if unit is None else join_header(name, unit)
            for name, unit in zip(found, units, strict=True)
        )

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the datasets numbered `indices`."""
        import h5py  # noqa: PLC0415

        headers = [split_header(self.headers[index])[0] for index in indices]
        try:
            with h5py.File(self._path, "r") as file:
                columns = [self._vector(file, header) for header in headers]
        except RecordingError:
            raise
        except Exception as error:
            raise damaged(self.source, self._kind, error) from error
        check_lengths(self.source, headers, columns)
        return columns

    def row(self, i: int) -> str:
        """Return the number of a sample, as MATLAB counts where it wrote the file."""
        return f"sample {i + 1}" if self._matlab else f"row {i}"

    def _vector(self, file: Any, header: str) -> FloatArray:
        name, part = split_offer(header)
        item = file[name]
        shape = self._shape(item)
        check_unpacked(self._path, item.size if part is None else max(shape))
        if part is None:
            if max(shape, default=0) != item.size:
                raise is_matrix(self.source, name, shape)
            value = item[()]
        else:
            value = item[part[::-1] if self._matlab else part]
        if value.dtype.kind not in "biuf":
            raise not_numbers(self.source, header, str(value.dtype))
        return np.asarray(value, dtype=np.float64).ravel()

    def _shape(self, item: Any) -> tuple[int, ...]:
        return tuple(reversed(item.shape)) if self._matlab else tuple(item.shape)


def _unit(item: Any) -> str | None:
    """Return the unit that a dataset states, None where it states none."""
    for attribute in UNIT_ATTRIBUTES:
        with suppress(KeyError, OSError, TypeError):
            value = item.attrs[attribute]
            text = (
                value.decode("utf-8", "replace") if isinstance(value, bytes) else value
            )
            if isinstance(text, str):
                return text.strip() or "1"
    return None
