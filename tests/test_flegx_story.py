"""The story of FlegX's own mismatch: the leg that is simulated, and its controllers.

What the simulator does is held to formulas by hand; an answer is taken on to the zero
of its controller. The diagnoses themselves are run by command.
"""

import ast
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy

from benchmarks.flegx_story import leg, recording, train, zeros
from benchmarks.flegx_story.__main__ import said, shaped
from benchmarks.flegx_story.leg import ALL, ALONE, JOINTS, Concealed, machine
from benchmarks.flegx_story.shaping import (
    designed,
    friction_pole,
    plant_of,
    rubbed,
    speed_of_the_test,
)
from benchmarks.flegx_story.telling import Told, concealed_in, telling
from benchmarks.flegx_story.zeros import found_zero
from bondgraph import InsertElement, Parameter, R, f, to_python
from flegx_models import models
from flegx_models.tuned_zeros import (
    friction_per_load,
    identified_friction,
    tuning_tests,
)

KNEE_IN_STANCE = JOINTS[2]


def _rates(drive, state, torque=0.0):
    """Return the slopes of (q, v, z), and the torque that the worm passes on."""
    n, stores = drive.coordinates, drive.stores
    q, v, z = np.split(np.asarray(state, float), [n, 2 * n])
    numbers = np.array([number.value for number in drive.numbers])
    force, slope, load = np.zeros(n), np.zeros(stores), np.zeros(8)
    still, inertia = np.zeros(n), np.zeros((n, n))
    train.forces.py_func(
        q, v, z, np.array([torque]), numbers, still, force, slope, load, np.zeros(8)
    )
    train.masses.py_func(q, v, numbers, inertia)
    return np.concatenate((v, np.linalg.solve(inertia, force), slope)), load[0]


def _matrix(drive):
    size = 2 * drive.coordinates + drive.stores
    return np.array([_rates(drive, row)[0] for row in np.eye(size)]).T


def test_the_story_shares_no_code_with_the_toolkit():
    for module in (train, leg, recording):
        tree = ast.parse(Path(module.__file__).read_text("utf-8"))
        names = {node.module for node in ast.walk(tree) if hasattr(node, "module")}
        names |= {
            alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.Import)
            for alias in node.names
        }
        roots = {name.split(".")[0] for name in names if name}
        assert not roots & {"bondgraph", "flegx_models"}


def test_the_concealed_friction_is_that_of_the_tuned_zeros():
    worm = identified_friction().worm
    assert pytest.approx(friction_per_load(worm), rel=0.01) == leg.FRICTION_PER_LOAD
    assert pytest.approx(worm.constant, rel=0.01) == leg.CONSTANT_FRICTION
    for joint, test in zip(JOINTS, tuning_tests(), strict=True):
        assert joint.model == test.model
        assert joint.load == pytest.approx(test.load, rel=0.01)


@pytest.mark.parametrize("joint", JOINTS, ids=lambda joint: joint.model)
def test_the_link_rings_between_the_drive_and_what_it_carries(joint):
    drive = machine(joint, Concealed(link=True))
    near = leg.MOTOR_SIDE + joint.inertia
    expected = math.sqrt(leg.LINK * (1 / near + 1 / joint.behind))
    found = np.abs(np.linalg.eigvals(_matrix(drive)).imag).max()
    assert found == pytest.approx(expected, rel=0.01)  # damped: a little lower


def test_the_filter_passes_a_quarter_of_the_power_at_its_cut_off():
    drive = machine(KNEE_IN_STANCE, Concealed(filter=True))
    a = _matrix(drive)[-4:]
    from_joint, own = a[:, 0], a[:, -4:]
    for omega, gain in ((1e-3, 1.0), (leg.CUT_OFF, 0.5)):
        answer = np.linalg.solve(1j * omega * np.eye(4) - own, from_joint)
        assert abs(answer[2]) == pytest.approx(gain, rel=1e-3)


