"""Simulate a model with the inputs of a recording, to compare its outputs.

Where a machine starts is never known exactly. So its initial state is estimated from
the recorded outputs, all parameters held, and the model runs freely from there.
"""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.estimate import FitSettings, FittedModel, fit_model
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.result import Score
from bondgraph.fitting.settling import settle
from bondgraph.fitting.step_error import MOST_SUBSTEPS, step_error
from bondgraph.fitting.told import score
from bondgraph.numeric.audited_model import audited_model
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import matched
from bondgraph.recordings.spread import size
from bondgraph.simulation.energy_audit import EnergyAudit, together
from bondgraph.simulation.events import Event
from bondgraph.simulation.run import Run, simulate_audited
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
STEP_ERROR = 1e-3
"""Of an output's spread: what a step may change, seen by one of half its length."""

SETTLE_ITERATIONS = 10


class SolveStatus(StrEnum):
    """How a simulation ended; the value is the sentence to show."""

    SUCCESSFUL = "The simulation ran to the end."
    FAILED = "The simulation did not stay finite."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """A model run with recorded inputs.

    Parameters
    ----------
    output_names, output_units
        The measurements of the model.
    time, measured, simulated
        Seconds, and ``[sample, output]``; samples in stretches too short to simulate
        are left out. Simulated values are nan where the simulation failed.
    score
        How far the two are apart.
    runs
        One per stretch that was simulated from its own initial state (one for a whole
        recording), with its states, energy audit and events.
    """

    status: SolveStatus
    recording: str
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    time: Array
    measured: Array
    simulated: Array
    score: Score
    runs: tuple[Run, ...]

    @property
    def audit(self) -> EnergyAudit:
        """The energy balance of all stretches together."""
        return together([run.audit for run in self.runs])

    @property
    def events(self) -> tuple[Event, ...]:
        """Stick, slip, contact and release, in order of time."""
        found = [event for run in self.runs for event in run.events]
        return tuple(sorted(found, key=lambda event: event.time))

    @property
    def reason(self) -> str:
        """Where and why the first stretch stopped that did not run to its end."""
        return next((run.reason for run in self.runs if run.reason), "")


def simulate(
    graph: FinishedGraph,
    recording: BoundRecording,
    *,
    settings: FitSettings | None = None,
) -> Solution:
    """Run a model with the inputs of a recording, from an estimated initial state.

    Parameters
    ----------
    graph
        The model; none of its parameters is changed.
    recording
        Its inputs drive the model, its outputs are what to compare with.
    settings
        How to simulate; from one initial state through the whole recording by default.
        Steps are finer where those of the solver tell another story.

    Raises
    ------
    FitError, ParameterError
        If the model measures nothing, or a parameter has no value.
    """
    chosen = FitSettings(horizon=WholeRecordings()) if settings is None else settings
    (recording,) = matched(graph, [recording])
    held = graph.with_parameters(
        [replace(parameter, std=0.0) for parameter in graph.parameters.members]
    )
    ran = _fine_enough(
        fit_model(held, [recording], chosen, sigma=size(recording.outputs))
    )
    shots, model = ran.problem.shots, ran.problem.model
    residuals = np.where(np.isfinite(shots.outputs), ran.residuals(), np.nan)
    finite = np.isfinite(ran.optimum.cost)
    return Solution(
        status=SolveStatus.SUCCESSFUL if finite else SolveStatus.FAILED,
        recording=recording.name,
        output_names=model.output_names,
        output_units=model.output_units,
        time=shots.time,
        measured=shots.outputs,
        simulated=shots.outputs - residuals,
        score=score(model, shots, residuals),
        runs=_runs(ran),
    )


def _fine_enough(ran: FittedModel) -> FittedModel:
    """Return the run with steps so fine that half of them would change little."""
    problem, fine = ran.problem, STEP_ERROR * size(ran.problem.shots.outputs)
    while problem.model.n_states and problem.solver.substeps < MOST_SUBSTEPS:
        if not np.isfinite(ran.optimum.cost):
            return ran
        theta = problem.start[problem.free]
        if np.all(step_error(problem, theta, ran.optimum.initial) <= fine):
            return ran
        solver = replace(problem.solver, substeps=2 * problem.solver.substeps)
        problem = replace(problem, solver=solver)
        initial, at = settle(problem, theta, ran.optimum.initial, SETTLE_ITERATIONS)
        if not np.isfinite(at.cost).all():
            return ran
        found = minimise(problem, theta, initial, iterations=0)
        ran = replace(ran, problem=problem, optimum=found)
    return ran


def _runs(ran: FittedModel) -> tuple[Run, ...]:
    """Run every stretch once more from its settled state, with its accounts."""
    problem = ran.problem
    model, shots = problem.model, problem.shots
    audited = audited_model(ran.graph)
    return tuple(
        simulate_audited(
            ran.graph,
            audited,
            shots.time[rows],
            inputs=dict(zip(model.input_names, shots.inputs[rows].T, strict=True)),
            initial=dict(zip(model.state_names, map(float, start), strict=True)),
            solver=problem.solver,
            hold=problem.hold,
        )
        for rows, start in zip(shots.slices, ran.optimum.initial, strict=True)
    )
