"""Loading models and checking their gains: the answers, and every refusal."""

import json
import math
import os
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from bondgraph.checking import run_checks, write_junit
from bondgraph.errors import BondGraphError, CheckError, ModelLoadError
from bondgraph.loading import load_model, load_object
from bondgraph.structure.graph import FinishedGraph

ROOT = Path(__file__).parent.parent
FLEGX = ROOT / "flegx_checks.toml"

MACHINES = """
from bondgraph import C, I, R, Se, BondGraph, FinishedGraph, Parameter, ParameterSet

def cart() -> BondGraph:
    cart = BondGraph("cart", domain="translation")
    cart.one("carriage", Se("force"), I("mass"), R("viscous"))
    cart.measure("position", displacement="carriage")
    cart.measure("speed", flow="carriage")
    cart.parameter("mass", 2.0, "kg")
    cart.parameter("viscous", 6.0, "N*s/m")
    return cart

def sprung(stiffness=18.0) -> "FinishedGraph":
    cart = BondGraph("sprung cart", domain="translation")
    cart.one("carriage", Se("force"), I("mass"), R("viscous"), C("spring"))
    cart.measure("position", displacement="carriage")
    cart.parameter("mass", 2.0, "kg")
    cart.parameter("viscous", 4.0, "N*s/m")
    cart.parameter("spring", 1 / stiffness, "m/N")
    return cart.finish()

def _helper() -> BondGraph:
    raise AssertionError

def number():
    return 42

def fails():
    return {}["mass"]

def unfinished():
    cart = BondGraph("cart")
    cart.put(I("mass"), on="carriage")
    return cart

HEAVY = ParameterSet((Parameter(name="mass", value=4.0, unit="kg"),
                      Parameter(name="other", value=1.0)))
"""

FAILING_LINE = MACHINES.splitlines().index('    return {}["mass"]') + 1


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "machines.py").write_text(MACHINES)
    return tmp_path


def one_line(error):
    """Return the error's text, which must be one line without a traceback."""
    text = str(error.value)
    assert "\n" not in text
    assert "Traceback" not in text
    return text


# -- loading ------------------------------------------------------------------------


def test_loads_a_factory_from_a_file_or_a_module(folder, monkeypatch):
    from_file = load_model(f"{folder}/machines.py:cart")
    assert isinstance(from_file, FinishedGraph)
    assert load_model("machines.py:sprung", directory=folder).name == "sprung cart"
    monkeypatch.chdir(folder)
    assert load_model("machines.py:cart").name == "cart"
    assert load_model("flegx_models.demo:drive").name == "lowerleg drive"


def test_the_factory_may_be_left_out_where_there_is_one(tmp_path):
    (tmp_path / "cart.py").write_text(MACHINES.partition("def sprung")[0])
    assert load_model("cart.py", directory=tmp_path).name == "cart"


def test_one_that_says_no_type_is_found_where_it_is_alone(tmp_path):
    text = MACHINES.partition("def sprung")[0].replace(" -> BondGraph", "")
    (tmp_path / "cart.py").write_text(text)
    assert load_model("cart.py", directory=tmp_path).name == "cart"
    helper = "\n\ndef stiff(times):\n    return times\n"
    (tmp_path / "helped.py").write_text(text + helper)
    assert load_model("helped.py", directory=tmp_path).name == "cart"
    (tmp_path / "two.py").write_text(text + helper.replace("times", ""))
    with pytest.raises(ModelLoadError, match="no function that returns"):
        load_model("two.py", directory=tmp_path)