@pytest.mark.parametrize("concealed", [*ALONE, ALL], ids=lambda one: one.name)
def test_the_worm_at_rest_carries_the_weight(concealed):
    drive = machine(KNEE_IN_STANCE, concealed)
    slopes, load = _rates(drive, np.zeros(2 * drive.coordinates + drive.stores))
    assert not slopes.any()
    assert train.WORM * load == pytest.approx(KNEE_IN_STANCE.load)


@pytest.mark.parametrize("concealed", [Concealed(), ALL], ids=lambda one: one.name)
def test_both_gauges_balance_what_the_joint_takes(concealed):
    drive = machine(KNEE_IN_STANCE, concealed, gauged=True)
    n = drive.coordinates
    state = 0.01 * np.arange(1.0, 2 * n + drive.stores + 1)
    q, v, z = np.split(state, [n, 2 * n])
    acceleration = _rates(drive, state, torque=0.02)[0][n : 2 * n]
    numbers = np.array([number.value for number in drive.numbers])
    read = np.zeros(3)
    train.readings.py_func(q, v, z, np.array([0.02]), numbers, acceleration, read)
    joint = 1 if concealed.tendons else 0
    taken = leg.VISCOUS * v[joint] + KNEE_IN_STANCE.inertia * acceleration[joint]
    _, torque, link = read
    assert torque + link == pytest.approx(taken)


def test_dry_friction_moves_the_zero_and_not_the_loop():
    test = tuning_tests()[2]
    graph = getattr(models, test.model)().finish()
    mesh = InsertElement("worm", R("mesh", law=sympy.Integer(0) * f + f))
    dry = 8.85  # N·m at the joint
    speed = speed_of_the_test(test.model)
    assert speed == test.speed
    plant = plant_of(
        rubbed(mesh.apply(graph), "mesh", dry / train.WORM, train.WORM * speed)
    )
    zero = (test.viscous + 4 * dry / (math.pi * speed)) / test.inertia
    assert friction_pole(plant) == pytest.approx(zero, rel=1e-3)
    printed = designed(test.model, plant_of(graph), filtered=True)
    found = designed(test.model, plant, filtered=True)
    assert found.controller.value("zero") == pytest.approx(zero, rel=1e-3)
    assert found.measures.crossover == pytest.approx(printed.measures.crossover)


def test_an_answer_is_taken_to_the_controller(tmp_path):
    size = Parameter(name="dry", value=0.035, unit="N*m", std=None)
    law = sympy.Symbol("dry") * sympy.sign(f)
    inserted = InsertElement("motor", R("rub", law=law), (size,))
    found = inserted.apply(models.lowerleg_stance().finish())
    finding = {
        "physics": "coulomb_friction",
        "place": "motor",
        "element": "rub",
        "parameters": {"dry": {"value": 0.035, "unit": "N*m"}},
    }
    told = {
        "verdict": "physics_missing",
        "findings": [finding],
        "model": to_python(found),
    }
    answer = tmp_path / "lowerleg_stance_worm.json"
    answer.write_text(json.dumps(told), "utf-8")
    assert said(answer).endswith("physics_missing: coulomb_friction at motor")
    # 0.035 N·m · 251.42 = 8.80 N·m, and z = (c + 4F/(πV))/J as above
    assert "F = 8.80 N·m at the joint; zero at 2.90 rad/s" in shaped(answer)


def test_a_friction_of_a_load_alone_has_no_size_to_lay_a_zero_by(tmp_path):
    finding = {
        "physics": "load_dependent_friction",
        "place": "worm",
        "parameters": {"mu_worm": {"value": 0.34, "unit": "1"}},
    }
    answer = tmp_path / "lowerleg_stance_worm.json"
    answer.write_text(json.dumps({"verdict": "", "findings": [finding]}), "utf-8")
    assert found_zero(answer) is None


