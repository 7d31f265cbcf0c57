"""The report page, the charts in it, and the same answers in terminal and notebook."""

import io
import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from handmade_diagnosis import cart, cart_diagnosis

from bondgraph.diagnosis.records import Diagnosis, Trace, Verdict
from bondgraph.errors import BondGraphError
from bondgraph.fitting.result import Estimate
from bondgraph.recordings.recording import Channel, Recording
from bondgraph.reporting.charts import SIDE, Curve, chart, extremes, ticks
from bondgraph.reporting.notebooks import diagnosis_html, graph_html
from bondgraph.reporting.report import report_html, write_report
from bondgraph.reporting.tables import (
    CheckRow,
    candidates_table,
    checks_table,
    estimates_table,
    parameters_table,
    recordings_table,
    wants_colour,
)
from bondgraph.reporting.wording import (
    number_words,
    percent,
    unit_words,
    with_deviation,
)
from bondgraph.structure.parameters import (
    Fitted,
    Measured,
    Parameter,
    ParameterSet,
    Published,
    Reconciled,
)

VOID = {"meta", "br", "link", "img", "input", "hr"}
HOSTILE = '<script>alert("x")</script><img src=x onerror=y> & {{ 7*7 }}'


class Page(HTMLParser):
    """Reads a page: its elements, its text, and tags that are not closed."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.stack: list[str] = []
        self.problems: list[str] = []
        self.feed(html)
        self.close()
        self.problems += [f"<{tag}> is never closed" for tag in self.stack]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.stack.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        opened = self.stack.pop() if self.stack else "nothing"
        if opened != tag:
            self.problems.append(f"</{tag}> closes <{opened}>")

    def handle_data(self, data: str) -> None:
        if not self.stack or self.stack[-1] not in {"style", "script", "title"}:
            self.text += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    return cart_diagnosis()


@pytest.fixture(scope="module")
def html(diagnosis: Diagnosis) -> str:
    return report_html(diagnosis)


def squeezed(text: str) -> str:
    return " ".join(text.split())


# The page


def test_the_page_is_well_formed(html: str) -> None:
    page = Page(html)
    assert page.problems == []
    assert html.lstrip().startswith("<!DOCTYPE html>")


def test_the_page_needs_nothing_else(html: str) -> None:
    links = re.findall(
        r"""(?:src|href|action)\s*=(?!"#)|@import|url\(|fetch\(|import\(""", html
    )
    assert links == []
    addresses = set(re.findall(r"""\w+://[^\s"'<]+""", html))
    assert addresses == {"http://www.w3.org/2000/svg"}  # a name, never fetched
    assert "default-src 'none'" in html


def test_the_statement_comes_first(html: str, diagnosis: Diagnosis) -> None:
    text = squeezed(Page(html).text)
    order = (
        "Diagnosis of cart on a belt drive",
        "Physics is missing",
        diagnosis.statement,
        "17.2 % → 1.2 %",
        "What is missing",
        "F_c*sign(f)",
        "Where on the bond graph",
        "Held-out recordings",
        "bench 07, held out",
        "bench 08, held out",
        "The missing relation",
        "What was considered",
        "These recordings do not decide",
        "Coulomb (dry) friction at carriage may as well sit at pulley.",
        "The next experiment",
        diagnosis.next_experiment,
        "Parameters before and after",
        "The improved model",
        "One R added at carriage",
        "How this was computed",
        "sha256 5f2c…",
    )
    at = 0
    for words in order:
        at = text.index(words, at)


def test_alternatives_and_confusable_places_are_named(html: str) -> None:
    text = squeezed(Page(html).text)
    assert "Could also be Stribeck friction at carriage" in text
    assert "Cannot be told apart from the same at pulley" in text


def test_the_inserted_element_is_marked_on_the_graph(html: str) -> None:
    marked = re.findall(r'class="node element inserted" data-name="(\w+)"', html)
    assert marked == ["coulomb"]
    assert 'class="causal"' in html
    assert "93%" in html


