"""Fit a graph's parameters to recordings: the pieces put together."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.equations.derivation import derive
from bondgraph.errors import FitError
from bondgraph.fitting.horizon import (
    SHORTEST,
    Automatic,
    Horizon,
    WholeRecordings,
    Windows,
    cut,
)
from bondgraph.fitting.levenberg_marquardt import Optimum, minimise, settle
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.result import Estimate, FitResult, FitStatus, Score
from bondgraph.fitting.uncertainty import null_sentences, uncertainty
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk2, Solver
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Fitted as FittedSource

Array = NDArray[np.float64]
GROWTH = 1.1
RESCALINGS = 4
SAME_SCALE = 0.05
"""Residual scales within this share of each other weigh the outputs alike."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Choices of a simulation-error fit; the defaults suit sampled machines.

    Parameters
    ----------
    horizon
        How long to simulate from each estimated initial state.
    solver, hold
        How to step, and how inputs behave between samples.
    iterations
        Limit of the optimiser.
    """

    horizon: Horizon = field(default_factory=Automatic)
    solver: Solver = field(default_factory=Sdirk2)
    hold: Hold = Hold.FIRST
    iterations: int = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedModel:
    """A graph with the problem it was fitted in and the optimum found.

    ``horizon`` is the one used (never `Automatic`).
    """

    graph: FinishedGraph
    problem: FitProblem
    optimum: Optimum
    horizon: Horizon

    @property
    def parameters(self) -> Array:
        """All parameter values, in the numeric model's order."""
        return self.problem.with_parameters(self.optimum.theta)

    @property
    def settings(self) -> Settings:
        """The choices to fit a variant of this model in the same way."""
        return Settings(
            horizon=self.horizon, solver=self.problem.solver, hold=self.problem.hold
        )

    @property
    def values(self) -> dict[str, float]:
        """All parameter values by name."""
        names = self.problem.model.parameter_names
        return dict(zip(names, map(float, self.parameters), strict=True))

    def residuals(self) -> Array:
        """Return measured minus simulated, (n, ny), in the outputs' units."""
        residuals: Array = self.optimum.linearisation.residuals * self.problem.sigma
        return residuals


def fit(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    settings: Settings | None = None,
) -> FitResult:
    """Fit the free parameters of a model to recordings by simulation error.

    Parameters
    ----------
    graph
        The model. Parameters with ``std=0.0`` stay; those with a positive std are held
        by it; those with None are free.
    recordings
        One or several, each with its own initial states.

    Raises
    ------
    FitError, ParameterError
        If nothing can be fitted: no output, a parameter without a value.
    """
    chosen = Settings() if settings is None else settings
    return report(fit_model(graph, recordings, chosen), graph, recordings)


def prepare(graph: FinishedGraph) -> NumericModel:
    """Return the numeric form of a graph."""
    return compile_model(derive(graph))


def pose(
    graph: FinishedGraph,
    model: NumericModel,
    shots: Shots,
    settings: Settings,
    sigma: Array | None = None,
) -> FitProblem:
    """Return the least-squares problem of fitting `graph` to windows of recordings.

    Parameters
    ----------
    sigma
        Residual scale per output; the outputs' standard deviations when None.
    """
    if not model.output_names:
        raise FitError(
            f"{graph.name!r} measures nothing.",
            (graph.name,),
            'Add an output with measure("name", displacement="junction").',
        )
    values = graph.parameters.values_by_name()
    members = [graph.parameters[name] for name in model.parameter_names]
    free = [i for i, member in enumerate(members) if not member.exact]
    if sigma is None:
        spread = np.nanstd(shots.outputs, axis=0)
        sigma = np.where(spread > 0.0, spread, 1.0)
    return FitProblem(
        model=model,
        shots=shots,
        start=np.array([values[name] for name in model.parameter_names]),
        free=np.array(free, dtype=np.int64),
        low=np.array([member.bounds[0] for member in members]),
        high=np.array([member.bounds[1] for member in members]),
        prior_std=np.array([member.std or math.inf for member in members]),
        sigma=sigma,
        solver=settings.solver,
        hold=settings.hold,
    )


