"""How a fit comes near its optimum: a choice, as an object.

Simulated over a long recording, a machine that swings, sticks or runs unstable gives a
cost with many minima, and a descent from the first guess ends in the nearest. Over a
short stretch from a state of its own the same machine is nearly linear in everything,
so that the descent leads to one place. The strategies differ in how they get from the
short to the long (`fitting.growing`, `fitting.multiple_shooting`).
"""

from dataclasses import dataclass

from bondgraph.errors import FitError
from bondgraph.fitting.horizon import SHORTEST


@dataclass(frozen=True, slots=True)
class Direct:
    """Descend on the final problem at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GrowingWindows:
    """Fit short windows first, then longer ones, each from where the last ended.

    The state at the beginning of a longer window is taken from the shorter ones.

    Parameters
    ----------
    shortest
        Samples in the first windows; there the fit amounts to fitting the equations.
    factor
        By which the windows grow.

    Raises
    ------
    FitError
        If the windows do not grow.
    """

    shortest: int = SHORTEST
    factor: int = 4

    def __post_init__(self) -> None:
        if self.shortest < 2 or self.factor < 2:
            raise FitError(
                f"Windows from {self.shortest} samples do not grow by "
                f"{self.factor} times.",
                (),
                "Give at least two samples and a factor of two.",
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class MultipleShooting:
    """Fit windows that need not join, and draw them together until they do.

    The gaps between the end of one window and the beginning of the next cost a
    penalty that rises until the trajectory is one (H. Bock, 1983). It needs the
    states only where windows meet and does not care how unstable the machine is.

    Parameters
    ----------
    windows
        Into how many each recording is cut.
    rise
        By which factor the penalty rises from one round to the next.

    Raises
    ------
    FitError
        If there is nothing to join, or the penalty does not rise.
    """

    windows: int = 100
    rise: float = 10.0

    def __post_init__(self) -> None:
        if self.windows < 2 or not self.rise > 1.0:
            raise FitError(
                f"{self.windows} windows and a rise of {self.rise:g} are no multiple "
                "shooting.",
                (),
                "Give at least two windows and a rise above one.",
            )


Strategy = Direct | GrowingWindows | MultipleShooting