def test_candidates_show_their_evidence(html: str) -> None:
    rows = re.findall(r"<tr>(.*?)</tr>", html, re.S)
    (row,) = (r for r in rows if "Quadratic drag" in r)
    text = squeezed(Page(row).text)
    for words in ("refuted", "3.1 ± 2.2 %", "16.6 %", "17.1 %", "what chance gives"):
        assert words in text


def test_parameters_before_and_after(html: str) -> None:
    rows = [squeezed(Page(r).text) for r in re.findall(r"<tr>(.*?)</tr>", html, re.S)]
    assert "mass 96 99.00 ± 0.90 95.10 ± 0.20 kg".replace(" ", "") in [
        r.replace(" ", "") for r in rows
    ]
    assert any(r.startswith("F_c new") and "20.41 ± 0.12" in r for r in rows)


def test_every_region_and_picture_has_a_name(html: str) -> None:
    page = Page(html)
    names = {a["id"] for _, a in page.elements if a.get("id")}
    sections = page.all("section")
    assert len(sections) == 9
    for section in sections:
        assert section["aria-labelledby"] in names
    for _, attributes in page.elements:
        if attributes.get("role") in {"img", "region"}:
            assert attributes.get("aria-label")
    assert [len(page.all(tag)) for tag in ("header", "main", "footer", "h1")] == [1] * 4
    assert page.all("html")[0]["lang"] == "en"


@pytest.mark.parametrize("verdict", list(Verdict))
def test_every_verdict_has_a_page(diagnosis: Diagnosis, verdict: Verdict) -> None:
    found = verdict is Verdict.PHYSICS_MISSING
    one = replace(
        diagnosis,
        verdict=verdict,
        statement=f"The answer is {verdict.value}.",
        findings=diagnosis.findings if found else (),
        fit_after=diagnosis.fit_after if found else diagnosis.fit_before,
        recovered=diagnosis.recovered if found else (),
        candidates=(),
        next_experiment="",
        traces=diagnosis.traces[:1],
    )
    page = Page(report_html(one))
    assert page.problems == []
    assert one.statement in page.text
    assert ("The improved model" in page.text) is found
    assert ("→" in page.text.split("What is missing")[0][:900]) is found


def test_an_unexplained_relation_shows_its_curve_without_a_law(
    diagnosis: Diagnosis,
) -> None:
    nothing = np.array([])
    law = replace(diagnosis.recovered[0], curve_argument=nothing, curve_value=nothing)
    page = Page(report_html(replace(diagnosis, findings=(), recovered=(law,))))
    assert "No law of the library fits it." in page.text
    assert "no law was found" in str(page.elements)


def test_a_law_of_more_than_its_argument_is_shown_as_points(
    diagnosis: Diagnosis,
) -> None:
    smooth = diagnosis.recovered[0]
    jumping = smooth.curve_value * (1 + np.arange(401) % 3)
    html = report_html(
        replace(diagnosis, recovered=(replace(smooth, curve_value=jumping),))
    )
    assert "shown as points at the same instants" in html
    assert "shown as points" not in report_html(diagnosis)


def test_a_long_law_is_folded(diagnosis: Diagnosis) -> None:
    law = " + ".join(f"c_{k}*f**{k}" for k in range(20))
    candidate = replace(diagnosis.candidates[0], law=law)
    page = Page(report_html(replace(diagnosis, candidates=(candidate,))))
    assert page.text.count("the law, ") == 1
    assert law in page.text


