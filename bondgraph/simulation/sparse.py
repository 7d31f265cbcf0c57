"""Simulation of large models through the sparse implicit system.

Fixed steps of an L-stable, stiffly accurate method; at every stage all efforts and
flows are solved for together, so algebraic loops and dependent storages need nothing
special. The matrix of a linear model is factorised once; that of a nonlinear one is
kept while Newton's method still converges with it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array, csr_array

from bondgraph.choices import refuse_other
from bondgraph.errors import EquationError, did_you_mean
from bondgraph.numeric.implicit.factor import Factor, Order, order_for
from bondgraph.numeric.implicit.points import solve_at
from bondgraph.numeric.implicit.system import ImplicitSystem, implicit_system
from bondgraph.simulation.energy_audit import EnergyAudit
from bondgraph.simulation.given import increasing, input_samples, refuse_no_numbers
from bondgraph.simulation.solvers import Hold, Implicit, Sdirk2
from bondgraph.simulation.sparse_energy import EnergyMeter
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]


class SparseStatus(StrEnum):
    """How a simulation ended; the value is the sentence to show."""

    SUCCESSFUL = "The simulation ran to the end."
    NOT_CONVERGED = (
        "The equations of a step had no solution that Newton's method found."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SparseSolution:
    """A large model run on a grid of samples.

    Parameters
    ----------
    reached
        The time in s until which it ran; outputs after it are nan.
    time, outputs
        Seconds, and ``[sample, output]``.
    states
        ``[sample, stored quantity]`` where asked for, else only the last sample.
    audit
        The energy balance of the whole run.
    factorisations, iterations
        Sparse factorisations, and solutions with them.
    """

    status: SparseStatus
    reached: float
    time: Array
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    outputs: Array
    state_names: tuple[str, ...]
    states: Array
    audit: EnergyAudit
    factorisations: int
    iterations: int

    def output(self, name: str) -> Array:
        """Return the samples of one measurement."""
        if name not in self.output_names:
            raise EquationError(
                f"There is no measurement {name!r}.",
                (name,),
                did_you_mean(name, self.output_names),
            )
        found: Array = self.outputs[:, self.output_names.index(name)]
        return found


def simulate_sparse(
    graph: FinishedGraph,
    time: ArrayLike,
    *,
    inputs: Mapping[str, ArrayLike] | None = None,
    initial: Mapping[str, float] | None = None,
    solver: Implicit | None = None,
    hold: Hold = Hold.FIRST,
    keep_states: bool = False,
) -> SparseSolution:
    """Run a model of any size; algebraic loops and dependent storages are allowed.

    Parameters
    ----------
    time
        Increasing samples in s.
    inputs
        Samples, or one constant value, of every input by name; zero if not named.
    initial
        Values of states by name (``p_…``, ``q_…``); zero if not named. Stored
        quantities that depend on others follow from these.
    solver
        ``Sdirk2()`` by default. Efforts and flows of dependent storages are accurate
        to first order, everything else to the method's.
    hold
        How inputs behave between samples.

    Raises
    ------
    EquationError
        If a name is unknown, or the equations have no unique solution at the start.
    """
    chosen = Sdirk2() if solver is None else solver
    refuse_other(chosen, Implicit, "The solver", EquationError)
    refuse_other(hold, Hold, "The hold", EquationError)
    system = implicit_system(graph)
    grid = increasing(time)
    refuse_no_numbers(initial or {}, "The initial value of", EquationError)
    samples = _sampled(system, inputs or {}, grid)
    run = _Run(system, chosen, hold)
    start = {**(initial or {}), "t": float(grid[0])}
    start.update(zip(system.input_names, samples[0].tolist(), strict=True))
    z = solve_at(system, start).z
    return run.through(grid, samples, z, keep_states=keep_states)


def _sampled(
    system: ImplicitSystem, inputs: Mapping[str, ArrayLike], time: Array
) -> Array:
    """Return all inputs, ``[sample, input]``."""
    for name in inputs:
        if name not in system.input_names:
            raise EquationError(
                f"{system.name!r} has no input {name!r}.",
                (name,),
                did_you_mean(name, system.input_names),
            )
    table = np.zeros((len(time), len(system.input_names)))
    for j, name in enumerate(system.input_names):
        table[:, j] = input_samples(
            inputs.get(name, 0.0),
            time,
            name,
            "Give one value per sample, or one for all.",
        )
    return table


class _NotConvergedError(Exception):
    """Newton's method found no solution; caught in this file only."""


