"""Fits by one-step prediction: for machines that are shaken, not only badly measured.

A disturbance inside the machine moves its state for good; a simulation from the start
cannot follow, and its error is coloured by the whole machine. An extended Kalman filter
carries the state along with the measurements instead, and the parameters, the
intensities of the process noise and the measurement noise maximise the likelihood of
its innovations. In closed loop, where the input follows the disturbance, this is what
keeps estimates unbiased (L. Ljung, *System Identification*, 1999, section 13.4).

The transitions between samples and their exact slopes come from all samples simulated
at once, each from the state that the filter last estimated there; filter and simulation
take turns until these states stand still (the iterated extended Kalman filter, Bell and
Cathey, IEEE Trans. Autom. Control 38, 1993). The likelihood is climbed by Fisher
scoring, with the expected Hessian of the innovations.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import FitError, did_you_mean
from bondgraph.fitting.growing import cut_finer
from bondgraph.fitting.horizon import SHORTEST, WholeRecordings, cut
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.multiple_shooting import with_states_read
from bondgraph.fitting.posing import pose, prepare
from bondgraph.fitting.problem import FitProblem, truncated_inverse
from bondgraph.fitting.result import Estimate
from bondgraph.fitting.settings import FitSettings
from bondgraph.fitting.solving import first_guess
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
ITERATIONS = 40
TURNS = 6
STILL = 1e-6
DIFFERENCE = 1e-4
LONGEST = 0.5
LAGS = 20
GRID = (1e-3, 1e-2, 1e-1, 1.0, 10.0)
NORMAL = 1.959963984540054


class InnovationStatus(StrEnum):
    """How a fit by innovations ended; the value is the sentence to show."""

    CONVERGED = "The fit converged."
    ITERATION_LIMIT = "The fit stopped at its iteration limit before it converged."
    FAILED = "The filter did not stay finite at the start values."


@dataclass(frozen=True, slots=True, kw_only=True)
class InnovationFit:
    """Parameters and noise that make the innovations most likely.

    Parameters
    ----------
    process_noise
        Intensity per state, in its unit per square root of a second.
    measurement_noise
        Standard deviation per output, in its unit.
    log_likelihood
        Of all innovations, natural logarithm.
    innovations
        Over their standard deviations, (n, ny); 0 where nothing was measured.
    whiteness
        Per output, the p-value of Ljung and Box (Biometrika 65, 1978) over 20 lags:
        small where innovations can still be predicted.
    """

    status: InnovationStatus
    estimates: tuple[Estimate, ...]
    process_noise: Mapping[str, float]
    measurement_noise: Mapping[str, float]
    log_likelihood: float
    innovations: Array
    whiteness: Mapping[str, float]

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of the parameter called `name`."""
        return next(e for e in self.estimates if e.name == name)


@dataclass(frozen=True, slots=True)
class _Filtered:
    innovations: Array
    variances: Array
    states: Array

    @property
    def loss(self) -> float:
        """Minus the log-likelihood, without its constant."""
        terms = np.log(self.variances) + self.innovations**2 / self.variances
        total = 0.5 * float(terms.sum())
        return total if math.isfinite(total) else math.inf


@dataclass(frozen=True, slots=True)
class _Unknowns:
    """Parameters, and logarithms of the two kinds of noise."""

    theta: Array
    process: Array
    noise: Array

    def stacked(self) -> Array:
        """Return all numbers in one array."""
        return np.concatenate([self.theta, self.process, self.noise])

    def moved(self, step: Array) -> "_Unknowns":
        """Return them after a step."""
        a = len(self.theta)
        b = a + len(self.process)
        return _Unknowns(
            self.theta + step[:a], self.process + step[a:b], self.noise + step[b:]
        )


@dataclass(frozen=True, slots=True)
class _Setting:
    """What stays the same during the fit."""

    problem: FitProblem
    pairs: Shots
    shaken: NDArray[np.int64]
    initial: Array
    spread: Array
    scale: Array


