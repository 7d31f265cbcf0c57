"""Margins and peaks with several crossovers, delays, integrators and instability."""

import math
from functools import cache

import control
import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import LoopShapingError
from bondgraph.loading import load_model
from bondgraph.loopshaping.loop import Loop, to_python_control, zero_pole_gain
from bondgraph.loopshaping.measures import Stability, measure
from bondgraph.loopshaping.realisation import closed_loop_poles
from bondgraph.loopshaping.step_response import step_response
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain
from bondgraph.numeric.state_space import state_space
from bondgraph.structure.signals import parameter_symbol

PLANTS = 100


def roots(generator, count, right):
    """Return real roots and pairs; about a share `right` of them unstable."""
    found = []
    while len(found) < count:
        size = 10 ** generator.uniform(-1.5, 2.5)
        side = 1 if generator.random() < right else -1
        if count - len(found) >= 2 and generator.random() < 0.5:
            angle = math.acos(generator.uniform(0.02, 1.0))
            root = size * complex(side * math.cos(angle), math.sin(angle))
            found += [root, root.conjugate()]
        else:
            found.append(complex(side * size))
    return found


@cache
def random_loop(seed):
    """Return a stable or unstable loop, with integrators and delays in a third each."""
    generator = np.random.default_rng(seed)
    poles = roots(generator, generator.integers(1, 6), 0.15)
    zeros = roots(generator, generator.integers(0, len(poles) + 1), 0.15)[: len(poles)]
    integrators = [0j] * int(generator.choice([0, 0, 1, 2]))
    system = ZeroPoleGain(
        zeros=tuple(zeros),
        poles=(*poles, *integrators),
        delay=float(generator.choice([0.0, 10 ** generator.uniform(-3, -0.5)])),
    )
    if system.relative_degree == 0:  # behind a delay that would be a neutral loop
        system *= ZeroPoleGain(poles=(-30.0,), gain=30.0)
    middle = 10 ** generator.uniform(-0.5, 1.5)
    # A loop that is still above one at 10⁴ rad/s behind a delay winds for ever.
    size = np.abs(system.response(np.array([middle, 1e4]))).max()
    sign = -1 if generator.random() < 0.1 else 1
    return system.times(sign * 10 ** generator.uniform(-0.4, 0.4) / size)


def sweep(system, low=1e-4, high=1e5, points=150_001):
    omega = np.geomspace(low, high, points)
    return omega, system.response(omega)


def changes(values):
    return np.flatnonzero(np.diff(np.sign(values)) != 0)


@pytest.mark.parametrize("seed", range(PLANTS))
def test_every_figure_agrees_with_a_dense_sweep(seed):
    system = random_loop(seed)
    measured = measure(system, step=False)
    omega, response = sweep(system)
    seen = changes(np.log(np.abs(response)))
    found = np.array([g.omega for g in measured.gain_crossovers])
    inside = found[(found > omega[0]) & (found < omega[-1])]
    assert len(seen) == len(inside)
    assert ((omega[seen] <= inside) & (inside <= omega[seen + 1])).all()
    for crossover in measured.gain_crossovers:
        angle = np.angle(system.response(np.array([crossover.omega]))[0], deg=True)
        apart = (crossover.phase_margin - 180 - angle + 180) % 360 - 180
        assert apart == pytest.approx(0, abs=1e-6)
    # The negative real axis is crossed where Im changes its sign and Re is negative.
    seen = changes(response.imag)
    seen = seen[(response.real[seen] < 0) & (response.real[seen + 1] < 0)]
    if system.delay:
        corner = max(abs(r) for r in (*system.zeros, *system.poles))
        seen = seen[(np.abs(response[seen]) > 2e-3) & (omega[seen] < 30 * corner)]
    found = [p.omega for p in measured.phase_crossovers]
    for k in seen:
        assert any(omega[k] * 0.999999 <= w <= omega[k + 1] * 1.000001 for w in found)
    if not system.delay:
        assert sum(omega[0] < w < omega[-1] for w in found) == len(seen)
    for crossover in measured.phase_crossovers:
        there = system.response(np.array([crossover.omega]))[0]
        assert there * crossover.gain_margin == pytest.approx(-1, abs=1e-6)
    for peak, shape in (
        (measured.sensitivity, lambda L: np.abs(1 / (1 + L))),
        (measured.complementary, lambda L: np.abs(L / (1 + L))),
    ):
        # at least what the sweep saw, and attained where it is said to be
        assert peak.value >= shape(response).max() * (1 - 1e-9)
        place = np.array([min(max(peak.omega, 1e-9), 1e12)])
        attained = shape(system.response(place))[0]
        assert attained == pytest.approx(peak.value, rel=1e-5)
    count = measured.unstable_poles
    assert winding(system) == count if count is not None else winding(system) > 500
    if not system.delay:
        right = sum(p.real > 0 for p in measured.closed_loop_poles)
        assert measured.unstable_poles == right