def test_hostile_text_stays_text(diagnosis: Diagnosis) -> None:
    finding = replace(diagnosis.findings[0], statement=HOSTILE, law=HOSTILE)
    trace = replace(diagnosis.traces[0], recording=HOSTILE, channel=HOSTILE)
    recovered = replace(diagnosis.recovered[0], place=HOSTILE, value_name=HOSTILE)
    model = replace(diagnosis.fit_before.model, name=HOSTILE)
    hostile = replace(
        diagnosis,
        statement=HOSTILE,
        findings=(finding,),
        traces=(trace,),
        recovered=(recovered,),
        candidates=(replace(diagnosis.candidates[0], reason=HOSTILE, place=HOSTILE),),
        notes=(HOSTILE,),
        next_experiment=HOSTILE,
        provenance={HOSTILE: [HOSTILE]},
        fit_before=replace(diagnosis.fit_before, model=model),
    )
    page = Page(report_html(hostile))
    assert page.problems == []
    assert len([a for a in page.all("script") if "type" not in a]) == 1
    assert page.all("img") == []
    assert not any("onerror" in attributes for _, attributes in page.elements)
    assert page.text.count(HOSTILE) >= 10
    assert Page(diagnosis_html(hostile)).all("script") == []


def test_a_million_samples_stay_light(diagnosis: Diagnosis) -> None:
    count = 1_000_000
    clock = np.arange(count) / 1000.0
    noise = np.random.default_rng(0).standard_normal(count)
    trace = Trace(
        recording="long",
        channel="position",
        unit="m",
        time=clock,
        measured=np.sin(clock) + 0.1 * noise,
        before=np.zeros(count),
        after=np.sin(clock),
    )
    html = report_html(replace(diagnosis, traces=(trace,)))
    assert len(html) < 8_000_000  # every sample is in it


def test_a_simulation_that_ran_away_does_not_hide_the_rest(
    diagnosis: Diagnosis,
) -> None:
    trace = diagnosis.traces[0]
    away = trace.before.copy()
    away[1000:] *= 1e9
    away[2000:] = np.nan
    page = Page(report_html(replace(diagnosis, traces=(replace(trace, before=away),))))
    assert page.problems == []
    paths = [a for t, a in page.elements if t == "path" and "class" in a]
    plots = [a for a in paths if "measured" in a["class"]]
    heights = [float(y) for y in re.findall(r"[ML]\S+ (\S+?)(?=L|M|$)", plots[-1]["d"])]
    assert max(heights) - min(heights) > 200


def test_a_simulation_that_did_not_end_has_no_error(diagnosis: Diagnosis) -> None:
    trace = diagnosis.traces[0]
    lost = np.full_like(trace.after, np.nan)
    html = report_html(replace(diagnosis, traces=(replace(trace, after=lost),)))
    assert Page(html).problems == []
    assert "after could not be simulated to its end" in squeezed(html)


def test_the_page_is_written_or_refused(diagnosis: Diagnosis, tmp_path: Path) -> None:
    write_report(diagnosis, tmp_path / "report.html")
    assert "Physics is missing" in (tmp_path / "report.html").read_text("utf-8")
    with pytest.raises(BondGraphError, match="cannot be written"):
        write_report(diagnosis, tmp_path / "absent" / "report.html")


