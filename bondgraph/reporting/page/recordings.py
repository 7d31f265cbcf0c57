"""Held-out recordings on the page: charts with one time axis, samples, and errors."""

from dataclasses import dataclass

import numpy as np

from bondgraph.diagnosis.records import Diagnosis, Trace
from bondgraph.reporting.charts import Array, Chart, Curve, chart
from bondgraph.reporting.page.packing import Packed, keep_every, pack
from bondgraph.reporting.wording import number_words, unit_words

MOST_SLICES = 1500
ALL_SLICES = 40_000  # over all charts of a page, so that it stays a few megabytes
AWAY = 2.0  # ranges of the measured signal: simulations that run farther are cut


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelCharts:
    """One output on one recording: its two charts, its samples, its errors."""

    trace: Trace
    outputs: Chart
    errors: Chart
    key: tuple[tuple[str, str], ...]
    packed: Packed | None
    every: int
    before: str
    after: str


def recording_charts(diagnosis: Diagnosis) -> dict[str, list[ChannelCharts]]:
    """Return the charts of every output, by recording."""
    traces = diagnosis.traces
    slices = min(MOST_SLICES, max(200, ALL_SLICES // max(1, len(traces))))
    every = keep_every(len(trace.time) for trace in traces)
    grouped: dict[str, list[ChannelCharts]] = {}
    for trace in traces:
        noise = diagnosis.noise_floor.get(trace.channel)
        unit = unit_words(trace.unit)
        errors = _simulated(*_errors(trace))
        whole = {
            name: trace.before if name == "before" else trace.after for name in errors
        }
        grouped.setdefault(trace.recording, []).append(
            ChannelCharts(
                trace=trace,
                outputs=_output_chart(trace, whole, slices),
                errors=_error_chart(trace, errors, noise, slices),
                key=tuple((_css(name, trace), name) for name in ("measured", *errors)),
                packed=None
                if trace.steady
                else _packed(trace.measured, trace.time, errors, every),
                every=every,
                before=_rms(trace.before, trace, unit),
                after=_rms(trace.after, trace, unit),
            )
        )
    return grouped


def _errors(trace: Trace) -> tuple[Array, Array]:
    """Return simulated minus measured, cut: what runs away would flatten the rest."""
    reach = AWAY * float(np.ptp(trace.measured[np.isfinite(trace.measured)])) or 1.0
    before, after = (
        np.clip(values - trace.measured, -reach, reach)
        for values in (trace.before, trace.after)
    )
    return before, after


def _simulated(before: Array, after: Array) -> dict[str, Array]:
    """Return the simulations by name: two, or one where nothing was changed."""
    if np.array_equal(before, after, equal_nan=True):
        return {"model": after}
    return {"before": before, "after": after}


def _packed(
    measured: Array, time: Array, errors: dict[str, Array], every: int
) -> Packed:
    series, sums = {"measured": measured}, {}
    for name, error in errors.items():
        series[f"error {name}"] = error
    for name, error in errors.items():
        series[name] = measured + error
        sums[name] = f"error {name}"
    return pack(time, series, sums, every)


def _curves(trace: Trace, values: dict[str, Array]) -> tuple[Curve, ...]:
    return tuple(
        Curve(name, _css(name, trace), trace.time, one, trace.steady)
        for name, one in values.items()
    )


def _css(name: str, trace: Trace) -> str:
    css = "after" if name == "model" else name
    return f"{css} dots" if trace.steady else css


def _axis(trace: Trace) -> str:
    return "row of the table" if trace.steady else "time [s]"


def _output_chart(trace: Trace, simulated: dict[str, Array], slices: int) -> Chart:
    unit = unit_words(trace.unit)
    errors = ", ".join(
        f"{name} {_rms(values, trace, unit)}" for name, values in simulated.items()
    )
    return chart(
        _curves(trace, {"measured": trace.measured, **simulated}),
        title=trace.channel,
        description=f"{trace.channel} over {_axis(trace)}: measured, and simulated "
        f"({' and '.join(simulated)}). Root mean square of the error: {errors}.",
        x_label=_axis(trace),
        y_label=f"{trace.channel} [{unit}]",
        frame=("measured", list(simulated)[-1]),
        slices=slices,
    )


def _error_chart(
    trace: Trace, errors: dict[str, Array], noise: float | None, slices: int
) -> Chart:
    return chart(
        _curves(trace, errors),
        title=f"error of {trace.channel}",
        description=f"Simulated minus measured {trace.channel} "
        f"({' and '.join(errors)}).",
        x_label=_axis(trace),
        y_label=f"error [{unit_words(trace.unit)}]",
        frame=tuple(errors),
        slices=slices,
        band=None if noise is None else 2 * noise,
    )


def _rms(simulated: Array, trace: Trace, unit: str) -> str:
    error = (simulated - trace.measured)[np.isfinite(trace.measured)]
    if not np.isfinite(error).all():
        return "could not be simulated to its end"
    return f"{number_words(float(np.sqrt(np.mean(error**2))), 3)} {unit}"
