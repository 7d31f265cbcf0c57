"""``bondgraph shape`` and the pictures of loops."""

import json
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from bondgraph.cli.program import program
from bondgraph.errors import BondGraphError, MissingExtraError
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import measure
from bondgraph.loopshaping.prototype import SecondOrderPrototype
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain
from bondgraph.reporting.loop_charts import draw_bode, draw_nichols, logarithm
from bondgraph.reporting.loop_pictures import (
    SheetRow,
    comparison_sheet,
    loop_sheet,
    write_picture,
)
from bondgraph.reporting.loop_tables import measures_text, measures_to_dict

LEG = "flegx_models.models:lowerleg_flight"
SPEC = """
[[series]]
gain = 1.312e4
zeros = [-4403]
poles = [-4201, -1.61e6]
[[feedback]]
low_pass = 157.08
damping = 0.707
times = 2
[[controller]]
kind = "lead"
zero = "cancel"
pole = 50
[require]
prototype_damping = 0.6
"""


def run(*words):
    return CliRunner().invoke(program, [str(word) for word in words])


@pytest.fixture
def spec(tmp_path):
    def written(text):
        path = tmp_path / "spec.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return written


def test_a_leg_is_shaped_from_its_graph(spec, tmp_path):
    answer = tmp_path / "design.json"
    result = run("shape", LEG, "--spec", spec(SPEC), "--json", answer)
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("Every requirement is met.")
    design = json.loads(answer.read_text())
    assert design["status"] == "met"
    # the zero lies on the friction pole c/J that the graph gives
    numbers = design["controller"]["numbers"]
    assert f"lead: gain {numbers['gain']:.5g}, zero 0.0014623" in result.stdout
    assert numbers["zero"] == pytest.approx(0.00146234, rel=1e-4)
    assert numbers["pole"] == 50
    assert design["binding"] == ["peak sensitivity"]
    measures = design["measures"]
    assert measures["stability"] == "stable"
    assert measures["sensitivity"]["value"] == pytest.approx(1.35276, rel=1e-4)
    # the same crossover whatever the motor's gain is: it is the filter that limits
    assert measures["crossover"] == pytest.approx(10.22, abs=0.01)


def test_what_cannot_be_met_is_said_with_how_much_and_exits_with_one(spec):
    text = SPEC + "crossover = 20\n"
    result = run("shape", LEG, "--spec", spec(text))
    assert result.exit_code == 1
    assert "No gain meets every requirement" in result.stdout
    assert "Crossover: at least 20 rad/s is required" in result.stdout
    assert "allow a crossover of 10.22 rad/s, 9.78 rad/s less" in result.stdout


