"""Samples packed into a page, so that a chart can be looked at as closely as recorded.

A page holds the samples themselves, in 16 bits each, as differences, byte by byte,
deflated and in base64; a script unpacks them when somebody zooms, and draws least and
greatest values from pyramids of them. Recordings too long for that are packed as the
least and the greatest of every few samples, so that no spike is lost.
"""

import base64
import json
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GAP = 0
"""The code of a value that is not finite."""

LEVELS = 65_535
MOST_VALUES = 4_000_000  # of a page: some 6 megabytes
STEADY = 1e-3  # of a step: how far a clock may be off and still be called even
LARGEST_TIME = 2**32 - 1


@dataclass(frozen=True, slots=True)
class Packed:
    """Samples as text for a page: how to read them, and themselves."""

    header: str
    data: str


def keep_every(sizes: Iterable[int]) -> int:
    """Return of how many samples only the least and greatest are kept, 1 for all.

    Parameters
    ----------
    sizes
        Number of samples of each output of each recording.
    """
    samples = sum(sizes)
    every = 1
    while samples * (3 if every == 1 else 10 / every) > MOST_VALUES:
        every *= 2
    return every


def pack(
    time: Array, series: Mapping[str, Array], sums: Mapping[str, str], every: int
) -> Packed:
    """Return samples packed.

    Parameters
    ----------
    time
        Shape (n,), increasing.
    series
        By name, each of shape (n,); what is not finite is a gap.
    sums
        Series that need not be packed while every sample is kept, because they are
        another one plus ``measured``: name of the sum, and of the other one.
    every
        Of how many samples only the least and greatest are kept.
    """
    count = len(time)
    chunks: list[bytes] = []
    start, step = _clock(time)
    if step is None:
        chunks.append(_planes(_time_codes(time[::every])))
    described = []
    for name, values in series.items():
        low, size = _scale(values)
        addend = sums.get(name) if every == 1 else None
        described.append({"name": name, "low": low, "step": size, "plus": addend})
        if addend is None:
            for kept in _kept(_codes(values, low, size), every):
                chunks.append(_planes(kept))
    header = {
        "count": -(-count // every),
        "every": every,
        "start": start,
        "end": float(time[-1]),
        "step": None if step is None else step * every,
        "series": described,
    }
    data = zlib.compress(b"".join(chunks), 6)
    return Packed(json.dumps(header), base64.b64encode(data).decode("ascii"))


def _clock(time: Array) -> tuple[float, float | None]:
    """Return the first time, and the step where all steps are equal."""
    start, count = float(time[0]), len(time)
    if count == 1:
        return start, 1.0
    step = (float(time[-1]) - start) / (count - 1)
    off = np.abs(time - (start + step * np.arange(count))).max()
    return start, step if off <= STEADY * step else None


def _time_codes(time: Array) -> NDArray[np.uint32]:
    span = float(time[-1] - time[0]) or 1.0
    codes: NDArray[np.uint32] = np.round((time - time[0]) / span * LARGEST_TIME).astype(
        np.uint32
    )
    return codes


def _scale(values: Array) -> tuple[float, float]:
    """Return the least value and the size of one level."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    return low, (high - low) / (LEVELS - 1) or 1.0


def _codes(values: Array, low: float, step: float) -> NDArray[np.uint16]:
    finite = np.isfinite(values)
    levels = np.round((np.where(finite, values, low) - low) / step) + 1
    return np.where(finite, levels, GAP).astype(np.uint16)


def _kept(codes: NDArray[np.uint16], every: int) -> list[NDArray[np.uint16]]:
    """Return the codes, or the least and the greatest of every few."""
    if every == 1:
        return [codes]
    rows = -(-len(codes) // every)
    padded = np.full(rows * every, GAP, dtype=np.uint16)
    padded[: len(codes)] = codes
    table = padded.reshape(rows, every)
    least = np.where(table == GAP, LEVELS, table).min(axis=1)
    greatest = table.max(axis=1)
    return [np.where(greatest == GAP, GAP, least).astype(np.uint16), greatest]


def _planes(codes: NDArray[np.uint16] | NDArray[np.uint32]) -> bytes:
    """Return differences, all low bytes first: neighbours are alike, so that deflates.

    Differences wrap around, as the sums that undo them do.
    """
    differences = np.diff(codes, prepend=codes.dtype.type(0))
    low_first = differences.astype(codes.dtype.newbyteorder("<"))
    return low_first.view(np.uint8).reshape(len(codes), -1).T.tobytes()
