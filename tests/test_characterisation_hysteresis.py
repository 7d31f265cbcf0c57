"""The torque sensor in three branches: simulated, identified, and where it jumps."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.hysteresis_fit import identify_hysteresis, reversals
from flegx_models.characterisation.sensor_line import Line
from flegx_models.characterisation.torque_hysteresis import (
    FixedWidth,
    Hysteresis,
    Transition,
    UntilMet,
)
from flegx_models.parameters_chapter3 import CHAPTER_3

FloatArray = NDArray[np.float64]
P = CHAPTER_3.values_by_name()
TURNS = (0.0, 1.0, -1.0, 1.2, -0.3, 0.8, -1.2, 0.4, -0.8, 0.0)


def hip(transition: Transition) -> Hysteresis:
    return Hysteresis(
        rising=Line(P["hip_slope_rising"], P["hip_offset_rising"]),
        falling=Line(P["hip_slope_falling"], P["hip_offset_falling"]),
        transition_slope=P["hip_slope_transition"],
        transition=transition,
    )


def ramps(*corners: float, per_volt: int = 300) -> FloatArray:
    parts = [
        np.linspace(a, b, round(abs(b - a) * per_volt), endpoint=False)
        for a, b in pairwise(corners)
    ]
    return np.concatenate([*parts, [corners[-1]]])


def test_the_three_branches_follow_each_other() -> None:
    model = hip(UntilMet())
    y = model.torque([-1.0, 0.0, 0.1, 0.0, -0.2, -0.9, -0.8, 0.5])
    assert y[1] == pytest.approx(P["hip_offset_rising"])
    at_turn = P["hip_slope_rising"] * 0.1 + P["hip_offset_rising"]
    assert y[3] == pytest.approx(at_turn + 54 * 0.1)  # the transition
    assert y[5] == pytest.approx(model.falling(-0.9))  # it has met the line
    assert y[6] == pytest.approx(y[5] - 54 * 0.1)
    assert y[7] == pytest.approx(model.rising(0.5))


def test_until_met_is_continuous_and_stays_between_the_lines() -> None:
    model = hip(UntilMet())
    u = ramps(*TURNS, per_volt=4000)
    y = model.torque(u)
    assert np.max(np.abs(np.diff(y) / np.diff(u))) < 54 + 1e-6
    assert np.all(y >= model.rising(u) - 1e-9)
    assert np.all(y <= model.falling(u) + 1e-9)


def test_the_torque_depends_on_the_way_and_not_on_the_speed() -> None:
    for transition in (UntilMet(), FixedWidth(P["V_transition"])):
        model = hip(transition)
        slow, fast = ramps(*TURNS, per_volt=400), ramps(*TURNS, per_volt=40)
        np.testing.assert_allclose(model.torque(slow)[::10], model.torque(fast))


def test_the_printed_hip_sensor_jumps_where_its_transition_ends() -> None:
    """0.2 V at -54 N·m/V bridge the lines at one voltage only, about -0.6 V."""
    model = hip(FixedWidth(P["V_transition"]))
    assert model.jump(-0.6, from_rising=True) == pytest.approx(0.0, abs=0.01)
    assert model.jump(0.0, from_rising=True) == pytest.approx(1.33, abs=0.005)
    assert model.jump(0.0, from_rising=False) == pytest.approx(-1.77, abs=0.005)
    u = ramps(-1.0, 0.5, -0.5, per_volt=2000)
    steps = np.diff(model.torque(u))
    largest = int(np.argmax(np.abs(steps)))
    assert abs(u[largest] - 0.3) < 2e-3
    assert steps[largest] == pytest.approx(model.jump(0.5, from_rising=True), abs=0.06)
    assert hip(UntilMet()).jump(0.0, from_rising=True) == 0.0


@pytest.mark.parametrize("transition", [UntilMet(), FixedWidth(0.2)])
def test_without_noise_the_branches_are_found_exactly(transition: Transition) -> None:
    model = hip(transition)
    u = ramps(*TURNS)
    fit = identify_hysteresis(
        u, model.torque(u), width=0.2, voltage_noise=1e-6, transition=transition
    )
    assert len(fit.reversals) == len(TURNS) - 2
    found = fit.model
    for line, true in ((found.rising, model.rising), (found.falling, model.falling)):
        assert line.slope == pytest.approx(true.slope, rel=1e-8)
        assert line.offset == pytest.approx(true.offset, rel=1e-7)
    assert found.transition_slope == pytest.approx(-54.0, rel=1e-8)
    assert fit.rms < 1e-8
    assert fit.single_line_rms > 1.0


@pytest.mark.parametrize("transition", [UntilMet(), FixedWidth(0.2)])
def test_with_noise_the_truth_lies_within_the_standard_deviations(
    transition: Transition,
) -> None:
    model = hip(transition)
    u = ramps(*TURNS, per_volt=150)
    true = model.torque(u)
    rng = np.random.default_rng(1)
    pulls = []
    for _ in range(12):
        fit = identify_hysteresis(
            u,
            true + rng.normal(0, 0.3, len(u)),
            width=0.2,
            voltage_noise=1e-6,
            transition=transition,
        )
        found = fit.model
        pulls += [
            (found.rising.slope - model.rising.slope) / fit.slope_std[0],
            (found.falling.slope - model.falling.slope) / fit.slope_std[1],
            (found.rising.offset - model.rising.offset) / fit.offset_std[0],
            (found.falling.offset - model.falling.offset) / fit.offset_std[1],
            (found.transition_slope + 54) / fit.transition_std,
        ]
        assert fit.rms == pytest.approx(0.3, rel=0.15)
    assert np.std(pulls) == pytest.approx(1.0, abs=4 / np.sqrt(2 * 60))


def test_noise_of_the_voltage_is_no_reversal() -> None:
    model = hip(UntilMet())
    u = ramps(*TURNS)
    rng = np.random.default_rng(3)
    noisy = u + rng.uniform(-0.01, 0.01, len(u))
    fit = identify_hysteresis(
        noisy,
        model.torque(u) + rng.normal(0, 0.2, len(u)),
        width=0.2,
        voltage_noise=0.01,
    )
    assert len(fit.reversals) == len(TURNS) - 2
    np.testing.assert_allclose(u[list(fit.reversals)], TURNS[1:-1], atol=0.015)
    assert fit.model.rising.slope == pytest.approx(model.rising.slope, rel=0.005)
    assert fit.model.falling.offset == pytest.approx(model.falling.offset, abs=0.1)
    assert fit.model.transition_slope == pytest.approx(-54, rel=0.03)


def test_a_sensor_with_nearly_parallel_lines_as_at_the_knee() -> None:
    knee = Hysteresis(
        rising=Line(P["knee_slope_rising"], P["knee_offset_rising"]),
        falling=Line(P["knee_slope_falling"], P["knee_offset_falling"]),
        transition_slope=30.0,
    )
    u = ramps(0.0, 0.8, 0.1, 0.9, 0.0, 0.6, 0.2, per_volt=400)
    fit = identify_hysteresis(u, knee.torque(u), width=0.05, voltage_noise=1e-6)
    assert fit.model.rising.slope == pytest.approx(P["knee_slope_rising"], rel=1e-6)
    assert fit.model.transition_slope == pytest.approx(30.0, rel=1e-6)


def test_reversals_need_more_than_the_threshold() -> None:
    u = np.array([0.0, 1.0, 0.95, 1.5, 1.0, 0.0, 0.3])
    assert reversals(u, threshold=0.1) == (3, 5)
    assert reversals(u, threshold=0.4) == (3,)
    assert reversals(u, threshold=0.01) == (1, 2, 3, 5)


def test_refuses_a_sweep_in_one_direction() -> None:
    u = np.linspace(0, 1, 50)
    with pytest.raises(CharacterisationError, match="falling line"):
        identify_hysteresis(u, -44 * u, width=0.2, voltage_noise=1e-3)
    with pytest.raises(CharacterisationError, match="torques"):
        identify_hysteresis(u, u[:-1], width=0.2, voltage_noise=1e-3)


def test_refuses_a_transition_that_leads_away_from_its_line() -> None:
    model = Hysteresis(
        rising=Line(48.0, -2.5), falling=Line(47.8, -0.6), transition_slope=70.0
    )
    with pytest.raises(CharacterisationError, match="leads away from the line of 48"):
        model.torque([0.0, 0.5, 0.2])
