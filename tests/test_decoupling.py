"""What the assumptions of chapter 4 cost, against inertias added up by hand."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from flegx_models import cost_tables, decoupling
from flegx_models.neglected import bending, neglected, weighted_poles
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.working_range import (
    flight_postures,
    printed_posture,
    stance_postures,
)

V = RECONCILED.values_by_name()
N = V["K_gearbox"] * V["K_worm_gear"]
DRIVE = (V["I_motor"] + V["I_gearbox"]) * N**2 + V["I_worm"] * V["K_worm_gear"] ** 2
SIN, COS = math.sin(V["theta_0"]), math.cos(V["theta_0"])
PAGE = Path(__file__).parent.parent / "docs" / "flegx_models.md"


@pytest.fixture(scope="module")
def rows():
    return decoupling.assumptions()


def of(rows, model, start):
    (row,) = (r for r in rows if r.model == model and r.statement.startswith(start))
    return row


@pytest.mark.parametrize("model", ["lowerleg_flight", "upperleg_flight"])
def test_each_step_starts_where_the_last_one_ended(rows, model):
    path = [row for row in rows if row.model == model]
    for row, following in pairwise(path):
        assert row.gain_without == following.gain
        assert row.pole_without == following.pole


@pytest.mark.parametrize(
    ("model", "start", "gain"),
    [
        ("lowerleg_flight", "the hip does not", 176.76),
        ("lowerleg_stance", "the links move", 108.36),
        ("upperleg_stance", "the links move", 106.24),
    ],
)
def test_the_path_starts_at_the_printed_gain(rows, model, start, gain):
    assert round(of(rows, model, start).gain, 2) == gain


def test_the_upper_leg_path_starts_at_its_own_formula_and_not_at_162_12(rows):
    """Section 4.2.2's formula with the masses of section 3.3 and the reconciled L."""
    squared = V["L"] ** 2 + V["l_cm_lowerleg"] ** 2
    squared += 2 * V["L"] * V["l_cm_lowerleg"] * math.cos(V["theta_knee"])
    J = DRIVE + V["I_gear"] + V["I_upperleg_link"] + V["m_lowerleg_link"] * squared
    row = of(rows, "upperleg_flight", "the lower leg is a point mass")
    assert row.gain == pytest.approx(N / J, rel=1e-9)
    at_knee = J - V["m_lowerleg_link"] * (squared - V["L"] ** 2)
    assert row.gain_without == pytest.approx(N / at_knee, rel=1e-9)
    bearings = V["c_friction_upperleg"] + V["c_friction_lowerleg"]
    assert row.pole_without == pytest.approx(bearings / at_knee, rel=1e-9)


def standing_inertia(drives):
    """Return J of the standing leg about either joint at θ0, with so many drives."""
    upper, lower, L = V["l_cm_upperleg"], V["l_cm_lowerleg"], V["L"]
    J = drives * DRIVE + V["I_gear"] + V["I_gear_tendons"]
    J += V["I_upperleg_link"] - V["m_upperleg"] * upper**2
    J += V["I_lowerleg"] - V["m_lowerleg_link"] * lower**2
    J += V["m_motors_support"] * (2 * L * SIN) ** 2
    squared = ((2 * L - upper) * SIN) ** 2 + (upper * COS) ** 2
    return J + V["m_upperleg"] * squared + V["m_lowerleg_link"] * (L - lower) ** 2


@pytest.mark.parametrize("model", ["lowerleg_stance", "upperleg_stance"])
def test_standing_moves_both_drives(rows, model):
    alone = of(rows, model, "the other motor has")
    assert alone.gain == pytest.approx(N / standing_inertia(1), rel=1e-9)
    assert alone.gain_without == pytest.approx(N / standing_inertia(2), rel=1e-9)
    # Without slip θ2' = -2 θ1': hip bearings turn once, those of the knee twice.
    friction = V["c_friction_upperleg"] + 4 * V["c_friction_lowerleg"]
    assert alone.pole == pytest.approx(friction / standing_inertia(1), rel=1e-6)
    pair = of(rows, model, "the other motor gives")
    assert pair.gain_without == pytest.approx(2 * N / standing_inertia(2), rel=1e-9)


def test_without_slip_the_lever_would_be_half_as_long(rows):
    """On slippery ground a joint moves the support by L sin θ0, its own drive only.

    What is left out here (links, the other joint following a little) is small.
    """
    for model, joint in (("lowerleg_stance", "knee"), ("upperleg_stance", "hip")):
        row = of(rows, model, "the foot does not slip")
        at_least = DRIVE + V["m_motors_support"] * (V["L"] * SIN) ** 2
        assert 0.9 * N / at_least < row.gain_without < N / at_least, joint


@pytest.mark.parametrize(
    ("model", "gear", "link", "mass"),
    [
        ("lowerleg_stance", "I_gear_tendons", "I_lowerleg", "m_lowerleg"),
        ("upperleg_stance", "I_gear", "I_upperleg", "m_upperleg"),
    ],
)
def test_the_printed_stance_gain_holds_at_one_angle_only(rows, model, gear, link, mass):
    fixed = DRIVE + V[gear] + V[link]
    lifted = (V["m_motors_support"] + V[mass]) * (2 * V["L"]) ** 2
    steepest = max(posture["knee"] for posture in stance_postures())
    here, there = (fixed + lifted * math.sin(a) ** 2 for a in (V["theta_0"], steepest))
    row = of(rows, model, "the lever is")
    assert row.lowest == pytest.approx(here / there - 1, rel=1e-9)
    assert row.highest == pytest.approx(0.0, abs=1e-12)


