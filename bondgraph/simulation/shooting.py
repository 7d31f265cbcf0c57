"""Many windows of recordings simulated at once, each from its own initial state."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.model import NumericModel
from bondgraph.numeric.set_valued import SetValuedForm
from bondgraph.simulation.engines import PAYING, Engine
from bondgraph.simulation.native_shooting import Windows, run_native
from bondgraph.simulation.solvers import Hold, Implicit, RungeKutta4, Solver
from bondgraph.simulation.trouble import CODES, RunStatus, Trouble, unknown_names

if TYPE_CHECKING:
    from bondgraph.numeric.kernel.native_steps import Fast
    from bondgraph.numeric.kernel.stage_arrays import System

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
        Per window, whether it was simulated to its end with finite outputs.
    trouble
        Per window, why it was not; None where it was.
    modes, since
        (n, frictions): whether each set-valued friction slips (1, -1) or sticks (0),
        and the time at which it took that mode; None without such frictions.
    """

    outputs: Array
    states: Array
    sensitivities: Array
    completed: NDArray[np.bool_]
    trouble: tuple[Trouble | None, ...] = ()
    modes: NDArray[np.int64] | None = None
    since: Array | None = None


def shoot(
    model: NumericModel,
    shots: Shots,
    *,
    parameters: Array,
    initial: Array,
    directions: NDArray[np.int64] | None,
    solver: Solver,
    hold: Hold,
    engine: Engine = PAYING,
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
    engine
        How the equations are evaluated, a matter of time only; `WhenItPays` by default.

    Raises
    ------
    EquationError
        If an explicit method is asked for a model whose rates are only implicit.
    """
    if isinstance(solver, RungeKutta4):
        return _by_native_code(
            model, shots, parameters, initial, directions, solver, hold
        )
    if engine.compiles(model, len(shots.time)):
        native = _by_native_code(
            model, shots, parameters, initial, directions, solver, hold
        )
        # Where native code failed, the tape says why.
        if native.completed.all():
            return native
    return _by_tape(model, shots, parameters, initial, directions, solver, hold, engine)


def _by_native_code(
    model: NumericModel,
    shots: Shots,
    parameters: Array,
    initial: Array,
    directions: NDArray[np.int64] | None,
    solver: Solver,
    hold: Hold,
) -> Shooting:
    windows = Windows(
        np.ascontiguousarray(shots.time, dtype=np.float64),
        np.ascontiguousarray(shots.inputs, dtype=np.float64),
        np.array(shots.edges, dtype=np.int64),
        np.ascontiguousarray(initial, dtype=np.float64),
    )
    run = run_native(
        model,
        windows,
        np.ascontiguousarray(parameters, dtype=np.float64),
        directions,
        solver,
        zero_hold=hold is Hold.ZERO,
    )
    troubles = _troubles(model, shots, run.outputs, run.done, None)
    fine = np.array([trouble is None for trouble in troubles], dtype=np.bool_)
    return Shooting(run.outputs, run.states, run.sensitivities, fine, troubles)


def _by_tape(
    model: NumericModel,
    shots: Shots,
    parameters: Array,
    initial: Array,
    directions: NDArray[np.int64] | None,
    solver: Implicit,
    hold: Hold,
    engine: Engine,
) -> Shooting:
    from bondgraph.numeric.kernel.method import Method  # noqa: PLC0415
    from bondgraph.numeric.kernel.windows import (  # noqa: PLC0415  (loads numba)
        Results,
        integrate_windows,
    )

    n, nx, ny = len(shots.time), model.n_states, len(model.output_names)
    wanted = np.zeros(0, np.int64) if directions is None else directions
    nd = 0 if directions is None else len(wanted) + nx
    outputs = np.full((n, ny), np.nan)
    states = np.full((n, nx), np.nan)
    sensitivities = np.zeros((n if directions is not None else 0, ny, nd))
    form = model if model.set_valued is None else model.set_valued
    system = _system(model)
    dry = system.nd
    method = Method(*solver.tableau, solver.substeps, hold is Hold.ZERO)
    values = np.concatenate([parameters, np.zeros(2 * dry)])
    fast, code = _fast(model, engine, n, sensitive=nd > 0)

    edges = np.array(shots.edges, dtype=np.int64)
    done = np.zeros(shots.n_windows, dtype=np.int64)
    trouble = np.zeros((shots.n_windows, 2), dtype=np.int64)
    modes, since = np.zeros((n, dry), np.int64), np.full((n, dry), -np.inf)
    results = Results(outputs, sensitivities, states, modes, since)
    initial = np.ascontiguousarray(initial, dtype=np.float64)
    constants, output_constants = form.dynamics.constants, form.output.constants

    def some(first: int, last: int) -> None:
        integrate_windows(
            system, fast, method, constants, output_constants, values, wanted,
            shots.time, shots.inputs, initial, results, edges, first, last, done,
            trouble,
        )  # fmt: skip

    share = np.linspace(0, shots.n_windows, THREADS + 1).astype(int).tolist()
    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(some, share[:-1], share[1:]))
    del code  # it was needed until here
    troubles = _troubles(model, shots, outputs, done, trouble)
    fine = np.array([found is None for found in troubles], dtype=np.bool_)
    if not dry:
        return Shooting(outputs, states, sensitivities, fine, troubles)
    return Shooting(outputs, states, sensitivities, fine, troubles, modes, since)


def _system(model: NumericModel) -> "System":
    """Return the model as the kernel sees it; dry friction's λ are at the end of z."""
    from bondgraph.numeric.kernel.stage_arrays import System  # noqa: PLC0415

    form = model if model.set_valued is None else model.set_valued
    dry = 0 if model.set_valued is None else len(model.set_valued.places)
    dynamics, output, nx = form.dynamics, form.output, model.n_states
    return System(
        dynamics=dynamics.code,
        first=dynamics.n_variables + len(dynamics.constants),
        rate=np.ascontiguousarray(dynamics.outputs[:nx]),
        residual=np.ascontiguousarray(dynamics.outputs[nx:]),
        output=output.code,
        first_output=output.n_variables + len(output.constants),
        read=output.outputs,
        nx=nx,
        nz=model.n_unknowns + dry,
        nd=dry,
        nu=len(model.input_names),
        n_parameters=len(model.parameter_names) + 2 * dry,
        linear=form.linear,
        instantaneous=form.instantaneous,
    )


def _fast(
    model: NumericModel, engine: Engine, samples: int, *, sensitive: bool
) -> tuple["Fast", object]:
    """Return native code of a model with held modes, and what keeps it alive."""
    from bondgraph.numeric.kernel.native_steps import Fast  # noqa: PLC0415
    from bondgraph.numeric.native.compiling import (  # noqa: PLC0415  (LLVM)
        compiled_text,
        module_text,
        values_of,
    )
    from bondgraph.numeric.native.model import (  # noqa: PLC0415
        NativeSystem,
        native_model,
    )

    form = model.set_valued
    held = None if form is None else _held(model, form)
    if form is None or held is None or not engine.compiles(held, samples):
        return Fast(NativeSystem(*(0,) * 13, False, False), 0, False), None
    native = native_model(held, sensitive=sensitive)
    arguments = compiled_text(module_text([values_of(form.arguments, "arguments")]))
    fast = Fast(native.system, arguments["arguments"], True)
    return fast, (native, arguments)


def _held(model: NumericModel, form: SetValuedForm) -> NumericModel:
    """Return the ordinary model that one with friction is while its modes last."""
    dry = len(form.places)
    return replace(
        model,
        dynamics=form.held,
        output=form.output,
        n_unknowns=model.n_unknowns + dry,
        parameter_names=(*model.parameter_names, *("",) * (2 * dry)),
        linear=form.linear,
        instantaneous=form.instantaneous,
        set_valued=None,
    )


def _troubles(
    model: NumericModel,
    shots: Shots,
    outputs: Array,
    done: NDArray[np.int64],
    codes: NDArray[np.int64] | None,
) -> tuple[Trouble | None, ...]:
    """Return per window what went wrong, by the kernel's codes and the outputs."""
    found: list[Trouble | None] = []
    for window, part in enumerate(shots.slices):
        reached = int(done[window])
        time = shots.time[part]
        finite = np.isfinite(outputs[part][:reached])
        if reached < len(time):
            code, unknown = (0, -1) if codes is None else codes[window]
            names = unknown_names(model) if code else ()
            found.append(
                Trouble(
                    status=CODES[int(code)],
                    time=float(time[min(reached, len(time) - 1)]),
                    unknown=names[unknown] if names else "",
                )
            )
        elif not finite.all():
            row, column = np.argwhere(~finite)[0]
            found.append(
                Trouble(
                    status=RunStatus.OUTPUT_NOT_FINITE,
                    time=float(time[row]),
                    unknown=model.output_names[column],
                )
            )
        else:
            found.append(None)
    return tuple(found)
