"""The compiled kernel: orders, agreement with scipy, exact sensitivities, stiffness."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import TF, BondGraph, C, I, R, Se, Sf, displacement, e, f, flow, p, q, t
from bondgraph.fitting.estimate import prepare
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk2, Sdirk3

SOLVERS = {"sdirk2": (Sdirk2, 2), "sdirk3": (Sdirk3, 3)}


def symbols(names):
    return sympy.symbols(names, real=True)


def oscillator():
    g = BondGraph("oscillator", domain="translation")
    g.one("mass", Se("force"), I("m"), C("c"), R("b"))
    g.measure("x", displacement="mass")
    g.measure("v", flow="mass")
    return g, {"m": 2.0, "c": 0.1, "b": 0.3}


def pendulum():
    g = BondGraph("pendulum", domain="rotation")
    weight = symbols("weight")
    g.one("axle", Se("torque"), I("J"), R("b"), C("mass", law=weight * sympy.sin(q)))
    g.measure("angle", displacement="axle")
    g.measure("speed", flow="axle")
    return g, {"J": 0.7, "b": 0.05, "weight": 6.0}


def dependent_storage():
    """Two inertias through a gear: one momentum depends on the other."""
    g = BondGraph("geared", domain="rotation")
    d = symbols("d")
    g.one("motor", Se("torque"), I("J1"))
    g.one("load", I("J2"), R("drag", law=d * f * sympy.sqrt(f**2 + 0.01)))
    g.join("motor", TF("K"), "load")
    g.measure("speed", flow="load")
    g.measure("angle", displacement="motor")
    g.measure("passed_on", effort="motor>K")
    return g, {"J1": 0.4, "J2": 3.0, "K": 2.5, "d": 0.8}


def algebraic_loop():
    """A nonlinear loop: what two resistances in a divider share is not explicit."""
    g = BondGraph("divider")
    k, s = symbols("k s")
    g.one("line", Se("u"), R("valve", law=k * (f + f**3)))
    g.zero("node", R("shunt", law=s * (e + e**3)))
    g.one("coil", I("l"), R("r"))
    g.join("line", "node")
    g.join("node", "coil")
    g.measure("i", flow="coil")
    g.measure("v", effort="node")
    return g, {"k": 1.5, "s": 0.6, "l": 0.4, "r": 0.9}


def time_varying():
    """A spring that stiffens as the clock runs, and an I written in its momentum."""
    g = BondGraph("warming", domain="translation")
    k, m = symbols("k m")
    g.one("mass", Se("force"), I("body", law=p / m), C("spring", law=k * (1 + t) * q))
    g.measure("x", displacement="mass")
    return g, {"m": 1.2, "k": 4.0}


MODELS = [oscillator, pendulum, dependent_storage, algebraic_loop, time_varying]


def numeric(make):
    """Return the numeric model and its parameter vector."""
    g, values = make()
    model = prepare(g.finish())
    return model, np.array([values[name] for name in model.parameter_names])


def one_window(time, u):
    n = len(time)
    inputs = np.asarray(u, dtype=float).reshape(n, -1)
    return Shots(np.asarray(time, dtype=float), inputs, np.zeros((n, 1)), (0, n))


def simulate(model, values, shots, x0, *, solver=None, hold=Hold.FIRST, about=None):
    return shoot(
        model,
        shots,
        parameters=values,
        initial=np.atleast_2d(np.asarray(x0, dtype=float)),
        directions=about,
        solver=Sdirk2() if solver is None else solver,
        hold=hold,
    )


def start(model, **values):
    """Return an initial state by state name."""
    assert set(values) <= set(model.state_names)
    return np.array([values.get(name, 0.0) for name in model.state_names])


def observed_orders(errors):
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


@pytest.mark.parametrize("name", SOLVERS)
def test_order_on_a_linear_oscillator(name):
    kind, order = SOLVERS[name]
    model, _ = numeric(oscillator)
    values = np.array(
        [{"m": 2.0, "c": 0.1, "b": 0.0}[n] for n in model.parameter_names]
    )
    omega = np.sqrt(1 / (2.0 * 0.1))
    errors = []
    for n in (40, 80, 160, 320):
        time = np.linspace(0.0, 3.0, n + 1)
        shots = one_window(time, np.zeros(n + 1))
        shot = simulate(
            model, values, shots, start(model, q_c=1.0, p_m=0.5), solver=kind()
        )
        v0 = 0.5 / 2.0
        exact = np.cos(omega * time) + v0 / omega * np.sin(omega * time)
        errors.append(np.abs(shot.outputs[:, 0] - exact).max())
    assert observed_orders(errors)[-2:] == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("name", SOLVERS)
def test_order_on_a_pendulum_that_swings_wide(name):
    kind, order = SOLVERS[name]
    model, values = numeric(pendulum)
    known = dict(zip(model.parameter_names, values, strict=True))

    def rate(_, x):
        momentum, angle = x
        speed = momentum / known["J"]
        return [-known["b"] * speed - known["weight"] * np.sin(angle), speed]

    end = 2.0
    reference = solve_ivp(rate, (0, end), [0.0, 2.5], rtol=1e-12, atol=1e-13).y[1, -1]
    errors = []
    for n in (50, 100, 200, 400):
        shots = one_window(np.linspace(0, end, n + 1), np.zeros(n + 1))
        x0 = start(model, q_mass=2.5)
        shot = simulate(model, values, shots, x0, solver=kind())
        errors.append(abs(shot.outputs[-1, 0] - reference))
    assert observed_orders(errors)[-2:] == pytest.approx(order, abs=0.2)


def test_substeps_do_what_more_samples_would():
    model, values = numeric(pendulum)
    x0 = start(model, q_mass=1.0)
    coarse = one_window(np.linspace(0, 1, 51), np.linspace(0, 2, 51))
    fine = one_window(np.linspace(0, 1, 201), np.linspace(0, 2, 201))
    few = simulate(model, values, coarse, x0, solver=Sdirk3(substeps=4)).outputs
    many = simulate(model, values, fine, x0, solver=Sdirk3()).outputs
    assert few == pytest.approx(many[::4], abs=1e-10)


def noisy_input(n, seed=3):
    return 2.0 * np.random.default_rng(seed).normal(size=n)


def test_agreement_with_scipy_under_an_input_of_straight_lines():
    model, values = numeric(pendulum)
    known = dict(zip(model.parameter_names, values, strict=True))
    time = np.linspace(0, 2, 201)
    u = noisy_input(201)

    def rate(now, x):
        momentum, angle = x
        speed = momentum / known["J"]
        torque = np.interp(now, time, u)
        return [torque - known["b"] * speed - known["weight"] * np.sin(angle), speed]

    # One call per sample: each piece is smooth, so that scipy's tolerance is met.
    x, angles = np.array([0.1, 0.4]), [0.4]
    for k in range(200):
        x = solve_ivp(
            rate, (time[k], time[k + 1]), x, method="DOP853", rtol=1e-11, atol=1e-12
        ).y[:, -1]
        angles.append(x[1])
    x0 = start(model, p_J=0.1, q_mass=0.4)
    shot = simulate(model, values, one_window(time, u), x0, solver=Sdirk3(substeps=8))
    assert shot.outputs[:, 0] == pytest.approx(np.array(angles), abs=2e-8)


@pytest.mark.parametrize("hold", Hold)
def test_held_and_joined_inputs_against_the_closed_form(hold):
    model, _ = numeric(lowpass)
    tau, h = 0.35, 0.1
    time = h * np.arange(60)
    u = noisy_input(60)
    y, expected = 0.0, [0.0]
    decay = np.exp(-h / tau)
    for k in range(59):
        slope = 0.0 if hold is Hold.ZERO else (u[k + 1] - u[k]) / h
        # τ ẏ + y = u_k + slope s has the particular solution u_k + slope (s - τ).
        y = (y - u[k] + slope * tau) * decay + u[k] + slope * (h - tau)
        expected.append(y)
    values = np.array([{"r": tau, "c": 1.0}[n] for n in model.parameter_names])
    solver = Sdirk3(substeps=40)
    shot = simulate(model, values, one_window(time, u), [0.0], solver=solver, hold=hold)
    assert shot.outputs[:, 0] == pytest.approx(np.array(expected), abs=2e-7)


def lowpass():
    g = BondGraph("lowpass")
    g.one("loop", Se("u"), R("r"), C("c"))
    g.measure("v", effort="c")
    return g, {"r": 1.0, "c": 1.0}


@pytest.mark.parametrize("hold", Hold)
@pytest.mark.parametrize("make", MODELS, ids=lambda m: m.__name__)
def test_sensitivities_are_those_of_the_discrete_solution(make, hold):
    model, values = numeric(make)
    time = np.linspace(0, 1, 41)
    shots = one_window(time, np.sin(5 * time) + 0.1 * noisy_input(41))
    x0 = np.linspace(0.3, 0.5, model.n_states)
    about = np.arange(len(values))
    shot = simulate(model, values, shots, x0, hold=hold, about=about)
    assert shot.completed.all()
    assert shot.sensitivities.shape == (
        41,
        len(model.output_names),
        len(values) + len(x0),
    )

    def outputs(parameters, initial):
        return simulate(model, parameters, shots, initial, hold=hold).outputs

    def slope(k):
        n = len(values)
        step = 1e-5 * (abs(values[k]) if k < n else 1.0)
        change = np.zeros(n + len(x0))
        change[k] = step
        up = outputs(values + change[:n], x0 + change[n:])
        down = outputs(values - change[:n], x0 - change[n:])
        return (up - down) / (2 * step)

    for k in range(len(values) + len(x0)):
        own = shot.sensitivities[:, :, k]
        size = max(1.0, np.abs(own).max())
        assert own == pytest.approx(slope(k), abs=1e-6 * size), k


def test_sensitivities_to_some_parameters_are_the_columns_of_all():
    model, values = numeric(pendulum)
    shots = one_window(np.linspace(0, 1, 31), np.ones(31))
    x0 = start(model, q_mass=0.5)
    every = simulate(model, values, shots, x0, about=np.arange(3)).sensitivities
    some = simulate(model, values, shots, x0, about=np.array([2])).sensitivities
    assert np.array_equal(some, every[:, :, [2, 3, 4]])


def test_the_models_are_of_the_kinds_they_stand_for():
    assert numeric(oscillator)[0].linear
    assert not numeric(pendulum)[0].linear
    geared, loop = numeric(dependent_storage)[0], numeric(algebraic_loop)[0]
    assert geared.n_unknowns >= 1
    assert geared.instantaneous
    assert loop.n_unknowns >= 1
    assert not loop.linear


def test_geared_inertias_obey_newton_on_the_motor_s_side():
    model, values = numeric(dependent_storage)
    known = dict(zip(model.parameter_names, values, strict=True))
    time = np.linspace(0, 2, 401)
    u = 3 + np.sin(4 * time)
    shot = simulate(model, values, one_window(time, u), np.zeros(model.n_states))
    speed, _, passed_on = shot.outputs.T
    # f_motor = K f_load and e_load = K e_motor, so that J2 weighs J2 / K² at the motor.
    k = known["K"]

    def rate(now, x):
        drag = known["d"] * x[0] * np.sqrt(x[0] ** 2 + 0.01)
        torque = k * (3 + np.sin(4 * now)) - drag
        return [torque / (known["J2"] + k**2 * known["J1"])]

    there = solve_ivp(rate, (0, 2), [0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0]
    assert speed == pytest.approx(there, abs=2e-4)
    accelerating = np.array(
        [rate(now, [v])[0] for now, v in zip(time, there, strict=True)]
    )
    assert passed_on == pytest.approx(u - known["J1"] * k * accelerating, abs=1e-3)


def test_the_loop_s_outputs_satisfy_kirchhoff():
    model, values = numeric(algebraic_loop)
    known = dict(zip(model.parameter_names, values, strict=True))
    time = np.linspace(0, 1, 101)
    u = 2 * np.sin(9 * time)
    current, v = simulate(model, values, one_window(time, u), [0.2]).outputs.T
    line = current + known["s"] * (v + v**3)
    assert known["k"] * (line + line**3) == pytest.approx(u - v, abs=1e-9)


def test_a_model_without_states_reads_its_inputs():
    g = BondGraph("load bench", domain="rotation")
    g.one("axle", Sf("speed"), R("b"))
    g.measure("torque", effort="b")
    model = prepare(g.finish())
    assert model.n_states == 0
    u = noisy_input(20)
    shots = one_window(np.arange(20.0), u)
    about = np.array([0])
    shot = simulate(model, np.array([1.7]), shots, np.zeros((1, 0)), about=about)
    assert shot.outputs[:, 0] == pytest.approx(1.7 * u)
    assert shot.sensitivities[:, 0, 0] == pytest.approx(u)
    assert shot.completed.tolist() == [True]


def test_an_inertia_that_is_driven_in_speed_reads_the_slope_of_the_input():
    g = BondGraph("dragged", domain="translation")
    g.one("cart", Sf("speed"), I("m"), R("b"))
    g.measure("force", effort="speed")
    model = prepare(g.finish())
    assert model.needs_input_rates
    values = np.array([{"m": 3.0, "b": 0.5}[n] for n in model.parameter_names])
    time = np.array([0.0, 1.0, 2.0, 3.0])
    u = np.array([0.0, 2.0, 2.0, 1.0])
    shot = simulate(model, values, one_window(time, u), np.zeros((1, model.n_states)))
    assert shot.outputs[:3, 0] == pytest.approx([3 * 2.0, 1.0, 1.0 - 3 * 1.0])


def stiff_cart(slip):
    g = BondGraph("cart with dry friction", domain="translation")
    coulomb, width = symbols("coulomb width")
    g.one("cart", Se("force"), I("m"), R("dry", law=coulomb * sympy.tanh(f / width)))
    g.measure("x", displacement="cart")
    g.measure("v", flow="cart")
    model = prepare(g.finish())
    known = {"m": 1.0, "coulomb": 2.0, "width": slip}
    return model, np.array([known[n] for n in model.parameter_names])


@pytest.mark.parametrize("kind", [Sdirk2, Sdirk3])
def test_friction_ten_thousand_times_sharper_than_the_speed_does_not_fail(kind):
    slip = 1.3e-5
    model, values = stiff_cart(slip)
    time = np.arange(0, 4, 1e-3)
    u = 2.8 * np.sin(2 * np.pi * time) + 0.05 * noisy_input(len(time))
    shots, x0 = one_window(time, u), np.zeros(model.n_states)
    about = np.arange(3)
    shot = simulate(model, values, shots, x0, solver=kind(), about=about)
    assert shot.completed.all()
    assert np.isfinite(shot.sensitivities).all()
    fine = simulate(model, values, shots, x0, solver=kind(substeps=50)).outputs
    some = simulate(model, values, shots, x0, solver=kind(substeps=5)).outputs
    coarse_error, error = (
        np.abs(outputs - fine).max(axis=0) / fine.std(axis=0)
        for outputs in (shot.outputs, some)
    )
    assert (coarse_error < 0.01).all()
    assert error[0] < 0.3 * coarse_error[0]
    # It slides and it sticks: both were there to be solved.
    speed = np.abs(fine[:, 1])
    assert speed.max() > 1e4 * slip
    assert (speed < slip).mean() > 0.02


def test_a_speed_that_escapes_to_infinity_is_not_completed():
    g = BondGraph("runaway", domain="translation")
    k = symbols("k")
    g.one("cart", Se("force"), I("m"), R("push", law=-k * f**3))
    g.measure("v", flow="cart")
    model = prepare(g.finish())
    values = np.ones(len(model.parameter_names))
    time = np.linspace(0, 2, 201)
    shots = Shots(
        np.tile(time, 2), np.zeros((402, 1)), np.zeros((402, 1)), (0, 201, 402)
    )
    initial = np.array([[0.1], [1.0]])
    shot = simulate(model, values, shots, initial)
    # v̇ = v³ reaches infinity at 1 / (2 v_0²): after 50 s, and after half a second.
    assert shot.completed.tolist() == [True, False]
    assert np.isfinite(shot.outputs[:201]).all()
    alive = np.isfinite(shot.outputs[201:, 0])
    assert 0.45 < time[alive][-1] < 0.6
    assert not alive[-1]


def test_an_unstable_linear_model_that_overflows_is_not_completed():
    g = BondGraph("inverted")
    g.one("loop", I("l"), R("r"))
    g.measure("i", flow="loop")
    model = prepare(g.finish())
    values = np.array([{"l": 1.0, "r": -40.0}[n] for n in model.parameter_names])
    time = np.linspace(0, 40, 4001)
    shot = simulate(model, values, one_window(time, np.zeros((4001, 0))), [1.0])
    assert shot.completed.tolist() == [False]


def test_windows_do_not_see_each_other():
    model, values = numeric(pendulum)
    time = np.linspace(0, 1, 51)
    u = noisy_input(153)
    edges = (0, 51, 102, 153)
    shots = Shots(np.tile(time, 3), u[:, None], np.zeros((153, 1)), edges)
    initial = np.array([[0.1, 0.2], [0.0, 1.0], [0.3, -0.4]])
    together = simulate(model, values, shots, initial, about=np.arange(3))
    for k in range(3):
        alone = simulate(
            model,
            values,
            one_window(time, u[51 * k : 51 * (k + 1)]),
            initial[k],
            about=np.arange(3),
        )
        part = shots.slices[k]
        assert np.array_equal(together.outputs[part], alone.outputs)
        assert np.array_equal(together.sensitivities[part], alone.sensitivities)
        some = shots.subset(np.array([k]), 20)
        assert np.array_equal(some.inputs[:, 0], u[51 * k : 51 * k + 20])


def test_uneven_steps_are_followed():
    model, values = numeric(oscillator)
    rng = np.random.default_rng(1)
    time = np.concatenate([[0.0], np.sort(rng.uniform(0, 2, 300)), [2.0]])
    x0 = start(model, q_c=1.0)
    shots = one_window(time, np.sin(time))
    uneven = simulate(model, values, shots, x0, solver=Sdirk3(substeps=4)).outputs
    even = np.linspace(0, 2, 4001)
    known = simulate(model, values, one_window(even, np.sin(even)), x0).outputs
    assert uneven[-1] == pytest.approx(known[-1], abs=2e-5)


def test_a_measured_displacement_starts_where_it_is_put():
    g, values = oscillator()
    g.measure("twice", 2 * displacement("mass"), unit="m")
    model = prepare(g.finish())
    ordered = np.array([values[n] for n in model.parameter_names])
    x0 = start(model, q_c=0.7)
    shot = simulate(model, ordered, one_window(np.linspace(0, 1, 11), np.zeros(11)), x0)
    assert shot.outputs[0].tolist() == [0.7, 0.0, 1.4]


@pytest.mark.parametrize("rate", [64, 128, 256])
@pytest.mark.parametrize("size", [0.05, 0.1, 0.3])
def test_a_rod_without_mass_that_rubs_behind_play_is_simulated(rate, size):
    """Sharp corners and a force that saturates: one step jumps over many of them."""
    g = BondGraph("rod behind play", domain="translation")
    z, x = displacement("memory"), displacement("contact")
    rub, reach, gap, k, d = 9453.0, 0.00127, 0.001356, 9.9e6, 4.3e8

    def beyond(at):
        return sympy.Max(at - gap, 0) + sympy.Min(at + gap, 0)

    v = flow("rod")
    g.one("rod", R("viscous"), Se("offset", value=-429.0), Se("rub", value=-rub * z))
    g.zero("node", Sf("rate", value=(v - abs(v) * z) / reach), C("memory", law=q))
    g.zero("ends", Sf("velocity"))
    losses = R("losses", law=d * f * abs(beyond(x)))
    g.one("play", C("contact", law=k * beyond(q)), losses)
    g.join("ends", "rod")
    g.join("ends", "play")
    g.measure("force", effort="ends")
    g.prefer("losses", "effort")
    model = prepare(g.finish())
    time = np.arange(0.0, 4.0, 1 / rate)
    shots = one_window(time, size * np.cos(4 * np.pi * time))
    shot = simulate(model, np.array([0.0825]), shots, [0.0, 0.0])
    assert shot.trouble == (None,)
    assert np.quantile(abs(shot.outputs), 0.9) == pytest.approx(rub, rel=0.2)
