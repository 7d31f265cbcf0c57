"""Sparse Jacobians of a `NumericModel` at a point, exact to rounding.

The model says ``ẋ = rate(w, v)`` and ``0 = residual(w, v)`` with w = (ẋ, z) and
v = (x, u, u̇). One sweep over each tape gives all partial derivatives as sparse rows,
and one sparse factorisation eliminates w where there are unknowns. A law with a kink at
the point has slopes only if every side has the same; else the model is refused there.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from bondgraph.equations.transfer.operating_point import AWAY
from bondgraph.errors import EquationError
from bondgraph.numeric.model import NumericModel, evaluate
from bondgraph.numeric.tape import Tape

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Matrix = sparse.csr_array

STEEP = 1e100
"""A slope beyond this stands for an infinite one (a root at zero)."""
RAYS = 4
ITERATIONS = 60
TOLERANCE = 1e-10
TINY = 1e-6
NO_SUCH_POINT = "Give an operating point where its laws are defined."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Point:
    """Values of all variables of a model: x, ẋ, z, u, u̇, p and t."""

    x: Array
    rates: Array
    unknowns: Array
    u: Array
    input_rates: Array
    p: Array
    t: float = 0.0

    @property
    def variables(self) -> Array:
        """The values in the order of the tapes."""
        parts = (self.x, self.rates, self.unknowns, self.u, self.input_rates, self.p)
        return np.concatenate([*parts, [self.t]])


@dataclass(frozen=True, slots=True, kw_only=True)
class Slopes:
    """Partial derivatives of a model at a point; rows are (ẋ - rate, residual) and y.

    ``implicit`` and ``read`` are those along w = (ẋ, z), ``explicit`` and ``direct``
    those along v = (x, u, u̇).
    """

    model: NumericModel
    implicit: Matrix
    explicit: Matrix
    read: Matrix
    direct: Matrix

    def eliminated(self) -> tuple[Matrix, Matrix]:
        """Return the sensitivities of ẋ and of y to v = (x, u, u̇).

        Raises
        ------
        EquationError
            If the residuals do not determine the unknowns here.
        """
        n = self.model.n_states
        if not self.model.n_unknowns or not self.explicit.shape[1]:
            followed = -self.explicit
        else:
            solve = factored(self.implicit, self.model)
            followed = _solved_in_parts(solve, -self.explicit)
        return followed[:n], sparse.csr_array(self.read @ followed + self.direct)


def factored(matrix: Matrix, model: NumericModel) -> "sparse.linalg.SuperLU":
    """Return the factors of dr/dw, or refuse naming the model."""
    if not np.isfinite(matrix.data).all():
        raise _undefined(model)
    try:
        return splu(sparse.csc_array(matrix))
    except RuntimeError:  # SuperLU's word for singular
        raise EquationError(
            f"The equations of {model.name!r} do not determine their unknowns at this "
            f"point and these parameter values.",
            (model.name,),
            "Try other values, or put an R or a storage between the elements "
            "concerned.",
        ) from None


def _solved_in_parts(
    lu: "sparse.linalg.SuperLU", right: Matrix, width: int = 256
) -> Matrix:
    """Solve for many sparse columns, a few at a time, so that zeros take no memory."""
    columns = sparse.csc_array(right)
    parts = []
    for at in range(0, columns.shape[1], width):
        dense = lu.solve(columns[:, at : at + width].toarray())
        parts.append(sparse.csc_array(dense))
    return sparse.csr_array(sparse.hstack(parts))


def _undefined(model: NumericModel) -> EquationError:
    return EquationError(
        f"A law of {model.name!r} is not defined at this point.",
        (model.name,),
        NO_SUCH_POINT,
    )


def _swept(
    tape: Tape, variables: Array, ray: Array, column: Integers
) -> tuple[Array, Matrix, bool]:
    """Return values and slopes of a tape's results, and whether a kink was met."""
    from bondgraph.numeric.kernel.slopes import gathered, partials, rows  # noqa: PLC0415

    first = tape.n_variables + len(tape.constants)
    v, tangent = np.zeros(tape.n_slots), np.zeros(tape.n_slots)
    where = np.full(first, -1, dtype=np.int64)
    v[: tape.n_variables] = variables
    v[tape.n_variables : first] = tape.constants
    tangent[: tape.n_variables] = ray
    where[: tape.n_variables] = column
    reads = np.zeros((len(tape.code), 2), dtype=np.int64)
    slopes = np.zeros((len(tape.code), 2))
    kinked = partials(tape.code, first, v, tangent, reads, slopes)
    bounds, columns, numbers = gathered(
        *rows(reads, slopes, first, where), tape.outputs
    )
    shape = len(tape.outputs), int((column >= 0).sum())
    matrix = sparse.csr_array((numbers, columns, bounds), shape=shape)
    return v[tape.outputs], matrix, bool(kinked)


