"""Simulation without recordings: inputs as samples, constants or functions of time."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondgraph.choices import refuse_other
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.hard_contact import refuse_hard_contact
from bondgraph.errors import EquationError, did_you_mean
from bondgraph.numeric.audited_model import ACCOUNTS, AuditedModel, audited_model
from bondgraph.numeric.dynamics import Dynamics
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.simulation.adaptive import Adaptive, Cvode, Ida, Radau, refuse_friction
from bondgraph.simulation.energy_audit import EnergyAudit, audit_of
from bondgraph.simulation.events import Event, contact_events, friction_events
from bondgraph.simulation.given import increasing, initial_states
from bondgraph.simulation.growth import growth_not_followed
from bondgraph.simulation.inputs import InputFunction, Inputs, gather_inputs
from bondgraph.simulation.jumps import ramped
from bondgraph.simulation.shooting import Shooting, Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk2, Solver
from bondgraph.simulation.trouble import RunStatus, Trouble
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """A model run on a grid of samples.

    Parameters
    ----------
    status, reason
        How it ended; `reason` says where and why it stopped, and what to do.
    reached
        The time in s until which it ran; what follows is nan.
    time, outputs, states
        Seconds, ``[sample, output]`` and ``[sample, state]``.
    audit
        The energy balance until `reached`.
    events
        Stick, slip, contact, impact, rest and release, in order of time.
    solver_error
        For each output an estimate of the largest error that the steps make, from steps
        of half the size; empty where it was not asked for.
    """

    status: RunStatus
    reason: str
    reached: float
    time: Array
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    outputs: Array
    state_names: tuple[str, ...]
    states: Array
    audit: EnergyAudit
    events: tuple[Event, ...]
    solver_error: tuple[float, ...] = ()

    def output(self, name: str) -> Array:
        """Return the samples of one measurement."""
        return _column(self.outputs, self.output_names, name, "measurement")

    def state(self, name: str) -> Array:
        """Return the samples of one state."""
        return _column(self.states, self.state_names, name, "state")


def _column(table: Array, names: tuple[str, ...], name: str, kind: str) -> Array:
    if name not in names:
        raise EquationError(
            f"There is no {kind} {name!r}.", (name,), did_you_mean(name, names)
        )
    found: Array = table[:, names.index(name)]
    return found


def simulate_inputs(
    graph: FinishedGraph,
    time: ArrayLike,
    *,
    inputs: Mapping[str, ArrayLike | InputFunction] | None = None,
    initial: Mapping[str, float] | None = None,
    solver: Solver | Adaptive | None = None,
    hold: Hold = Hold.FIRST,
    estimate_error: bool = False,
) -> Run:
    """Run a model from an initial state.

    Parameters
    ----------
    time
        Increasing samples in s; fixed-step solvers step from one to the next.
    inputs
        Samples, one constant value, or a function of time, by name; zero if not named.
        Fixed-step solvers, whatever their substeps, take a function at the samples of
        `time` alone and go on between them as `hold` says: give samples as fine as the
        function moves, or an adaptive solver, which asks it wherever it steps.
    initial
        Values of states by name (``p_…``, ``q_…``); zero if not named.
    solver
        ``Sdirk2()`` by default.
    hold
        How sampled inputs, and functions that were sampled, behave between samples.
    estimate_error
        Whether to run a fixed-step solver a second time, with half the step, and with
        functions of time sampled twice as finely.

    Raises
    ------
    EquationError
        If a name is unknown, a number is not finite, or the solver does not suit the
        model.
    ParameterError
        If a parameter has no value.
    """
    return simulate_audited(
        graph,
        audited_model(graph),
        time,
        inputs=inputs,
        initial=initial,
        solver=solver,
        hold=hold,
        estimate_error=estimate_error,
    )


def simulate_audited(
    graph: FinishedGraph,
    audited: AuditedModel,
    time: ArrayLike,
    *,
    inputs: Mapping[str, ArrayLike | InputFunction] | None = None,
    initial: Mapping[str, float] | None = None,
    solver: Solver | Adaptive | None = None,
    hold: Hold = Hold.FIRST,
    estimate_error: bool = False,
) -> Run:
    """Run a model whose accounts are made already, as `simulate_inputs` does."""
    chosen = Sdirk2() if solver is None else solver
    refuse_other(chosen, Solver | Adaptive, "The solver", EquationError)
    refuse_other(hold, Hold, "The hold", EquationError)
    grid = increasing(time)
    model = audited.model
    given = gather_inputs(model.input_names, grid, inputs or {}, hold)
    values = graph.parameters.values_by_name()
    case = _Case(
        graph=graph,
        audited=audited,
        inputs=given,
        start=_start(model, initial or {}),
        parameters=np.array([values[name] for name in model.parameter_names]),
    )
    if isinstance(chosen, Cvode | Ida | Radau):
        return case.adaptive(chosen)
    run = case.fixed(chosen)
    if not estimate_error or run.status is not RunStatus.SUCCESSFUL:
        return run
    finer = case.outputs_of_half_steps(chosen)
    error = np.abs(run.outputs - finer).max(axis=0, initial=0.0)
    return replace(run, solver_error=tuple(map(float, error)))


def _start(model: NumericModel, initial: Mapping[str, float]) -> Array:
    own = model.state_names[: -len(ACCOUNTS)]
    states = initial_states(initial, own, model.name)
    return np.array([*states, *(0.0 for _ in ACCOUNTS)])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Case:
    """A model with its numbers, ready to be run by any solver."""

    graph: FinishedGraph
    audited: AuditedModel
    inputs: Inputs
    start: Array
    parameters: Array

    def fixed(self, solver: Solver) -> Run:
        """Run with fixed steps."""
        shot = self._shoot(self.audited.model, self.start, solver)
        trouble = shot.trouble[0]
        if trouble is not None and trouble.unknown in self.audited.storages:
            trouble = None  # then the audit, not the run, is not a number
        if trouble is not None and any(x in trouble.unknown for x in ACCOUNTS):
            # Energies grow faster than what makes them: which of the others was it?
            plain = compile_model(derive(self.graph))
            own = self.start[: plain.n_states]
            trouble = self._shoot(plain, own, solver).trouble[0] or trouble
        if trouble is None and self.audited.model.contacts is None:
            trouble = growth_not_followed(
                self.audited.model,
                self.parameters,
                self.inputs,
                shot.states,
                substeps=solver.substeps,
                own=self.audited.model.state_names[: -len(ACCOUNTS)],
            )
        events = (*self._slips(shot), *(e for part in shot.impacts for e in part))
        return self._run(shot.states, shot.outputs, trouble, events)

    def outputs_of_half_steps(self, solver: Solver) -> Array:
        """Return the outputs of a run with half the step.

        Functions of time are sampled anew at the finer steps, so that what is lost
        between samples shows as well.
        """
        if any(self.inputs.functions):
            finer = replace(self, inputs=self.inputs.halved()).fixed(solver)
            return finer.outputs[::2]
        return self.fixed(replace(solver, substeps=2 * solver.substeps)).outputs

    def _shoot(self, model: NumericModel, start: Array, solver: Solver) -> Shooting:
        time, samples = self.inputs.time, self.inputs.samples
        return shoot(
            model,
            Shots(time, samples, np.zeros((len(time), 0)), (0, len(time))),
            parameters=self.parameters,
            initial=start[None, :],
            directions=None,
            solver=solver,
            hold=self.inputs.hold,
        )

    def _slips(self, shot: Shooting) -> tuple[Event, ...]:
        form = self.audited.model.set_valued
        if form is None or shot.modes is None or shot.since is None:
            return ()
        return friction_events(form.places, shot.modes, shot.since)

    def adaptive(self, solver: Adaptive) -> Run:
        """Run with a solver that chooses its steps."""
        inputs = self.inputs
        if inputs.hold is Hold.FIRST or not self.audited.model.needs_input_rates:
            return self._adaptive(solver)
        lines, rows = ramped(inputs.time, inputs.samples, (0, len(inputs.time)))
        crossed = replace(
            inputs, time=lines.time, samples=lines.inputs, hold=Hold.FIRST
        )
        run = replace(self, inputs=crossed)._adaptive(solver)
        return replace(
            run, time=inputs.time, outputs=run.outputs[rows], states=run.states[rows]
        )

    def _adaptive(self, solver: Adaptive) -> Run:
        model, inputs = self.audited.model, self.inputs
        if model.contacts is not None:
            refuse_hard_contact(
                self.graph.name,
                model.contacts.places,
                "whose impacts lie between the steps of an adaptive solver",
            )
        if model.set_valued is not None:
            refuse_friction(model.set_valued.places)
        if model.n_unknowns and not solver.takes_unknowns:
            raise EquationError(
                f"{model.name!r} has the algebraic unknowns "
                f"{', '.join(model.unknown_names)}, which Cvode does not solve for.",
                model.unknown_names,
                "Use Ida() or Radau().",
            )
        dynamics = Dynamics(model, self.parameters)
        time = inputs.time
        states = np.full((len(time), model.n_states), np.nan)
        outputs = np.full((len(time), len(model.output_names)), np.nan)
        trouble = None
        x, z = self.start, np.zeros(model.n_unknowns)
        cuts = range(len(time)) if inputs.sampled else [0, len(time) - 1]
        for first, last in pairwise(cuts):
            drive = inputs.between(first)
            here = time[first : last + 1]
            try:
                piece = solver.integrate(dynamics, drive, here, x, z)
            except EquationError as error:
                trouble = _gave_up(time[first], str(error))
                break
            for k, t in enumerate(here):
                if np.isfinite(piece.x[k]).all():
                    u, du = drive(t)
                    rates, z = dynamics.settle(t, piece.x[k], z, u, du)
                    states[first + k] = piece.x[k]
                    at = (piece.x[k], rates, z, u, du)
                    outputs[first + k] = dynamics.output(t, *at)
            if piece.message:
                alive = here[np.isfinite(states[first : last + 1]).all(axis=1)]
                trouble = _gave_up(float(alive[-1]), piece.message)
                break
            x = piece.x[-1]
        return self._run(states, outputs, trouble, ())

    def _run(
        self,
        states: Array,
        outputs: Array,
        trouble: Trouble | None,
        slips: tuple[Event, ...],
    ) -> Run:
        audited, time = self.audited, self.inputs.time
        model = audited.model
        kept = len(model.output_names) - len(audited.storages) - len(audited.contacts)
        efforts = kept + len(audited.storages)
        ran = np.isfinite(states).all(axis=1)
        count = len(time) if ran.all() else max(int(np.argmin(ran)), 1)
        own = model.n_states - len(ACCOUNTS)
        touches = contact_events(
            audited.contacts, time[:count], outputs[:count, efforts:]
        )
        return Run(
            status=RunStatus.SUCCESSFUL if trouble is None else trouble.status,
            reason="" if trouble is None else trouble.reason,
            reached=float(time[count - 1]),
            time=time,
            output_names=model.output_names[:kept],
            output_units=model.output_units[:kept],
            outputs=outputs[:, :kept],
            state_names=model.state_names[:own],
            states=states[:, :own],
            audit=audit_of(
                states[:count, own:], outputs[:count, kept:efforts],
                closed=audited.closed,
            ),
            events=tuple(sorted((*slips, *touches), key=lambda event: event.time)),
        )  # fmt: skip


def _gave_up(time: float, message: str) -> Trouble:
    return Trouble(status=RunStatus.SOLVER_FAILED, time=float(time), unknown=message)