def winding(system):
    """Count unstable closed-loop poles by unwrapping 1 + L on a fine grid."""
    _, response = sweep(system, 1e-6, 1e6, 400_001)
    angle = np.unwrap(np.angle(1 + response))
    turned = angle[-1] - angle[0]
    axis = sum(p.real == 0 for p in system.poles)
    right = sum(p.real > 0 for p in system.poles)
    return round(right - (2 * turned - math.pi * axis) / (2 * math.pi))


@pytest.mark.parametrize("seed", [s for s in range(60) if not random_loop(s).delay])
def test_margins_agree_with_python_control(seed):
    system = random_loop(seed)
    measured = measure(system, step=False)
    theirs = control.stability_margins(
        control.ss2tf(to_python_control(system)), returnall=True
    )
    ours = [g.omega for g in measured.gain_crossovers]
    # Polynomial roots lose digits; what it finds must be ours, and nothing more.
    np.testing.assert_allclose(ours, theirs[4], rtol=1e-3)
    for omega, margin in zip(theirs[3], theirs[0], strict=True):
        if 1e-3 < omega < 1e4:
            near = min(measured.phase_crossovers, key=lambda p: abs(p.omega - omega))
            assert near.omega == pytest.approx(omega, rel=1e-2)
            assert near.gain_margin == pytest.approx(margin, rel=1e-2)
    assert measured.modulus_margin <= min(theirs[2], default=1.0) * 1.001


def test_three_gain_crossovers_are_all_found():
    # a resonance lifts the gain above one again (Åström and Murray's textbook case)
    bump = ZeroPoleGain(poles=(0, -0.01 + 10j, -0.01 - 10j), gain=100.0)
    measured = measure(bump.times(0.5), step=False)
    assert len(measured.gain_crossovers) == 3
    assert measured.stability is Stability.UNSTABLE
    assert measured.unstable_poles == 2


def test_an_integrator_with_a_delay_has_its_textbook_margins():
    # L = K exp(-sT)/s: ω_c = K, φ_m = 90° - K T, ω_180 = π/(2T), GM = π/(2 K T)
    K, T = 2.0, 0.25
    measured = measure(ZeroPoleGain(poles=(0,), gain=K, delay=T))
    (crossover,) = measured.gain_crossovers
    assert crossover.omega == pytest.approx(K, rel=1e-12)
    assert crossover.phase_margin == pytest.approx(90 - math.degrees(K * T), rel=1e-12)
    assert crossover.delay_margin == pytest.approx(math.pi / 2 / K - T, rel=1e-12)
    assert measured.phase_crossovers[0].omega == pytest.approx(math.pi / 2 / T)
    assert measured.gain_margin == pytest.approx(math.pi / (2 * K * T), rel=1e-12)
    assert measured.stability is Stability.STABLE


@pytest.mark.parametrize(("share", "stable"), [(0.999, True), (1.001, False)])
def test_the_delay_margin_is_where_stability_ends(share, stable):
    rational = ZeroPoleGain(zeros=(-1,), poles=(0, 0, -8), gain=24.0)
    margin = measure(rational, step=False).delay_margin
    late = zero_pole_gain(rational, delay=share * margin)
    assert measure(late, step=False).stable is stable


