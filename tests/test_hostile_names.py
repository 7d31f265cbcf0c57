"""Names that would like to be code: in a page, a picture, a document, a terminal.

Everything a model or a recording can be called is called so; the whole way from the
diagnosis to the page, the pictures, the Python text and the terminal is walked.
"""

import ast
import json
import shutil
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, Measured, R, Recording, Sf, bind_to, derive
from bondgraph.cli.session import Session
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.equations.rendering import as_latex
from bondgraph.errors import BondGraphError
from bondgraph.physics.library import LIBRARY
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict
from bondgraph.reporting.drawing import draw_svg
from bondgraph.reporting.model_text import to_python
from bondgraph.reporting.notebooks import diagnosis_html
from bondgraph.reporting.report import report_html
from bondgraph.reporting.tables import candidates_table, parameters_table
from bondgraph.structure.signals import f

NAMES = (
    "</script><script>alert(1)</script>",
    "</style></title></textarea><script>alert(2)</script>",
    '"><img src=x onerror=alert(3)>',
    "' onmouseover='alert(4)' autofocus onfocus='alert(5)",
    "javascript:alert(6)",
    "<svg/onload=alert(7)><foreignObject><iframe src=javascript:alert(8)>",
    "]]><!-- --!> <![CDATA[ &lt;script&gt; &#x3c;b>",
    "{{ 7*7 }}{% include '/etc/passwd' %}",
    "\\input{/etc/passwd}\\write18{id}$$ \\end{document} %",
    "[link](javascript:alert(9)) ![](http://example.org/x.png) `code`",
    "../../../etc/passwd",
    '=HYPERLINK("http://example.org")',
    "\u202ecod.exe\u2066 \u200b",
    '"""\\N{BULLET} \' + __import__("os").system("true") + \'',
)
ALL = " ".join(NAMES)
ESCAPES = "\x1b]0;owned\x07\x1b[2J\x1b[31mred\x9b5m\x08\r"


def slider(name):
    graph = BondGraph(name, domain="translation")
    law = sympy.Symbol(name) * f
    graph.one("body", Sf("speed"), R("rub", law=law))
    graph.parameter(
        name,
        2.0,
        "N*s/m",
        bounds=(0, 100),
        source=Measured(recording=name, method=name),
    )
    graph.measure(name, effort="rub")
    return graph.finish()


def pulled(graph, name, seed, samples):
    random = np.random.default_rng(seed)
    speed = 0.05 * np.cumsum(random.standard_normal(samples))
    force = 2.2 * speed + 0.8 * np.sign(speed) + 0.01 * random.standard_normal(samples)
    channels = {"speed": (speed, "m/s"), name: (force, "N")}
    time = 0.01 * np.arange(samples)
    return bind_to(graph, Recording.from_arrays(f"{name} {seed}", time, channels))


@pytest.fixture(scope="module")
def diagnosis():
    graph = slider(ALL)
    laws = tuple(p for p in LIBRARY if p.word in {"unknown_relation", "dead_zone"})
    return diagnose(
        graph,
        [pulled(graph, ALL, 1, 600)],
        held_out=[pulled(graph, ALL, 2, 300)],
        options=Options(library=laws, most_findings=1),
    )


@pytest.fixture(scope="module")
def page(diagnosis):
    return report_html(diagnosis)


class Elements(HTMLParser):
    """The elements of a page as a browser sees them."""

    def __init__(self, html):
        super().__init__()
        self.found = []
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))

    handle_startendtag = handle_starttag


ACTIVE = {"img", "iframe", "object", "embed", "base", "form", "foreignobject", "link"}


@pytest.mark.parametrize("make", [report_html, diagnosis_html])
def test_no_name_becomes_markup_of_a_page(diagnosis, make):
    html = make(diagnosis)
    elements = Elements(html).found
    assert not {tag for tag, _ in elements} & ACTIVE
    for _, attributes in elements:
        assert not [name for name in attributes if name.startswith("on")]
        for name in ("href", "src", "xlink:href", "action", "formaction"):
            target = attributes.get(name) or "#"
            assert target.startswith("#") or target.startswith("data:image/png;base64,")
    assert "alert(1)" in html
    assert "<script>alert" not in html
    assert "{{ 7*7 }}" in html