def test_a_changed_file_is_loaded_afresh(folder, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    file = folder / "machines.py"
    before = load_model("machines.py:cart", directory=folder)
    written = file.stat().st_mtime_ns
    file.write_text(MACHINES.replace("2.0", "2.5"))
    os.utime(file, ns=(written, written))  # within the second, and as long as before
    after = load_model("machines.py:cart", directory=folder)
    assert before.parameters["mass"].value == 2.0
    assert after.parameters["mass"].value == 2.5


def test_a_file_may_import_its_neighbour(folder):
    (folder / "plant.py").write_text("from machines import cart as machine\n")
    assert load_model("plant.py:machine", directory=folder).name == "cart"


@pytest.mark.parametrize(
    ("reference", "expected"),
    [
        ("absent.py:cart", "There is no file"),
        ("machine.py:cart", "Did you mean machines.py?"),
        ("absent_package.models:cart", "There is no module 'absent_package.models'"),
        ("flegx_models.modles:drive", "There is no module 'flegx_models.modles'"),
        ("machines.py:cartt", "no 'cartt' in 'machines.py'. Did you mean cart?"),
        ("machines.py", "has 2 models: cart, sprung. Write machines.py:cart"),
        ("machines.py:number", "returns an int, not a BondGraph"),
        ("machines.py:HEAVY", "is a ParameterSet, not a function"),
        ("machines.py:fails", f"machines.py, line {FAILING_LINE}: KeyError: 'mass'."),
        ("machines.py:unfinished", "There is no junction 'carriage'"),
        ("machines.py:", "names no model"),
        ("", "names no model"),
        ("notes/readme.txt:cart", "There is no file"),
    ],
)  # fmt: skip
def test_refusals_are_one_line(folder, reference, expected):
    with pytest.raises(BondGraphError) as error:
        load_model(reference, directory=folder)
    assert expected in one_line(error)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def cart(:\n    pass\n", "broken.py, line 1: invalid syntax"),
        ("x = 1\ny = x / 0\n", "broken.py, line 2: ZeroDivisionError: division by"),
        ("import no_such_package\n", "line 1: ModuleNotFoundError: No module named"),
        ("import math\n", "no function that returns a BondGraph"),
        ("raise SystemExit(3)\n", "broken.py, line 1: SystemExit: 3"),
        ("raise BaseException('base')\n", "broken.py, line 1: BaseException: base"),
        (
            "class E(Exception):\n    def __str__(self): raise ValueError\nraise E\n",
            "broken.py, line 3: E.",
        ),
        ("def f() -> 'BondGraph':\n    return None\n", "returns None, not a BondGraph"),
        ("raise ValueError('two\\nlines')\n", "ValueError: two lines"),
        ("import math\nmath.sqrt(-1)\n", "broken.py, line 2: ValueError"),
    ],
)
def test_a_broken_file_is_one_line_with_its_place(tmp_path, text, expected):
    (tmp_path / "broken.py").write_text(text)
    with pytest.raises(ModelLoadError) as error:
        load_model("broken.py", directory=tmp_path)
    assert expected in one_line(error)


def test_a_file_without_python_is_refused(tmp_path):
    (tmp_path / "readme.txt").write_text("hello")
    with pytest.raises(ModelLoadError) as error:
        load_model("./readme.txt:cart", directory=tmp_path)
    assert "is not a Python file" in one_line(error)


def test_an_object_needs_a_name(folder):
    assert len(load_object("machines.py:HEAVY", directory=folder)) == 2
    with pytest.raises(ModelLoadError) as error:
        load_object("machines.py", directory=folder)
    assert "names no object" in one_line(error)


# -- checking -----------------------------------------------------------------------

GAIN = """
[[check]]
name = "gain"
model = "machines.py:cart"
input = "force"
output = "position"
quantity = "gain"
value = 0.5
digits = 3
"""


def checks(folder, text=GAIN, name="checks.toml"):
    path = folder / name
    path.write_text(text)
    return path


def edited(**keys):
    """Return the gain check with keys replaced, added or (None) removed."""
    lines = dict(line.split(" = ") for line in GAIN.strip().splitlines()[1:])
    lines |= keys
    kept = (f"{key} = {value}" for key, value in lines.items() if value is not None)
    return "[[check]]\n" + "\n".join(kept) + "\n"


def test_a_gain_is_derived_and_compared(folder):
    report = run_checks(checks(folder))
    (result,) = report.results
    assert report.ok
    assert report.failed == ()
    assert result.derived == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("keys", "derived"),
    [
        ({"output": '"speed"', "quantity": '"dc_gain"', "value": 0.1666667}, 1 / 6),
        ({"quantity": '"pole"', "value": -3.0}, -3.0),
        ({"quantity": '"pole"', "value": 0.0, "index": 0}, 0.0),
        ({"quantity": '"pole"', "value": -3.0, "index": 1}, -3.0),
        ({"quantity": '"pole"', "value": -3.0, "nearest": -10}, -3.0),
        ({"value": 0.25, "parameters": "{mass = 4.0}"}, 0.25),
        ({"value": 0.25, "parameters": '"machines.py:HEAVY"'}, 0.25),
        (
            {
                "model": '"machines.py:sprung"',
                "quantity": '"pole"',
                "value": f"[-1.0, {math.sqrt(8)}]",
            },
            complex(-1, math.sqrt(8)),
        ),
    ],
)
def test_quantities_selections_and_parameters(folder, keys, derived):
    text = edited(digits=None, tolerance=1e-6, **keys)
    report = run_checks(checks(folder, text))
    assert report.ok
    assert report.results[0].derived == pytest.approx(derived, abs=1e-9)


@pytest.mark.parametrize(
    ("keys", "ok"),
    [
        ({"value": 0.501, "digits": 3}, False),
        ({"value": 0.5, "digits": 1}, True),
        ({"value": 0.504, "digits": None, "tolerance": 0.005}, True),
        ({"value": 0.506, "digits": None, "tolerance": 0.005}, False),
        ({"value": 0.504, "digits": None, "relative_tolerance": 0.01}, True),
        ({"value": 0.504, "digits": None, "relative_tolerance": 0.005}, False),
    ],
)
def test_tolerances_decide(folder, keys, ok):
    report = run_checks(checks(folder, edited(**keys)))
    assert report.ok is ok
    assert len(report.failed) == (0 if ok else 1)
    assert ("not as declared" in report.results[0].statement) is not ok


