"""One recording's inputs, many parameter sets: all simulations at once.

An explicit method steps eight sets together, in vector code; an implicit one takes each
set by itself in native code, because its Newton iterations end at different times. Both
run on two threads.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.choices import refuse_other
from bondgraph.equations.deriving.derivation import derive
from bondgraph.errors import EquationError, ParameterError, RecordingError, did_you_mean
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.given import initial_states, refuse_no_numbers
from bondgraph.simulation.native_shooting import stepped_explicitly
from bondgraph.simulation.shooting import shoot
from bondgraph.simulation.shots import Shots, as_loops_take
from bondgraph.simulation.solvers import Hold, RungeKutta4, Solver
from bondgraph.simulation.threads import in_parallel
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class SetStatus(StrEnum):
    """How the simulation of one parameter set ended; the value is the sentence."""

    SUCCESSFUL = "The simulation ran to the end."
    NOT_FINITE = "The outputs did not stay finite."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """Many simulations of one model with the same inputs.

    Parameters
    ----------
    output_names, output_units
        The measurements of the model.
    time
        Seconds, (n,).
    simulated
        ``[set, sample, output]``; NaN after `samples_done` of a set that failed.
    status
        How each set ended.
    samples_done
        Samples with finite outputs, per set.
    """

    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    time: Array
    simulated: Array
    status: tuple[SetStatus, ...]
    samples_done: tuple[int, ...]

    def output(self, name: str) -> Array:
        """Return one measurement of all sets, ``[set, sample]``."""
        return self.simulated[:, :, self.output_names.index(name)]


def simulate_batch(
    graph: FinishedGraph,
    parameter_sets: Sequence[Mapping[str, float]],
    recording: BoundRecording,
    *,
    initial: Mapping[str, float] | None = None,
    solver: Solver = RungeKutta4(),  # noqa: B008  (frozen)
    hold: Hold = Hold.FIRST,
) -> Batch:
    """Simulate a model with a recording's inputs for many parameter sets.

    Parameters
    ----------
    graph
        The model; what a set does not name has the graph's value.
    parameter_sets
        Values by parameter name, SI units.
    recording
        Gives the time and the inputs; its outputs are not looked at.
    initial
        Initial states by name, the same for all sets; zero where not given.
    solver
        `RungeKutta4` is the fastest, for models that are neither stiff nor implicit.
    hold
        How inputs behave between samples.

    Raises
    ------
    ParameterError
        If a name is unknown, a parameter has no value, or a number is not finite.
    RecordingError
        If an input was not recorded at some sample.
    EquationError
        If an explicit solver is asked for a model whose rates are only implicit.
    """
    refuse_other(solver, Solver, "The solver of a batch", EquationError)
    refuse_other(hold, Hold, "The hold", EquationError)
    model = compile_model(derive(graph))
    recording = recording.ordered(model.input_names, recording.output_names)
    if not np.isfinite(recording.inputs).all() or not np.isfinite(recording.time).all():
        raise RecordingError(
            f"Recording {recording.name!r} has samples without time or input.",
            (recording.name,),
            "Simulate a part of it without gaps: recording.part(start, stop).",
        )
    values = _values(graph, model, parameter_sets)
    begin = initial_states(initial or {}, model.state_names, model.name, ParameterError)
    start = np.tile(begin, (len(values), 1))
    time, inputs = as_loops_take(recording.time), as_loops_take(recording.inputs)
    simulated = np.full((len(values), len(time), len(model.output_names)), np.nan)
    done = np.zeros(len(values), dtype=np.int64)
    if isinstance(solver, RungeKutta4):
        some = _in_lanes(model, values, start, time, inputs, solver, hold)
    else:
        some = _one_by_one(model, values, start, time, inputs, solver, hold)
    in_parallel(lambda first, last: some(simulated, done, first, last), len(values))
    for k in np.flatnonzero(done < len(time)):
        simulated[k, done[k] :] = np.nan
    return Batch(
        output_names=model.output_names,
        output_units=model.output_units,
        time=time,
        simulated=simulated,
        status=tuple(
            SetStatus.SUCCESSFUL if n == len(time) else SetStatus.NOT_FINITE
            for n in done.tolist()
        ),
        samples_done=tuple(done.tolist()),
    )


_Some = Callable[[Array, Integers, int, int], None]


def _in_lanes(
    model: NumericModel,
    values: Array,
    start: Array,
    time: Array,
    inputs: Array,
    solver: RungeKutta4,
    hold: Hold,
) -> _Some:
    """Return what simulates the sets ``first … last - 1`` in vector code."""
    from bondgraph.numeric.native.lanes import LANES, integrate_lanes  # noqa: PLC0415  (numba)
    from bondgraph.numeric.native.model import native_model  # noqa: PLC0415  (LLVM)

    model = stepped_explicitly(model)
    native = native_model(model, along=None, explicit=True, lanes=LANES, optimised=True)

    def some(simulated: Array, done: Integers, first: int, last: int) -> None:
        integrate_lanes(
            native.system, solver.substeps, hold is Hold.ZERO, values, time, inputs,
            start, simulated, first, last, done,
        )  # fmt: skip

    return some


def _one_by_one(
    model: NumericModel,
    values: Array,
    start: Array,
    time: Array,
    inputs: Array,
    solver: Solver,
    hold: Hold,
) -> _Some:
    """Return what simulates the sets ``first … last - 1`` one after another."""
    nothing = np.zeros((len(time), len(model.output_names)))
    shots = Shots(time, inputs, nothing, (0, len(time)))

    def some(simulated: Array, done: Integers, first: int, last: int) -> None:
        for k in range(first, last):
            shot = shoot(
                model,
                shots,
                parameters=values[k],
                initial=start[k : k + 1],
                directions=None,
                solver=solver,
                hold=hold,
            )
            simulated[k] = shot.outputs
            finite = np.isfinite(shot.outputs).all(axis=1)
            done[k] = len(time) if finite.all() else int(np.argmin(finite))

    return some


def _values(
    graph: FinishedGraph, model: NumericModel, sets: Sequence[Mapping[str, float]]
) -> Array:
    """Return the parameter values, (sets, parameters), in the model's order."""
    names = model.parameter_names
    known = {p.name: p.value for p in graph.parameters.members if p.value is not None}
    for name in {name for one in sets for name in one}:
        _check_known(name, names, model.name)
    for one in sets:
        refuse_no_numbers(one, "In a parameter set the value of", ParameterError)
    rows = [[{**known, **one}.get(name, np.nan) for name in names] for one in sets]
    values = np.array(rows, dtype=np.float64).reshape(len(sets), len(names))
    missing = tuple(names[i] for i in np.flatnonzero(np.isnan(values).any(axis=0)))
    if missing:
        raise ParameterError(
            f"{model.name!r} needs a value of {', '.join(missing)}.",
            missing,
            "Give one in every parameter set, or in the graph.",
        )
    return values


def _check_known(name: str, names: Sequence[str], model: str) -> None:
    if name not in names:
        raise ParameterError(
            f"{model!r} has no parameter {name!r}.", (name,), did_you_mean(name, names)
        )
