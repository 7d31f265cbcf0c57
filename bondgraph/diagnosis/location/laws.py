"""What a missing signal may depend on at its place: curves of what is local there.

A law that is not known is a curve: straight lines between knots at the quantiles of its
variable, with a step at zero where the variable changes sign. The curve may be the
effort (flow) itself, as for an R or a C, or what is differentiated to give it, as for
the contents of an I or of a C on a 0-junction; it may be multiplied by the load that a
neighbouring bond carries.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
QUANTILES = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)
TIME_KNOTS = 8
STEP_WIDTH = 0.02
"""Of the variable's size: over so much the step at zero is spread."""


class Form(StrEnum):
    """How the missing signal follows its variable; the value is the phrase to show."""

    CURVE = "a function of"
    RATE = "the rate of a function of"
    LOAD = "the sign of the motion times a function of"
    PERIODIC = "a sine of"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LocalVariable:
    """A variable at a place, one value per sample.

    ``role`` says what it is there: own, displacement, load, value, conjugate or time.
    """

    name: str
    role: str
    unit: str
    values: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LocalLaw:
    """A family of laws: columns whose combinations are the curves of one variable.

    ``curve`` holds the curves themselves, ``columns`` the signals they give.
    """

    form: Form
    variable: LocalVariable
    curve: Array
    columns: Array


def hats(values: Array, knots: Array) -> Array:
    """Return the hat functions of `knots` at `values`, (n, len(knots)).

    Their combinations are the curves that are straight between knots and level beyond.
    """
    unit = np.eye(len(knots))
    return np.column_stack([np.interp(values, knots, row) for row in unit])


def knots_of(values: Array, quantiles: tuple[float, ...] | None = None) -> Array:
    """Return knots at quantiles of `values`, those too close together merged."""
    finite = values[np.isfinite(values)]
    knots = np.quantile(finite, QUANTILES if quantiles is None else quantiles)
    spread = float(knots[-1] - knots[0])
    if spread <= 0.0:
        return knots[:1]
    kept = [knots[0]]
    for knot in knots[1:]:
        if knot - kept[-1] > 0.01 * spread:
            kept.append(knot)
    return np.array(kept)


def sign(values: Array) -> Array:
    """Return a sign that passes zero smoothly within 2 % of the variable's size."""
    size = float(np.sqrt(np.mean(values**2)))
    return (
        np.tanh(values / (STEP_WIDTH * size)) if size > 0.0 else np.zeros_like(values)
    )


def curve_columns(values: Array, quantiles: tuple[float, ...] | None = None) -> Array:
    """Return the columns of a free curve of `values`, with a step where they pass 0."""
    columns = hats(values, knots_of(values, quantiles))
    if values.min() < 0.0 < values.max():
        return np.column_stack([columns, sign(values)])
    return columns


def rate(columns: Array, time: Array, follows: NDArray[np.bool_]) -> Array:
    """Return the rate of every column over the step that begins at each sample."""
    steps = np.diff(time)
    changes = np.diff(columns, axis=0) / np.where(steps > 0, steps, 1.0)[:, None]
    changes[~follows[1:]] = 0.0
    return np.vstack([changes, np.zeros((1, columns.shape[1]))])


def laws_of(
    variables: Mapping[str, LocalVariable],
    time: Array,
    follows: NDArray[np.bool_],
    *,
    rotating: bool,
    quantiles: tuple[float, ...] | None = None,
) -> tuple[LocalLaw, ...]:
    """Return the families of laws that the local variables allow.

    Parameters
    ----------
    variables
        By name; the one with role ``own`` (or ``value`` at a channel) comes first.
    rotating
        Whether a displacement is an angle, of which a law may be periodic.
    quantiles
        Where curves have their knots; eight quantiles when None.
    """
    own = next((v for v in variables.values() if v.role in ("own", "value")), None)
    laws: list[LocalLaw] = []

    def add(form: Form, variable: LocalVariable, curve: Array, columns: Array) -> None:
        law = LocalLaw(form=form, variable=variable, curve=curve, columns=columns)
        laws.append(law)

    for variable in variables.values():
        values, role = variable.values, variable.role
        if not np.isfinite(values).all() or np.ptp(values) == 0.0:
            continue
        if role == "load":
            if own is not None:
                curve = hats(np.abs(values), knots_of(np.abs(values), quantiles))
                add(Form.LOAD, variable, curve, curve * sign(own.values)[:, None])
            continue
        if role == "time":
            even = np.linspace(values.min(), values.max(), TIME_KNOTS)
            add(Form.CURVE, variable, hats(values, even), hats(values, even))
            continue
        curve = curve_columns(values, quantiles)
        add(Form.CURVE, variable, curve, curve)
        if role in ("own", "value", "conjugate"):
            add(Form.RATE, variable, curve, rate(curve, time, follows))
        if role == "displacement" and rotating:
            sine = np.column_stack([np.sin(values), np.cos(values)])
            sine = np.column_stack([sine, np.ones_like(values)])
            add(Form.PERIODIC, variable, sine, sine)
    return tuple(laws)
