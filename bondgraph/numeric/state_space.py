"""Linear systems with numbers in them, and their python-control twins.

The matrices come from the same chain rule as the symbolic ones, with each partial
derivative evaluated to a float first, so that size costs little.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.equations.chain_rule import Row, propagate, row_of, seeded
from bondgraph.equations.derivation import derive
from bondgraph.equations.operating_point import OperatingPoint
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.transfer_function import TransferFunction
from bondgraph.errors import EquationError
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import parameter_symbol

if TYPE_CHECKING:
    import control

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class StateSpace:
    """``ẋ = A x + B u``, ``y = C x + D u`` in SI units, with named signals.

    Where an input is differentiated, the states are x - B_rate u (see
    `state_space`), so that its rate does not appear.
    """

    name: str
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    state_units: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray

    def poles(self) -> NDArray[np.complex128]:
        """Return the eigenvalues of A in 1/s, sorted by magnitude."""
        values: NDArray[np.complex128] = np.linalg.eigvals(self.A).astype(complex)
        return values[np.argsort(np.abs(values), kind="stable")]

    def response(self, omega: FloatArray) -> NDArray[np.complex128]:
        """Return the frequency response ``[frequency, output, input]``.

        Parameters
        ----------
        omega
            Angular frequencies in rad/s.
        """
        eye = np.eye(len(self.states))
        return np.array(
            [
                self.C @ np.linalg.solve(1j * w * eye - self.A, self.B) + self.D
                for w in omega
            ]
        )


def state_space(
    graph: FinishedGraph, *, at: Mapping[str, float] | None = None
) -> StateSpace:
    """Return the linear system of `graph` at its parameter values.

    Parameters
    ----------
    at
        Operating point of a nonlinear model: values of states and inputs by name.

    Raises
    ------
    ParameterError
        If a parameter has no value.
    EquationError
        If an output follows the rate of an input (an improper system), or the model
        has no linear form at the operating point.
    """
    return from_equations(derive(graph), graph.parameters.values_by_name(), at=at)


def from_equations(
    equations: StateEquations,
    values: Mapping[str, float],
    *,
    at: Mapping[str, float] | None = None,
) -> StateSpace:
    """Return the linear system of `equations` at these parameter values."""
    x, y = _matrices(equations, values, at)
    n, m = len(equations.states), len(equations.inputs)
    A, B, B_rate = x[:, :n], x[:, n : n + m], x[:, n + m :]
    C, D, D_rate = y[:, :n], y[:, n : n + m], y[:, n + m :]
    if np.any(D_rate):
        row, column = np.argwhere(D_rate)[0]
        output, source = equations.outputs[row].name, str(equations.inputs[column])
        raise EquationError(
            f"The output {output!r} follows the rate of the input {source!r}, so the "
            f"system is improper.",
            (output, source),
            "Use the transfer function, or put an R or a storage between the two.",
        )
    return StateSpace(
        name=equations.name,
        states=tuple(s.symbol.name for s in equations.states),
        inputs=tuple(u.name for u in equations.inputs),
        outputs=tuple(o.name for o in equations.outputs),
        state_units=tuple(s.unit for s in equations.states),
        input_units=equations.input_units,
        output_units=tuple(o.unit for o in equations.outputs),
        A=A,
        B=B + A @ B_rate,
        C=C,
        D=D + C @ B_rate,
    )


def _matrices(
    equations: StateEquations,
    values: Mapping[str, float],
    at: Mapping[str, float] | None,
) -> tuple[FloatArray, FloatArray]:
    """Return the sensitivities of rates and outputs to (x, u, u̇)."""
    numbers = {parameter_symbol(n): sympy.Float(v) for n, v in values.items()}
    point = OperatingPoint(equations, at)

    def evaluate(partial: sympy.Expr) -> float:
        if partial.is_Number:
            return float(partial)
        return float(point(partial).xreplace(numbers))

    states = [state.symbol for state in equations.states]
    leaves = [*states, *equations.inputs, *equations.input_rates]
    rates = [state.rate for state in equations.states]
    rows = seeded((*leaves, *equations.unknowns), 1.0)
    early, late = equations.around_rates()
    propagate(rows, early, evaluate)
    for rate, expression in zip(rates, equations.rates, strict=True):
        rows[rate] = row_of(expression, rows, evaluate)
    propagate(rows, late, evaluate)
    residuals = [row_of(r, rows, evaluate) for r in equations.residuals]
    outputs = [row_of(o.expression, rows, evaluate) for o in equations.outputs]
    unknowns = equations.unknowns
    followed = -np.linalg.solve(_dense(residuals, unknowns), _dense(residuals, leaves))
    top, bottom = [rows[rate] for rate in rates], outputs
    x, y = (
        _dense(part, leaves) + _dense(part, unknowns) @ followed
        for part in (top, bottom)
    )
    return x, y


def _dense(rows: Sequence[Row], columns: Sequence[sympy.Symbol]) -> FloatArray:
    place = {symbol: j for j, symbol in enumerate(columns)}
    matrix = np.zeros((len(rows), len(columns)))
    for i, row in enumerate(rows):
        for symbol, value in row.items():
            if symbol in place:
                matrix[i, place[symbol]] = value
    return matrix


def to_control(model: StateSpace) -> "control.StateSpace":
    """Return `model` as a python-control system with the same signal names."""
    import control  # noqa: PLC0415  (1 s; only its users wait for it)

    return control.StateSpace(
        model.A,
        model.B,
        model.C,
        model.D,
        states=list(model.states),
        inputs=list(model.inputs),
        outputs=list(model.outputs),
        name=_plain(model.name),
    )


def transfer_function_to_control(
    transfer: TransferFunction, values: Mapping[str, float]
) -> "control.TransferFunction":
    """Return `transfer` at these parameter values as a python-control system.

    Raises
    ------
    ParameterError
        If a parameter in it has no value.
    """
    import control  # noqa: PLC0415

    numerator, denominator = transfer.coefficients(values)
    return control.TransferFunction(
        list(numerator),
        list(denominator),
        inputs=[transfer.input],
        outputs=[transfer.output],
        name=_plain(f"{transfer.output} over {transfer.input}"),
    )


def _plain(name: str) -> str:
    """Return `name` without the dots that python-control does not allow."""
    return name.replace(".", "_")