def solve(
    problem: FitProblem,
    *,
    theta: Array | None = None,
    initial: Array | None = None,
    iterations: int = 60,
    tolerance: float = 1e-6,
) -> Optimum:
    """Settle the initial states, then fit everything."""
    start = problem.start[problem.free] if theta is None else theta
    states = initial if initial is not None else first_guess(problem, start)
    states, here = settle(problem, start, states)
    return minimise(
        problem,
        start,
        states,
        iterations=iterations,
        tolerance=tolerance,
        settled=here,
    )


def first_guess(problem: FitProblem, theta: Array) -> Array:
    """Return initial states that fit the first samples of every window.

    From zero, over a short stretch, the fit is nearly linear; from there the long one
    starts close enough.
    """
    shots = problem.shots
    zeros = np.zeros((shots.n_windows, problem.model.n_states))
    if max(np.diff(shots.edges)) <= 2 * SHORTEST:
        return zeros
    short = shots.subset(np.arange(shots.n_windows), SHORTEST)
    initial, _ = settle(replace(problem, shots=short), theta, zeros)
    return initial


def fit_model(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    settings: Settings,
    *,
    sigma: Array | None = None,
) -> FittedModel:
    """Fit, choosing the horizon and the residual scales where they are not given."""
    model = prepare(graph)
    horizon = settings.horizon
    if isinstance(horizon, Automatic):
        horizon = choose_horizon(graph, model, recordings, settings)
    problem = pose(graph, model, cut(recordings, horizon), settings, sigma)
    optimum = solve(problem, iterations=settings.iterations)
    # The residual scale weighs outputs against each other and against priors, and so
    # depends on the optimum that depends on it.
    for _ in range(RESCALINGS if sigma is None else 0):
        scale = residual_scale(problem, optimum)
        if not np.isfinite(scale).all() or np.allclose(
            scale, problem.sigma, rtol=SAME_SCALE, atol=0.0
        ):
            break
        problem = replace(problem, sigma=scale)
        optimum = solve(
            problem,
            theta=optimum.theta,
            initial=optimum.initial,
            iterations=settings.iterations,
        )
    return FittedModel(graph=graph, problem=problem, optimum=optimum, horizon=horizon)


def residual_scale(problem: FitProblem, optimum: Optimum) -> Array:
    """Return the root mean square residual per output, never zero."""
    power = np.sum(optimum.linearisation.residuals**2, axis=0) / problem.measured
    scale: Array = problem.sigma * np.sqrt(np.maximum(power, 1e-24))
    return scale


def choose_horizon(
    graph: FinishedGraph,
    model: NumericModel,
    recordings: Sequence[BoundRecording],
    settings: Settings,
) -> Horizon:
    """Return whole recordings, or the window that suits an integrating plant.

    The window is doubled as long as the residual stays within a tenth of its
    level over short windows: while measurement noise dominates it is level, and it
    grows once what the model leaves out accumulates.
    """
    whole = WholeRecordings()
    if model.n_states == 0 or not accumulates(graph, model, recordings, settings):
        return whole
    longest = max(len(recording) for recording in recordings)
    samples = max(SHORTEST, 6 * model.n_states)
    best, lowest, theta = Windows(samples), math.inf, None
    while samples < longest:
        problem = pose(graph, model, cut(recordings, Windows(samples)), settings)
        optimum = solve(problem, theta=theta, iterations=15, tolerance=1e-3)
        theta = optimum.theta
        size = math.sqrt(optimum.linearisation.cost.sum() / problem.shots.outputs.size)
        lowest = min(lowest, size)
        if not size <= GROWTH * lowest:
            return best
        best, samples = Windows(samples), 2 * samples
    return best


