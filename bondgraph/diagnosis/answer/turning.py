"""A reading that turns where nothing drives the model: what drives it is missing.

The state of one store that is left alone goes one way: x' = f(x) crosses no value
twice. No law that only changes f makes it rise and then fall, and one that adds a store
does so from where that happens to begin. A tank that is still being filled is no tank
with a slow gauge.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.answer.doubt import less_probable
from bondgraph.diagnosis.evidence.leftover import noise_floor
from bondgraph.diagnosis.records import Finding
from bondgraph.numeric.model import NumericModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.spread import changes

Array = NDArray[np.float64]

STRETCHES = 50
"""A recording is seen as the medians of so many stretches, or of `SHORTEST` samples
each: single readings that are wrong turn nothing.
"""

SHORTEST = 5

FEWEST = 6
"""Of fewer stretches none is said to turn."""

COUNTS = 0.1
"""A way back of less than this share of all that it goes through may be drift."""

OVER_NOISE = 5.0

LEFT = 0.5
"""What is left of the probability of a law where a reading turns: a judgement. It may
be a lag of a gauge, as it is of a thermometer that was just put in.
"""

WHY = " What drives the machine there may be missing instead: see the notes."


@dataclass(frozen=True, slots=True)
class Turn:
    """Where a reading turns: from `before` to `at` and back to `after`."""

    recording: str
    output: str
    unit: str
    seconds: float
    before: float
    at: float
    after: float

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return (
            f"{self.output} turns in {self.recording}: it goes from {self.before:.4g} "
            f"to {self.at:.4g} at {self.seconds:.4g} s and then to {self.after:.4g}"
            f"{unit}. Nothing that changes drives the model, and what its one store "
            "holds then goes one way. Add the source that drives it, with its record; "
            f"or leave that time out, with --begin {self.seconds:.4g} or --end."
        )


def turns_of(
    model: NumericModel, recordings: Sequence[BoundRecording]
) -> tuple[Turn, ...]:
    """Return where readings turn that nothing in the model turns, one per reading."""
    if model.n_states != 1 or model.needs_time:
        return ()
    floor = noise_floor(recordings)
    found: dict[str, Turn] = {}
    for one in recordings:
        if one.steady or changes(one.inputs).any():
            continue
        for name, unit in zip(one.output_names, one.output_units, strict=True):
            turn = _turn(one.time, one.output(name), OVER_NOISE * floor[name])
            if turn is not None:
                found.setdefault(name, Turn(one.name, name, unit, *turn))
    return tuple(found.values())


def _turn(
    time: Array, reading: Array, least: float
) -> tuple[float, float, float, float] | None:
    """Return when a reading has turned, and its values before, there and after."""
    known = np.isfinite(reading)
    time, reading = time[known], reading[known]
    count = min(STRETCHES, len(reading) // SHORTEST)
    if count < FEWEST:
        return None
    values = np.array([np.median(part) for part in np.array_split(reading, count)])
    least = max(least, COUNTS * float(np.ptp(values)))
    deepest, at, way = max((*_farthest(sign * values), sign) for sign in (1, -1))
    if deepest <= least:
        return None
    first = np.argmin(way * values[: at + 1])
    last = at + np.argmin(way * values[at:])
    ended = float(np.array_split(time, count)[at][-1])
    return ended, float(values[first]), float(values[at]), float(values[last])


def _farthest(values: Array) -> tuple[float, int]:
    """Return how far values go both up to the top of a hill and down from it; where."""
    up = values - np.minimum.accumulate(values)
    down = values - np.minimum.accumulate(values[::-1])[::-1]
    both = np.minimum(up, down)
    at = int(np.argmax(both))
    return float(both[at]), at


def doubted_at_turns(
    findings: Sequence[Finding], turns: Sequence[Turn]
) -> list[Finding]:
    """Return the findings, half as probable where a reading turns by itself."""
    if not turns:
        return list(findings)
    return [less_probable(finding, LEFT, WHY) for finding in findings]
