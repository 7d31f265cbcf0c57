"""`next_experiment`: the input, or the sensor, that would tell alternatives apart."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.experiment.contest import Contest
from bondgraph.diagnosis.experiment.records import (
    Experiment,
    ExperimentStatus,
    InputProposal,
    SensorAddition,
)
from bondgraph.diagnosis.experiment.waves import waves
from bondgraph.errors import FitError, did_you_mean
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.recording import Recording

Array = NDArray[np.float64]
MOST_SAMPLES = 5000
"""Played by one input; of several that can move, each is tried with its share."""
DECISIVE, VISIBLE = 10.0, 3.0
"""Sigmas of the whole difference that decide, and that may be seen at all."""
TELLING = 2.0
"""Times the sigmas without it that a sensor must give to be worth a word."""
WEAKER = (1.0, 0.4, 0.15)
"""Strengths tried where the whole range would take an output too far."""


def next_experiment(
    alternatives: Sequence[FittedModel],
    recordings: Sequence[BoundRecording],
    *,
    limits: Mapping[str, tuple[float, float]] | None = None,
    seed: int = 0,
    nested: bool = False,
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
    nested
        Whether the others are the first alternative with something added. A law that
        may be nothing at all imitates its absence under any input; the question is then
        what would show if it is there.

    Raises
    ------
    FitError
        If there are fewer than two alternatives, they have other inputs or outputs, the
        recordings have no time, a limit names no input, or no input can be played.
    """
    _check(alternatives, recordings, limits or {})
    first = recordings[0]
    rivals = Contest.between(alternatives, recordings, nested=nested)
    ranges = _ranges(recordings, limits or {})
    moving = sum(high > low for low, high in ranges)
    samples = min(MOST_SAMPLES // max(moving, 1), len(first))
    time: Array = first.step * np.arange(samples, dtype=np.float64)
    found: list[tuple[float, str, Array]] = []
    for name, strengths in _inputs(recordings, time, ranges, seed).items():
        for inputs in strengths:
            done = rivals.played(time, inputs)
            if done is not None and rivals.stay_near(done):
                found.append((rivals.distance(done), name, inputs))
                break
    if not found:
        raise FitError(
            "No input within these limits can be played: with each of them an "
            "alternative fails or an output leaves by far the range seen so far.",
            tuple(one.graph.name for one in alternatives),
            "Give narrower limits, or close a loop around the machine.",
        )
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
    recorded, sensors = rivals.as_recorded(len(time))
    return Experiment(
        status=_status(sigmas),
        statement=_statement(name, sigmas, recorded, played, sensors),
        sigmas=sigmas,
        recorded_sigmas=recorded,
        input=played,
        inputs=tuple(InputProposal(name=n, sigmas=s) for s, n, _ in found),
        sensors=sensors,
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
    recordings: Sequence[BoundRecording],
    time: Array,
    ranges: Sequence[tuple[float, float]],
    seed: int,
) -> dict[str, list[Array]]:
    """Return inputs by name, each in several strengths, the strongest first.

    One input moves, the others rest at their median. The strongest takes the whole
    range. Weaker ones keep to the mean of what was recorded, about which a machine that
    integrates its input stayed where it was.
    """
    together = np.concatenate([one.inputs for one in recordings])
    rest, names = np.median(together, axis=0), recordings[0].input_names
    found = {}
    for i, (low, high) in enumerate(ranges):
        if not high > low:
            continue
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        mean = float(np.clip(together[:, i].mean(), low, high))
        reach = min(mean - low, high - mean)
        levels = [(middle, half), *((mean, share * reach) for share in WEAKER)]
        for name, wave in waves(time, np.random.default_rng(seed)).items():
            found[f"{name} on {names[i]}"] = [
                _moving(rest, i, centre + size * wave) for centre, size in levels
            ]
    if not found:
        raise FitError(
            "No input has a range to move in.",
            names,
            "Give limits: limits={'input': (least, greatest)}.",
        )
    return found


def _moving(rest: Array, which: int, values: Array) -> Array:
    """Return all inputs over time, one of which moves."""
    inputs = np.tile(rest, (len(values), 1))
    inputs[:, which] = values
    return inputs


def _status(sigmas: float) -> ExperimentStatus:
    if sigmas >= DECISIVE:
        return ExperimentStatus.DECISIVE
    return ExperimentStatus.WEAK if sigmas >= VISIBLE else ExperimentStatus.USELESS


def _statement(
    name: str,
    sigmas: float,
    recorded: float,
    played: Recording,
    sensors: Sequence[SensorAddition],
) -> str:
    sensor = _sensor_words(recorded, sensors)
    designed, seen = _two_digits(sigmas), _two_digits(recorded)
    if sigmas < VISIBLE:
        return (
            f"No input within these limits separates the alternatives: the best, a "
            f"{name}, by {designed} sigmas.{sensor}"
        )
    if sigmas <= recorded:
        return (
            "Record more of the same: no one input tried separates the alternatives "
            f"better than those recorded do together ({seen} sigmas in "
            f"{played.duration:.3g} s; the best, a {name}, {designed}).{sensor}"
        )
    spans = ", ".join(
        f"{c.name} from {c.values.min():.3g} to {c.values.max():.3g} {c.unit}"
        for c in played.channels
    )
    return (
        f"Play a {name} ({spans}, {played.duration:.3g} s): the alternatives then "
        f"differ by {designed} sigmas in all, against {seen} in as much of the "
        f"recording there is.{sensor}"
    )


def _two_digits(sigmas: float) -> str:
    """Return a number of sigmas to read, without a power of ten below a million."""
    return f"{float(f'{sigmas:.2g}'):.6g}"


def _sensor_words(recorded: float, sensors: Sequence[SensorAddition]) -> str:
    """Return what the best further sensor would do, where it makes a difference."""
    if not sensors or sensors[0].sigmas < max(VISIBLE, TELLING * recorded):
        return ""
    best = sensors[0]
    return (
        f" Measuring the {best.quantity} at {best.place} as well, they differ by "
        f"{_two_digits(best.sigmas)} sigmas with the motion that was recorded."
    )