def accumulates(
    graph: FinishedGraph,
    model: NumericModel,
    recordings: Sequence[BoundRecording],
    settings: Settings,
) -> bool:
    """Return whether the effect of an initial state on the outputs does not fade.

    True for integrators and unstable plants, judged by the sensitivity of the outputs
    to the initial state over the longest recording.
    """
    longest = max(recordings, key=len)
    shots = cut([longest], WholeRecordings())
    problem = pose(graph, model, shots, settings)
    shot = shoot(
        model,
        shots,
        parameters=problem.start,
        initial=np.zeros((shots.n_windows, model.n_states)),
        directions=np.zeros(0, np.int64),
        solver=settings.solver,
        hold=settings.hold,
    )
    size = np.abs(shot.sensitivities[shots.slices[0]]).max(axis=1)
    if not np.isfinite(size).all():
        return True
    tail = size[-max(len(size) // 10, 1) :].max(axis=0)
    peak = size.max(axis=0)
    # An oscillation decays; an integrator stays at its peak to the end.
    ends_level = (tail >= 0.999 * peak) & (peak > 0.0)
    return bool(ends_level.any())


def score(
    model: NumericModel,
    shots: Shots,
    residuals: Array,
) -> Score:
    """Return the size of residuals per output, and relative to the outputs' spread.

    Not a number where a measured sample was not simulated.
    """
    measured = np.isfinite(shots.outputs)
    squared = np.where(measured, residuals, 0.0) ** 2
    rmse = np.sqrt(squared.sum(axis=0) / np.maximum(measured.sum(axis=0), 1))
    spread = np.nanstd(shots.outputs, axis=0)
    relative = rmse / np.where(spread > 0.0, spread, 1.0)
    return Score(
        nrmse=float(np.sqrt(np.mean(relative**2))),
        rmse=dict(zip(model.output_names, map(float, rmse), strict=True)),
    )


def report(
    fitted: FittedModel, start: FinishedGraph, recordings: Sequence[BoundRecording]
) -> FitResult:
    """Return the fit as the record users see."""
    problem, optimum = fitted.problem, fitted.optimum
    names = [problem.model.parameter_names[i] for i in problem.free]
    known = uncertainty(problem, optimum)
    sources = tuple(recording.name for recording in recordings)
    estimates = []
    for name, value, std in zip(names, optimum.theta, known.std, strict=True):
        before = start.parameters.get(name)
        first = before.value if before is not None else None
        estimates.append(
            Estimate(
                name=name,
                value=float(value),
                std=float(std) if math.isfinite(std) else None,
                unit=fitted.graph.parameters[name].unit,
                start=first,
            )
        )
    return FitResult(
        status=_status(problem, optimum),
        model=with_estimates(fitted.graph, estimates, sources),
        estimates=tuple(estimates),
        score=score(problem.model, problem.shots, fitted.residuals()),
        cost=optimum.cost,
        iterations=optimum.iterations,
        unidentifiable=null_sentences(names, known.null),
        window=_window_seconds(fitted),
        covariance=tuple(tuple(map(float, row)) for row in known.covariance),
    )


def _status(problem: FitProblem, optimum: Optimum) -> FitStatus:
    if not math.isfinite(optimum.cost):
        return FitStatus.SIMULATION_FAILED
    if not len(problem.free):
        return FitStatus.NO_FREE_PARAMETERS
    return FitStatus.CONVERGED if optimum.converged else FitStatus.ITERATION_LIMIT


def _window_seconds(fitted: FittedModel) -> float | None:
    if isinstance(fitted.horizon, WholeRecordings):
        return None
    time = fitted.problem.shots.time
    lengths = [time[s.stop - 1] - time[s.start] for s in fitted.problem.shots.slices]
    return float(np.median(lengths))


def with_estimates(
    graph: FinishedGraph, estimates: Sequence[Estimate], sources: tuple[str, ...]
) -> FinishedGraph:
    """Return the graph with the estimated values and where they come from.

    The std of a parameter stays what was known before the fit, so that the model can be
    fitted again.
    """
    found = {estimate.name: estimate for estimate in estimates}
    return graph.with_parameters(
        [
            replace(
                member,
                value=_inside(found[member.name].value, member.bounds),
                source=FittedSource(sources),
            )
            for member in graph.parameters.members
            if member.name in found
        ]
    )


def _inside(value: float, bounds: tuple[float, float]) -> float:
    return min(max(value, bounds[0]), bounds[1])
