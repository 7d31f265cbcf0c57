"""Linear systems with numbers in them, and their python-control twins.

The matrices come from the tape's exact sparse Jacobian, so that a thousand stages cost
milliseconds; nothing symbolic happens here. `SparseStateSpace` keeps them sparse, for
systems too large to write out; `StateSpace` is the dense one to design with.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.steady_state import SteadyState, point_values
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import EquationError
from bondgraph.numeric.jacobian import Matrix, Point, settled, slopes
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.numeric.placing import placed
from bondgraph.structure.graph import FinishedGraph

if TYPE_CHECKING:
    import control

FloatArray = NDArray[np.float64]
At = Mapping[str, object] | SteadyState | None

ANOTHER_TIME = 0.7390851332151607  # no period of anything

KEPT = 8
"""Of how many graphs the equations are kept: one is asked for at many points."""

MOST_DENSE_STATES = 6000
"""Four dense matrices of more states than this take over half a gigabyte."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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


@dataclass(frozen=True, slots=True, kw_only=True)
class SparseStateSpace:
    """``ẋ = A x + B u``, ``y = C x + D u`` with sparse matrices; see `StateSpace`."""

    name: str
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    state_units: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix

    def dense(self) -> StateSpace:
        """Return the system with its matrices written out.

        Raises
        ------
        EquationError
            If they would take more than half a gigabyte.
        """
        if len(self.states) > MOST_DENSE_STATES:
            raise EquationError(
                f"{self.name!r} has {len(self.states)} states; its dense matrices "
                f"would not fit.",
                (self.name,),
                "Use sparse_state_space(graph), or simulate the model.",
            )
        return StateSpace(
            name=self.name,
            states=self.states,
            inputs=self.inputs,
            outputs=self.outputs,
            state_units=self.state_units,
            input_units=self.input_units,
            output_units=self.output_units,
            A=self.A.toarray(),
            B=self.B.toarray(),
            C=self.C.toarray(),
            D=self.D.toarray(),
        )

    def response(self, omega: FloatArray) -> NDArray[np.complex128]:
        """Return the frequency response ``[frequency, output, input]``.

        Parameters
        ----------
        omega
            Angular frequencies in rad/s, none of them that of a pole.
        """
        eye = sparse.eye_array(len(self.states), dtype=complex)
        B, D = self.B.toarray().astype(complex), self.D.toarray()
        return np.array(
            [
                self.C @ splu(sparse.csc_array(1j * w * eye - self.A)).solve(B) + D
                if len(self.states)
                else D.astype(complex)
                for w in omega
            ]
        )


def state_space(graph: FinishedGraph, *, at: At = None) -> StateSpace:
    """Return the linear system of `graph` at its parameter values.

    Parameters
    ----------
    at
        Operating point of a nonlinear model: what `steady_state` found, or values of
        states and inputs by name (zero where not named).

    Raises
    ------
    ParameterError
        If a parameter has no value.
    EquationError
        If an output follows the rate of an input (an improper system), or the model
        has no linear form at the operating point.
    """
    return sparse_state_space(graph, at=at).dense()


def sparse_state_space(graph: FinishedGraph, *, at: At = None) -> SparseStateSpace:
    """Return the linear system of `graph` with sparse matrices; see `state_space`."""
    if isinstance(graph, StateEquations):
        raise EquationError(
            f"The equations of {graph.name!r} have no values of parameters.",
            (graph.name,),
            "Pass the finished graph that they were derived from.",
        )
    values = graph.parameters.values_by_name()
    return _linearised(*_derived(graph), values, at)


@lru_cache(maxsize=KEPT)
def _derived(graph: FinishedGraph) -> tuple[StateEquations, NumericModel]:
    equations = derive(graph)
    return equations, compile_model(equations)


def from_equations(
    equations: StateEquations, values: Mapping[str, float], *, at: At = None
) -> StateSpace:
    """Return the linear system of `equations` at these parameter values."""
    return sparse_from_equations(equations, values, at=at).dense()


def sparse_from_equations(
    equations: StateEquations, values: Mapping[str, float], *, at: At = None
) -> SparseStateSpace:
    """Return the sparse linear system of `equations` at these parameter values."""
    return _linearised(equations, compile_model(equations), values, at)


def _linearised(
    equations: StateEquations, model: NumericModel, values: Mapping[str, float], at: At
) -> SparseStateSpace:
    here = placed(model, equations, values, at)
    x, y = _sensitivities(model, here)
    if "t" not in point_values(at) and model.needs_time:
        _refuse_moving(model, here, x, y)
    n, m = len(equations.states), len(equations.inputs)
    A, B, B_rate = x[:, :n], x[:, n : n + m], x[:, n + m :]
    C, D, D_rate = y[:, :n], y[:, n : n + m], y[:, n + m :]
    if D_rate.count_nonzero():
        row, column = (int(index[0]) for index in D_rate.nonzero())
        output, source = equations.outputs[row].name, str(equations.inputs[column])
        raise EquationError(
            f"The output {output!r} follows the rate of the input {source!r}, so the "
            f"system is improper.",
            (output, source),
            "Use the transfer function, or put an R or a storage between the two.",
        )
    return SparseStateSpace(
        name=equations.name,
        states=tuple(s.symbol.name for s in equations.states),
        inputs=tuple(u.name for u in equations.inputs),
        outputs=tuple(o.name for o in equations.outputs),
        state_units=tuple(s.unit for s in equations.states),
        input_units=equations.input_units,
        output_units=tuple(o.unit for o in equations.outputs),
        A=_trimmed(A),
        B=_trimmed(B + A @ B_rate),
        C=_trimmed(C),
        D=_trimmed(D + C @ B_rate),
    )


def _sensitivities(model: NumericModel, here: Point) -> tuple[Matrix, Matrix]:
    return slopes(model, settled(model, here)).eliminated()


def _refuse_moving(model: NumericModel, here: Point, x: Matrix, y: Matrix) -> None:
    """Refuse a linear form that is another one at another time."""
    later = _sensitivities(model, replace(here, t=here.t + ANOTHER_TIME))
    for now, then in zip((x, y), later, strict=True):
        scale = float(np.abs(now.data).max(initial=0.0))
        if np.abs((now - then).data).max(initial=0.0) > 1e-12 * scale:
            raise EquationError(
                f"{model.name!r} depends on time.",
                ("t",),
                'Give the time of the operating point: at={"t": 0}.',
            )


def _trimmed(matrix: Matrix) -> Matrix:
    """Return the matrix without stored zeros."""
    trimmed = sparse.csr_array(matrix)
    trimmed.eliminate_zeros()
    return trimmed


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
