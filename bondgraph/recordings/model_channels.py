"""What a model needs of a recording: its inputs and measurements, with their units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from bondgraph.errors import RecordingError, UnitError
from bondgraph.recordings.binding import BoundRecording, bind, read_bound
from bondgraph.recordings.recording import Recording
from bondgraph.structure.graph import FinishedGraph, Measurement
from bondgraph.structure.signals import Signal, signals_in
from bondgraph.structure.units import conversion


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelChannels:
    """The channels of a model, ``{name: unit}``.

    Parameters
    ----------
    inputs, outputs
        The sources that a recording drives, and the measurements.
    unchecked
        Those of the analogue domain, whose unit is whatever the recording says.
    """

    inputs: Mapping[str, str]
    outputs: Mapping[str, str]
    unchecked: frozenset[str]


def channels_of(graph: FinishedGraph) -> ModelChannels:
    """Return the channels that a recording of `graph` has to have."""
    inputs = {source.name: graph.input_unit(source.name) for source in graph.inputs}
    outputs = {m.name: m.unit for m in graph.measurements}
    free = [name for name in inputs if not graph.domain_at(name).checked]
    free += [m.name for m in graph.measurements if _takes_any_unit(graph, m)]
    return ModelChannels(inputs=inputs, outputs=outputs, unchecked=frozenset(free))


def matched(
    graph: FinishedGraph, recordings: Sequence[BoundRecording], what_for: str = ""
) -> tuple[BoundRecording, ...]:
    """Return recordings with the columns in the order in which `graph` has them.

    Parameters
    ----------
    what_for
        They are needed, for the refusal where there is none: ``" to diagnose from"``.

    Raises
    ------
    RecordingError
        If there is none, one is not bound to a model, or one was bound to another
        model: other names or units.
    """
    if isinstance(recordings, Recording | BoundRecording):
        raise RecordingError(
            f"Recording {recordings.name!r} is one, and several are asked for.",
            (recordings.name,),
            "Give a list, of one if there is one: [recording].",
        )
    if not recordings:
        raise RecordingError(
            f"There is no recording of {graph.name!r}{what_for}.",
            (graph.name,),
            "Give at least one, read with read_for(graph, path); split(recording, 0.6) "
            "makes two of one.",
        )
    _refuse_unbound(graph, recordings)
    channels = channels_of(graph)
    names = tuple(channels.inputs), tuple(channels.outputs)
    found = tuple(one.ordered(*names) for one in recordings)
    for one in found:
        _refuse_other_units(graph, one, channels)
    return found


def _refuse_unbound(graph: FinishedGraph, recordings: Sequence[object]) -> None:
    for one in recordings:
        if isinstance(one, Recording):
            raise RecordingError(
                f"Recording {one.name!r} is not bound to {graph.name!r} yet.",
                (one.name, graph.name),
                "Bind it to this model: bind_to(graph, recording).",
            )
        if not isinstance(one, BoundRecording):
            raise RecordingError(
                f"A {type(one).__name__} is no recording of {graph.name!r}.",
                (graph.name,),
                "Read a file with read_for(graph, path), or make a recording with "
                "Recording.from_arrays and bind it: bind_to(graph, recording).",
            )


def _refuse_other_units(
    graph: FinishedGraph, recording: BoundRecording, channels: ModelChannels
) -> None:
    names = (*recording.input_names, *recording.output_names)
    bound = dict(
        zip(names, (*recording.input_units, *recording.output_units), strict=True)
    )
    for name, unit in {**channels.inputs, **channels.outputs}.items():
        if name not in channels.unchecked and not _alike(bound[name], unit):
            raise RecordingError(
                f"{name!r} of recording {recording.name!r} was bound in "
                f"{bound[name]!r}, and {graph.name!r} has it in {unit!r}.",
                (recording.name, name),
                "Bind it to this model: bind_to(graph, recording).",
            )


def refuse_twice(recordings: Sequence[BoundRecording]) -> None:
    """Refuse a recording that is given more than once: it would count as several.

    Raises
    ------
    RecordingError
        Naming it.
    """
    for first, second in combinations(recordings, 2):
        same = np.array_equal(first.time, second.time) and np.array_equal(
            first.outputs, second.outputs, equal_nan=True
        )
        if same and np.array_equal(first.inputs, second.inputs):
            raise RecordingError(
                f"Recordings {first.name!r} and {second.name!r} hold the same samples, "
                "which would count twice.",
                (first.name, second.name),
                "Leave one of them out.",
            )


def _alike(unit: str, other: str) -> bool:
    """Return whether a number in one unit is the same number in the other."""
    try:
        return np.allclose(conversion(unit, other), (1.0, 0.0))
    except UnitError:
        return False


def bind_to(
    graph: FinishedGraph,
    recording: Recording,
    *,
    mapping: Mapping[str, str] | None = None,
) -> BoundRecording:
    """Return a recording as the inputs and measurements of a model.

    Parameters
    ----------
    mapping
        Model name to channel name, where they differ.

    Raises
    ------
    RecordingError
        If a channel is missing or its unit does not convert to the model's.
    """
    channels = channels_of(graph)
    return bind(
        recording,
        channels.inputs,
        channels.outputs,
        mapping=mapping,
        unchecked=channels.unchecked,
    )


def read_for(
    graph: FinishedGraph,
    path: str | Path,
    *,
    mapping: Mapping[str, str] | None = None,
    **choices: Any,
) -> BoundRecording:
    """Read what a model needs from a file, and bind it; other columns are not read.

    Parameters
    ----------
    mapping
        Model name to name in the file, with a unit where the file has none:
        ``{"time": "t [s]", "position": "qm [m]"}``.
    **choices
        Further choices of `read_recording`.

    Raises
    ------
    RecordingError, MissingExtraError
        As `read_recording` and `bind` do.
    """
    channels = channels_of(graph)
    return read_bound(
        path,
        channels.inputs,
        channels.outputs,
        mapping=mapping,
        unchecked=channels.unchecked,
        **choices,
    )


def _takes_any_unit(graph: FinishedGraph, measurement: Measurement) -> bool:
    """Return whether nobody said what a measurement is measured in.

    That is so where it reads the analogue domain and has the unit that comes of itself.
    """
    read = measurement.expression
    if isinstance(read, Signal):
        domain = graph.domain_at(read.place)
        return not domain.checked and measurement.unit == domain.unit(read.quantity)
    domains = [graph.domain_at(signal.place) for signal in signals_in(read)]
    return measurement.unit == "1" and any(not domain.checked for domain in domains)
