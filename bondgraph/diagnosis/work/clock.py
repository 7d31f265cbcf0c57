"""How far a list of work is, and how long the rest will take."""

from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic

Progress = Callable[[str], None]


@dataclass(slots=True)
class Clock:
    """Counts what is done and estimates what is left from the time it took."""

    what: str
    total: int
    progress: Progress
    done: int = 0
    started: float = field(default_factory=monotonic)

    def __post_init__(self) -> None:
        if self.total:
            self.progress(f"{self.what}, {self.total} to do")

    @property
    def left(self) -> float:
        """The seconds left, as far as one can tell; 0 before anything is done."""
        if not self.done:
            return 0.0
        return (monotonic() - self.started) / self.done * (self.total - self.done)

    def tick(self) -> None:
        """Count one more."""
        self.done += 1
        words = f", about {self.left:.0f} s left" if self.left >= 1.0 else ""
        self.progress(f"{self.what}, {self.done} of {self.total}{words}")
