"""Signals that go on all through a recording as they began.

Where a motion has died away, or has gone one way only, what changes with time and what
changes with the motion look the same. Where it comes back late as it was early they do
not.
"""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

OFTEN = 10
"""So many times a signal passes its median at least."""

ALIKE = 2.0
"""What is farther from it late than early by less than this factor comes back."""


def lasting(time: Array, signals: Mapping[str, Array]) -> frozenset[str]:
    """Return the names of the signals that go on so, in one recording at least.

    Parameters
    ----------
    time
        Of all samples, (n,); it goes back where another recording begins.
    signals
        Samples by name, (n,) each; what is not known is nan.
    """
    begins = np.flatnonzero(np.diff(time) <= 0.0) + 1
    parts = [slice(a, b) for a, b in pairwise([0, *begins.tolist(), len(time)])]
    return frozenset(
        name
        for name, values in signals.items()
        if any(_goes_on(values[part]) for part in parts)
    )


def _goes_on(values: Array) -> bool:
    """Return whether values come back to their median often, and from as far."""
    values = values[np.isfinite(values)]
    if len(values) < OFTEN:
        return False
    off = values - np.median(values)
    half = len(off) // 2
    early, late = np.sqrt(np.mean(off[:half] ** 2)), np.sqrt(np.mean(off[half:] ** 2))
    often = np.count_nonzero(np.diff(np.sign(off))) >= OFTEN
    return bool(often and max(early, late) < ALIKE * min(early, late))
