"""Many windows of recordings simulated at once, each from its own initial state."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.engines import PAYING, Engine
from bondgraph.simulation.hard_contact import shoot_with_contacts
from bondgraph.simulation.jumps import at_samples, ramped
from bondgraph.simulation.native_shooting import Windows, run_native
from bondgraph.simulation.shots import Shooting, Shots
from bondgraph.simulation.solvers import Hold, Implicit, RungeKutta4, Solver
from bondgraph.simulation.tape_shooting import run_tape
from bondgraph.simulation.trouble import CODES, RunStatus, Trouble, unknown_names

__all__ = ["Shooting", "Shots", "shoot"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def shoot(
    model: NumericModel,
    shots: Shots,
    *,
    parameters: Array,
    initial: Array,
    directions: Integers | None,
    solver: Solver,
    hold: Hold,
    engine: Engine = PAYING,
    of_initial: bool = True,
    reasons: bool = True,
) -> Shooting:
    """Simulate every window from its initial state.

    Parameters
    ----------
    parameters
        Values in the model's order.
    initial
        Initial states, shape (n_windows, nx).
    directions
        Indices of the parameters whose sensitivities are wanted; None for no
        sensitivities at all.
    of_initial
        Whether those to the initial states are added.
    engine
        How the equations are evaluated, a matter of time only; `WhenItPays` by default.
    reasons
        Whether to find out why a window could not be simulated, where native code only
        says that: a fit has no use for it.

    Raises
    ------
    EquationError
        If an explicit method is asked for a model whose rates are only implicit.
    """
    if hold is Hold.ZERO and model.needs_input_rates:
        lines, rows = ramped(shots.time, shots.inputs, shots.edges)
        shot = shoot(
            model, lines, parameters=parameters, initial=initial, directions=directions,
            solver=solver, hold=Hold.FIRST, engine=engine, of_initial=of_initial,
            reasons=reasons,
        )  # fmt: skip
        return at_samples(shot, rows)
    if model.contacts is not None and not isinstance(solver, RungeKutta4):
        found = shoot_with_contacts(
            model, shots, parameters, initial, directions, solver, hold, engine, shoot
        )
        if of_initial or directions is None:
            return found
        return replace(found, sensitivities=found.sensitivities[..., : len(directions)])
    if isinstance(solver, RungeKutta4):
        return _by_native_code(
            model, shots, parameters, initial, directions, solver, hold, engine,
            of_initial,
        )  # fmt: skip
    if engine.compiles(model, len(shots.time)):
        native = _by_native_code(
            model, shots, parameters, initial, directions, solver, hold, engine,
            of_initial,
        )  # fmt: skip
        failed = np.flatnonzero(~native.completed)
        if len(failed) == 0 or not reasons:
            return native
        # The tape says why.
        again = _by_tape(
            model, shots.subset(failed), parameters, initial[failed], directions,
            solver, hold, engine, of_initial,
        )  # fmt: skip
        return _with_windows(native, shots, failed, again)
    return _by_tape(
        model, shots, parameters, initial, directions, solver, hold, engine, of_initial
    )


def _with_windows(
    whole: Shooting, shots: Shots, windows: Integers, part: Shooting
) -> Shooting:
    """Return `whole` with those windows as they are in `part`."""
    chosen = np.isin(np.arange(shots.n_windows), windows)
    rows = np.repeat(chosen, shots.lengths)
    outputs, states = whole.outputs.copy(), whole.states.copy()
    slopes, completed = whole.sensitivities.copy(), whole.completed.copy()
    outputs[rows], states[rows] = part.outputs, part.states
    completed[windows] = part.completed
    if len(part.sensitivities):
        slopes[rows] = part.sensitivities
    trouble = list(whole.trouble)
    for window, found in zip(windows, part.trouble, strict=True):
        trouble[window] = found
    return Shooting(outputs, states, slopes, completed, tuple(trouble))


def _by_native_code(
    model: NumericModel,
    shots: Shots,
    parameters: Array,
    initial: Array,
    directions: Integers | None,
    solver: Solver,
    hold: Hold,
    engine: Engine,
    of_initial: bool,
) -> Shooting:
    windows = Windows(
        np.ascontiguousarray(shots.time, dtype=np.float64),
        np.ascontiguousarray(shots.inputs, dtype=np.float64),
        shots.edge_array,
        np.ascontiguousarray(initial, dtype=np.float64),
    )
    run = run_native(
        model,
        windows,
        np.ascontiguousarray(parameters, dtype=np.float64),
        directions,
        solver,
        zero_hold=hold is Hold.ZERO,
        of_initial=of_initial,
        optimised=engine.optimises(len(shots.time)),
    )
    troubles = _troubles(model, shots, run.outputs, run.done, None)
    fine = np.array([trouble is None for trouble in troubles], dtype=np.bool_)
    return Shooting(run.outputs, run.states, run.sensitivities, fine, troubles)


def _by_tape(
    model: NumericModel,
    shots: Shots,
    parameters: Array,
    initial: Array,
    directions: Integers | None,
    solver: Implicit,
    hold: Hold,
    engine: Engine,
    of_initial: bool,
) -> Shooting:
    zero_hold = hold is Hold.ZERO
    run = run_tape(
        model, shots, parameters, initial, directions, solver, engine,
        zero_hold=zero_hold, of_initial=of_initial,
    )  # fmt: skip
    troubles = _troubles(model, shots, run.outputs, run.done, run.trouble)
    fine = np.array([found is None for found in troubles], dtype=np.bool_)
    told = (run.outputs, run.states, run.sensitivities, fine, troubles)
    if model.set_valued is None:
        return Shooting(*told)
    return Shooting(*told, run.modes, run.since)


def _troubles(
    model: NumericModel,
    shots: Shots,
    outputs: Array,
    done: Integers,
    codes: Integers | None,
) -> tuple[Trouble | None, ...]:
    """Return per window what went wrong, by the kernel's codes and the outputs."""
    if np.array_equal(done, shots.lengths) and np.isfinite(outputs).all():
        return (None,) * shots.n_windows  # Nearly always, and fits ask very often.
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
