"""A recording bound to a model: which channel is which input and which output.

Here, and only here, the units of a recording meet those of a model. What a model needs
and a recording lacks is refused by the model's name for it.
"""

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bondgraph.errors import RecordingError, UnitError, did_you_mean
from bondgraph.recordings.channel import Channel, FloatArray, read_only
from bondgraph.recordings.names import join_header
from bondgraph.recordings.reading import read_recording
from bondgraph.recordings.recording import Recording, as_index, part_range
from bondgraph.structure.units import conversion, is_coherent


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BoundRecording:
    """The inputs and outputs of a model as recorded, in the model's units.

    Parameters
    ----------
    name, time, steady, source, sha256, notes
        As in `Recording`.
    inputs, outputs
        ``[sample, channel]``, in the order of the names.
    input_units, output_units
        The model's units, or the recording's where they were not checked.
    recorded_units
        Of the outputs, as the recording has them; none where that is not known.
    unused
        Channels of the recording (or columns of its file) that the model does not use.
    """

    name: str
    time: FloatArray
    inputs: FloatArray
    outputs: FloatArray
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    recorded_units: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    steady: bool = False
    source: str = ""
    sha256: str = ""
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return self.time.size

    @property
    def duration(self) -> float:
        """Seconds from the first sample to the last; nan for a steady table."""
        return float("nan") if self.steady else float(self.time[-1] - self.time[0])

    @property
    def step(self) -> float:
        """The median sampling step in seconds; nan for a steady table."""
        if self.steady or len(self) < 2:
            return float("nan")
        return float(np.median(np.diff(self.time)))

    def input(self, name: str) -> FloatArray:
        """Return the samples of the model's input called `name`."""
        return self.inputs[:, _position(name, self.input_names, "input")]

    def output(self, name: str) -> FloatArray:
        """Return the samples of the model's measurement called `name`."""
        return self.outputs[:, _position(name, self.output_names, "measurement")]

    def part(self, start: int, stop: int) -> "BoundRecording":
        """Return the samples ``start <= i < stop`` (negative: from the end)."""
        part = part_range(self.name, len(self), start, stop)
        return self.rows(part, name=f"{self.name}[{part.start}:{part.stop}]")

    def ordered(
        self, inputs: Sequence[str], outputs: Sequence[str]
    ) -> "BoundRecording":
        """Return the inputs and outputs of those names, in that order.

        Raises
        ------
        RecordingError
            If it was bound to a model with others.
        """
        if (*inputs, *outputs) == (*self.input_names, *self.output_names):
            return self
        for wanted, there in (inputs, self.input_names), (outputs, self.output_names):
            if set(wanted) != set(there):
                raise RecordingError(
                    f"Recording {self.name!r} was bound to a model with the channels "
                    f"{_listed(there)}, and this one has {_listed(wanted)}.",
                    (self.name, *set(wanted).symmetric_difference(there)),
                    "Bind it to this model: bind_to(graph, recording).",
                )
        order = [self.input_names.index(name) for name in inputs]
        read = [self.output_names.index(name) for name in outputs]
        return replace(
            self,
            inputs=self.inputs[:, order],
            outputs=self.outputs[:, read],
            input_names=tuple(inputs),
            output_names=tuple(outputs),
            input_units=tuple(self.input_units[i] for i in order),
            output_units=tuple(self.output_units[i] for i in read),
            recorded_units=tuple(self.recorded_units[i] for i in read)
            if self.recorded_units
            else (),
        )

    def rows(self, rows: Sequence[int], *, name: str | None = None) -> "BoundRecording":
        """Return the samples numbered `rows` (increasing)."""
        chosen = as_index(rows)
        return replace(
            self,
            name=self.name if name is None else name,
            time=self.time[chosen],
            inputs=self.inputs[chosen],
            outputs=self.outputs[chosen],
        )


def bind(
    recording: Recording,
    inputs: Mapping[str, str],
    outputs: Mapping[str, str],
    *,
    mapping: Mapping[str, str] | None = None,
    unchecked: AbstractSet[str] = frozenset(),
) -> BoundRecording:
    """Return the recording as the inputs and outputs of a model.

    Parameters
    ----------
    recording
        What was measured.
    inputs, outputs
        The model's inputs and measurements with their units, ``{name: unit}``. The
        samples are converted to these units.
    mapping
        Model name to channel name, where they differ.
    unchecked
        Model names (those of the analogue domain) whose unit may be anything; their
        samples are taken as they are.

    Raises
    ------
    RecordingError
        If a channel is missing, its unit does not convert, is input and measurement at
        once, or `mapping` names what is not in the model.
    """
    mapping = mapping or {}
    needed = {**inputs, **outputs}
    _refuse_twice(inputs, outputs, mapping)
    for name in mapping:
        if name not in needed and name != "time":
            raise RecordingError(
                f"The mapping names {name!r}, which is neither an input nor a "
                "measurement of the model.",
                (name,),
                did_you_mean(name, needed),
            )
    found = {
        name: _channel(recording, name, mapping, None if name in unchecked else unit)
        for name, unit in needed.items()
    }
    for name in inputs:
        _check_driven(recording, name, found[name])
    used = {mapping.get(name, name) for name in needed}
    return BoundRecording(
        name=recording.name,
        time=recording.time,
        inputs=_matrix([found[name] for name in inputs], len(recording)),
        outputs=_matrix([found[name] for name in outputs], len(recording)),
        input_names=tuple(inputs),
        output_names=tuple(outputs),
        input_units=tuple(found[name].unit for name in inputs),
        output_units=tuple(found[name].unit for name in outputs),
        recorded_units=tuple(
            recording.channel(mapping.get(name, name)).unit for name in outputs
        ),
        unused=tuple(n for n in recording.names if n not in used) + recording.unread,
        steady=recording.steady,
        source=recording.source,
        sha256=recording.sha256,
        notes=(*recording.notes, *_not_converted(found, unchecked)),
    )


