"""Motor, gravity compensation, loops and controllers of sections 4.4 to 5.2."""

import cmath
import math
import re
from pathlib import Path

import numpy as np
import pytest
import sympy
from scipy.signal import cont2discrete, lfilter

from bondgraph import (
    BondGraphError,
    FitSettings,
    FitStatus,
    Hold,
    Recording,
    WholeRecordings,
    bind_to,
    derive,
    fit,
    linearise,
)
from flegx_models.controllers import (
    MODELS,
    VERSIONS,
    controller,
    corrected_reading,
    evaluated,
    printed_figures,
    printed_loop,
    printed_reading,
)
from flegx_models.gains import derived
from flegx_models.gravity import (
    CASES,
    derived_feed_forward,
    feed_forward,
    printed_feed_forward,
)
from flegx_models.jump.leg_graph import leg_parameters
from flegx_models.loop_numerators import (
    numerator,
    torque_constants_of_the_numerators,
)
from flegx_models.models import lowerleg_stance
from flegx_models.motor import black_box, driven_motor, motor_with
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_control import CHOSEN, CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.published import PUBLISHED

PAGE = (Path(__file__).parent.parent / "docs" / "jump.md").read_text(encoding="utf-8")
VALUES = CONTROL.values_by_name()
CHOICES = CHOSEN.values_by_name()
BOX = {
    "k_driver": VALUES["k_driver"],
    "zero": VALUES["zero_driver"],
    "fast_pole": VALUES["fast_pole_driver"],
    "slow_pole": VALUES["slow_pole_driver"],
}


def square_wave(rate, samples, period, *, seed):
    """Return time, duty cycle and current of eq. 4.36, exact between held samples."""
    top = np.array([1 / BOX["zero"], 1.0]) * BOX["k_driver"]
    bottom = np.polymul([1 / BOX["fast_pole"], 1.0], [1 / BOX["slow_pole"], 1.0])
    b, a, _ = cont2discrete((top, bottom), 1 / rate, method="zoh")
    time = np.arange(samples) / rate
    duty = np.where((time % period) < period / 2, 20.0, -20.0)
    noise = np.random.default_rng(seed).normal(size=samples) * CHOICES["current_noise"]
    return time, duty, lfilter(b.ravel(), a, duty) + noise


def identified(rate, samples, period):
    wrong = {"k_driver": 0.25, "zero": 4e3, "fast_pole": 1e6, "slow_pole": 3.5e3}
    graph = driven_motor(motor_with(wrong)).finish()
    time, duty, current = square_wave(rate, samples, period, seed=3)
    channels = {"duty": (duty, "A"), "current": (current, "A")}
    recording = bind_to(graph, Recording.from_arrays("bench", time, channels))
    settings = FitSettings(hold=Hold.ZERO, horizon=WholeRecordings())
    result = fit(graph, [recording], settings=settings)
    found = {e.name: e.value for e in result.estimates}
    return result, black_box({**found, "L_motor": graph.parameters["L_motor"].value})


def test_the_motor_graph_is_the_printed_black_box():
    graph = driven_motor().finish()
    values = graph.parameters.values_by_name()
    transfer = linearise(derive(graph)).transfer_function("current", "duty")
    (zero,) = transfer.zeros(values)
    slow, fast = sorted(transfer.poles(values), key=abs)
    assert zero == pytest.approx(-BOX["zero"])
    assert slow == pytest.approx(-BOX["slow_pole"])
    assert fast == pytest.approx(-BOX["fast_pole"])
    at_rest = transfer.gain_at(values) * zero.real / (slow * fast).real * -1
    assert at_rest == pytest.approx(BOX["k_driver"])


def test_square_waves_at_a_bench_rate_do_not_show_the_fast_pole():
    result, box = identified(CHOICES["sampling_bench"], 2000, 0.01)
    assert result.status is FitStatus.CONVERGED
    (sentence,) = result.unidentifiable
    assert all(name in sentence for name in ("K_p", "K_i", "R_motor"))
    assert box["k_driver"] == pytest.approx(BOX["k_driver"], rel=1e-3)
    assert box["slow_pole"] == pytest.approx(BOX["slow_pole"], rel=0.01)
    assert box["zero"] == pytest.approx(BOX["zero"], rel=0.01)


