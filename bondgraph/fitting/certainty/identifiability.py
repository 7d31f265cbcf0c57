"""What can be known: from the channels at all, and from these recordings.

A model is structurally identifiable from its channels if the sensitivities of its
outputs have full rank at almost all parameter values, for some input (generic rank:
Hermann and Krener, IEEE Trans. Autom. Control 22, 1977). That is decided by numbers, at
random parameters under a random input of the recordings' size, their initial states
unknown. The same rank under the recorded input says what these recordings add to that.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.combinations import Local, combination_sentences
from bondgraph.fitting.horizon import WholeRecordings, cut
from bondgraph.fitting.posing import pose, prepare
from bondgraph.fitting.problem import (
    FitProblem,
    linearise_windows,
    prior_residuals,
    reduced_hessian,
)
from bondgraph.fitting.settings import FitSettings
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import matched
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
POINTS = 4
SPREAD = 0.3
SAMPLES = 400
CHANNELS, RECORDED = "these channels", "these recordings"
UNMOVED = 1e-12


class IdentifiabilityStatus(StrEnum):
    """What can be known of the free parameters; the value is the sentence to show."""

    IDENTIFIABLE = "Every free parameter can be told from these recordings."
    NOT_FROM_RECORDINGS = (
        "These channels could tell every free parameter, but these recordings do not."
    )
    NOT_FROM_CHANNELS = "No recording of these channels tells every free parameter."
    NOT_SIMULATED = "The model could not be simulated at its parameters."


@dataclass(frozen=True, slots=True, kw_only=True)
class Identifiability:
    """What the channels and the recordings determine.

    Parameters
    ----------
    from_channels
        Sentences on what no recording of these channels determines, such as "J and K
        only as K/J" or "c has no effect on these channels".
    from_recordings
        The same of these recordings, whose inputs may excite less.
    unused_inputs
        Inputs that no output depends on.
    silent_outputs
        Outputs that no free parameter has an effect on.
    """

    status: IdentifiabilityStatus
    from_channels: tuple[str, ...] = ()
    from_recordings: tuple[str, ...] = ()
    unused_inputs: tuple[str, ...] = ()
    silent_outputs: tuple[str, ...] = ()


def identifiability(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    settings: FitSettings | None = None,
    seed: int = 0,
) -> Identifiability:
    """Return what can be known of the free parameters before anything is fitted.

    Parameters
    ----------
    graph
        The model; what is known of its parameters beforehand is left aside.
    recordings
        Of their samples, the first 400 of each are looked at.
    seed
        Of the random parameters and inputs.

    Raises
    ------
    FitError, ParameterError
        If there is no recording, the model measures nothing, or a parameter has no
        value.
    """
    chosen = FitSettings() if settings is None else settings
    model, recordings = prepare(graph), matched(graph, recordings)
    short = [
        recording.part(0, min(len(recording), SAMPLES)) for recording in recordings
    ]
    problem = pose(graph, model, cut(short, WholeRecordings()), chosen)
    problem = replace(problem, prior_std=np.full_like(problem.prior_std, np.inf))
    random = np.random.default_rng(seed)
    rich = replace(problem, shots=_excited(problem.shots, random))
    theta = problem.start[problem.free]
    initial = random.normal(size=(problem.shots.n_windows, model.n_states))
    names = problem.free_names
    general = around(rich, theta, initial, random)
    special = around(problem, theta, initial, random)
    if not general or not special:
        return Identifiability(status=IdentifiabilityStatus.NOT_SIMULATED)
    channels = combination_sentences(names, general, CHANNELS)
    recorded = combination_sentences(names, special, RECORDED)
    return Identifiability(
        status=_status(channels, recorded),
        from_channels=channels,
        from_recordings=recorded,
        unused_inputs=_unused_inputs(rich, theta, initial, random),
        silent_outputs=_silent_outputs(rich, theta, initial),
    )


def _status(
    channels: tuple[str, ...], recorded: tuple[str, ...]
) -> IdentifiabilityStatus:
    if channels:
        return IdentifiabilityStatus.NOT_FROM_CHANNELS
    if recorded:
        return IdentifiabilityStatus.NOT_FROM_RECORDINGS
    return IdentifiabilityStatus.IDENTIFIABLE


def _excited(shots: Shots, random: np.random.Generator) -> Shots:
    """Return the windows with white inputs of the recorded size, all measured."""
    size = np.sqrt(np.mean(shots.inputs**2, axis=0))
    size = np.where(size > 0.0, size, 1.0)
    inputs = size * random.normal(size=shots.inputs.shape)
    return Shots(shots.time, inputs, np.zeros_like(shots.outputs), shots.edges)


def around(
    problem: FitProblem, theta: Array, initial: Array, random: np.random.Generator
) -> tuple[Local, ...]:
    """Return the Hessian at `theta` and at random parameters near it.

    Points where the model cannot be simulated are left out.
    """
    low, high = problem.low[problem.free], problem.high[problem.free]
    found = []
    for index in range(POINTS):
        near = theta
        if index > 0:
            factor = np.exp(SPREAD * random.normal(size=len(theta)))
            shift = np.where(theta == 0.0, SPREAD * random.normal(size=len(theta)), 0.0)
            near = np.clip(theta * factor + shift, low, high)
        at = linearise_windows(problem, near, initial)
        if np.isfinite(at.cost).all():
            _, weight = prior_residuals(problem, near)
            hessian = reduced_hessian(at, len(theta)) + np.diag(weight**2)
            found.append(Local(near, hessian))
    return tuple(found)


def _run(problem: FitProblem, theta: Array, initial: Array, inputs: Array) -> Array:
    shots = replace(problem.shots, inputs=inputs)
    shot = shoot(
        problem.model,
        shots,
        parameters=problem.with_parameters(theta),
        initial=initial,
        directions=None,
        solver=problem.solver,
        hold=problem.hold,
    )
    return shot.outputs


def _unused_inputs(
    problem: FitProblem, theta: Array, initial: Array, random: np.random.Generator
) -> tuple[str, ...]:
    """Return the inputs whose change changes no output."""
    before = _run(problem, theta, initial, problem.shots.inputs)
    unused = []
    for i, name in enumerate(problem.model.input_names):
        inputs = problem.shots.inputs.copy()
        inputs[:, i] += np.std(inputs[:, i]) * random.normal(size=len(inputs))
        moved = np.abs(_run(problem, theta, initial, inputs) - before)
        if np.nanmax(moved) <= UNMOVED * np.nanmax(np.abs(before)):
            unused.append(name)
    return tuple(unused)


def _silent_outputs(
    problem: FitProblem, theta: Array, initial: Array
) -> tuple[str, ...]:
    """Return the outputs that no free parameter has an effect on."""
    silent = []
    for i, name in enumerate(problem.model.output_names):
        only = np.full_like(problem.shots.outputs, np.nan)
        only[:, i] = 0.0
        part = replace(problem, shots=replace(problem.shots, outputs=only))
        at = linearise_windows(part, theta, initial)
        if not np.abs(np.einsum("wii->wi", at.hessian)[:, : len(theta)]).max() > 0.0:
            silent.append(name)
    return tuple(silent)
