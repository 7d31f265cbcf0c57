"""The report page of a diagnosis: one HTML file that needs nothing else.

The statement comes first; then the evidence a reader would ask for: where on the graph,
how measured and simulated compare on data no choice has seen, the law and its data,
what else was considered, what cannot be told apart, and the model to copy. The page
makes no request, runs without its script, and every text in it is escaped.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bondgraph.causality.assignment import assign_causality
from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.records import Diagnosis
from bondgraph.physics.names import name_of
from bondgraph.reporting.diagnosis_json import delivered
from bondgraph.reporting.drawing import draw_svg
from bondgraph.reporting.files import write_text
from bondgraph.reporting.model_text import describe_difference, to_python
from bondgraph.reporting.page.evidence import (
    considered,
    how_sure,
    not_told_apart,
    rivals,
)
from bondgraph.reporting.page.experiment import experiment_picture
from bondgraph.reporting.page.laws import law_picture
from bondgraph.reporting.page.parameters import parameter_rows
from bondgraph.reporting.page.provenance import provenance_rows
from bondgraph.reporting.page.recordings import recording_charts
from bondgraph.reporting.wording import (
    NOTHING,
    headline,
    number_words,
    percent,
    sentence_start,
    unit_words,
    with_deviation,
    with_unit,
)

if TYPE_CHECKING:
    import jinja2

LEAST_BLAME = 0.005
"""Shares of the error below it are written as 0 %."""
FEW = 6
"""Changes of the model that are listed; more are folded."""


def write_report(diagnosis: Diagnosis, path: Path | str, *, command: str = "") -> None:
    """Write the report page of a diagnosis to the file at `path`.

    Parameters
    ----------
    diagnosis
        Any diagnosis, whatever its verdict.
    path
        The file.
    command
        The command line that repeats it, to be shown; none by default.

    Raises
    ------
    BondGraphError
        If the file cannot be written.
    """
    write_text(path, report_html(diagnosis, command=command))


def report_html(diagnosis: Diagnosis, *, command: str = "") -> str:
    """Return the report page of a diagnosis: one self-contained HTML document.

    Parameters
    ----------
    diagnosis
        Any diagnosis, whatever its verdict.
    command
        The command line that repeats it, to be shown; none by default.
    """
    page = _environment().get_template("report.html")
    return page.render(**_context(diagnosis), command=command)


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
        sure=how_sure,
        unit=unit_words,
    )
    environment.globals.update(
        curve=CURVE,
        deviation=with_deviation,
        few=FEW,
        nothing=NOTHING,
        rivals=rivals,
        with_unit=with_unit,
    )
    return environment


def _context(diagnosis: Diagnosis) -> dict[str, Any]:
    from markupsafe import Markup  # noqa: PLC0415  (comes with jinja2)

    before, model = diagnosis.model_before, delivered(diagnosis).model
    return {
        "diagnosis": diagnosis,
        "improved": (before.nodes, before.measurements)
        != (model.nodes, model.measurements),
        "considered": considered(diagnosis.candidates, diagnosis.findings),
        "not_told_apart": not_told_apart(diagnosis),
        "verdict": headline(diagnosis),
        "blame": _shown_blame(diagnosis),
        "picture": Markup(diagnosis_picture(diagnosis)),  # noqa: S704  (escapes its names)
        "units": {m.name: unit_words(m.unit) for m in model.measurements},
        "recordings": recording_charts(diagnosis),
        "experiment": experiment_picture(diagnosis.experiment),
        "laws": [law_picture(law, diagnosis.findings) for law in diagnosis.recovered],
        "parameters": parameter_rows(diagnosis),
        "changes": describe_difference(before, model),
        "model_text": to_python(model),
        "provenance": list(provenance_rows(diagnosis.provenance)),
    }


def diagnosis_picture(diagnosis: Diagnosis) -> str:
    """Return the improved graph as SVG, coloured by blame, what is new in it marked.

    Sensors are drawn where one of them was changed.
    """
    model, before = diagnosis.model, diagnosis.model_before
    known = {m.name: m for m in before.measurements}
    changed = {
        node.name for node in model.nodes if node != before.by_name.get(node.name)
    }
    sensors = {m.name for m in model.measurements if m != known.get(m.name)}
    return draw_svg(
        model,
        assignment=assign_causality(model),
        blame=_shown_blame(diagnosis),
        highlight=changed | sensors,
        signals=bool(sensors),
    )


def _shown_blame(diagnosis: Diagnosis) -> Mapping[str, float]:
    """Return the blame, where any place has some."""
    blame = diagnosis.blame
    return blame if any(share >= LEAST_BLAME for share in blame.values()) else {}
