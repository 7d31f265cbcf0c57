"""Adaptive solvers as objects, for stiff models and inputs that are functions of time.

On sampled noise use fixed steps: step control takes noise for dynamics. Where inputs
are samples, each of these starts anew at every sample, so that the jump (held inputs)
or the bend (straight lines) lies between two integrations and is met exactly.
"""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bondgraph.choices import refuse_other_size
from bondgraph.errors import EquationError, MissingExtraError
from bondgraph.numeric.dynamics import Dynamics

Array = NDArray[np.float64]
Drive = Callable[[float], tuple[Array, Array]]
MOST_STEPS = 100_000
NEAR = 1e-7


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Piece:
    """What one integration gave: states and unknowns at the times reached."""

    x: Array
    z: Array
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Cvode:
    """CVODE of SUNDIALS: backward differentiation formulas of variable order.

    For ordinary differential equations (Hindmarsh et al., ACM TOMS 31, 2005).

    Parameters
    ----------
    rtol, atol
        Tolerances of the local error, relative and absolute.

    Raises
    ------
    EquationError
        If one is not a finite number above zero.
    """

    rtol: float = 1e-8
    atol: float = 1e-10
    takes_unknowns: ClassVar[bool] = False

    def __post_init__(self) -> None:
        _check_tolerances(self)

    def integrate(
        self, dynamics: Dynamics, drive: Drive, time: Array, x: Array, z: Array
    ) -> Piece:
        """Integrate over `time` from its first value."""
        sundials = _sundials()

        def rate(t: float, y: Array, yp: Array) -> None:
            yp[:] = dynamics.residual(t, y, np.zeros_like(y), z, *drive(t))[0]

        def slope(t: float, y: Array, yp: Array, matrix: Array) -> None:
            matrix[:, :] = dynamics.slopes(t, y, np.zeros_like(y), z, *drive(t))[0]

        solver = sundials.cvode.CVODE(
            rate,
            jacfn=slope,
            rtol=self.rtol,
            atol=self.atol,
            max_num_steps=MOST_STEPS,
        )
        found = solver.solve(_three(time), x)
        return Piece(
            x=_rows(found.y, time, found.success),
            z=np.zeros((len(time), 0)),
            message="" if found.success else str(found.message),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Ida:
    """IDA of SUNDIALS: differential-algebraic equations of index 1, as they stand.

    Hindmarsh et al., ACM TOMS 31, 2005.

    Parameters
    ----------
    rtol, atol
        Tolerances of the local error, relative and absolute.

    Raises
    ------
    EquationError
        If one is not a finite number above zero.
    """

    rtol: float = 1e-8
    atol: float = 1e-10
    takes_unknowns: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _check_tolerances(self)

    def integrate(
        self, dynamics: Dynamics, drive: Drive, time: Array, x: Array, z: Array
    ) -> Piece:
        """Integrate over `time` from its first value."""
        sundials = _sundials()
        nx, nz = len(x), len(z)
        rates, z = dynamics.settle(time[0], x, z, *drive(time[0]))

        def residual(t: float, y: Array, yp: Array, res: Array) -> None:
            rate, left = dynamics.residual(t, y[:nx], yp[:nx], y[nx:], *drive(t))
            res[:nx] = yp[:nx] - rate
            res[nx:] = left

        solver = sundials.ida.IDA(
            residual,
            rtol=self.rtol,
            atol=self.atol,
            algebraic_idx=list(range(nx, nx + nz)) or None,
            max_num_steps=MOST_STEPS,
        )
        start = np.concatenate([x, z])
        # The first step needs the rates of the unknowns as well.
        later = time[0] + NEAR * (time[-1] - time[0])
        there = x + (later - time[0]) * rates
        moved = dynamics.settle(later, there, z, *drive(later))[1] - z
        rates = np.concatenate([rates, moved / (later - time[0])])
        found = solver.solve(_three(time), start, rates)
        y = _rows(found.y, time, found.success)
        return Piece(
            x=y[:, :nx],
            z=y[:, nx:],
            message="" if found.success else str(found.message),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Radau:
    """Radau IIA of order 5, from scipy (Hairer and Wanner, 1996, section IV.8).

    Parameters
    ----------
    rtol, atol
        Tolerances of the local error, relative and absolute.

    Raises
    ------
    EquationError
        If one is not a finite number above zero.
    """

    rtol: float = 1e-8
    atol: float = 1e-10
    takes_unknowns: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _check_tolerances(self)

    def integrate(
        self, dynamics: Dynamics, drive: Drive, time: Array, x: Array, z: Array
    ) -> Piece:
        """Integrate over `time` from its first value."""
        from scipy.integrate import solve_ivp  # noqa: PLC0415  (0.4 s)

        def rate(t: float, y: Array) -> Array:
            return dynamics.settle(t, y, z, *drive(t))[0]

        found = solve_ivp(
            rate,
            (time[0], time[-1]),
            x,
            method="Radau",
            t_eval=time,
            rtol=self.rtol,
            atol=self.atol,
        )
        states = _rows(found.y.T, time, True)
        unknowns = np.full((len(time), len(z)), np.nan)
        for row in range(found.y.shape[1]):
            z = dynamics.settle(time[row], states[row], z, *drive(time[row]))[1]
            unknowns[row] = z
        return Piece(
            x=states, z=unknowns, message="" if found.success else found.message
        )


Adaptive = Cvode | Ida | Radau


def _check_tolerances(solver: Adaptive) -> None:
    for name, value in (("rtol", solver.rtol), ("atol", solver.atol)):
        what = f"The tolerance {name} of {type(solver).__name__}"
        refuse_other_size(value, what, EquationError)


def _three(time: Array) -> Array:
    """Return at least three times: of two, SUNDIALS answers with steps of its own."""
    if len(time) != 2:
        return time
    return np.array([time[0], 0.5 * (time[0] + time[1]), time[1]])


def _rows(y: Array, time: Array, complete: bool) -> Array:
    """Return `y` with one row per time, nan where it was not reached."""
    if len(time) == 2 and len(y) > 1:
        y = y[[0, -1]]
    rows = np.full((len(time), y.shape[1]), np.nan)
    reached = min(len(y), len(time)) if complete else max(len(y) - 1, 1)
    rows[:reached] = y[:reached]
    return rows


def _sundials() -> Any:
    """Return the binding of SUNDIALS."""
    try:
        for part in ("cvode", "ida"):
            import_module(f"sksundae.{part}")
    except ImportError as error:
        raise MissingExtraError(
            "Cvode and Ida are SUNDIALS, which is not installed.",
            ("scikit-sundae",),
            "Install bondgraph-workbench[stiff], or use Radau().",
        ) from error
    return import_module("sksundae")


def refuse_friction(places: tuple[str, ...]) -> None:
    """Refuse set-valued friction, which has no rate where it sticks."""
    raise EquationError(
        f"The dry friction of {', '.join(places)} is set-valued, which an adaptive "
        f"solver does not follow.",
        places,
        "Use Sdirk2() or Sdirk3(), which stick and slip, or write the law smooth: "
        "tanh(f/v) for sign(f).",
    )
