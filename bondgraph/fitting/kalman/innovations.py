"""Fits by one-step prediction: for machines that are shaken, not only badly measured.

A disturbance inside the machine moves its state for good; a simulation from the start
cannot follow, and its error is coloured by the whole machine. A Kalman filter
carries the state along with the measurements instead, and the parameters, the
intensities of the process noise and the measurement noise maximise the likelihood of
its innovations. In closed loop, where the input follows the disturbance, this is what
keeps estimates unbiased (L. Ljung, *System Identification*, 1999, section 13.4).

The filter is in `filtering`, where the climb starts in `filter_start`, and the climb
itself in `scoring`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.choices import refuse_other
from bondgraph.errors import FitError
from bondgraph.fitting.certainty.whiteness import ljung_box
from bondgraph.fitting.kalman.filter_setting import Setting
from bondgraph.fitting.kalman.filter_start import best_noise, filter_starts
from bondgraph.fitting.kalman.kalman_choices import Extended, KalmanFilter
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.result import Estimate
from bondgraph.fitting.scoring import Climbed, climb
from bondgraph.fitting.settings import FitSettings
from bondgraph.fitting.truncated_inverse import truncated_inverse
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import matched
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
NORMAL = 1.959963984540054


class InnovationStatus(StrEnum):
    """How a fit by innovations ended; the value is the sentence to show."""

    CONVERGED = "The fit converged."
    ITERATION_LIMIT = "The fit stopped at its iteration limit before it converged."
    FAILED = "The filter did not stay finite at the start values."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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


def fit_innovations(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    shaken: Sequence[str] | None = None,
    settings: FitSettings | None = None,
    kalman: KalmanFilter | None = None,
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
    kalman
        ``Extended()`` by default; ``Unscented()`` where laws bend within the spread of
        the estimate.

    Raises
    ------
    FitError, ParameterError
        If the model has no state or output, a parameter has no value, or a name in
        `shaken` is no state.
    """
    chosen = FitSettings() if settings is None else settings
    recordings = matched(graph, recordings)
    carried = Extended() if kalman is None else kalman
    refuse_other(carried, KalmanFilter, "The Kalman filter", FitError)
    tried = filter_starts(graph, recordings, shaken, chosen, carried)
    found = [(setting, best_noise(setting)) for setting in tried]
    able = [(setting, start) for setting, start in found if start is not None]
    if not able:
        return _answer(graph, tried[-1], None)
    setting, start = min(able, key=lambda pair: pair[1][1].loss)
    return _answer(graph, setting, climb(setting, *start))


def _answer(
    graph: FinishedGraph, setting: Setting, climbed: Climbed | None
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
    graph: FinishedGraph, problem: FitProblem, climbed: Climbed
) -> tuple[Estimate, ...]:
    covariance = truncated_inverse(climbed.information, 1e-12)
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    names = problem.free_names
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