def test_a_free_number_and_a_picture(spec, tmp_path):
    picture = tmp_path / "loop.png"
    text = SPEC + '[free]\n"pole" = [20, 100]\n'
    result = run("shape", LEG, "--spec", spec(text), "-o", picture, "--set", "L=0.3")
    assert result.exit_code == 2  # L is no parameter of the leg in flight
    result = run("shape", LEG, "--spec", spec(text), "-o", picture)
    assert result.exit_code == 0, result.output
    assert "upper limit 100" in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("pole = 50", "pol = 50"), "'pol' is not understood in a lead controller"),
        (("pole = 50", 'pole = "fast"'), "'pole' is not a number"),
        (('"lead"', '"led"'), "'led' is no kind of controller. Did you mean lead"),
        (("[require]", "[requires]"), "'requires' is not understood"),
        (("prototype_damping = 0.6", ""), "Nothing is required"),
        (("prototype_damping = 0.6", "phase_margn = 40"), "phase_margin"),
        (("[[controller]]", "[[controllers]]"), "'controllers' is not understood"),
        (("zeros = [-4403]", "zeros = [[1, 2]]"), "no conjugate"),
        (("zeros = [-4403]", "zeros = ["), "is no TOML"),
        (("[[series]]", 'output = "phi"\n[[series]]'), "no output 'phi'"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(spec, change, says):
    result = run("shape", LEG, "--spec", spec(SPEC.replace(*change)))
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.splitlines()
    assert says in line


def test_a_missing_file_is_refused(tmp_path):
    result = run("shape", LEG, "--spec", tmp_path / "none.toml")
    assert result.exit_code == 2
    assert "cannot be read" in result.stderr


SLOW = Loop(plant=ZeroPoleGain(poles=(0, -5), gain=10.0))
LATE = Loop(plant=ZeroPoleGain(poles=(0, -5), gain=20.0, delay=0.05))
SAMPLED = Loop(plant=ZeroPoleGain(poles=(1.0, 0.8), gain=0.02, period=0.1))


def test_a_sheet_has_every_chart_and_is_written(tmp_path):
    sheet = loop_sheet(
        {"slow": SLOW, "late": LATE, "sampled": SAMPLED},
        prototype=SecondOrderPrototype(0.6),
        title="three",
    )
    assert [a.get_ylabel() for a in sheet.axes] == [
        "|L| in dB",
        "arg L in °",
        "|L| in dB",
        "Im L",
        "|S|, and paler |T|",
        "y after a step of r",
        "|command / noise|",
    ]
    for suffix in ("png", "svg", "pdf"):
        path = tmp_path / f"sheet.{suffix}"
        write_picture(sheet, path)
        assert path.stat().st_size > 10_000


def test_the_charts_show_the_loop_and_its_margins():
    figure = loop_sheet({"slow": SLOW})
    gain, phase, nichols = figure.axes[:3]
    line = gain.lines[0]
    response = SLOW.open_loop.response(line.get_xdata())
    np.testing.assert_allclose(line.get_ydata(), 20 * np.log10(np.abs(response)))
    degrees = np.degrees(np.angle(response))
    np.testing.assert_allclose(phase.lines[0].get_ydata(), degrees, atol=1e-9)
    crossover = measure(SLOW).gain_crossovers[0]
    marks = [m for m in nichols.lines if m.get_marker() == "o"]
    assert marks[0].get_xdata()[0] == pytest.approx(
        crossover.phase_margin - 180, abs=0.01
    )


def test_the_circles_of_the_nichols_chart_have_their_magnitude():
    figure = loop_sheet(SLOW)
    nichols = figure.axes[2]
    values = []
    for level, line in zip((12, 6, 3, 1, -1, -3, -6, -12), nichols.lines, strict=False):
        degrees, decibels = (np.asarray(x)[100:-100] for x in line.get_data())
        L = 10 ** (decibels / 20) * np.exp(1j * np.radians(degrees))
        np.testing.assert_allclose(np.abs(L / (1 + L)), 10 ** (level / 20), rtol=1e-6)
        values.append(level)
    assert len(values) == 8


def test_the_phase_is_between_minus_360_and_0_at_the_crossover():
    # an unstable pole and two integrators: continuous phase is turned into the chart
    loop = Loop(plant=ZeroPoleGain(zeros=(-1, -2), poles=(0, 0, 4), gain=12.0))
    omega = np.geomspace(0.1, 1000, 400)
    decibels, degrees = logarithm(loop, omega)
    at = degrees[np.argmin(np.abs(decibels))]
    assert -360 < at <= 0
    expected = np.angle(loop.open_loop.response(omega))
    np.testing.assert_allclose(np.exp(1j * np.radians(degrees)), np.exp(1j * expected))


def test_the_comparison_sheet_has_six_charts_for_each_row():
    row = SheetRow(title="leg", designed={"a": SLOW}, changed={"a": SLOW, "b": LATE})
    sheet = comparison_sheet([row, row], prototype=SecondOrderPrototype(0.6))
    assert len(sheet.axes) == 12
    assert "φ_m" in sheet.axes[2].get_title()


def test_seven_loops_are_too_many_and_a_wrong_suffix_is_refused(tmp_path):
    with pytest.raises(BondGraphError, match="cannot be read"):
        loop_sheet({str(k): SLOW for k in range(7)})
    with pytest.raises(BondGraphError, match="cannot be written"):
        write_picture(loop_sheet(SLOW), tmp_path / "loop.xyz")


def test_without_matplotlib_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match="matplotlib"):
        loop_sheet(SLOW)


def test_measures_as_text_and_as_data():
    measures = measure(LATE)
    text = measures_text(measures)
    assert "The closed loop is stable." in text
    assert f"{measures.crossover:.5g} rad/s" in text
    data = json.dumps(measures_to_dict(measures), allow_nan=False)
    assert json.loads(data)["crossover"] == measures.crossover


def test_charts_draw_into_axes_of_the_caller():
    from matplotlib.figure import Figure  # noqa: PLC0415

    axes = Figure().subplots(3)
    measured = {"slow": measure(SLOW)}
    draw_bode(axes[0], axes[1], {"slow": SLOW}, measured)
    draw_nichols(axes[2], {"slow": SLOW}, measured)
    assert axes[2].get_xlabel() == "arg L in °"