def _smooth(
    model: NumericModel, tape: Tape, variables: Array, column: Integers
) -> Matrix:
    """Return the slopes of a tape's results, or refuse a kink at this point.

    Where a kink is met, the slopes are taken on both sides along several directions:
    only what is the same on all of them is a derivative.
    """
    moving = (column >= 0).astype(float)
    draw = np.random.default_rng(0)
    ray = moving * draw.uniform(0.5, 1.5, len(moving))
    values, matrix, kinked = _swept(tape, variables, ray, column)
    if not kinked:
        _refuse_undefined(model, tape, values, matrix)
        return matrix
    for k in range(2 * RAYS):
        if k:
            ray = moving * draw.uniform(0.5, 1.5, len(moving))
            ray *= draw.choice([-1.0, 1.0], len(moving))
        for side in (ray, -ray):
            other_values, other, _ = _swept(tape, variables, side, column)
            _refuse_undefined(model, tape, other_values, other)
            _refuse_kink(model, tape, values - other_values, matrix - other)
    return matrix


def _refuse_undefined(
    model: NumericModel, tape: Tape, values: Array, matrix: Matrix
) -> None:
    bad = np.flatnonzero(~np.isfinite(values))
    if not len(bad):
        slopes = matrix.tocoo()
        wrong = ~(np.abs(slopes.data) < STEEP)
        bad = slopes.coords[0][wrong]
    if len(bad):
        what = _result(model, tape, int(bad[0]))
        raise EquationError(
            f"{model.name!r} has no linear form at this operating point: {what} has no "
            f"finite value or slope there.",
            (model.name,),
            NO_SUCH_POINT,
        )


def _refuse_kink(
    model: NumericModel, tape: Tape, jump: Array, difference: Matrix
) -> None:
    apart = difference.tocoo()
    scale = max(1.0, float(np.abs(apart.data).max(initial=0.0)))
    rows = apart.coords[0][np.abs(apart.data) > 1e-12 * scale]
    jumps = np.flatnonzero(np.abs(jump) > 1e-12 * max(1.0, np.abs(jump).max(initial=0)))
    for found, word in ((jumps, "jumps"), (rows, "has a kink")):
        if len(found):
            raise EquationError(
                f"{model.name!r} has no linear form at this operating point: "
                f"{_result(model, tape, int(found[0]))} {word} there.",
                (model.name,),
                AWAY,
            )


def _result(model: NumericModel, tape: Tape, row: int) -> str:
    """Say in words which result of a tape a row is."""
    if tape is model.output:
        return f"the output {model.output_names[row]!r}"
    if row < model.n_states:
        return f"the rate of {model.state_names[row]!r}"
    return f"the equation of unknown {row - model.n_states + 1}"


def slopes(model: NumericModel, at: Point) -> Slopes:
    """Return all partial derivatives of `model` at a point.

    Raises
    ------
    EquationError
        If a law has no slope there; says which rate or output.
    """
    column = _columns(model)
    return _arranged(
        model,
        _smooth(model, model.dynamics, at.variables, column),
        _smooth(model, model.output, at.variables, column),
    )


def one_sided(model: NumericModel, at: Point, width: int | None = None) -> Matrix:
    """Return the slopes of (ẋ - rate, residual) along w and v, the first `width` alone.

    At a kink they are those of one of its sides: good enough to step towards a
    solution, not to say what a machine does there.
    """
    column = _columns(model)
    ray = (column >= 0).astype(float)
    _, dynamics, _ = _swept(model.dynamics, at.variables, ray, column)
    return _of_equations(model, dynamics, width)


