"""`next_experiment`: the input, or the sensor, that would tell alternatives apart."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.experiment.divergence import (
    behaviour,
    information,
    least_distance,
)
from bondgraph.diagnosis.experiment.records import (
    Experiment,
    ExperimentStatus,
    InputProposal,
    SensorAddition,
)
from bondgraph.diagnosis.experiment.waves import waves
from bondgraph.diagnosis.virtual.noise import noise_scale
from bondgraph.errors import FitError, did_you_mean
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.recording import Recording
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import OneJunction
from bondgraph.structure.signals import Signal

Array = NDArray[np.float64]
MOST_SAMPLES = 2000
DECISIVE, VISIBLE = 10.0, 3.0
"""Sigmas of the whole difference that decide, and that may be seen at all."""
USUAL_NOISE = 1e-3
"""Of a signal's spread: noise of a sensor that is not there."""
BEYOND = 3.0
"""An output may leave the range seen so far by this factor."""


def next_experiment(
    alternatives: Sequence[FittedModel],
    recordings: Sequence[BoundRecording],
    *,
    limits: Mapping[str, tuple[float, float]] | None = None,
    seed: int = 0,
) -> Experiment:
    """Design the input, and name the sensor, that separates alternatives best.

    Parameters
    ----------
    alternatives
        Two or more models of one machine, fitted to the same recordings.
    recordings
        Those; the step, the ranges of the inputs and the noise are taken from them.
    limits
        Least and greatest value per input, in SI units; the range seen when not given.
    seed
        Of the random signals.

    Raises
    ------
    FitError
        If there are fewer than two alternatives, they have other inputs or outputs, the
        recordings have no time, or a limit names no input.
    """
    _check(alternatives, recordings, limits or {})
    first = recordings[0]
    noise = noise_scale(alternatives[0], recordings)
    known = [information(one, noise) for one in alternatives]
    ranges = _ranges(recordings, limits or {})
    time: Array = first.step * np.arange(
        min(MOST_SAMPLES, len(first)), dtype=np.float64
    )
    found: list[tuple[float, str, Array]] = []
    for name, inputs in _inputs(first, time, ranges, seed).items():
        sigmas = _sigmas(alternatives, known, time, inputs, noise, recordings)
        found.append((sigmas, name, inputs))
    found.sort(key=lambda one: -one[0])
    sigmas, name, inputs = found[0]
    played = Recording.from_arrays(
        name,
        time,
        {
            channel: (inputs[:, i], first.input_units[i])
            for i, channel in enumerate(first.input_names)
        },
        source="next_experiment",
    )
    clock, driven = first.time[: len(time)], first.inputs[: len(time)]
    recorded = _sigmas(alternatives, known, clock, driven, noise, None)
    return Experiment(
        status=_status(sigmas),
        statement=_statement(name, sigmas, recorded, played),
        sigmas=sigmas,
        recorded_sigmas=recorded,
        input=played,
        inputs=tuple(InputProposal(name=n, sigmas=s) for s, n, _ in found),
        sensors=_sensors(alternatives, known, clock, driven, noise),
    )


def _check(
    alternatives: Sequence[FittedModel],
    recordings: Sequence[BoundRecording],
    limits: Mapping[str, tuple[float, float]],
) -> None:
    if len(alternatives) < 2:
        raise FitError(
            "An experiment separates at least two alternatives.",
            (),
            "Give two fitted models or more.",
        )
    channels = {
        (one.problem.model.input_names, one.problem.model.output_names)
        for one in alternatives
    }
    if len(channels) > 1:
        raise FitError(
            "The alternatives have different inputs or outputs.",
            tuple(one.graph.name for one in alternatives),
            "Fit them to the same recordings.",
        )
    if recordings[0].steady or not recordings[0].input_names:
        raise FitError(
            "Without time and an input there is no signal to design.",
            (recordings[0].name,),
            "Give a recording with a clock that drives at least one input.",
        )
    for name in limits:
        if name not in recordings[0].input_names:
            raise FitError(
                f"The limits name {name!r}, which is no input.",
                (name,),
                did_you_mean(name, recordings[0].input_names),
            )


