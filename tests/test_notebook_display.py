"""What a notebook shows: pictures, formulas, tables and charts, and progress."""

import sys
from types import SimpleNamespace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from handmade_diagnosis import cart_diagnosis
from IPython.core.interactiveshell import InteractiveShell

import bondgraph
from bondgraph import (
    BondGraph,
    C,
    I,
    R,
    Recording,
    Se,
    assign_causality,
    bind_to,
    derive,
    fit,
    linearise,
    simulate,
    simulate_inputs,
)
from bondgraph.notebook import as_html
from bondgraph.progress import Count, Steps, count, shown_progress


@pytest.fixture(scope="module")
def shell():
    """Return an IPython shell that knows the objects, as a kernel would."""
    shell = InteractiveShell()
    bondgraph.load_ipython_extension(shell)
    return shell


def shown(shell, thing):
    """Return what a front end gets to choose from."""
    data, _ = shell.display_formatter.format(thing)
    return data


def cart(name="velocity"):
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("viscous"))
    graph.measure(name, flow="carriage")
    graph.parameter("mass", 2.0, "kg", bounds=(0.1, 10))
    graph.parameter("viscous", 0.8, "N*s/m")
    return graph


@pytest.fixture(scope="module")
def recorded():
    """Return the cart's exact answer to a constant force, from rest."""
    time = 0.02 * np.arange(200)
    velocity = (1 - np.exp(-0.4 * time)) / 0.8
    noise = 1e-3 * np.random.default_rng(1).normal(size=200)
    channels = {"force": (np.ones(200), "N"), "velocity": (velocity + noise, "m/s")}
    return Recording.from_arrays("run", time, channels)


def charts(html):
    """Return the charts in some HTML, parsed."""
    pictures = ET.fromstring(f"<div>{html}</div>").iter("svg")
    return [picture for picture in pictures if "aria-label" in picture.attrib]


def test_a_graph_is_its_picture_with_strokes_finished_or_not(shell):
    picture = shown(shell, cart())["text/html"]
    assert "<svg" in picture
    assert "causal" in picture.split("</style>")[-1]
    assert shown(shell, cart().finish())["text/html"] == picture


def test_causality_is_a_table_with_the_reason_of_every_stroke(shell):
    graph = cart().finish()
    assignment = assign_causality(graph)
    html = shown(shell, assignment)["text/html"]
    assert "<b>integral:</b> mass" in html
    assert html.count("<tr>") == 1 + len(graph.bonds)
    for step in assignment.steps:
        assert step.reason.replace("'", "&#x27;") in html


def test_equations_matrices_and_transfer_functions_are_formulas(shell):
    equations = derive(cart().finish())
    linear = linearise(equations)
    formula = shown(shell, equations)["text/latex"]
    assert formula.startswith("$$\n\\begin{aligned}")
    assert r"\dot{p}_{\mathrm{mass}}" in formula
    matrices = shown(shell, linear)["text/latex"]
    assert r"A &= \left[\begin{matrix}- \frac{\mathrm{viscous}}" in matrices
    transfer = linear.transfer_function("velocity", "force")
    ratio = shown(shell, transfer)["text/latex"]
    assert r"\frac{\mathrm{velocity}}{\mathrm{force}} = \frac{1}{" in ratio


def test_large_systems_are_not_written_out(shell):
    ladder = BondGraph("ladder", domain="electrical")
    ladder.one("stage_0", Se("u"), R("r_0"), I("l_0"))
    for k in range(1, 6):
        ladder.zero(f"node_{k}", C(f"c_{k}"))
        ladder.one(f"stage_{k}", I(f"l_{k}"), R(f"r_{k}"))
        ladder.bond(f"stage_{k - 1}", f"node_{k}")
        ladder.bond(f"node_{k}", f"stage_{k}")
    assert "text/latex" not in shown(shell, linearise(derive(ladder.finish())))


def test_a_recording_is_a_chart_per_channel(shell, recorded):
    for thing in (recorded, bind_to(cart().finish(), recorded)):
        html = shown(shell, thing)["text/html"]
        labels = [chart.attrib["aria-label"] for chart in charts(html)]
        assert [label.partition(" over")[0] for label in labels] == [
            "force" if thing is recorded else "force (input)",
            "velocity",
        ]
        assert "200 samples, 3.98 s, step 0.02 s" in html