def luminance(colour: str) -> float:
    digits = colour if len(colour) == 6 else "".join(2 * c for c in colour)
    parts = [int(digits[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    linear = [
        c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a: str, b: str) -> float:
    light, dark = sorted((luminance(a), luminance(b)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("theme", [0, 1], ids=["light", "dark"])
def test_text_has_contrast(theme: int) -> None:
    folder = resources.files("bondgraph.reporting") / "templates"
    css = (folder / "report.css").read_text("utf-8")
    colours = dict(
        re.findall(r"--(\w+):#([0-9a-f]{3,6})[;}]", css.split(":root{")[theme + 1])
    )
    for line in ("measured", "rival0", "rival1", "rival2", "rival3"):
        assert contrast(colours[line], colours["card"]) > 3.0, line
    for text in ("ink", "soft", "accent", "warm", "good"):
        for ground in ("paper", "card"):
            assert contrast(colours[text], colours[ground]) > 4.5, (text, ground)
    assert contrast(colours["ink"], colours["tint"]) > 4.5


# Charts


def test_extremes_keep_every_spike() -> None:
    values = np.zeros(100_000)
    values[[12_345, 77_777]] = 5.0, -7.0
    chosen = extremes(values, 500)
    assert len(chosen) <= 1002
    assert {0, 12_345, 77_777, 99_999} <= set(chosen.tolist())
    assert (np.diff(chosen) > 0).all()


def test_extremes_leave_short_lines_alone_and_survive_gaps() -> None:
    assert extremes(np.ones(10), 500).tolist() == list(range(10))
    gaps = np.full(10_000, np.nan)
    gaps[5_000] = 1.0
    assert 5_000 in extremes(gaps, 100)


@pytest.mark.parametrize(
    "limits", [(0.0, 1.0), (-3e-7, 2e-7), (99.5, 100.5), (-1e6, 4e6), (0.0, 7.3)]
)
def test_ticks_are_round_inside_and_apart(limits: tuple[float, float]) -> None:
    made = ticks(limits, 6)
    assert 3 <= len(made) <= 8
    assert all(-0.01 <= tick.at <= 100.01 for tick in made)
    values = [float(tick.label.replace("−", "-")) for tick in made]
    steps = np.diff(values)
    assert np.allclose(steps, steps[0], rtol=1e-2)
    places = [limits[0] + tick.at / 100 * (limits[1] - limits[0]) for tick in made]
    assert np.allclose(places, values, atol=0.01 * abs(steps[0]))


def test_lines_are_where_their_numbers_are() -> None:
    x, y = np.array([0.0, 1.0, 4.0]), np.array([2.0, -1.0, 0.5])
    made = chart(
        [Curve("one", "css", x, y)],
        title="t",
        description="d",
        x_label="x",
        y_label="y",
        frame=["one"],
    )
    points = re.findall(r"([\d.]+) ([\d.]+)", made.lines[0].path)
    drawn = np.array(points, dtype=float)
    assert np.allclose(drawn[:, 0], SIDE * x / 4, atol=0.1)
    zero, one = (next(t.at for t in made.y_ticks if t.label == label) for label in "01")
    height = (drawn[:, 1] / 10 - zero) / (one - zero)
    assert np.allclose(height, y, atol=0.01)


def test_gaps_interrupt_a_line_and_infinity_leaves_the_picture() -> None:
    y = np.array([0.0, 1.0, math.nan, 1.0, math.inf, 0.0])
    made = chart(
        [Curve("one", "css", np.arange(6.0), y)],
        title="t",
        description="d",
        x_label="x",
        y_label="y",
        frame=["one"],
    )
    path = made.lines[0].path
    assert (path.count("M"), path.count("L")) == (2, 3)
    assert "nan" not in path
    assert "inf" not in path


def test_a_constant_line_has_a_frame() -> None:
    made = chart(
        [Curve("one", "css", np.arange(3.0), np.zeros(3))],
        title="t",
        description="d",
        x_label="x",
        y_label="y",
        frame=["one"],
        band=0.5,
    )
    assert made.band is not None
    top, height = made.band
    assert 0 < top < 500 < top + height < 1000


# Words


@pytest.mark.parametrize(
    ("value", "std", "text"),
    [
        (20.412, 0.123, "20.41 ± 0.12"),
        (20412.3, 123.0, "20412 ± 123"),
        (-0.004, 0.006, "−0.0040 ± 0.0060"),
        (1.234e-7, 2.1e-9, "(1.234 ± 0.021)·10⁻⁷"),
        (5.0, 0.0, "5"),
        (31.7166, 5.9e-69, "31.7166"),
        (5.0, None, "5"),
        (math.nan, 0.1, "–"),
        (0.0, 0.02, "0.000 ± 0.020"),
        (10.0, 1.13e7, "10 ± 1.1·10⁷"),
    ],
)
def test_values_are_rounded_to_what_is_known(
    value: float, std: float | None, text: str
) -> None:
    assert with_deviation(value, std) == text


def test_words_and_units() -> None:
    assert unit_words("kg*m^2/s**2") == "kg·m²/s²"
    assert percent(0.12345) == "12.3 %"
    assert percent(math.nan) == percent(None) == "–"
    assert number_words(1.5e-9) == "1.5·10⁻⁹"
    assert number_words(math.inf) == "∞"


# Terminal and notebook

PARAMETERS = ParameterSet(
    (
        Parameter(name="k[0]", value=3.2, unit="N*m/rad", std=0.1),
        Parameter(name="n", value=20.0, std=0.0, source=Published("sheet 3")),
        Parameter(name="c", unit="N*s/m", source=Measured("run 7", "coast down")),
        Parameter(name="J", value=1.0, source=Reconciled("gain")),
        Parameter(name="m", value=2.0, unit="kg", source=Fitted(("a", "b"))),
    )
)


def test_parameters_are_listed_with_their_source() -> None:
    lines = parameters_table(PARAMETERS, width=100).splitlines()
    assert [line.split()[0] for line in lines[2:]] == ["k[0]", "n", "c", "J", "m"]
    assert "3.20 ± 0.10   N·m/rad" in lines[2]
    assert "20 (exact)" in lines[3]
    assert "published: sheet 3" in lines[3]
    assert "measured, run 7, coast down" in lines[4]
    assert "fitted: a, b" in lines[6]


def test_colour_is_a_choice_and_carries_no_meaning(diagnosis: Diagnosis) -> None:
    plain = candidates_table(diagnosis.candidates, width=120)
    coloured = candidates_table(diagnosis.candidates, colour=True, width=120)
    assert "\x1b" not in plain
    assert "\x1b[32m" in coloured
    stripped = re.sub(r"\x1b\[[\d;]*m", "", coloured)
    assert [x.split() for x in stripped.splitlines()] == [
        x.split() for x in plain.splitlines()
    ]
    assert "Coulomb (dry) friction" in plain
    assert "96.2 ± 1.1 %" in plain


def test_names_are_never_markup() -> None:
    row = CheckRow(
        name="gain [red]x[/red]", declared="1", derived="2", tolerance="± 0.1", ok=False
    )
    text = checks_table([row, replace(row, ok=True)], width=100)
    assert text.count("gain [red]x[/red]") == 2
    assert [line.split()[0] for line in text.splitlines()[2:]] == ["OFF", "ok"]


def test_estimates_say_what_is_not_identifiable() -> None:
    blind = Estimate(name="k", value=2.0, std=None, unit="N/m", start=1.0)
    assert "2 (not identifiable)" in estimates_table([blind], width=80)
    for value, told in ((5e103, "grown without bound"), (-3e-20, "shrunk to nothing")):
        gone = estimates_table([replace(blind, value=value)], width=80)
        assert f"has {told} (not identifiable)" in gone
    unknown = replace(blind, value=5e103, start=0.0)
    assert "10¹⁰³ (not identifiable)" in estimates_table([unknown], width=80)


def test_recordings_are_listed_with_units() -> None:
    clock = np.arange(100) * 0.01
    recording = Recording(
        name="bench 07",
        time=clock,
        channels=(Channel("torque", "N*m", np.sin(clock)),),
    )
    text = recordings_table([recording], width=100)
    assert "bench 07" in text
    assert "0.99 s" in text
    assert "0.01 s" in text
    assert "torque [N·m]" in text


def test_colour_is_wanted_by_terminals_only(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    assert wants_colour(Terminal())
    assert not wants_colour(io.StringIO())
    monkeypatch.setenv("NO_COLOR", "1")
    assert not wants_colour(Terminal())
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("TERM", "dumb")
    assert not wants_colour(Terminal())


def test_notebooks_show_graph_and_answer(diagnosis: Diagnosis) -> None:
    graph = Page(graph_html(cart()))
    assert graph.problems == []
    assert "return_spring" in graph.text
    answer = Page(diagnosis_html(diagnosis))
    assert answer.problems == []
    for words in (
        diagnosis.statement,
        "17.2 %",
        "Stribeck friction",
        "Next experiment",
    ):
        assert words in answer.text