class _Run:
    """One simulation: the method, the factors in use, and what is counted."""

    def __init__(self, system: ImplicitSystem, solver: Implicit, hold: Hold) -> None:
        self.system = system
        self.hold = hold
        self.substeps = solver.substeps
        self.weights, self.nodes = solver.tableau
        n = system.n_powers
        where = (np.arange(system.n_states), system.rate_columns)
        self.rate_of: csr_array = coo_array(
            (system.rate_signs, where), shape=(system.n_states, n)
        ).tocsr()
        self.meter = EnergyMeter(system)
        self.order: Order | None = None
        self.factor: Factor | None = None
        self.factor_step = 0.0
        self.factorisations = self.iterations = 0
        is_effort = np.zeros(n, bool)
        is_effort[system.columns[: system.places.n_bonds]] = True
        self.kinds = (is_effort, ~is_effort)

    def through(
        self, time: Array, samples: Array, z: Array, *, keep_states: bool
    ) -> SparseSolution:
        """Run through all samples."""
        system, n = self.system, self.system.n_powers
        first = z
        outputs = np.full((len(time), len(system.output_names)), np.nan)
        outputs[0] = system.outputs(z, time[0])
        states = [z[n:]]
        status, reached = SparseStatus.SUCCESSFUL, 0
        for k in range(len(time) - 1):
            try:
                z = self._between(time, samples, z, k)
            except _NotConvergedError:
                status = SparseStatus.NOT_CONVERGED
                break
            outputs[k + 1] = system.outputs(z, time[k + 1])
            reached = k + 1
            if keep_states:
                states.append(z[n:])
        times = (float(time[0]), float(time[reached]))
        return SparseSolution(
            status=status,
            reached=times[1],
            time=time,
            output_names=system.output_names,
            output_units=system.output_units,
            outputs=outputs,
            state_names=system.state_names,
            states=np.array(states if keep_states else [z[n:]]),
            audit=self.meter.audit(first, z, times),
            factorisations=self.factorisations,
            iterations=self.iterations,
        )

    def _between(self, time: Array, samples: Array, z: Array, k: int) -> Array:
        """Return z at sample k + 1."""
        whole = time[k + 1] - time[k]
        h = whole / self.substeps
        slope = samples[k + 1] - samples[k]
        if self.hold is Hold.ZERO:
            slope = np.zeros_like(slope)
        for step in range(self.substeps):
            z = self._step(
                z, time[k] + step * h, h, (samples[k], slope, time[k], whole)
            )
        return z

    def _step(
        self, z: Array, t: float, h: float, line: tuple[Array, Array, float, float]
    ) -> Array:
        """Return z one step later; the last stage is the end of the step."""
        n = self.system.n_powers
        x = z[n:]
        start, slope, origin, whole = line
        rates: list[Array] = []
        for i, node in enumerate(self.nodes):
            now = t + node * h
            u = start + slope * ((now - origin) / whole)
            known = x.copy()
            for weight, earlier in zip(self.weights[i], rates, strict=False):
                known += h * weight * earlier
            step = h * self.weights[i, i]
            w = self._solve(z[:n], known, step, u, now)
            rate = np.asarray(self.rate_of @ w)
            rates.append(rate)
            z = np.concatenate([w, known + step * rate])
            self.meter.add(z, h * self.weights[-1, i])
        return z

    def _left(self, w: Array, known: Array, step: float, u: Array, t: float) -> Array:
        """Return the residual of a stage, whose x follow from w."""
        z = np.concatenate([w, known + step * (self.rate_of @ w)])
        return self.system.residual(z, u, t)

    def _factorise(self, w: Array, known: Array, step: float, t: float) -> Factor:
        """Return the factors of the derivative of `_left`."""
        n = self.system.n_powers
        z = np.concatenate([w, known + step * (self.rate_of @ w)])
        jacobian = self.system.jacobian(z, t, capped=True)
        matrix = csr_array(jacobian[:, :n] + step * (jacobian[:, n:] @ self.rate_of))
        if self.order is None:
            self.order = order_for(matrix)
        self.factorisations += 1
        self.factor = self.order.factorised(matrix)
        self.factor_step = step
        return self.factor

    def _solve(self, w: Array, known: Array, step: float, u: Array, t: float) -> Array:
        """Return the efforts and flows of a stage."""
        if self.system.linear:
            start = np.zeros_like(w)
            factor = self.factor
            if factor is None or not np.isclose(step, self.factor_step, rtol=1e-12):
                factor = self._factorise(start, known, step, t)
            self.iterations += 1
            return factor.solve(-self._left(start, known, step, u, t))
        return self._newton(w, known, step, (u, t))

    def _newton(
        self, w: Array, known: Array, step: float, drive: tuple[Array, float]
    ) -> Array:
        """Solve a nonlinear stage, with old factors while they shrink the error."""
        u, t = drive
        factor, fresh = self.factor, False
        if factor is None or not np.isclose(step, self.factor_step, rtol=1e-9):
            factor, fresh = self._factorise(w, known, step, t), True
        left = self._left(w, known, step, u, t)
        before = np.inf
        for _ in range(MOST_ITERATIONS):
            change = factor.solve(-left)
            self.iterations += 1
            size = self._size(change, w)
            if not fresh and not size < 0.3 * before:
                factor, fresh, before = self._factorise(w, known, step, t), True, np.inf
                continue
            w, left = self._damped(w, change, left, (known, step, u, t))
            if size < TOLERANCE:
                return w
            before, fresh = size, False
        raise _NotConvergedError

    def _damped(
        self,
        w: Array,
        change: Array,
        left: Array,
        stage: tuple[Array, float, Array, float],
    ) -> tuple[Array, Array]:
        """Return the next iterate and its residual, shortening a step that worsens."""
        norm = np.linalg.norm(left)
        factor = 1.0
        while True:
            new = w + factor * change
            rest = self._left(new, *stage)
            size = np.linalg.norm(rest)
            if size <= norm or (factor < 1e-3 and np.isfinite(size)):
                return new, rest
            if np.linalg.norm(rest) < 1e-9 * (1.0 + np.linalg.norm(new)):
                return new, rest
            factor /= 2.0
            if factor < 1e-6:
                raise _NotConvergedError

    def _size(self, change: Array, w: Array) -> float:
        """Return the largest change, efforts against efforts, flows against flows."""
        worst = 0.0
        for kind in self.kinds:
            if np.any(kind):
                scale = np.abs(w[kind]).max()
                worst = max(worst, float(np.abs(change[kind]).max() / (scale + 1e-9)))
        return worst if np.isfinite(worst) else np.inf


MOST_ITERATIONS = 50
TOLERANCE = 1e-10
"""Newton's method ends at a change this small against the largest effort or flow."""