def test_square_waves_sampled_fast_enough_give_all_four_numbers():
    result, box = identified(CHOICES["sampling_fast"], 20000, 4e-4)
    assert result.status is FitStatus.CONVERGED
    assert not result.unidentifiable
    for name, value in BOX.items():
        assert box[name] == pytest.approx(value, rel=0.01), name


def test_the_printed_zero_does_not_follow_from_the_printed_winding():
    values = driven_motor().finish().parameters.values_by_name()
    table = DATASHEETS.values_by_name()["motor_resistance"]
    assert values["R_motor"] / table > 30
    K_p = values["K_p"] + values["R_motor"] - table  # keeps the sum of the poles
    assert values["K_i"] / K_p < BOX["slow_pole"] < BOX["zero"]


@pytest.mark.parametrize("case", CASES)
def test_gravity_compensation_from_the_graph_is_the_printed_one(case):
    derived, printed = feed_forward(case, leg_parameters()), printed_feed_forward(case)
    assert derived.hip == pytest.approx(printed.hip, abs=0.005)
    assert derived.knee == pytest.approx(printed.knee, abs=0.005)


def test_gravity_compensation_in_symbols_is_the_formula_of_the_thesis():
    def is_zero(difference):
        named = {s: sympy.Symbol(s.name) for s in difference.free_symbols}
        return sympy.simplify(difference.xreplace(named)) == 0

    g, L, m, m_ul, m_ll, l_ul, l_ll, m_c = sympy.symbols(
        "g L m_motors_support m_upperleg m_lowerleg_link l_cm_upperleg l_cm_lowerleg "
        "m_counterweight"
    )
    hip, knee = map(sympy.sin, sympy.symbols("q_hip q_knee"))
    printed = {
        "flight": ((m_ul * l_ul + m_ll * L) * g, m_ll * g * l_ll),
        "stance": (
            -(m * L + m_ul * (L - l_ul)) * g,
            -(m * L + m_ul * L + m_ll * (L - l_ll)) * g,
        ),
        "counterweight": (
            -((m - m_c) * L + m_ul * (L - l_ul)) * g,
            -((m - m_c) * L + m_ul * L + m_ll * (L - l_ll)) * g,
        ),
    }
    for case, (at_hip, at_knee) in printed.items():
        derived = derived_feed_forward(case)
        assert is_zero(derived[0] - at_hip * hip), case
        assert is_zero(derived[1] - at_knee * knee), case


@pytest.mark.parametrize("model", ["lowerleg_flight", "lowerleg_stance"])
def test_the_lower_legs_loops_reproduce_with_two_named_corrections(model):
    reading = corrected_reading()
    assert len(reading.corrections) == 2
    derived, printed = printed_loop(model).figures, printed_figures(model)
    assert derived.crossover == pytest.approx(printed.crossover, abs=0.015)
    assert derived.turnover == pytest.approx(printed.turnover, abs=0.3)
    assert abs(math.degrees(derived.phase_margin - printed.phase_margin)) < 0.3


@pytest.mark.parametrize("model", ["upperleg_flight", "upperleg_stance"])
def test_the_upper_legs_phase_crossovers_follow_from_no_printed_controller(model):
    printed = printed_figures(model)
    for version in VERSIONS:
        derived = printed_loop(model, version).figures
        assert derived.turnover < 0.7 * printed.turnover
    designed = printed_loop(model).figures
    assert designed.crossover == pytest.approx(printed.crossover, abs=0.05)


@pytest.mark.parametrize("model", MODELS)
def test_the_loops_as_printed_are_unstable(model):
    assert printed_loop(model, reading=printed_reading()).figures.phase_margin < 0


def around(loop, omega):
    """Return eq. 5.10 to 5.24 once around at s = jω, as the thesis writes them."""
    s, lead, cutoff = 1j * omega, loop.lead, loop.filter.cutoff
    train = loop.numerator * (s + loop.zero) / (s * (s + loop.friction_pole))
    driven = train / ((s + loop.fast_pole) * (s + loop.slow_pole))
    second = 1 + loop.filter.damping_term * s / cutoff + (s / cutoff) ** 2
    return lead.gain * (s + lead.zero) / (1 + s / lead.pole) * driven / second**2