def _ranges(
    recordings: Sequence[BoundRecording], limits: Mapping[str, tuple[float, float]]
) -> list[tuple[float, float]]:
    """Return the least and greatest value of each input."""
    ranges = []
    for i, name in enumerate(recordings[0].input_names):
        low = min(float(r.inputs[:, i].min()) for r in recordings)
        high = max(float(r.inputs[:, i].max()) for r in recordings)
        ranges.append(limits.get(name, (low, high)))
    return ranges


def _inputs(
    first: BoundRecording, time: Array, ranges: list[tuple[float, float]], seed: int
) -> dict[str, Array]:
    """Return input arrays by name: one input moves, the others rest at their median."""
    rest = np.median(first.inputs, axis=0)
    found = {}
    for i, (low, high) in enumerate(ranges):
        if not high > low:
            continue
        shapes = waves(time, np.random.default_rng(seed))
        for name, wave in shapes.items():
            inputs = np.tile(rest, (len(time), 1))
            inputs[:, i] = 0.5 * (low + high) + 0.5 * (high - low) * wave
            found[f"{name} on {first.input_names[i]}"] = inputs
    if not found:
        raise FitError(
            "No input has a range to move in.",
            first.input_names,
            "Give limits: limits={'input': (least, greatest)}.",
        )
    return found


def _sigmas(
    alternatives: Sequence[FittedModel],
    known: Sequence[Array],
    time: Array,
    inputs: Array,
    noise: Array,
    recordings: Sequence[BoundRecording] | None,
    sensors: tuple[Signal, ...] = (),
) -> float:
    """Return the least distance under an input; 0 where it cannot be played.

    It cannot where an alternative fails, or says that an output would go far beyond
    what was seen.
    """
    done = [
        behaviour(one, time, inputs, k, sensors)
        for one, k in zip(alternatives, known, strict=True)
    ]
    fine = [one for one in done if one is not None]
    if len(fine) < len(done):
        return 0.0
    if recordings is not None:
        seen = np.max([np.ptp(r.outputs, axis=0) for r in recordings], axis=0)
        if any((np.ptp(one.outputs, axis=0) > BEYOND * seen).any() for one in fine):
            return 0.0
    ny = len(noise)
    spread = np.std(fine[0].outputs[:, ny:], axis=0)
    assumed = np.where(spread > 0.0, USUAL_NOISE * spread, np.inf)
    return least_distance(fine, np.concatenate([noise, assumed]))


def _sensors(
    alternatives: Sequence[FittedModel],
    known: Sequence[Array],
    time: Array,
    inputs: Array,
    noise: Array,
) -> tuple[SensorAddition, ...]:
    """Return what a sensor at each junction common to all would add."""
    graph = alternatives[0].graph
    read = {measurement.expression for measurement in graph.measurements}
    found = []
    for junction in graph.junctions:
        one = isinstance(junction, OneJunction)
        signal = Signal(Quantity.FLOW if one else Quantity.EFFORT, junction.name)
        shared = all(other.graph.has_place(junction.name) for other in alternatives)
        if signal in read or not shared:
            continue
        sigmas = _sigmas(alternatives, known, time, inputs, noise, None, (signal,))
        word = graph.domain_at(junction.name).word(signal.quantity)
        found.append(SensorAddition(quantity=word, place=junction.name, sigmas=sigmas))
    worth = (addition for addition in found if addition.sigmas > 0.0)
    return tuple(sorted(worth, key=lambda addition: -addition.sigmas))


def _status(sigmas: float) -> ExperimentStatus:
    if sigmas >= DECISIVE:
        return ExperimentStatus.DECISIVE
    return ExperimentStatus.WEAK if sigmas >= VISIBLE else ExperimentStatus.USELESS


def _statement(name: str, sigmas: float, recorded: float, played: Recording) -> str:
    if sigmas < VISIBLE:
        return (
            f"No input within these limits separates the alternatives: the best, a "
            f"{name}, by {sigmas:.2g} sigmas."
        )
    spans = ", ".join(
        f"{c.name} from {c.values.min():.3g} to {c.values.max():.3g} {c.unit}"
        for c in played.channels
    )
    return (
        f"Play a {name} ({spans}, {played.duration:.3g} s): the alternatives then "
        f"differ by {sigmas:.2g} sigmas in all, against {recorded:.2g} in as much of "
        "the recording there is."
    )