@given(
    gain=st.floats(0.05, 20),
    lag=st.floats(0.01, 10),
    delay=st.sampled_from([0.0, 1e-3, 0.1]) | st.floats(0.05, 2.0),
)
@settings(max_examples=40, deadline=None)
def test_margins_mark_the_edge_of_stability(gain, lag, delay):
    system = ZeroPoleGain(poles=(0, -lag, -4.0), gain=gain, delay=delay)
    measured = measure(system, step=False)
    edge = measured.gain_margin if measured.stable else measured.gain_reduction_margin
    assert measure(system.times(edge * 0.999), step=False).stable
    assert not measure(system.times(edge * 1.001), step=False).stable


def test_an_unstable_plant_has_a_least_gain():
    plant = ZeroPoleGain(zeros=(-4,), poles=(1, -10), gain=10.0)
    measured = measure(plant)
    assert measured.stable
    assert 0 < measured.gain_reduction_margin < 1
    assert not measure(plant.times(measured.gain_reduction_margin * 0.99)).stable


def test_a_cancelled_unstable_pole_stays_unstable():
    hidden = ZeroPoleGain(zeros=(2,), poles=(2, -1), gain=3.0)
    measured = measure(hidden)
    assert measured.unstable_poles == 1
    assert any(p == pytest.approx(2) for p in measured.closed_loop_poles)


def test_a_loop_through_minus_one_is_at_the_limit():
    # L = 8 / (s + 1)^3 is -1 at ω = √3
    measured = measure(ZeroPoleGain(poles=(-1, -1, -1), gain=8.0))
    assert measured.stability is Stability.MARGINAL
    assert measured.step is None


@pytest.mark.parametrize("seed", range(12))
def test_a_sampled_loop_agrees_with_its_own_sweep_and_poles(seed):
    system = random_loop(seed)
    period = 0.02
    rational = zero_pole_gain(system)
    discrete = control.sample_system(
        to_python_control(ZeroPoleGain(**parts(rational))), period, method="zoh"
    )
    sampled = zero_pole_gain(discrete)
    measured = measure(sampled, step=False)
    omega = np.linspace(1e-4, math.pi / period * (1 - 1e-9), 400_001)
    response = sampled.response(omega)
    seen = changes(np.log(np.abs(response)))
    assert len(seen) == sum(g.omega > 1e-4 for g in measured.gain_crossovers)
    largest = np.abs(1 / (1 + response)).max()
    assert largest * (1 - 1e-9) <= measured.sensitivity.value <= largest * 1.01
    closed = np.abs(control.feedback(discrete, 1).poles())
    assert measured.unstable_poles == (closed > 1).sum()


@pytest.mark.parametrize(
    ("system", "unstable"),
    [
        # undamped poles: 1 + L by Routh, or by np.roots where it is longer
        (ZeroPoleGain(zeros=(-1,), poles=(1j, -1j, -20), gain=40.0), 0),
        (ZeroPoleGain(zeros=(1,), poles=(1j, -1j, -20), gain=100.0), 1),
        (ZeroPoleGain(poles=(1j, -1j, -20), gain=10.0), 2),
        (ZeroPoleGain(zeros=(-0.1, -0.2, -0.3), poles=(1j, -1j) * 2, gain=4.0), 2),
        (ZeroPoleGain(zeros=(2j, -2j), poles=(0, -1, -3), gain=2.0), 0),
        (ZeroPoleGain(zeros=(-1,), poles=(0, 0, 0), gain=1.0), 2),
        (ZeroPoleGain(zeros=(-1, -1), poles=(0, 0, 0), gain=5.0), 0),
        (ZeroPoleGain(gain=0.5), 0),
        # sampled with a pole at -1: 1 + 0.5/(z + 1) has its root at -1.5
        (ZeroPoleGain(poles=(-1,), gain=0.5, period=0.1), 1),
        (ZeroPoleGain(poles=(-1,), gain=-0.5, period=0.1), 0),
        (ZeroPoleGain(zeros=(-1,), poles=(1, 0.5), gain=0.05, period=0.1), 0),
    ],
    ids=str,
)
def test_poles_on_the_edge_are_counted_as_they_move(system, unstable):
    measured = measure(system)
    assert measured.unstable_poles == unstable
    top = system.gain * np.poly(system.zeros) if system.zeros else [system.gain]
    closed = np.roots(np.polyadd(np.poly(system.poles), top)) if system.poles else []
    limit = 0.0 if system.period is None else 1.0
    size = np.real(closed) if system.period is None else np.abs(closed)
    assert (np.asarray(size) > limit).sum() == unstable
    assert len(measured.closed_loop_poles) == len(closed)
    for pole in measured.closed_loop_poles:
        assert np.abs(closed - pole).min() < 1e-6