def test_every_range_contains_what_happens_at_its_own_posture(rows):
    """θ0 is in the standing leg's working range; the ranges were computed apart."""
    assert printed_posture() in stance_postures()
    for row in rows:
        assert row.lowest <= row.highest
        if row.model.endswith("stance"):
            assert row.lowest - 1e-12 <= row.gain_change <= row.highest + 1e-12


@pytest.fixture(scope="module")
def terms():
    return {(n.leg, n.joint, n.term): n for n in neglected()}


def test_gravity_is_the_term_that_counts(terms):
    hips = [posture["hip"] for posture in flight_postures()]
    moment = V["m_upperleg"] * V["l_cm_upperleg"] + V["m_lowerleg_link"] * V["L"]
    J = DRIVE + V["I_gear"] + V["I_upperleg_link"] + V["m_lowerleg_link"] * V["L"] ** 2
    alone = max(abs(moment * V["g"] * math.sin(hip) / J) for hip in hips)
    # The knee's weight acts on the hip through the small coupling.
    assert terms["hanging", "hip", "G"].acceleration == pytest.approx(alone, rel=0.01)
    for joint in ("hip", "knee"):
        assert terms["flying", joint, "G"].acceleration == pytest.approx(0, abs=1e-9)
        assert terms["hanging", joint, "h"].share < 1e-3
    assert terms["standing", "hip", "h"].share < 0.02
    assert terms["standing", "hip", "G"].share > 0.4


def test_shares_are_of_the_nominal_torque(terms):
    term = terms["standing", "hip", "G"]
    torque = DATASHEETS["motor_nominal_torque"].value
    steepest = max(posture["knee"] for posture in stance_postures())
    upper, lower, L = V["l_cm_upperleg"], V["l_cm_lowerleg"], V["L"]
    # The potential is g (2 L m_support + (2 L - l_u) m_u + (L - l_l) m_l) cos θ.
    lifted = 2 * L * V["m_motors_support"] + (2 * L - upper) * V["m_upperleg"]
    lifted += (L - lower) * V["m_lowerleg_link"]
    force = V["g"] * lifted * math.sin(steepest)
    assert term.share == pytest.approx(force / (N * torque), rel=1e-9)


def test_a_standing_leg_falls_and_a_hanging_one_swings():
    poles = weighted_poles()
    assert poles["flying"] == pytest.approx(0, abs=1e-6)
    assert abs(poles["hanging"].real) < 1e-9
    moment = V["m_upperleg"] * V["l_cm_upperleg"] + V["m_lowerleg_link"] * V["L"]
    J = DRIVE + V["I_gear"] + V["I_upperleg_link"] + V["m_lowerleg_link"] * V["L"] ** 2
    swings = math.sqrt(moment * V["g"] * COS / J)
    assert abs(poles["hanging"].imag) == pytest.approx(swings, rel=0.01)
    assert poles["standing"].imag == pytest.approx(0, abs=1e-9)
    assert poles["standing"].real > 0


def bent_leg():
    """Return M and K of the standing leg in hip and knee; the link closes the ring.

    The foot yields by -L (θ1' + φ'), so knee and support follow from the hip alone.
    """
    upper, lower, L = V["l_cm_upperleg"], V["l_cm_lowerleg"], V["L"]
    hip = DRIVE + V["I_gear"] + V["I_upperleg_link"] - V["m_upperleg"] * upper**2
    hip += V["m_motors_support"] * (2 * L * SIN) ** 2 + V["m_lowerleg_link"] * L**2
    hip += V["m_upperleg"] * (((2 * L - upper) * SIN) ** 2 + (upper * COS) ** 2)
    knee = DRIVE + V["I_gear_tendons"] + V["I_lowerleg"]
    both = V["m_lowerleg_link"] * L * lower
    k = CHAPTER_3["m_eq"].value * (2 * math.pi * CHAPTER_3["f_1"].value) ** 2
    return np.array([[hip, both], [both, knee]]), k * L**2 * np.ones((2, 2))


def test_the_link_bends_against_both_drives():
    M, K = bent_leg()
    squared = np.linalg.eigvals(np.linalg.solve(M, K)).real
    for row in bending():
        assert row.resonance == pytest.approx(math.sqrt(squared.max()), rel=1e-9)
        i = ("hip", "knee").index(row.joint)
        response = np.linalg.inv(K - row.crossover**2 * M)[i]
        rigid = row.crossover**2 * standing_inertia(2)
        # Bearings are negligible here, which by hand they are left out for.
        assert row.alone == pytest.approx(abs(response[i]) * rigid - 1, abs=1e-5)
        pair = abs(response[i] - response[1 - i]) * rigid / 2 - 1
        assert row.opposed == pytest.approx(pair, abs=1e-5)


def test_the_page_shows_the_tables_as_they_are():
    page = PAGE.read_text(encoding="utf-8")
    for line in cost_tables.as_text().splitlines():
        assert line in page


def test_other_parameters_give_other_costs():
    """Nothing is typed in: a support ten times heavier makes the drives matter less."""
    heavy = RECONCILED.with_values({"m_motors_support": 10 * V["m_motors_support"]})
    row = of(decoupling.assumptions(heavy), "lowerleg_stance", "the other motor has")
    ten = 9 * V["m_motors_support"] * (2 * V["L"] * SIN) ** 2
    expected = (standing_inertia(1) + ten) / (standing_inertia(2) + ten) - 1
    assert row.gain_change == pytest.approx(expected, rel=1e-9)
    assert np.isfinite(row.pole_change)
