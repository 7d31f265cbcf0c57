"""Many windows of recordings simulated at once, each from its own initial state."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.solvers import Hold, Solver

Array = NDArray[np.float64]
THREADS = 2


@dataclass(frozen=True)
class Shots:
    """Windows of recordings laid end to end.

    Parameters
    ----------
    time, inputs, outputs
        Samples of all windows: (n,), (n, nu), (n, ny); a missing output is NaN.
    edges
        Window k holds the samples ``edges[k]:edges[k + 1]``.
    """

    time: Array
    inputs: Array
    outputs: Array
    edges: tuple[int, ...]

    @property
    def n_windows(self) -> int:
        """Number of windows."""
        return len(self.edges) - 1

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """The windows as slices."""
        return tuple(slice(a, b) for a, b in pairwise(self.edges))

    def subset(self, windows: NDArray[np.int64], most: int | None = None) -> "Shots":
        """Return the windows numbered `windows`, each cut after `most` samples."""
        parts = [self.slices[w] for w in windows]
        stops = [s.stop if most is None else min(s.stop, s.start + most) for s in parts]
        lengths = [b - s.start for s, b in zip(parts, stops, strict=True)]
        ends = zip(parts, stops, strict=True)
        index = np.concatenate([np.arange(s.start, b) for s, b in ends])
        edges = np.cumsum([0, *lengths])
        return Shots(
            self.time[index],
            self.inputs[index],
            self.outputs[index],
            tuple(int(e) for e in edges),
        )


@dataclass(frozen=True, slots=True)
class Shooting:
    """What simulating all windows gave.

    Parameters
    ----------
    outputs, states
        (n, ny) and (n, nx).
    sensitivities
        (n, ny, nq + nx): to the chosen parameters, then to the initial state.
    completed
        Per window, whether it was simulated to its end.
    """

    outputs: Array
    states: Array
    sensitivities: Array
    completed: NDArray[np.bool_]


def shoot(
    model: NumericModel,
    shots: Shots,
    *,
    parameters: Array,
    initial: Array,
    directions: NDArray[np.int64] | None,
    solver: Solver,
    hold: Hold,
) -> Shooting:
    """Simulate every window from its initial state.

    Parameters
    ----------
    parameters
        Values in the model's order.
    initial
        Initial states, shape (n_windows, nx).
    directions
        Indices of the parameters whose sensitivities are wanted (those to the initial
        states are always added); None for no sensitivities at all.
    """
    from bondgraph.numeric.kernel import (  # noqa: PLC0415
        Method,
        Results,
        integrate_windows,
    )
    from bondgraph.numeric.stage import System  # noqa: PLC0415  (both load numba)

    n, nx, ny = len(shots.time), model.n_states, len(model.output_names)
    wanted = np.zeros(0, np.int64) if directions is None else directions
    nd = 0 if directions is None else len(wanted) + nx
    outputs = np.full((n, ny), np.nan)
    states = np.full((n, nx), np.nan)
    sensitivities = np.zeros((n if directions is not None else 0, ny, nd))
    dynamics, output = model.dynamics, model.output
    system = System(
        dynamics=dynamics.code,
        first=dynamics.n_variables + len(dynamics.constants),
        rate=np.ascontiguousarray(dynamics.outputs[:nx]),
        residual=np.ascontiguousarray(dynamics.outputs[nx:]),
        output=output.code,
        first_output=output.n_variables + len(output.constants),
        read=output.outputs,
        nx=nx,
        nz=model.n_unknowns,
        nu=len(model.input_names),
        n_parameters=len(model.parameter_names),
        linear=model.linear,
        instantaneous=model.instantaneous,
    )
    method = Method(*solver.tableau, solver.substeps, hold is Hold.ZERO)
    values = np.ascontiguousarray(parameters, dtype=np.float64)

    edges = np.array(shots.edges, dtype=np.int64)
    done = np.zeros(shots.n_windows, dtype=np.int64)
    results = Results(outputs, sensitivities, states)
    initial = np.ascontiguousarray(initial, dtype=np.float64)

    def some(first: int, last: int) -> None:
        integrate_windows(
            system, method, dynamics.constants, output.constants, values, wanted,
            shots.time, shots.inputs, initial, results, edges, first, last, done,
        )  # fmt: skip

    share = np.linspace(0, shots.n_windows, THREADS + 1).astype(int).tolist()
    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(some, share[:-1], share[1:]))
    completed = done == np.diff(edges)
    return Shooting(outputs, states, sensitivities, completed)