def test_a_static_loop_through_minus_one_has_no_answer_to_a_step():
    with pytest.raises(LoopShapingError, match="no solution"):
        closed_loop_poles(ZeroPoleGain(gain=-1.0))
    assert measure(ZeroPoleGain(gain=-1.0)).stability is Stability.MARGINAL


def test_a_loop_that_washes_out_has_no_step_figures():
    measured = measure(ZeroPoleGain(zeros=(0,), poles=(-1, -2), gain=5.0))
    assert measured.stable
    assert measured.step is None
    assert measured.bandwidth is None


def test_a_delay_far_beyond_the_crossover_is_unstable_without_a_count():
    fast = ZeroPoleGain(poles=(0,), gain=1e6, delay=0.1)
    measured = measure(fast)
    assert measured.stability is Stability.UNSTABLE
    assert measured.unstable_poles is None


def parts(system):
    return {"zeros": system.zeros, "poles": system.poles, "gain": system.gain}


def test_a_sampled_delay_is_a_pole_at_zero():
    slow = ZeroPoleGain(poles=(1,), gain=0.4, period=0.1)
    late = ZeroPoleGain(poles=(1,), gain=0.4, delay=0.2, period=0.1)
    spelled = ZeroPoleGain(poles=(1, 0, 0), gain=0.4, period=0.1)
    assert measure(late).phase_margin == pytest.approx(measure(spelled).phase_margin)
    # deadbeat algebra: 1 + 0.4/(z - 1) has its pole at 0.6
    assert measure(slow).closed_loop_poles == (pytest.approx(0.6),)
    lag = math.degrees(0.2 * measure(late).crossover)
    assert measure(slow).phase_margin - lag == pytest.approx(measure(late).phase_margin)


@pytest.mark.parametrize("damping", [0.2, 0.6, 0.9])
def test_the_second_order_prototype_has_its_textbook_figures(damping):
    wn = 3.0
    measured = measure(ZeroPoleGain(poles=(0, -2 * damping * wn), gain=wn**2))
    figures = measured.step
    root = math.sqrt(1 - damping**2)
    overshoot = 100 * math.exp(-math.pi * damping / root)
    assert figures.overshoot == pytest.approx(overshoot, rel=1e-4)
    assert figures.peak_time == pytest.approx(math.pi / (wn * root), rel=1e-4)
    inner = 1 - 2 * damping**2
    bandwidth = wn * math.sqrt(inner + math.sqrt(inner**2 + 1))
    assert measured.bandwidth == pytest.approx(bandwidth, rel=1e-9)
    if damping < math.sqrt(0.5):
        peak = 1 / (2 * damping * root)
        assert measured.complementary.value == pytest.approx(peak, rel=1e-9)
    assert figures.steady_state_error == pytest.approx(0, abs=1e-12)


def test_a_proportional_loop_keeps_an_error():
    measured = measure(ZeroPoleGain(poles=(-1,), gain=4.0))
    assert measured.step.steady_state_error == pytest.approx(0.2)
    # closed loop 4/(s + 5): 10 to 90 % takes ln 9 / 5, 2 % takes ln 50 / 5
    assert measured.step.rise_time == pytest.approx(math.log(9) / 5, rel=1e-3)
    assert measured.step.settling_time == pytest.approx(math.log(50) / 5, rel=1e-3)


