"""Shares of cases with Wilson's 95 % intervals, and quantiles."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a share."""
    if trials == 0:
        return 0.0, 1.0
    z = 1.959963984540054
    share, weight = successes / trials, z * z / trials
    centre = (share + weight / 2.0) / (1.0 + weight)
    half = z * math.sqrt(share * (1 - share) / trials + weight / (4 * trials))
    half /= 1.0 + weight
    return max(0.0, centre - half), min(1.0, centre + half)


@dataclass(frozen=True, slots=True)
class Share:
    """So many of so many, with Wilson's 95 % interval."""

    successes: int
    trials: int

    def as_dict(self) -> dict[str, Any]:
        """Return it for JSON."""
        low, high = wilson(self.successes, self.trials)
        share = self.successes / self.trials if self.trials else None
        return {**asdict(self), "share": share, "low": low, "high": high}


def share(held: Iterable[bool]) -> dict[str, Any]:
    """Return the share of what held."""
    listed = list(held)
    return Share(sum(listed), len(listed)).as_dict()


def counts(values: Iterable[str]) -> dict[str, int]:
    """Return how often each value occurs, the most frequent first."""
    return dict(Counter(values).most_common())


def quantile(values: Sequence[float], at: float) -> float | None:
    """Return a quantile, or None of nothing."""
    return float(np.quantile(values, at)) if len(values) else None