def test_checks_may_live_in_pyproject(folder):
    text = GAIN.replace("[[check]]", "[[tool.bondgraph.checks.check]]")
    text = '[project]\nname = "cart"\n' + text
    assert run_checks(checks(folder, text, "pyproject.toml")).ok


def test_the_report_is_plain_data(folder):
    pole = edited(name='"pole"', quantity='"pole"', value=-2.0)
    report = run_checks(checks(folder, GAIN + pole))
    plain = json.loads(json.dumps(report.to_dict()))
    assert [check["ok"] for check in plain["checks"]] == [True, False]
    assert plain["ok"] is False
    assert plain["checks"][1]["derived"] == pytest.approx(-3.0)


def test_junit_is_well_formed_whatever_the_names(folder):
    text = edited(name=r'"a <gain> & \"more\" \u0001"', value=0.7)
    report = run_checks(checks(folder, GAIN + text))
    write_junit(report, folder / "junit.xml")
    suite = ET.parse(folder / "junit.xml").getroot().find("testsuite")
    assert suite.attrib["tests"] == "2"
    assert suite.attrib["failures"] == "1"
    passed, failed = suite.findall("testcase")
    assert passed.find("failure") is None
    assert failed.attrib["name"] == 'a <gain> & "more" \ufffd'
    assert "0.7" in failed.find("failure").attrib["message"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (edited(tolerence=0.1), "unknown key 'tolerence'. Did you mean tolerance"),
        (edited(value=None), "check 'gain' lacks 'value'"),
        (edited(digits=None), "has no tolerance"),
        (edited(tolerance=0.1), "has both tolerance and digits"),
        (edited(value="true"), "value = True"),
        (edited(value="nan"), "value = nan"),
        (edited(value='"0.5"'), "value = '0.5'"),
        (edited(value="[1, 2]"), "complex gain"),
        (edited(value=0.5004), "more than 3 decimals"),
        (edited(digits=1.5), "digits = 1.5"),
        (edited(digits=None, tolerance=-1), "tolerance = -1"),
        (edited(quantity='"gian"'), "quantity 'gian'. Did you mean gain"),
        (edited(index=0), "has index, but a gain is one number"),
        (edited(name='""'), "name = ''"),
        (edited(parameters=3), "parameters = 3"),
        (edited(parameters='{mass = "2"}'), "mass = '2'"),
        (edited(parameters="{mas = 2.0}"), "no parameter 'mas'. Did you mean mass"),
        (edited(parameters='"machines.py:cart"'), "is not a ParameterSet"),
        (edited(model='"absent.py:cart"'), "There is no file"),
        (edited(model='"machines.py:fails"'), f"line {FAILING_LINE}: KeyError"),
        (edited(output='"positon"'), "no output 'positon'. Did you mean position"),
        (edited(input='"T_motor"'), "no input 'T_motor'. Known here: force"),
        (edited(quantity='"zero"', value=1.0), "has no zero"),
        (edited(quantity='"pole"', value=1.0, index=7), "there is no pole 7"),
        (edited(quantity='"dc_gain"'), "dc gain"),
        (GAIN + GAIN, "two checks called 'gain'"),
        ("[[check]\n", "is not TOML"),
        ("", "declares no check"),
        ("check = 3\n", "declares no check"),
        ("check = [3]\n", "check 1 is not a table"),
        ("[checks]\n", "has 'checks', which checks do not use"),
    ],
)
def test_a_bad_check_file_is_one_line(folder, text, expected):
    path = checks(folder, text)
    with pytest.raises(CheckError) as error:
        run_checks(path)
    assert expected in one_line(error)
    assert "checks.toml" in one_line(error)


def test_a_model_is_no_check_file_and_what_looks_at_it_is_named(folder):
    path = folder / "cart.py"
    path.write_text("from bondgraph import BondGraph\n")
    with pytest.raises(CheckError) as error:
        run_checks(path)
    assert "'bondgraph derive'" in one_line(error)


def test_a_missing_or_unreadable_check_file_is_one_line(folder):
    with pytest.raises(CheckError) as error:
        run_checks(folder / "absent.toml")
    assert "There is no check file" in one_line(error)
    with pytest.raises(CheckError) as error:
        run_checks(folder)
    assert "cannot be read" in one_line(error)
    (folder / "latin.toml").write_bytes(b'name = "\xe9"')
    with pytest.raises(CheckError) as error:
        run_checks(folder / "latin.toml")
    assert "not UTF-8" in one_line(error)


def test_a_parameter_without_value_is_named(folder):
    text = MACHINES.replace('cart.parameter("viscous", 6.0, "N*s/m")\n', "\n")
    (folder / "machines.py").write_text(text)
    with pytest.raises(CheckError) as error:
        run_checks(checks(folder, edited(quantity='"pole"', value=-3.0)))
    assert "viscous" in one_line(error)


# -- FlegX in CI --------------------------------------------------------------------


def test_flegx_keeps_its_gains_and_poles():
    report = run_checks(FLEGX)
    assert [result.check.name for result in report.failed] == []
    assert len(report.results) == 22