def test_a_delayed_step_response_follows_the_method_of_steps_by_hand():
    # ẏ = 1 - y(t - T) with L = exp(-sT)/s, delay in the feedback branch:
    # y = t until T, then y = t - (t - T)²/2 until 2 T
    T = 0.5
    loop = Loop(
        plant=ZeroPoleGain(poles=(0,), gain=1.0), feedback=ZeroPoleGain(delay=T)
    )
    response = step_response(loop, scale=1.0)
    t, y = response.time, response.output
    first, second = t <= T, (t > T) & (t <= 2 * T)
    np.testing.assert_allclose(y[first], t[first], atol=1e-12)
    by_hand = t[second] - (t[second] - T) ** 2 / 2
    np.testing.assert_allclose(y[second], by_hand, atol=1e-9)


def test_a_delay_in_front_shifts_the_answer():
    plant = ZeroPoleGain(poles=(0, -5.0), gain=5.0)
    front = Loop(plant=zero_pole_gain(plant, delay=0.1))
    back = Loop(plant=plant, feedback=ZeroPoleGain(delay=0.1))
    a, b = (step_response(x, scale=1.0) for x in (front, back))
    moved = np.interp(b.time + 0.1, a.time, a.output)
    np.testing.assert_allclose(moved[:1000], b.output[:1000], atol=1e-6)


def test_the_slow_tail_beside_a_friction_pole_is_waited_for():
    # zero 0.18 on pole 0.17: a closed-loop pole near 0.18 leaves a tail of minutes
    C = ZeroPoleGain(zeros=(-0.3,), gain=1.0)
    loop = Loop(plant=ZeroPoleGain(poles=(0, -0.1, -20), gain=60.0), controller=C)
    response = step_response(loop, scale=3.0)
    assert response.time[-1] > 10
    assert response.output[-1] == pytest.approx(1.0, abs=1e-3)


def test_every_kind_of_plant_gives_the_same_loop():
    R, L_ = parameter_symbol("R"), parameter_symbol("L")
    symbolic = TransferFunction(
        input="u",
        output="i",
        numerator_coefficients=(sympy.Integer(1),),
        denominator_coefficients=(L_, R, sympy.Integer(0)),
    )
    values = {"R": 3.0, "L": 0.5}
    factored = ZeroPoleGain(poles=(0, -6), gain=2.0)
    from_control = control.TransferFunction([1], [0.5, 3, 0])
    expected = measure(factored)
    for other in (symbolic, from_control, control.tf2ss(from_control)):
        got = measure(other, values if other is symbolic else None)
        assert got.phase_margin == pytest.approx(expected.phase_margin, rel=1e-9)
        assert got.step.rise_time == pytest.approx(expected.step.rise_time, rel=1e-6)


def test_a_state_space_of_a_graph_is_factored():
    model = state_space(load_model("flegx_models.models:lowerleg_flight"))
    system = zero_pole_gain(model, output="theta", input="T_motor")
    assert system.gain == pytest.approx(176.76, abs=0.005)
    assert system.zeros == ()
    assert sorted(p.real for p in system.poles) == [
        pytest.approx(-0.00146234, rel=1e-4),
        0.0,
    ]


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: measure(ZeroPoleGain(gain=0.0)), "gain is zero"),
        (lambda: measure(ZeroPoleGain(zeros=(-1, -2), poles=(-3,))), "2 zeros"),
        (lambda: ZeroPoleGain(poles=(1 + 2j,)), "no conjugate"),
        (lambda: ZeroPoleGain(delay=-1.0), "delay"),
        (lambda: ZeroPoleGain(delay=0.15, period=0.1), "1.5 sampling periods"),
        (lambda: ZeroPoleGain(period=0.1, poles=(0.5,)) * ZeroPoleGain(poles=(-1,)),
         "meet in one loop"),
        (lambda: measure("plant"), "str is no linear system"),
        (lambda: to_python_control(ZeroPoleGain(delay=1.0)), "no delays"),
    ],
)  # fmt: skip
def test_refusals_name_the_cause_and_the_way_out(build, says):
    with pytest.raises(LoopShapingError, match=says) as refused:
        build()
    assert refused.value.remedy