@pytest.mark.parametrize("reading", [printed_reading, corrected_reading])
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_figures_are_those_of_the_written_formula(model, version, reading):
    loop = printed_loop(model, version, reading())
    figures = loop.figures
    there = around(loop, figures.crossover)
    assert abs(there) == pytest.approx(1.0, rel=1e-8)
    assert cmath.phase(-there) == pytest.approx(figures.phase_margin, abs=1e-9)
    turned = around(loop, figures.turnover)
    assert turned.real < 0
    assert turned.imag == pytest.approx(0.0, abs=1e-8 * abs(turned))
    # The first of each: the gain falls, and the phase does not reach -180° before.
    omega = np.geomspace(1e-3, figures.turnover, 400)[:-1]
    assert np.all(np.diff(np.abs(around(loop, omega))) < 0)
    assert np.all(np.unwrap(np.angle(around(loop, omega))) > -np.pi)


def test_all_twelve_controllers_are_evaluated_with_the_friction_they_are_for():
    rows = {(model, version): loop for model, version, loop in evaluated()}
    assert set(rows) == {(m, v) for m in MODELS for v in VERSIONS}
    margins = {k: math.degrees(loop.figures.phase_margin) for k, loop in rows.items()}
    assert all(60 < margin < 80 for margin in margins.values())
    for model in MODELS:
        tuned = rows[model, "tuned"]
        assert tuned.friction_pole == tuned.lead.zero
        # The tuned gains are higher, and so are the crossovers.
        designed = rows[model, "printed"].figures.crossover
        assert 1.0 < tuned.figures.crossover / designed < 1.2
    # Where the designed zero is off the pole, its multiple does not keep the margin.
    changes = {m: margins[m, "modified"] - margins[m, "printed"] for m in MODELS}
    assert changes.pop("upperleg_flight") > 9
    assert all(abs(change) < 1.2 for change in changes.values())


def test_the_page_shows_the_twelve_loops_as_they_are():
    for model, version, loop in evaluated():
        figures = loop.figures
        margin = f"{math.degrees(figures.phase_margin):.2f}°"
        row = (
            rf"\| {model.replace('_', ', ')} \| {version} \| {loop.friction_pole:.2f} "
            rf"\| {figures.crossover:.2f}[^|]* \| {margin}"
        )
        assert re.search(row, PAGE), (model, version)


@pytest.mark.parametrize("model", ["lowerleg_flight", "lowerleg_stance"])
def test_the_modified_zero_keeps_the_loop_where_it_rides_on_the_friction(model):
    growth = VALUES["friction_growth"]
    designed = printed_loop(model)
    grown = printed_loop(model, "modified").rubbed(growth * designed.friction_pole)
    assert designed.figures.crossover == pytest.approx(
        grown.figures.crossover, rel=0.01
    )
    change = grown.figures.phase_margin - designed.figures.phase_margin
    assert abs(math.degrees(change)) < 1.0


def test_all_four_numerators_follow_from_one_torque_constant():
    low, high = torque_constants_of_the_numerators()
    assert low <= 0.042 <= high
    table = DATASHEETS.find("K_m")
    assert table.value - table.rounding > high  # not Table 2.1's
    for printed in PUBLISHED:
        row = CONTROL.find(f"numerator_{printed.model}")
        assert abs(numerator(printed.gain, 0.042) - row.value) <= row.rounding
        assert numerator(printed.gain) - row.value > row.rounding


def test_the_counterweight_adds_inertia_where_the_thesis_takes_mass_away():
    mass = RECONCILED["m_motors_support"].value
    hung = VALUES["m_counterweight"]
    gains = []
    for change in (-hung, 0.0, hung):
        parameters = RECONCILED.with_values({"m_motors_support": mass + change})
        gains.append(derived(lowerleg_stance(parameters))[0])
    lighter, plain, heavier = gains
    # For the same loop the controller's gain goes with the inverse of the plant's.
    assert plain / lighter == pytest.approx(0.8, abs=0.01)
    assert plain / heavier == pytest.approx(1.2, abs=0.01)


def test_unknown_names_are_refused():
    with pytest.raises(BondGraphError, match="no printed controller of 'ankle'"):
        controller("ankle")
    with pytest.raises(BondGraphError, match="'water'"):
        printed_feed_forward("water")
