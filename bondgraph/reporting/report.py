"""The report page of a diagnosis: one HTML file that needs nothing else.

The statement comes first; then the evidence a reader would ask for: where on the graph,
how measured and simulated compare on data no choice has seen, the law and its data,
what else was considered, what cannot be told apart, and the model to copy. The page
makes no request, runs without its script, and every text in it is escaped.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bondgraph.causality.assignment import assign_causality
from bondgraph.diagnosis.answer.wording import name_of
from bondgraph.diagnosis.records import Diagnosis, RecoveredLaw, Trace
from bondgraph.fitting.result import Estimate
from bondgraph.reporting.charts import Array, Chart, Curve, chart
from bondgraph.reporting.diagnosis_json import delivered
from bondgraph.reporting.drawing import draw_svg
from bondgraph.reporting.files import write_text
from bondgraph.reporting.model_text import describe_difference, to_python
from bondgraph.reporting.wording import (
    NOTHING,
    VERDICTS,
    number_words,
    percent,
    sentence_start,
    unit_words,
    with_deviation,
    with_unit,
)

if TYPE_CHECKING:
    import jinja2

MOST_SLICES = 1500
ALL_SLICES = 40_000  # over all charts of a page, so that it stays a few megabytes


@dataclass(frozen=True, slots=True)
class _ChannelCharts:
    """The two charts of one output on one recording, which share their time axis."""

    trace: Trace
    outputs: Chart
    errors: Chart


@dataclass(frozen=True, slots=True)
class _ParameterRow:
    """One parameter before and after."""

    name: str
    unit: str
    before: str
    after: str
    everything: str
    new: bool


def write_report(diagnosis: Diagnosis, path: Path | str) -> None:
    """Write the report page of a diagnosis to the file at `path`.

    Raises
    ------
    BondGraphError
        If the file cannot be written.
    """
    write_text(path, report_html(diagnosis))


def report_html(diagnosis: Diagnosis) -> str:
    """Return the report page of a diagnosis: one self-contained HTML document.

    Parameters
    ----------
    diagnosis
        Any diagnosis, whatever its verdict.
    """
    return _environment().get_template("report.html").render(**_context(diagnosis))


@cache
def _environment() -> "jinja2.Environment":
    import jinja2  # noqa: PLC0415  (0.1 s, and only pages need it)

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("bondgraph.reporting"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        number=number_words,
        percent=percent,
        physics=name_of,
        raised=sentence_start,
        unit=unit_words,
    )
    environment.globals.update(
        deviation=with_deviation, with_unit=with_unit, nothing=NOTHING
    )
    return environment


def _context(diagnosis: Diagnosis) -> dict[str, Any]:
    from markupsafe import Markup  # noqa: PLC0415  (comes with jinja2)

    before, model = diagnosis.model_before, delivered(diagnosis).model
    improved = (before.nodes, before.measurements) != (model.nodes, model.measurements)
    return {
        "diagnosis": diagnosis,
        "improved": improved,
        "held_out_known": any(
            one.held_out_nrmse is not None for one in diagnosis.candidates
        ),
        "verdict": VERDICTS[diagnosis.verdict],
        "picture": Markup(diagnosis_picture(diagnosis)),  # noqa: S704  (escapes its names)
        "units": {m.name: unit_words(m.unit) for m in model.measurements},
        "recordings": _recordings(diagnosis),
        "laws": [(law, _law_chart(law)) for law in diagnosis.recovered],
        "parameters": _parameter_rows(diagnosis),
        "changes": describe_difference(before, model),
        "model_text": to_python(model),
        "provenance": list(_flattened(diagnosis.provenance)),
    }


def diagnosis_picture(diagnosis: Diagnosis) -> str:
    """Return the improved graph as SVG, coloured by blame, the insertions marked."""
    model = diagnosis.model
    inserted = set(model.by_name) - set(diagnosis.model_before.by_name)
    return draw_svg(
        model,
        assignment=assign_causality(model),
        blame=diagnosis.blame,
        highlight=inserted,
    )


def _recordings(diagnosis: Diagnosis) -> dict[str, list[_ChannelCharts]]:
    """Return the charts of every channel, by recording."""
    count = max(1, len(diagnosis.traces))
    slices = min(MOST_SLICES, max(200, ALL_SLICES // count))
    grouped: dict[str, list[_ChannelCharts]] = {}
    for trace in diagnosis.traces:
        noise = diagnosis.noise_floor.get(trace.channel)
        charts = _ChannelCharts(
            trace, _output_chart(trace, slices), _error_chart(trace, noise, slices)
        )
        grouped.setdefault(trace.recording, []).append(charts)
    return grouped


def _output_chart(trace: Trace, slices: int) -> Chart:
    unit = unit_words(trace.unit)
    return chart(
        (
            Curve("measured", "measured", trace.time, trace.measured),
            Curve("before", "before", trace.time, trace.before),
            Curve("after", "after", trace.time, trace.after),
        ),
        title=trace.channel,
        description=f"{trace.channel} over time: measured, and simulated by the model "
        f"before and after. Errors: before {_rms(trace.before, trace)} {unit}, after "
        f"{_rms(trace.after, trace)} {unit} (root mean square).",
        x_label="time [s]",
        y_label=f"{trace.channel} [{unit}]",
        frame=("measured", "after"),
        slices=slices,
    )


def _error_chart(trace: Trace, noise: float | None, slices: int) -> Chart:
    # A simulation that runs away would flatten all other errors.
    reach = 2 * float(np.ptp(trace.measured)) or 1.0
    curves = tuple(
        Curve(name, name, trace.time, np.clip(values - trace.measured, -reach, reach))
        for name, values in (("before", trace.before), ("after", trace.after))
    )
    return chart(
        curves,
        title=f"error of {trace.channel}",
        description=f"Simulated minus measured {trace.channel}, before and after.",
        x_label="time [s]",
        y_label=f"error [{unit_words(trace.unit)}]",
        frame=("before", "after"),
        slices=slices,
        band=None if noise is None else 2 * noise,
    )


def _rms(simulated: Array, trace: Trace) -> str:
    error = simulated - trace.measured
    return number_words(float(np.sqrt(np.mean(error**2))), 3)


def _law_chart(law: RecoveredLaw) -> Chart:
    curves = [Curve("recovered", "cloud", law.argument, law.value, dots=True)]
    if len(law.curve_argument):
        order = np.argsort(law.curve_argument, kind="stable")
        x, y = law.curve_argument[order], law.curve_value[order]
        dots = not _is_a_curve(y)
        curves.append(Curve("law", "after dots" if dots else "after", x, y, dots))
    return chart(
        curves,
        title=f"{law.value_name} at {law.place}",
        description=f"{law.value_name} recovered at {law.place}, against "
        f"{law.argument_name}: {len(law.argument)} points"
        + (" and the law found." if len(curves) > 1 else "; no law was found."),
        x_label=f"{law.argument_name} [{unit_words(law.argument_unit)}]",
        y_label=f"{law.value_name} [{unit_words(law.value_unit)}]",
        frame=("recovered", "law"),
    )


def _is_a_curve(values: Array) -> bool:
    """Return whether a law is a function of the one argument it is shown against.

    One that also depends on a load jumps up and down from point to point, and is shown
    as points.
    """
    return float(np.abs(np.diff(values)).sum()) <= 6 * float(np.ptp(values))


def _parameter_rows(diagnosis: Diagnosis) -> list[_ParameterRow]:
    before = {e.name: e for e in diagnosis.fit_before.estimates}
    after = {e.name: e for e in diagnosis.fit_after.estimates}
    everything = {e.name: e for e in delivered(diagnosis).estimates}
    return [
        _ParameterRow(
            name=name,
            unit=unit_words((after.get(name) or before[name]).unit),
            before=_estimate(before.get(name)),
            after=_estimate(after.get(name)),
            everything=_estimate(everything.get(name)),
            new=name not in diagnosis.model_before.parameters,
        )
        for name in dict.fromkeys((*before, *after))
    ]


def _estimate(estimate: Estimate | None) -> str:
    if estimate is None:
        return NOTHING
    if estimate.std is None:
        return f"{number_words(estimate.value)} (not identifiable)"
    return with_deviation(estimate.value, estimate.std)


def _flattened(value: object, name: str = "") -> Iterator[tuple[str, str]]:
    """Yield nested provenance as rows of name and text."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _flattened(item, f"{name} / {key}" if name else str(key))
    elif isinstance(value, tuple | list):
        yield name, ", ".join(str(item) for item in value)
    else:
        yield name, str(value)