def _columns(model: NumericModel) -> Integers:
    """Return the column of each variable: w first, then v, -1 for p and t."""
    nx, nu = model.n_states, len(model.input_names)
    nw = nx + model.n_unknowns
    column = np.full(model.dynamics.n_variables, -1, dtype=np.int64)
    column[:nx] = np.arange(nx) + nw
    column[nx : nx + nw] = np.arange(nw)
    column[nx + nw : nx + nw + 2 * nu] = np.arange(2 * nu) + nw + nx
    return column


def _arranged(model: NumericModel, dynamics: Matrix, output: Matrix) -> Slopes:
    nw = model.n_states + model.n_unknowns
    equations = _of_equations(model, dynamics)
    return Slopes(
        model=model,
        implicit=equations[:, :nw],
        explicit=equations[:, nw:],
        read=output[:, :nw],
        direct=output[:, nw:],
    )


def _of_equations(
    model: NumericModel, dynamics: Matrix, width: int | None = None
) -> Matrix:
    """Return the slopes of (ẋ - rate, residual) from those of (rate, residual)."""
    height, every = dynamics.shape
    width = every if width is None else width
    rows = np.repeat(np.arange(height), np.diff(dynamics.indptr))
    within = dynamics.indices < width
    rows, columns = rows[within], dynamics.indices[within]
    steep = dynamics.data[within]
    own = np.arange(model.n_states)
    signed = np.where(rows < model.n_states, -steep, steep)
    # What is given twice for one place, as a rate that its own law reads, is added.
    entries = (
        np.append(np.ones(len(own)), signed),
        (np.append(own, rows), np.append(own, columns)),
    )
    matrix = sparse.csr_array(entries, shape=(height, width))
    matrix.eliminate_zeros()
    return matrix


def settled(model: NumericModel, start: Point) -> Point:
    """Return `start` with the rates and unknowns that the equations give there.

    Newton from the rates and unknowns in `start`; steps are halved until the residual
    shrinks.

    Raises
    ------
    EquationError
        If no solution is found from there.
    """
    nx = model.n_states
    here = start
    w = np.concatenate([start.rates, start.unknowns])
    r = residual(model, here)
    for _ in range(ITERATIONS):
        if not model.n_unknowns:
            return replace(here, rates=w - r)
        step = factored(one_sided(model, here, len(w)), model).solve(r)
        for halving in range(30):
            new = w - step * 0.5**halving
            trial = replace(here, rates=new[:nx], unknowns=new[nx:])
            r_new = residual(model, trial)
            if np.isfinite(r_new).all() and (
                model.linear or np.linalg.norm(r_new) < np.linalg.norm(r)
            ):
                break
        small = np.abs(new - w) <= TOLERANCE * (TINY + np.abs(new))
        here, w, r = trial, new, r_new
        if model.linear or small.all():
            break
    if not np.isfinite(r).all() or not (model.linear or small.all()):
        raise EquationError(
            f"The unknowns of {model.name!r} were not found at this point.",
            (model.name,),
            'Give start values of them: at={"name": value}.',
        )
    return here


def residual(model: NumericModel, at: Point) -> Array:
    """Return (ẋ - rate, residual)."""
    values, _ = evaluate(model.dynamics, at.variables, np.zeros((len(at.variables), 0)))
    nx = model.n_states
    return np.concatenate([at.rates - values[:nx], values[nx:]])


def jacobian(
    model: NumericModel, x: Array, u: Array, p: Array, *, t: float = 0.0
) -> Matrix:
    """Return dẋ/dx as a sparse matrix, with the unknowns eliminated.

    Parameters
    ----------
    x, u, p
        States, inputs (held constant) and parameters in the model's order, SI units.

    Raises
    ------
    EquationError
        If a law has no slope at this point, or the unknowns are not determined.
    """
    at = settled(model, point(model, x, u, p, t=t))
    rates, _ = slopes(model, at).eliminated()
    return rates[:, : model.n_states]


def point(
    model: NumericModel, x: Array, u: Array, p: Array, *, t: float = 0.0
) -> Point:
    """Return a point with rates, unknowns and input rates at zero."""
    u = np.asarray(u, dtype=float)
    return Point(
        x=np.asarray(x, dtype=float),
        rates=np.zeros(model.n_states),
        unknowns=np.zeros(model.n_unknowns),
        u=u,
        input_rates=np.zeros_like(u),
        p=np.asarray(p, dtype=float),
        t=t,
    )