def test_behind_a_dead_zone_no_zero_is_laid(tmp_path, monkeypatch):
    size = Parameter(name="dry", value=0.035, unit="N*m", std=None)
    law = sympy.Symbol("dry") * sympy.sign(f)
    rubs = InsertElement("motor", R("rub", law=law), (size,))
    finding = {
        "physics": "coulomb_friction",
        "place": "motor",
        "element": "rub",
        "parameters": {"dry": {"value": 0.035, "unit": "N*m"}},
    }
    model = to_python(rubs.apply(models.lowerleg_stance().finish()))
    answer = tmp_path / "lowerleg_stance_worm.json"
    answer.write_text(json.dumps({"findings": [finding], "model": model}), "utf-8")
    assert found_zero(answer) is not None
    plant = zeros.plant_of
    monkeypatch.setattr(
        zeros, "plant_of", lambda graph: replace(plant(graph), gain=0.0)
    )
    assert found_zero(answer) is None


def found(physics, place, **parameters):
    """Return a finding with parameters, each of a value and its standard error."""
    numbers = {
        name: {"value": value, "std": std} for name, (value, std) in parameters.items()
    }
    return {
        "physics": physics,
        "place": place,
        "indistinguishable_places": [],
        "parameters": numbers,
    }


def told_of(answer, *findings):
    """Return what an answer with findings has right, of the case by its name."""
    error = {"rmse": {"theta": 0.5}}
    told = {
        "verdict": "physics_missing",
        "findings": findings,
        "fit": {"held_out": {"before": error, "after": error}},
    }
    answer.write_text(json.dumps(told), "utf-8")
    return telling(answer)


def test_a_finding_stands_for_one_piece_and_what_else_is_said_is_told(tmp_path):
    answer = tmp_path / "lowerleg_stance_all.json"
    rub, gives, weight, late = (
        found(physics, place, size=(1.0, 0.1))
        for physics, place in (
            ("direction_dependent_friction", "motor"),
            ("compliance", "K_worm_gear"),
            ("gravity", "joint"),
            ("lag", "worm"),
        )
    )
    gives["indistinguishable_places"] = ["joint"]
    seen = told_of(answer, rub, gives, weight, late)
    assert seen.pieces == {
        "worm": Told.KIND,
        "tendons": Told.RIGHT,
        "link": Told.SILENT,
        "filter": Told.SILENT,  # at a place where no filter can be
    }
    assert seen.beside == ("gravity at joint", "lag at worm")
    gives["parameters"] = {"size": {"value": 1.0, "std": 30.0}}
    seen = told_of(answer, rub, gives, weight, late)
    assert seen.pieces["tendons"] is Told.SILENT
    assert "compliance at K_worm_gear (no size)" in seen.beside
    assert concealed_in("upperleg_flight_all") == ("worm", "link", "filter")
    assert concealed_in("upperleg_flight_all_gauged") == ("worm", "link", "filter")


@pytest.mark.parametrize(
    ("size", "place", "told"),
    [
        (2e-3, "joint", Told.RIGHT),
        (2e-3 * train.WORM**2, "worm", Told.RIGHT),
        (7.3, "joint", Told.SILENT),
    ],
    ids=["as large", "as large, seen from the joint", "far too soft"],
)
def test_a_compliance_counts_where_it_is_as_large_as_the_concealed_one(
    tmp_path, size, place, told
):
    gives = found("compliance", place, compliance_there=(size, size / 100))
    seen = told_of(tmp_path / "lowerleg_stance_tendons.json", gives)
    assert seen.pieces == {"tendons": told}
    assert bool(seen.beside) is (told is Told.SILENT)


@pytest.mark.parametrize(
    ("inertia", "error", "told"),
    [(0.05, 0.001, Told.RIGHT), (1e-9, 1e-10, Told.SILENT), (0.05, 0.03, Told.SILENT)],
    ids=["as large", "next to none", "not told from none"],
)
def test_a_part_that_swings_is_a_compliance_of_its_inertia_and_its_rate(
    tmp_path, inertia, error, told
):
    rate = (0.05 * 2e-3) ** -0.5
    swings = found(
        "compliance",
        "joint",
        mode_inertia_joint=(inertia, error),
        mode_frequency_joint=(rate, rate / 100),
    )
    seen = told_of(tmp_path / "lowerleg_stance_tendons.json", swings)
    assert seen.pieces == {"tendons": told}
