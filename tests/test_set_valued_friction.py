"""Set-valued dry friction: stick is stick, slip starts and ends where it must."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import TF, BondGraph, C, I, R, Sdirk2, Sdirk3, Se, Sf, effort, f, flow
from bondgraph.equations.deriving.derivation import derive
from bondgraph.numeric.model import compile_model
from bondgraph.simulation.engines import Interpreted, Native
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold

STANDARD_GRAVITY = 9.81
V0 = sympy.Symbol("v0", real=True)


def symbols(names):
    return sympy.symbols(names, real=True)


def run(graph, values, time, u=(), *, start=None, solver=None, about=None, hold=None):
    """Return the shooting of one window; `start` and `about` by name."""
    model = compile_model(derive(graph.finish()))
    time = np.asarray(time, float)
    inputs = np.zeros((len(time), len(model.input_names)))
    if len(u):
        inputs[:, 0] = u
    shots = Shots(time, inputs, np.zeros((len(time), 1)), (0, len(time)))
    x0 = [(start or {}).get(name, 0.0) for name in model.state_names]
    directions = None
    if about is not None:
        directions = np.array([model.parameter_names.index(n) for n in about], np.int64)
    return shoot(
        model,
        shots,
        parameters=np.array([values[name] for name in model.parameter_names]),
        initial=np.array([x0]),
        directions=directions,
        solver=solver or Sdirk2(),
        hold=hold or Hold.FIRST,
    )


def block():
    """A block on a slope, pushed."""
    g = BondGraph("block on a slope", domain="translation")
    m, mu, slope, gravity = symbols("m mu slope g")
    rub = mu * m * gravity * sympy.cos(slope) * sympy.sign(f)
    weight = Se("weight", value=m * gravity * sympy.sin(slope))
    g.one("block", Se("push"), weight, I("m"), R("rub", law=rub))
    g.measure("x", displacement="block")
    g.measure("v", flow="block")
    g.measure("rubs", effort="rub")
    return g, {"m": 2.0, "mu": 0.3, "slope": np.deg2rad(10), "g": STANDARD_GRAVITY}


@pytest.mark.parametrize("kind", [Sdirk2, Sdirk3])
def test_a_block_on_a_slope_stays_for_an_hour(kind):
    g, values = block()
    time = np.arange(0, 3600.0, 0.1)
    shot = run(g, values, time, solver=kind())
    assert shot.completed.all()
    x, v, force = shot.outputs.T
    assert np.abs(x).max() < 1e-9
    assert np.abs(v).max() < 1e-12
    weight = 2.0 * STANDARD_GRAVITY * np.sin(values["slope"])
    assert force == pytest.approx(np.full(len(time), weight), rel=1e-9)


def test_a_shaken_block_that_never_slips_does_not_creep():
    g, values = block()
    time = np.arange(0, 60.0, 1e-3)
    shake = np.random.default_rng(0).uniform(-2.0, 2.0, len(time))
    x, v, force = run(g, values, time, shake).outputs.T
    weight = 2.0 * STANDARD_GRAVITY * np.sin(values["slope"])
    assert np.abs(x).max() < 1e-9
    assert np.abs(v).max() < 1e-12
    assert force == pytest.approx(shake + weight, abs=1e-8)


def test_slip_begins_at_the_force_that_friction_can_hold():
    g, values = block()
    values = {**values, "slope": 0.0}
    time = np.arange(0, 2.0, 1e-3)
    push = 5.0 * time
    x, v, force = run(g, values, time, push).outputs.T
    hold = 0.3 * 2.0 * STANDARD_GRAVITY
    begins = hold / 5.0
    sticking = time < begins
    assert np.abs(v[sticking]).max() < 1e-12
    assert force[sticking] == pytest.approx(push[sticking], abs=1e-9)
    since = np.maximum(time - begins, 0.0)
    assert v == pytest.approx(5.0 * since**2 / 4, abs=3e-6)
    assert x == pytest.approx(5.0 * since**3 / 12, abs=3e-6)
    assert force[~sticking] == pytest.approx(hold)


@pytest.mark.parametrize("kind", [Sdirk2, Sdirk3])
def test_a_sliding_block_stops_where_energy_says(kind):
    g, values = block()
    time = np.linspace(0, 3, 76)
    x, v, _ = run(g, values, time, start={"p_m": 2.0}, solver=kind()).outputs.T
    slows = STANDARD_GRAVITY * (0.3 * np.cos(values["slope"]) - np.sin(values["slope"]))
    moving = time < 1 / slows
    assert v == pytest.approx(np.where(moving, 1 - slows * time, 0.0), abs=1e-12)
    assert x[-1] == pytest.approx(1 / (2 * slows), rel=1e-10)


def oscillator():
    """A mass on a spring, rubbing."""
    g = BondGraph("rubbing oscillator", domain="translation")
    (tau,) = symbols(["tau"])
    g.one("mass", Se("force"), I("m"), C("c"), R("rub", law=tau * sympy.sign(f)))
    g.measure("x", effort="c")
    g.measure("v", flow="mass")
    return g, {"m": 1.5, "c": 1 / 40, "tau": 1.0}


def test_free_swings_lose_the_same_amount_each_until_they_stick():
    # Kirchhoff: every half period the amplitude falls by 2 τ c.
    g, values = oscillator()
    half = np.pi * np.sqrt(1.5 / 40)
    time = np.linspace(0, 8 * half, 801)
    shot = run(g, values, time, start={"q_c": 0.33}, solver=Sdirk3())
    spring = shot.outputs[::100, 0] * values["c"]
    peaks = [0.33, -0.28, 0.23, -0.18, 0.13, -0.08, 0.03]
    assert spring[:7] == pytest.approx(peaks, abs=2e-5)
    # There |k q| = 1.2 still exceeds τ; after one more half swing it sticks.
    assert spring[7] == pytest.approx(0.02, abs=2e-5)
    assert spring[8] == pytest.approx(spring[7], abs=1e-12)
    assert np.abs(shot.outputs[-90:, 1]).max() < 1e-12


def automaton(time, force, *, m=1.5, c=1 / 40, tau=1.0):
    """Return x and v by an event-driven simulation: three modes, each smooth."""
    x, v, now, mode = 0.0, 0.0, time[0], 0
    states = np.zeros((len(time), 2))

    def slips(t, y):
        return y[1]

    def begins(t, y):
        return abs(force(t) - y[0] / c) - tau

    slips.terminal = begins.terminal = True
    while now < time[-1]:

        def rate(t, y, mode=mode):
            if mode == 0:
                return [0.0, 0.0]
            return [y[1], (force(t) - y[0] / c - tau * mode) / m]

        slips.direction = -mode
        begins.direction = 1
        part = time[(time >= now - 1e-15)]
        found = solve_ivp(
            rate,
            (now, time[-1]),
            [x, v],
            t_eval=part,
            events=slips if mode else begins,
            rtol=1e-11,
            atol=1e-13,
            max_step=0.01,
        )
        states[np.isin(time, found.t)] = found.y.T
        if found.status == 0:
            break
        now, (x, _) = found.t_events[0][0], found.y_events[0][0]
        v = 0.0
        net = force(now) - x / c
        if mode:
            mode = 0 if abs(net) <= tau else int(np.sign(net))
        else:
            mode = int(np.sign(net))
        now += 1e-12
    return states


def drive(t):
    return 1.6 * np.sin(3.1 * t) + 0.8 * np.sin(7.7 * t)


def test_an_event_driven_simulation_agrees_and_the_error_is_of_second_order():
    g, values = oscillator()
    errors = []
    for n in (1001, 2001, 4001):
        time = np.linspace(0, 10, n)
        known = automaton(time, drive)
        shot = run(g, values, time, drive(time))
        x = shot.outputs[:, 0] * values["c"]
        errors.append(np.abs(x - known[:, 0]).max())
        if n == 2001:
            both = np.abs(known[:, 1]) < 1e-12
            assert 0.1 < both.mean() < 0.9
            assert np.abs(shot.outputs[both, 1]).max() < 1e-3
    assert errors[0] < 2e-4
    assert errors[0] / errors[2] > 8


def test_friction_in_load_and_position():
    """Friction that a spring presses: mu |N| sign(f), N = q/c."""
    g = BondGraph("pressed", domain="translation")
    (mu,) = symbols(["mu"])
    law = mu * sympy.Abs(effort("c")) * sympy.sign(f)
    g.one("mass", Se("force"), I("m"), C("c"), R("rub", law=law))
    g.measure("v", flow("mass"))
    g.measure("rubs", effort="rub")
    values = {"m": 1.0, "c": 0.01, "mu": 0.4}
    # The spring pushes with 10 N; 4 N of friction hold pushes between 6 and 14 N.
    time = np.linspace(0, 1, 1001)
    push = 10.0 + 5.0 * time
    shot = run(g, values, time, push, start={"q_c": 0.1})
    assert shot.completed.all()
    v, rub = shot.outputs.T
    holds = time < 0.8
    assert np.abs(v[holds]).max() < 1e-12
    assert rub[holds] == pytest.approx(push[holds] - 10.0, abs=1e-8)
    assert v[time > 0.82].min() > 1e-6


def two_blocks():
    g = BondGraph("two blocks", domain="translation")
    t1, t2 = symbols("t1 t2")
    g.one("first", Se("force"), I("m1"), R("r1", law=t1 * sympy.sign(f)))
    g.one("second", I("m2"), R("r2", law=t2 * sympy.sign(f)))
    g.zero("spring", C("c"))
    g.join("first", "spring")
    g.join("spring", "second")
    g.measure("v1", flow="first")
    g.measure("v2", flow="second")
    g.measure("pull", effort="c")
    return g, {"m1": 1.0, "m2": 2.0, "t1": 1.0, "t2": 3.0, "c": 0.01}


def test_two_frictions_slip_one_after_the_other():
    g, values = two_blocks()
    time = np.linspace(0, 8, 8001)
    push = np.minimum(time, 4.5)
    shot = run(g, values, time, push)
    assert shot.completed.all()
    v1, v2, pull = shot.outputs.T
    assert np.abs(v1[time < 0.99]).max() < 1e-10
    assert v1[time > 1.01].max() > 1e-3
    before = np.flatnonzero(np.abs(v2) > 1e-9)[0]
    assert pull[before] == pytest.approx(3.0, abs=0.02)
    assert (pull[:before] < 3.0 + 1e-3).all()


def test_frictions_that_hold_one_motion_together_hold_what_both_can():
    """Motor and load on a rigid gear: neither load share is determined, the sum is."""
    g = BondGraph("geared", domain="rotation")
    t1, t2 = symbols("t1 t2")
    g.one("motor", Se("torque"), I("J1"), R("r1", law=t1 * sympy.sign(f)))
    g.one("load", I("J2"), R("r2", law=t2 * sympy.sign(f)))
    g.join("motor", TF("n"), "load")
    g.measure("speed", flow="load")
    values = {"J1": 0.1, "J2": 1.0, "t1": 0.5, "t2": 2.0, "n": 4.0}
    # At the motor: f_motor = n f_load and e_load = n e_motor: 0.5 + 2.0 / 4 = 1 N m.
    time = np.linspace(0, 3, 3001)
    torque = np.where(time < 1.5, time, 3.0 - time)
    shot = run(g, values, time, torque)
    assert shot.completed.all()
    speed = shot.outputs[:, 0]
    assert np.abs(speed[time < 0.999]).max() < 1e-9
    at_load = 0.1 * 4.0**2 + 1.0
    gains = lambda t: 4.0 * (t - 1.0) ** 2 / 2 / at_load  # noqa: E731
    rising = (time > 1.0) & (time < 1.5)
    assert speed[rising] == pytest.approx(gains(time[rising]), abs=1e-5)
    stops = 2.0 + 0.5 * np.sqrt(2.0)
    assert np.abs(speed[time > stops + 2e-3]).max() < 1e-9
    assert speed[time < stops - 5e-2][-1] > 1e-3


def test_friction_that_receives_effort_does_not_move_below_its_limit():
    g = BondGraph("slipping clutch", domain="rotation")
    c, tau = symbols("c tau")
    g.zero("shaft", Sf("speed"), C("k"), R("clutch", law=c * f + tau * sympy.sign(f)))
    g.measure("torque", effort="shaft")
    g.measure("slip", flow="clutch")
    values = {"c": 0.1, "tau": 2.0, "k": 0.5}
    time = np.linspace(0, 4, 401)
    shot = run(g, values, time, np.ones(401), solver=Sdirk3())
    torque, slip = shot.outputs.T
    winds = time < 0.999
    assert torque[winds] == pytest.approx(2.0 * time[winds])
    assert np.abs(slip[winds]).max() < 1e-12
    # Then c q̇ + q/k = … relaxes to torque τ + c.
    after = time > 1.0
    relaxed = 2.0 + 0.1 * (1 - np.exp(-(time[after] - 1.0) / (0.1 * 0.5)))
    assert torque[after] == pytest.approx(relaxed, abs=1e-3)


def test_a_sign_in_a_source_is_a_sign():
    g = BondGraph("relay", domain="translation")
    (size,) = symbols(["size"])
    relay = Se("relay", value=-size * sympy.sign(flow("mass")))
    g.one("mass", Se("force"), relay, I("m"))
    g.measure("v", flow="mass")
    assert compile_model(derive(g.finish())).set_valued is None


def test_a_law_that_does_not_jump_has_no_mode():
    g = BondGraph("drag", domain="translation")
    (b,) = symbols(["b"])
    g.one("mass", Se("force"), I("m"), R("drag", law=b * f**2 * sympy.sign(f)))
    assert compile_model(derive(g.finish())).set_valued is None


@pytest.mark.parametrize("tau", [0.0, -0.5])
def test_friction_of_no_size_or_the_wrong_sign_is_simulated_too(tau):
    """A fit may pass through both."""
    g, values = oscillator()
    time = np.linspace(0, 2, 401)
    shot = run(g, {**values, "tau": tau}, time, drive(time), start={"q_c": 0.1})
    assert shot.completed.all()


def test_sensitivities_have_the_slope_of_fine_solutions_across_stops_and_turns():
    g, values = oscillator()
    values = {**values, "tau": 0.7}
    time = np.linspace(0, 6, 1201)
    about = ["m", "c", "tau"]
    shot = run(g, values, time, drive(time), about=about, start={"p_m": 0.3})
    assert shot.completed.all()
    fine = np.linspace(0, 6, 24001)
    for k, name in enumerate(about):
        step = 1e-3 * values[name]
        up, down = (
            run(
                g,
                {**values, name: values[name] + side * step},
                fine,
                drive(fine),
                start={"p_m": 0.3},
            ).outputs[::20]
            for side in (1, -1)
        )
        slope = (up - down) / (2 * step)
        for j in range(2):
            error = shot.sensitivities[:, j, k] - slope[:, j]
            size = np.abs(slope[:, j]).max()
            assert np.median(np.abs(error)) < 2e-3 * size, (name, j)
            # Next to an event the two are on different sides of it.
            assert np.quantile(np.abs(error), 0.95) < 1e-2 * size, (name, j)


@pytest.mark.parametrize("make", [oscillator, two_blocks, block])
def test_native_code_and_tape_stick_and_slip_alike(make):
    g, values = make()
    model = compile_model(derive(g.finish()))
    time = np.linspace(0, 4, 2001)
    push = 5.0 * drive(time)
    shots = Shots(time, push[:, None], np.zeros((2001, 1)), (0, 2001))
    native, tape = (
        shoot(
            model,
            shots,
            parameters=np.array([values[name] for name in model.parameter_names]),
            initial=np.zeros((1, model.n_states)),
            directions=np.arange(len(model.parameter_names)),
            solver=Sdirk2(),
            hold=Hold.FIRST,
            engine=engine,
        )
        for engine in (Native(), Interpreted())
    )
    assert native.completed.all()
    assert np.array_equal(native.modes, tape.modes)
    sticks = native.modes == 0
    assert sticks.any()
    assert not sticks.all()
    for one, other in (
        (native.outputs, tape.outputs),
        (native.sensitivities, tape.sensitivities),
    ):
        size = np.abs(other).max(axis=0)
        assert (np.abs(one - other) <= 1e-7 * size + 1e-9).all()


@pytest.mark.parametrize("kind", [Sdirk2, Sdirk3])
def test_chains_of_rubbing_masses_shaken_by_noise_are_followed(kind):
    """Frictions beside and between the masses; some of these steps need halving."""
    rng = np.random.default_rng(1)
    for n in (2, 3, 4):
        g = BondGraph("chain", domain="translation")
        known = {}
        for i in range(n):
            rub = symbols([f"t{i}"])[0] * sympy.sign(f)
            g.one(f"x{i}", I(f"m{i}"), R(f"r{i}", law=rub), *[Se("u")][: i == 0])
            known |= {f"m{i}": rng.uniform(0.1, 5), f"t{i}": rng.uniform(0, 3)}
            if i:
                between = symbols([f"k{i}"])[0] * sympy.sign(f) + 0.1 * f
                link = C(f"c{i}") if i % 2 else R(f"slip{i}", law=between)
                known |= {f"c{i}": 10 ** rng.uniform(-4, -1), f"k{i}": 1.0}
                g.zero(f"s{i}", link)
                g.join(f"x{i - 1}", f"s{i}")
                g.join(f"s{i}", f"x{i}")
        g.measure("v", flow=f"x{n - 1}")
        names = g.finish().parameters
        values = {name: known[name] for name in known if name in names}
        time = np.arange(0, 2, 2e-3)
        shake = 6 * np.sin(3 * time) + 4 * rng.standard_normal(len(time))
        assert run(g, values, time, shake, solver=kind()).completed.all()


@pytest.mark.parametrize(
    ("law", "jumps"),
    [
        (sympy.Symbol("mu", real=True) * sympy.sign(f), True),
        (sympy.Symbol("mu", real=True) * sympy.sign(f - V0), True),
        (sympy.Symbol("mu", real=True) * sympy.sign(2 * f - V0) + f, True),
        ((2 * f - V0) * sympy.sign(2 * f - V0), False),
        (f * sympy.sign(f), False),
        (f + sympy.sign(f) ** 2, False),
        (sympy.sign(f**2 - 1), False),
    ],
    ids=str,
)
def test_friction_of_a_belt_jumps_where_the_belt_is_followed(law, jumps):
    g = BondGraph("belt")
    g.one("block", Se("push"), I("m"), R("rub", law=law))
    equations = derive(g.finish())
    assert len(equations.dry_friction) == jumps
