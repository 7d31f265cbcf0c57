"""flegx_checks.toml: green as it stands, red after a change of one parameter."""

import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from bondgraph.checking import run_checks
from bondgraph.cli.program import program
from flegx_models import models
from flegx_models.controllers import MODELS, printed_loop
from flegx_models.parameters import RECONCILED
from flegx_models.published import PUBLISHED

ROOT = Path(__file__).parent.parent
FLEGX = (ROOT / "flegx_checks.toml").read_text(encoding="utf-8")
DECLARED = tomllib.loads(FLEGX)["check"]

CHANGED = """
from flegx_models import models
from flegx_models.parameters import RECONCILED

NEW = RECONCILED.with_values({{"{name}": {factor} * RECONCILED["{name}"].value}})

def lowerleg_flight(): return models.lowerleg_flight(NEW)
def upperleg_flight(): return models.upperleg_flight(NEW)
def lowerleg_stance(): return models.lowerleg_stance(NEW)
def upperleg_stance(): return models.upperleg_stance(NEW)
"""


def failures(folder, name, factor, text=FLEGX):
    (folder / "changed.py").write_text(CHANGED.format(name=name, factor=factor))
    text = text.replace('"flegx_models.models:', '"changed.py:')
    (folder / "checks.toml").write_text(text)
    return [r.check.name for r in run_checks(folder / "checks.toml").failed]


def without_loops():
    tables = FLEGX.split("[[check]]")[1:]
    return "".join(f"[[check]]{t}" for t in tables if "controller" not in t)


def used_by_the_models():
    """Return the names of all parameters that stand in one of the four graphs."""
    graphs = [getattr(models, model)().finish() for model in MODELS]
    return sorted({name for graph in graphs for name in graph.parameters})


def test_the_file_checks_gains_poles_filter_and_margins(tmp_path):
    assert failures(tmp_path, "I_motor", 1.0) == []
    for quantity in ("gain", "pole", "gain_crossover", "phase_crossover"):
        assert FLEGX.count(f'quantity = "{quantity}"') >= 4
    assert FLEGX.count('quantity = "phase_margin"') == 4


# The three least inertias are under a five-hundredth of J: one per cent of them is
# below the printed digits of a gain.
SMALL = {"I_worm": 1.1, "I_gear_tendons": 1.2, "I_gear": 2.0}


@pytest.mark.parametrize("name", used_by_the_models())
def test_a_change_of_any_parameter_turns_it_red(tmp_path, name):
    failed = failures(tmp_path, name, SMALL.get(name, 1.01), without_loops())
    legs = {words.split(",")[0] for words in failed}
    phases = {words.split(":")[0].split(", ")[1] for words in failed}
    upper = name in ("I_upperleg", "I_gear", "m_upperleg", "c_friction_upperleg")
    lower = name in (
        "I_lowerleg",
        "I_gear_tendons",
        "m_lowerleg",
        "c_friction_lowerleg",
    )
    assert legs == ({"upperleg"} if upper else {"lowerleg"} if lower else legs)
    assert len(legs) == (1 if upper or lower else 2)
    standing = name in ("L", "theta_0", "m_motors_support", "m_lowerleg", "m_upperleg")
    assert phases == ({"stance"} if standing else {"flight", "stance"})
    if name.startswith("c_friction"):
        assert all("pole" in words for words in failed)


def test_a_lighter_rotor_moves_the_loops_too(tmp_path):
    failed = failures(tmp_path, "I_motor", 0.98)
    assert sum("gain crossover" in words for words in failed) == 4


@pytest.mark.parametrize("entry", PUBLISHED, ids=lambda entry: entry.model)
def test_the_declared_loops_are_those_of_the_parameter_files(entry):
    """So that a change of a number of chapter 5 turns this red."""
    loop = printed_loop(entry.model)
    declared = [
        check
        for check in DECLARED
        if "controller" in check and check["model"].endswith(f":{entry.model}")
    ]
    assert len(declared) == 3
    for check in declared:
        control, filtered = check["controller"], check["feedback"]
        assert control["zeros"] == [-loop.lead.zero, -loop.zero]
        assert control["poles"] == [-loop.lead.pole, -loop.slow_pole, -loop.fast_pole]
        # K p times the driver's 64518 of the file's head, which is that of eq. 5.10 ff.
        driver = control["gain"] / (loop.lead.gain * loop.lead.pole)
        numerator = driver * entry.gain
        assert numerator == pytest.approx(loop.numerator, rel=5e-3)
        poles = [complex(*pole) for pole in filtered["poles"]]
        wanted = sorted(loop.filter.poles, key=lambda p: p.imag)
        assert sorted(poles, key=lambda p: p.imag) == pytest.approx(wanted, rel=1e-6)
        assert filtered["gain"] == pytest.approx(loop.filter.cutoff**4, rel=1e-6)
        (friction,) = check["parameters"].values()
        N = RECONCILED["K_gearbox"].value * RECONCILED["K_worm_gear"].value
        assert friction * entry.gain / N == pytest.approx(entry.friction_pole, rel=1e-4)


def test_the_filters_printed_cut_off_turns_it_red(tmp_path):
    """25 rad/s instead of 25 Hz: the slip of eq. 3.34, and the loops are lost."""
    slow = FLEGX.replace("111.0553", "17.675").replace("111.0888", "17.6803")
    slow = slow.replace("608806819.0", "390625.0")
    failed = failures(tmp_path, "I_motor", 1.0, slow)
    assert sum("phase crossover" in name for name in failed) == 4
    assert sum("phase margin" in name for name in failed) == 4


def test_a_changed_parameter_is_exit_status_1(tmp_path):
    failures(tmp_path, "I_upperleg", 1.01)
    done = CliRunner().invoke(program, ["check", str(tmp_path / "checks.toml")])
    assert done.exit_code == 1, done.output
    assert "not as declared" in done.output
    right = CliRunner().invoke(program, ["check", str(ROOT / "flegx_checks.toml")])
    assert right.exit_code == 0
