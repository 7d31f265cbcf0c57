"""Recordings, simulations and profiles as charts in a notebook.

One picture per channel, under each other over the same time. It stands by itself: no
script, colours that read on light and dark paper, and a sentence for those who hear it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.profile import Profile
from bondgraph.fitting.simulate import Solution, SolveStatus
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.recording import Recording
from bondgraph.reporting.charts import Chart, Curve, chart
from bondgraph.reporting.wording import number_words, relative_error, unit_words
from bondgraph.simulation.run import Run

Array = NDArray[np.float64]
HEIGHT, SLICES, MOST_CHARTS = 110, 500, 12
LEFT, BOTTOM, WIDTH, SIDE = 90, 34, 720, 1000.0
_COLOURS = {"measured": "#888", "simulated": "#d55e00"}
_AXIS = 'fill="currentColor" font-size="11" font-family="system-ui,sans-serif"'


@dataclass(frozen=True, slots=True, eq=False)
class _Channel:
    """One picture: the name and unit of its axis, and curves by their name."""

    name: str
    unit: str
    curves: dict[str, Array]


def recording_html(recording: Recording) -> str:
    """Return the channels of a recording over time."""
    channels = [_Channel(c.name, c.unit, {"": c.values}) for c in recording.channels]
    return _over_time(recording.name, recording.time, channels, recording.steady)


def bound_html(recording: BoundRecording) -> str:
    """Return inputs and outputs of a model's recording over time."""
    inputs = zip(
        recording.input_names, recording.input_units, recording.inputs.T, strict=True
    )
    outputs = zip(
        recording.output_names, recording.output_units, recording.outputs.T, strict=True
    )
    channels = [
        *(_Channel(f"{name} (input)", unit, {"": x}) for name, unit, x in inputs),
        *(_Channel(name, unit, {"": x}) for name, unit, x in outputs),
    ]
    return _over_time(recording.name, recording.time, channels, recording.steady)


def solution_html(solution: Solution) -> str:
    """Return measured and simulated outputs over time, and how far they are apart."""
    if solution.status is SolveStatus.FAILED:
        return f"<p><b>The simulation failed.</b> {escape(solution.reason)}</p>"
    units = zip(solution.output_names, solution.output_units, strict=True)
    channels = [
        _Channel(
            name,
            unit,
            {
                "measured": solution.measured[:, i],
                "simulated": solution.simulated[:, i],
            },
        )
        for i, (name, unit) in enumerate(units)
    ]
    shown = _over_time(solution.recording, solution.time, channels, steady=False)
    error = escape(relative_error(solution.score, "the measured spread"))
    return f"{shown}<p>Error: {error}.</p>"


def run_html(run: Run) -> str:
    """Return the outputs of a run over time, and how it ended."""
    units = zip(run.output_names, run.output_units, run.outputs.T, strict=True)
    channels = [_Channel(name, unit, {"": y}) for name, unit, y in units]
    shown = _over_time("run", run.time, channels, steady=False)
    words = f"<p>{escape(f'{run.status.value} {run.reason}'.strip())}</p>"
    return shown + words


def profile_html(profile: Profile) -> str:
    """Return how the cost rises as a parameter moves, and what that says of it."""
    x, y = np.array(profile.values), np.array(profile.rise)
    drawn = chart(
        [
            Curve("rise", "", x, y),
            Curve("95 %", "", x, np.full(x.size, profile.threshold)),
        ],
        title=profile.name,
        description=f"Rise of the cost over {profile.name}",
        x_label=profile.name,
        y_label="rise",
        frame=["rise", "95 %"],
    )
    unit = f" [{unit_words(profile.unit)}]" if profile.unit else ""
    words = f"<p>{escape(profile.name)}: {escape(profile.status.value)}</p>"
    return words + _svg(drawn, x_label=f"{profile.name}{unit}")


def _over_time(
    name: str, time: Array, channels: Sequence[_Channel], steady: bool
) -> str:
    clock = f"{time.size} operating points" if steady else _clock(time)
    caption = f"<p><b>{escape(name)}</b>: {clock}</p>"
    pictures = [
        _svg(_channel_chart(channel, time), x_label="row" if steady else "time [s]")
        for channel in channels[:MOST_CHARTS]
    ]
    more = len(channels) - len(pictures)
    rest = f"<p>and {more} more channels</p>" if more else ""
    return f'<div style="max-width:{WIDTH}px">{caption}{"".join(pictures)}{rest}</div>'


def _clock(time: Array) -> str:
    step = number_words(float(np.median(np.diff(time))), 3)
    return f"{time.size} samples, {number_words(float(np.ptp(time)))} s, step {step} s"


def _channel_chart(channel: _Channel, time: Array) -> Chart:
    curves = [Curve(name, "", time, y) for name, y in channel.curves.items()]
    ranges = ", ".join(
        f"{name} {number_words(float(np.nanmin(y)))} to "
        f"{number_words(float(np.nanmax(y)))} {unit_words(channel.unit)}".strip()
        for name, y in channel.curves.items()
    )
    unit = f" [{unit_words(channel.unit)}]" if channel.unit else ""
    return chart(
        curves,
        title=channel.name,
        description=f"{channel.name} over time: {ranges}",
        x_label="time [s]",
        y_label=f"{channel.name}{unit}",
        frame=[next(iter(channel.curves))],
        slices=SLICES,
    )


def _svg(drawn: Chart, *, x_label: str) -> str:
    """Return a chart, whose lines live in a square of 1000, as one picture."""
    across, up = WIDTH - LEFT - 10, HEIGHT - BOTTOM - 16
    texts = [
        f'<text x="{LEFT}" y="11" {_AXIS}>{escape(drawn.y_label)}'
        + "".join(
            f'<tspan dx="14" fill="{_colour(line.name)}">— {escape(line.name)}</tspan>'
            for line in drawn.lines
            if line.name
        )
        + "</text>",
        f'<text x="{WIDTH - 10}" y="{HEIGHT - 2}" text-anchor="end" {_AXIS}>'
        f"{escape(x_label)}</text>",
    ]
    for tick in drawn.x_ticks:
        x = LEFT + across * tick.at / 100
        texts.append(
            f'<text x="{x:.1f}" y="{16 + up + 13}" text-anchor="middle" {_AXIS}>'
            f"{tick.label}</text>"
        )
    for tick in drawn.y_ticks[:: max(1, len(drawn.y_ticks) // 3)]:
        y = 16 + up * tick.at / 100
        texts.append(
            f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end" {_AXIS}>'
            f"{tick.label}</text>"
            f'<path d="M{LEFT} {y:.1f}h{across}" stroke="currentColor" opacity=".15"/>'
        )
    lines = "".join(
        f'<path d="{line.path}" fill="none" stroke="{_colour(line.name)}" '
        'stroke-width="1.4" vector-effect="non-scaling-stroke"/>'
        for line in drawn.lines
    )
    words, square = "".join(texts), f"0 0 {SIDE:g} {SIDE:g}"
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" width="100%" role="img" '
        f'aria-label="{escape(drawn.description)}">{words}'
        f'<svg x="{LEFT}" y="16" width="{across}" height="{up}" viewBox="{square}" '
        f'preserveAspectRatio="none">{lines}</svg></svg>'
    )


def _colour(name: str) -> str:
    return _COLOURS.get(name, "#0072b2")