def test_the_page_may_load_and_send_nothing(page):
    (policy,) = [
        attributes["content"]
        for tag, attributes in Elements(page).found
        if tag == "meta" and attributes.get("http-equiv") == "Content-Security-Policy"
    ]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    assert "http" not in policy
    assert "unsafe-eval" not in policy
    assert rules.get("base-uri", "'none'") == "'none'"


def test_a_browser_runs_no_name(page, tmp_path):
    playwright = pytest.importorskip("playwright.sync_api")
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("no Chromium here")
    file = tmp_path / "report.html"
    file.write_text(page, encoding="utf-8")
    spoke, asked, complained = [], [], []
    with playwright.sync_playwright() as run:
        browser = run.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        tab = browser.new_page()
        tab.on("dialog", lambda box: (spoke.append(box.message), box.dismiss()))
        tab.on("request", lambda request: asked.append(request.url))
        tab.on("pageerror", lambda error: complained.append(str(error)))
        tab.on("console", lambda said: complained.append(said.text))
        tab.goto(file.as_uri())
        for details in tab.query_selector_all("details"):
            details.evaluate("node => { node.open = true; }")
        for element in tab.query_selector_all("h1, h2, h3, th, td, dd, figure, svg")[
            :60
        ]:
            element.dispatch_event("mouseover")
            element.dispatch_event("focus")
        tab.wait_for_timeout(100)
        title, text = tab.title(), tab.inner_text("body")
        heard = list(spoke)
        tab.evaluate("alert('the listener hears')")
        browser.close()
    assert heard == []
    assert spoke == ["the listener hears"]
    assert complained == []
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
    assert "</script><script>alert(1)</script>" in text
    assert "alert(2)" in title


@pytest.mark.parametrize("name", NAMES)
def test_a_picture_is_a_picture(name):
    root = ElementTree.fromstring(draw_svg(slider(name)))
    tags = {element.tag.rpartition("}")[2].lower() for element in root.iter()}
    assert not tags & {*ACTIVE, "script", "animate", "set", "use", "image", "a"}
    for element in root.iter():
        assert not [key for key in element.attrib if key.lower().startswith("on")]


@pytest.mark.parametrize("name", NAMES)
def test_the_python_text_of_a_model_holds_names_as_strings(name):
    graph = slider(name)
    text = to_python(graph)
    tree = ast.parse(text)
    called = {
        ast.unparse(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)
    }
    assert not {c for c in called if "import" in c or "system" in c}
    names = {}
    exec(compile(tree, "model.py", "exec"), names)
    assert names["model"]().finish() == graph


@pytest.mark.parametrize("name", ["=1+1", "../x", "a b", "x;y", "$(true)", "", "a\nb"])
def test_what_names_columns_and_files_is_an_identifier(name):
    """Inputs head the columns of a table to play; spreadsheets run what starts so."""
    with pytest.raises(BondGraphError):
        Sf(name)
    with pytest.raises(BondGraphError):
        BondGraph("a").one(name, Sf("speed"))


def test_json_gives_names_back_as_they_are(diagnosis):
    text = json.dumps(diagnosis_to_dict(diagnosis), allow_nan=False)
    assert ALL in json.loads(text)["noise_floor"]


@pytest.mark.parametrize("name", NAMES)
def test_formulas_hold_names_as_text(name):
    formulas = derive(slider(name))
    latex = as_latex(formulas)
    for command in ("\\input", "\\write", "\\include", "\\end{document}", "\\def"):
        assert command not in latex
    without = latex.replace("\\{", "").replace("\\}", "")
    assert without.count("{") == without.count("}")


def test_a_terminal_hears_no_control_codes(capsys):
    graph = slider("plain")
    table = parameters_table(graph.parameters)
    session = Session()
    session.say(f"{table}{ESCAPES}")
    session.note(ESCAPES)
    session.refuse(ESCAPES)
    out, err = capsys.readouterr()
    for control in "\x1b\x07\x9b\x08\r":
        assert control not in out
        assert control not in err


def test_tables_read_no_markup(diagnosis):
    table = candidates_table(diagnosis.candidates, width=400)
    assert "[link]" in parameters_table(diagnosis.model.parameters, width=2000)
    assert "\x1b" not in table
