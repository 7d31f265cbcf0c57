"""A time limit: when the search is to end, and how much was left undone for it.

What stands when time has run out is the answer, and it says so. No step of the search
may take more than its share of the time that is left, so that every later one gets some
of it. What was worked out is in the journal; what was not has no entry there, and is
done when the work goes on.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import monotonic

SHARE = 0.5
"""Of the time left, that one step of the search may take."""

OUT_OF_TIME = "time ran out"


@dataclass(slots=True)
class Limit:
    """When the search is to end.

    Parameters
    ----------
    end
        On the monotonic clock, in seconds; inf for never.
    undone
        Pieces of work that were left for want of time.
    """

    end: float = math.inf
    undone: int = 0

    @classmethod
    def after(cls, seconds: float | None) -> "Limit":
        """Return the limit so many seconds from now; none where None."""
        return cls(math.inf if seconds is None else monotonic() + seconds)

    @property
    def passed(self) -> bool:
        """Whether time has run out."""
        return monotonic() >= self.end

    @contextmanager
    def shared(self) -> Iterator[None]:
        """Leave what comes after its share of the time that is left now."""
        whole, self.end = self.end, self.of_step()
        try:
            yield
        finally:
            self.end = whole

    def of_step(self) -> float:
        """Return when a step that begins now has to end, on the monotonic clock."""
        now = monotonic()
        return now + SHARE * max(self.end - now, 0.0)
