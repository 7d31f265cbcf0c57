"""Solvers as objects: fixed-step, L-stable, stiffly accurate Runge-Kutta methods.

Recorded inputs are sampled noise, which adaptive step control takes for dynamics; a
fixed step on the recording's own grid is faster and more accurate. The methods are
diagonally implicit: dry friction and electrical time constants do not limit the step.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from bondgraph.choices import refuse_other_count
from bondgraph.errors import EquationError

Array = NDArray[np.float64]


class Hold(Enum):
    """How an input behaves between its samples."""

    ZERO = "held"
    FIRST = "joined by straight lines"

    @property
    def other(self) -> "Hold":
        """The other way."""
        return Hold.ZERO if self is Hold.FIRST else Hold.FIRST


@dataclass(frozen=True, slots=True)
class Sdirk2:
    """Two stages, order 2 (Alexander, SIAM J. Numer. Anal. 14, 1977).

    Parameters
    ----------
    substeps
        Steps between two samples.

    Raises
    ------
    EquationError
        If that is not a whole number of at least one.
    """

    substeps: int = 1

    def __post_init__(self) -> None:
        _check_substeps(self)

    @property
    def tableau(self) -> tuple[Array, Array]:
        """Runge-Kutta matrix and nodes; the last row is the weights."""
        g = 1 - 1 / math.sqrt(2)
        return np.array([[g, 0.0], [1 - g, g]]), np.array([g, 1.0])


@dataclass(frozen=True, slots=True)
class Sdirk3:
    """Three stages, order 3 (Alexander, SIAM J. Numer. Anal. 14, 1977).

    Parameters
    ----------
    substeps
        Steps between two samples.

    Raises
    ------
    EquationError
        If that is not a whole number of at least one.
    """

    substeps: int = 1

    def __post_init__(self) -> None:
        _check_substeps(self)

    @property
    def tableau(self) -> tuple[Array, Array]:
        """Runge-Kutta matrix and nodes; the last row is the weights."""
        g = 0.435866521508458999416
        b1 = -(6 * g * g - 16 * g + 1) / 4
        b2 = (6 * g * g - 20 * g + 5) / 4
        matrix = np.array([[g, 0.0, 0.0], [(1 - g) / 2, g, 0.0], [b1, b2, g]])
        return matrix, np.array([g, (1 + g) / 2, 1.0])


@dataclass(frozen=True, slots=True)
class RungeKutta4:
    """The classical explicit method, four stages, order 4 (Kutta, 1901).

    For models that are plain differential equations, or become so once unknowns that
    enter linearly have been eliminated. The fastest where nothing is stiff: a step
    longer than 2.7 of the shortest time constant is unstable.

    Parameters
    ----------
    substeps
        Steps between two samples.

    Raises
    ------
    EquationError
        If that is not a whole number of at least one.
    """

    substeps: int = 1

    def __post_init__(self) -> None:
        _check_substeps(self)


Implicit = Sdirk2 | Sdirk3
"""Methods that solve for rates and unknowns together, whatever the model."""

Solver = RungeKutta4 | Implicit


def implicit(solver: Solver) -> Implicit:
    """Return the solver, or an implicit one with as many steps in place of another.

    An implicit method stays stable wherever a simulation starts.
    """
    if isinstance(solver, RungeKutta4):
        return Sdirk2(solver.substeps)
    return solver


def _check_substeps(solver: Solver) -> None:
    what = f"The number of substeps of {type(solver).__name__}"
    refuse_other_count(solver.substeps, 1, what, EquationError)
