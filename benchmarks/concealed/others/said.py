"""What another method says of a case."""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.machine import Array


@dataclass(frozen=True, slots=True)
class Said:
    """What a method says: (physics, place) or None, and its held-out residual.

    ``before`` and ``after`` are rms of the held-out residual over the noise; ``terms``
    how many terms it keeps.
    """

    finding: tuple[str, str] | None
    before: float
    after: float
    terms: int
    note: str = ""


def rms(values: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