def fit_innovations(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    shaken: Sequence[str] | None = None,
    settings: FitSettings | None = None,
) -> InnovationFit:
    """Fit parameters and noise by the likelihood of one-step predictions.

    Parameters
    ----------
    graph
        The model. Parameters with ``std=0.0`` stay, all others are free.
    recordings
        One or several, each with its own initial state.
    shaken
        Names of the states that a disturbance moves; all momenta and, where there are
        none, all states by default.

    Raises
    ------
    FitError, ParameterError
        If the model has no state or output, a parameter has no value, or a name in
        `shaken` is no state.
    """
    chosen = FitSettings() if settings is None else settings
    setting = _prepare(graph, recordings, shaken, chosen)
    start = _best_noise(setting)
    if start is None:
        return _answer(graph, setting, None)
    return _answer(graph, setting, _climb(setting, *start))


def _prepare(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    shaken: Sequence[str] | None,
    settings: FitSettings,
) -> _Setting:
    model = prepare(graph)
    names = model.state_names
    if not names:
        raise FitError(
            f"{graph.name!r} has no state to filter.", (graph.name,), "Use fit."
        )
    chosen = [n for n in names if n.startswith("p_")] or list(names)
    for name in shaken or ():
        if name not in names:
            raise FitError(
                f"{name!r} is no state of {graph.name!r}.",
                (name,),
                did_you_mean(name, names),
            )
    index = [names.index(name) for name in (shaken or chosen)]
    problem = pose(graph, model, cut(recordings, WholeRecordings()), settings)
    theta = problem.start[problem.free]
    short = replace(problem, shots=cut_finer(problem.shots, SHORTEST))
    warm = minimise(short, theta, first_guess(short, theta), iterations=15)
    states = warm.linearisation.states
    scale = np.std(states, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    rms = np.sqrt((warm.linearisation.residuals**2).sum(axis=0) / problem.measured)
    begins = np.searchsorted(np.array(short.shots.edges), problem.shots.edges[:-1])
    start = problem.start.astype(np.float64)
    start[problem.free] = warm.theta
    return _Setting(
        problem=replace(
            problem, start=start, sigma=np.maximum(rms, 1e-9) * problem.sigma
        ),
        pairs=_pairs(problem.shots),
        shaken=np.array(index, dtype=np.int64),
        initial=warm.initial[begins],
        spread=scale**2,
        scale=scale,
    )


def _pairs(shots: Shots) -> Shots:
    """Return every sample with the next one as a window, the last of each alone."""
    last = {stop - 1 for stop in shots.edges[1:]}
    rows = [(k,) if k in last else (k, k + 1) for k in range(shots.edges[-1])]
    index = np.array([k for pair in rows for k in pair], dtype=np.int64)
    edges = np.cumsum([0, *map(len, rows)])
    nothing = np.zeros((len(index), 0))
    return Shots(
        shots.time[index], shots.inputs[index], nothing, tuple(int(e) for e in edges)
    )


def _best_noise(setting: _Setting) -> tuple[_Unknowns, _Filtered] | None:
    """Return start values whose noise is the most likely on a coarse grid."""
    problem = setting.problem
    theta = problem.start[problem.free]
    found = []
    for share in GRID:
        at = _Unknowns(
            theta,
            np.log(share * setting.scale[setting.shaken]),
            np.log(np.maximum(problem.sigma, 1e-300)),
        )
        filtered = _filtered(setting, at, None)
        if math.isfinite(filtered.loss):
            found.append((at, filtered))
    return min(found, key=lambda pair: pair[1].loss) if found else None


def _filtered(setting: _Setting, at: _Unknowns, near: Array | None) -> _Filtered:
    """Filter and simulate by turns until the states stand still."""
    states = _first_states(setting) if near is None else near
    for _ in range(TURNS):
        found = _once(setting, at, states)
        if not math.isfinite(found.loss):
            return found
        change = np.abs(found.states - states) / setting.scale
        states = found.states
        if change.max() <= STILL:
            break
    return found


def _first_states(setting: _Setting) -> Array:
    """Return the states at every sample of short windows, each settled."""
    shots = cut_finer(setting.problem.shots, SHORTEST)
    short = replace(setting.problem, shots=shots)
    theta = setting.problem.start[setting.problem.free]
    warm = minimise(short, theta, first_guess(short, theta), iterations=2)
    return warm.linearisation.states


def _once(setting: _Setting, at: _Unknowns, around: Array) -> _Filtered:
    """Simulate from the points `around` and filter along these transitions."""
    from bondgraph.fitting.kalman_filter import run_filter  # noqa: PLC0415  (numba)

    problem, pairs = setting.problem, setting.pairs
    shot = shoot(
        with_states_read(problem.model),
        pairs,
        parameters=problem.with_parameters(at.theta),
        initial=around,
        directions=np.zeros(0, np.int64),
        solver=problem.solver,
        hold=problem.hold,
    )
    ny, nx = len(problem.sigma), problem.model.n_states
    first, after = np.array(pairs.edges[:-1]), np.array(pairs.edges[1:]) - 1
    starts = np.zeros(len(first), dtype=np.int64)
    starts[list(problem.shots.edges[:-1])] = 1
    process = np.zeros(nx)
    process[setting.shaken] = np.exp(2.0 * at.process)
    n = len(first)
    innovations, variances = np.zeros((n, ny)), np.ones((n, ny))
    states = np.zeros((n, nx))
    run_filter(
        np.ascontiguousarray(problem.shots.outputs),
        np.ascontiguousarray(shot.outputs[first, :ny]),
        np.ascontiguousarray(shot.sensitivities[first, :ny]),
        np.ascontiguousarray(shot.outputs[after, ny:]),
        np.ascontiguousarray(shot.sensitivities[after, ny:]),
        np.ascontiguousarray(around),
        pairs.time[after] - pairs.time[first],
        starts,
        setting.initial,
        setting.spread,
        process,
        np.exp(2.0 * at.noise),
        innovations,
        variances,
        states,
    )
    return _Filtered(innovations, variances, states)


@dataclass(frozen=True, slots=True)
class _Climbed:
    at: _Unknowns
    filtered: _Filtered
    information: Array
    converged: bool


def _climb(setting: _Setting, at: _Unknowns, here: _Filtered) -> _Climbed:
    """Maximise the likelihood by damped Fisher scoring."""
    damping, converged = 1e-3, False
    information, slope = _information(setting, at, here)
    for _ in range(ITERATIONS):
        raised = information + damping * np.diag(np.diag(information))
        step = truncated_inverse(raised, 1e-12) @ slope
        trial = _bounded(setting.problem, at.moved(_short(at, step)))
        new = _filtered(setting, trial, here.states)
        gain = here.loss - new.loss
        if gain > 0.0:
            at, here, damping = trial, new, damping / 10.0
            information, slope = _information(setting, at, here)
            if gain < 1e-3 and damping < 1e-3:
                converged = True
                break
        else:
            damping *= 10.0
            if damping > 1e8:
                converged = float(slope @ step) < 1.0
                break
    return _Climbed(at, here, information, converged)


def _short(at: _Unknowns, step: Array) -> Array:
    """Return the step shortened so that nothing moves by more than about half."""
    own = len(at.theta)
    size = np.where(at.theta == 0.0, np.inf, np.abs(at.theta))
    reach = np.concatenate([np.abs(step[:own]) / size, np.abs(step[own:])])
    shortened: Array = step * min(1.0, LONGEST / max(float(reach.max()), 1e-300))
    return shortened


def _bounded(problem: FitProblem, at: _Unknowns) -> _Unknowns:
    low, high = problem.low[problem.free], problem.high[problem.free]
    return replace(at, theta=np.clip(at.theta, low, high))


def _information(
    setting: _Setting, at: _Unknowns, here: _Filtered
) -> tuple[Array, Array]:
    """Return Fisher's information and the slope of the log-likelihood."""
    values = at.stacked()
    size = np.where(values == 0.0, 1.0, np.abs(values))
    size[len(at.theta) :] = 1.0
    errors, spreads = [], []
    for i in range(len(values)):
        step = np.zeros(len(values))
        step[i] = DIFFERENCE * size[i]
        after = _filtered(setting, at.moved(step), here.states)
        before = _filtered(setting, at.moved(-step), here.states)
        width = 2.0 * step[i]
        root = np.sqrt(here.variances)
        errors.append(((after.innovations - before.innovations) / width / root).ravel())
        change = (after.variances - before.variances) / width / here.variances
        spreads.append(change.ravel())
    first, second = np.array(errors), np.array(spreads)
    white = (here.innovations / np.sqrt(here.variances)).ravel()
    information: Array = first @ first.T + 0.5 * second @ second.T
    # Where nothing was measured, the innovation and all its changes are zero.
    slope: Array = -(first @ white) - 0.5 * second @ (1.0 - white**2)
    return information, slope


def _answer(
    graph: FinishedGraph, setting: _Setting, climbed: _Climbed | None
) -> InnovationFit:
    model, problem = setting.problem.model, setting.problem
    ny = len(problem.sigma)
    if climbed is None:
        return InnovationFit(
            status=InnovationStatus.FAILED,
            estimates=(),
            process_noise={},
            measurement_noise={},
            log_likelihood=-math.inf,
            innovations=np.zeros((0, ny)),
            whiteness={},
        )
    at, here = climbed.at, climbed.filtered
    white = here.innovations / np.sqrt(here.variances)
    count = int(np.isfinite(problem.shots.outputs).sum())
    status = (
        InnovationStatus.CONVERGED
        if climbed.converged
        else InnovationStatus.ITERATION_LIMIT
    )
    shaken = [model.state_names[i] for i in setting.shaken]
    outputs = model.output_names
    noise, process = map(float, np.exp(at.noise)), map(float, np.exp(at.process))
    p_values = [ljung_box(column) for column in white.T]
    return InnovationFit(
        status=status,
        estimates=_estimates(graph, problem, climbed),
        process_noise=dict(zip(shaken, process, strict=True)),
        measurement_noise=dict(zip(outputs, noise, strict=True)),
        log_likelihood=-here.loss - 0.5 * count * math.log(2.0 * math.pi),
        innovations=white,
        whiteness=dict(zip(outputs, p_values, strict=True)),
    )


def _estimates(
    graph: FinishedGraph, problem: FitProblem, climbed: _Climbed
) -> tuple[Estimate, ...]:
    covariance = truncated_inverse(climbed.information, 1e-12)
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    names = [problem.model.parameter_names[i] for i in problem.free]
    return tuple(
        Estimate(
            name=name,
            value=float(value),
            std=float(s) if s > 0.0 else None,
            unit=graph.parameters[name].unit,
            start=graph.parameters[name].value,
            interval=(float(value - NORMAL * s), float(value + NORMAL * s))
            if s > 0.0
            else None,
        )
        for name, value, s in zip(names, climbed.at.theta, std, strict=False)
    )


def ljung_box(white: Array, lags: int = LAGS) -> float:
    """Return the p-value for the hypothesis that a series is white.

    Parameters
    ----------
    white
        The series, with mean zero.
    lags
        How many autocorrelations are looked at.
    """
    from scipy.special import chdtrc  # noqa: PLC0415  (slow to import)

    n = len(white)
    power = float(white @ white)
    if power == 0.0 or n <= lags + 1:
        return 1.0
    rho = np.array([float(white[k:] @ white[:-k]) for k in range(1, lags + 1)]) / power
    statistic = n * (n + 2) * float((rho**2 / (n - np.arange(1, lags + 1))).sum())
    return float(chdtrc(lags, statistic))