def test_a_long_recording_stays_small(shell):
    time = 1e-3 * np.arange(200_000)
    spike = np.zeros(time.size)
    spike[123_456] = 7.0
    long = Recording.from_arrays("long", time, {"x": (spike, "m")})
    html = shown(shell, long)["text/html"]
    assert len(html) < 40_000
    assert "x over time: 0 to 7 m" in " ".join(html.split())


def test_a_simulation_shows_measured_and_simulated(shell, recorded):
    html = shown(shell, simulate(cart().finish(), bind_to(cart().finish(), recorded)))
    (chart,) = charts(html["text/html"])
    assert len(chart.findall(".//path[@vector-effect]")) == 2
    assert "measured" in html["text/html"]
    assert "of the measured spread" in html["text/html"]


def test_a_run_shows_its_outputs_and_how_it_ended(shell):
    run = simulate_inputs(cart().finish(), np.arange(50) / 50, inputs={"force": 1.0})
    html = shown(shell, run)["text/html"]
    assert len(charts(html)) == 1
    assert run.status.value in html


def test_a_fit_is_its_sentence_and_a_table(shell, recorded):
    graph = cart().finish()
    result = fit(graph, [bind_to(graph, recorded)])
    html = shown(shell, result)["text/html"]
    assert result.status.value in html
    assert all(f">{e.name}</td>" in html for e in result.estimates)
    html = shown(shell, result.model.parameters)["text/html"]
    assert "fitted" in html


def test_a_diagnosis_is_its_statement_and_its_picture(shell):
    found = cart_diagnosis()
    html = shown(shell, found)["text/html"]
    assert found.statement in html
    assert "<svg" in html


def test_names_are_text_in_every_picture(shell):
    name = '</text><script>alert("x")</script>'
    time = 0.1 * np.arange(50)
    made = Recording.from_arrays(name, time, {name: (np.sin(time), "m")})
    assert "<script" not in shown(shell, made)["text/html"]


def test_other_front_ends_get_the_same_html(shell, recorded):
    assert as_html(recorded) == shown(shell, recorded)["text/html"]
    with pytest.raises(TypeError, match="no picture of 'int'"):
        as_html(3)


# Progress


@pytest.mark.parametrize(
    ("step", "read"),
    [
        ("fitting the base model", Count(what="fitting the base model")),
        ("round 1: fits, 7 to do", Count(what="round 1: fits", done=0, total=7)),
        (
            "round 1: fits, 3 of 7, about 9 s left",
            Count(what="round 1: fits", done=3, total=7, rest="about 9 s left"),
        ),
    ],
)
def test_a_step_is_read_as_a_count_where_it_is_one(step, read):
    assert count(step) == read


def test_steps_are_printed_once_and_at_their_end():
    lines = []
    with Steps(lines.append).shown() as tell:
        for step in ("fits, 3 to do", "fits, 1 of 3", "fits, 3 of 3", "answering"):
            tell(step)
    said = [line.partition("] ")[2] for line in lines]
    assert said == ["fits, 3 to do", "fits, 3 of 3", "answering"]


def test_nothing_is_shown_where_nobody_watches(capsys):
    with shown_progress() as tell:
        tell("fits, 1 of 3")
    assert capsys.readouterr() == ("", "")


def test_a_notebook_gets_a_bar_that_says_how_it_ended(monkeypatch):
    pictures = []
    handle = SimpleNamespace(update=pictures.append)
    front_end = SimpleNamespace(HTML=str, display=lambda *_, **__: handle)
    kernel = SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel=True))
    monkeypatch.setitem(sys.modules, "IPython", kernel)
    monkeypatch.setitem(sys.modules, "IPython.display", front_end)
    with shown_progress() as tell:
        tell("fits <1>, 3 of 3")
    bar, end = pictures
    assert '<progress aria-label="fits &lt;1&gt;" value="3" max="3">' in bar
    assert "done in" in end

    def work():
        with shown_progress() as tell:
            tell("fits, 1 of 3")
            raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        work()
    assert "stopped after" in pictures[-1]