def _refuse_twice(
    inputs: Mapping[str, str], outputs: Mapping[str, str], mapping: Mapping[str, str]
) -> None:
    """Refuse one channel as an input and as a measurement: it would explain itself."""
    driven = {mapping.get(name, name): name for name in inputs}
    for name in outputs:
        channel = mapping.get(name, name)
        if channel in driven:
            raise RecordingError(
                f"Channel {channel!r} would be the input {driven[channel]!r} and the "
                f"measurement {name!r} at once.",
                (channel, driven[channel], name),
                "Map one of them to another channel.",
            )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) or "none"


def _not_converted(
    found: Mapping[str, Channel], unchecked: AbstractSet[str]
) -> Iterator[str]:
    """Yield a sentence for each channel whose unit would convert, and does not."""
    for name in found:
        if name in unchecked and not is_coherent(found[name].unit):
            yield (
                f"{name} goes in as the number of [{found[name].unit}] that the file "
                "has: the domain analogue has no unit to convert it to."
            )


def read_bound(
    path: str | Path,
    inputs: Mapping[str, str],
    outputs: Mapping[str, str],
    *,
    mapping: Mapping[str, str] | None = None,
    unchecked: AbstractSet[str] = frozenset(),
    **choices: Any,
) -> BoundRecording:
    """Read only what a model needs from a file, and bind it.

    Columns that the model does not use are neither read nor checked.

    Parameters
    ----------
    path
        The file.
    inputs, outputs, unchecked
        As in `bind`.
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
    needed = tuple({**inputs, **outputs})
    _refuse_twice(inputs, outputs, mapping or {})
    allowed = {*needed, choices.get("time", "time")}
    for name in mapping or {}:
        if name not in allowed:
            raise RecordingError(
                f"The mapping names {name!r}, which is neither an input nor a "
                "measurement of the model.",
                (name,),
                did_you_mean(name, needed),
            )
    recording = read_recording(path, mapping=mapping, channels=needed, **choices)
    return bind(recording, inputs, outputs, unchecked=unchecked)


def _channel(
    recording: Recording, name: str, mapping: Mapping[str, str], unit: str | None
) -> Channel:
    """Return the channel for the model's `name`, in `unit` if one is asked for."""
    wanted = mapping.get(name, name)
    if wanted not in recording.names:
        mapped = f"channel {wanted!r} for {name!r}" if wanted != name else f"{name!r}"
        listed = ", ".join(join_header(c.name, c.unit) for c in recording.channels)
        raise RecordingError(
            f"Recording {recording.name!r} has no {mapped}; it has {listed}.",
            (recording.name, name),
            f"Map it: {name}=CHANNEL.",
        )
    channel = recording.channel(wanted)
    if unit is None:
        return channel
    try:
        conversion(channel.unit, unit)
    except UnitError as error:
        raise RecordingError(
            f"{name!r} of the model is in {unit!r}, and channel {wanted!r} of "
            f"{recording.name!r} is in {channel.unit!r}, which does not convert to it.",
            (recording.name, name, wanted),
            "Degrees Celsius are [degC]."
            if (channel.unit, unit) == ("C", "K")
            else "Correct the unit in the header or the domain of the model, map the "
            f"channel with another unit ({name}={wanted}[{unit}]), or name that of a "
            "measured formula: measure(name, formula, unit=...).",
        ) from error
    return channel.to(unit)


def _check_driven(recording: Recording, name: str, channel: Channel) -> None:
    """Refuse an input with gaps: nothing says what drove the machine in them."""
    missing = np.flatnonzero(np.isnan(channel.values))
    if missing.size:
        raise RecordingError(
            f"Input {name!r} of {recording.name!r} was not measured in "
            f"{missing.size} of {len(recording)} samples, first at "
            f"{recording.time[missing[0]]:.6g} s.",
            (recording.name, name),
            'Drop those rows with gaps="drop"; or, of a command that stays until the '
            "next, put the channels on one clock with held=(...).",
        )


def _matrix(channels: list[Channel], samples: int) -> FloatArray:
    if not channels:
        return read_only(np.empty((samples, 0)))
    return read_only(np.stack([c.values for c in channels], axis=1))


def _position(name: str, names: tuple[str, ...], what: str) -> int:
    if name not in names:
        raise RecordingError(
            f"There is no {what} {name!r} here.", (name,), did_you_mean(name, names)
        )
    return names.index(name)
