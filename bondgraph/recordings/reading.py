"""`read_recording`: a file in, a checked recording out, or one clear sentence why not.

The suffix of the path decides the kind of the file; nothing else is inferred.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from bondgraph.errors import RecordingError
from bondgraph.recordings.binary_tables import MatTable, ParquetTable
from bondgraph.recordings.csv_table import CsvTable
from bondgraph.recordings.files import check_file
from bondgraph.recordings.hdf5_table import Hdf5Table, is_hdf5
from bondgraph.recordings.recording import Recording
from bondgraph.recordings.repairs import AbstractTable, Gaps, Order, Repeats
from bondgraph.recordings.table import Choices, read_table

SUFFIXES = (".csv", ".tsv", ".txt", ".parquet", ".mat", ".h5", ".hdf5")


def read_recording(
    path: str | Path,
    *,
    mapping: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    channels: Sequence[str] | None = None,
    time: str | None = "time",
    step: float | None = None,
    steady: bool = False,
    gaps: Gaps = "refuse",
    order: Order = "refuse",
    repeats: Repeats = "refuse",
    name: str | None = None,
    delimiter: str | None = None,
    decimal: str = ".",
    encoding: str = "utf-8",
) -> Recording:
    """Read a recording from CSV (.csv, .tsv, .txt), Parquet, MAT or HDF5.

    Only the channels asked for are read, and text never more than a block at a time.

    Parameters
    ----------
    path
        The file; its first line (CSV) or its columns' names (Parquet) are written
        ``name [unit]``. A MAT file has no units: it needs a `mapping` with units. A
        dataset of an HDF5 file is named by its path, its unit is its attribute
        ``units``.
    mapping
        Channel name to name in the file, with a unit where the file has none:
        ``{"time": "t [s]", "position": "qm [m]"}``. Columns that are not mentioned keep
        their names (in a MAT file they are left unread).
    units
        Units by channel name, before those that the file or `mapping` gives.
    channels
        Names (after mapping) of the channels to read; all by default. What is not read
        is not checked.
    time
        Name of the time column, in any unit of time.
    step
        Seconds between samples, for a file without a time column.
    steady
        True if the rows are independent operating points (``time=None`` means the
        same); a time column is then a channel like any other.
    gaps
        ``"drop"`` drops rows with an empty, NaN or infinite cell and leaves a gap;
        ``"keep"`` keeps them, and those samples of those channels are unmeasured.
    order
        ``"sort"`` sorts the samples by time.
    repeats
        ``"first"`` keeps the first sample of equal times, ``"mean"`` averages them.
    name
        What to call the recording; the file's name without suffix by default.
    delimiter, decimal, encoding
        Of a CSV file; tabs by default in a .tsv.

    Raises
    ------
    RecordingError
        If the file cannot be read or is not a recording: the message names the file,
        the channel, and the line or row.
    MissingExtraError
        If the file is Parquet or HDF5 and pyarrow or h5py is not installed.
    """
    path = Path(path)
    choices = Choices(
        name=path.stem if name is None else name,
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
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise RecordingError(
            f"{str(path)!r} has the suffix {suffix!r}, which says nothing known.",
            (str(path),),
            f"Recordings end in {', '.join(SUFFIXES)}.",
        )
    check_file(path, SUFFIXES)
    return read_table(_table(path, suffix, delimiter, decimal, encoding), choices)


def _table(
    path: Path, suffix: str, delimiter: str | None, decimal: str, encoding: str
) -> AbstractTable:
    match suffix:
        case ".parquet":
            return ParquetTable(path)
        case ".mat":
            return Hdf5Table(path, matlab=True) if is_hdf5(path) else MatTable(path)
        case ".h5" | ".hdf5":
            return Hdf5Table(path)
        case _:
            between = "\t" if suffix == ".tsv" else ","
            return CsvTable(
                path,
                delimiter=between if delimiter is None else delimiter,
                decimal=decimal,
                encoding=encoding,
            )
