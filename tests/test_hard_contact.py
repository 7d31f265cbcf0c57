"""Hard contact with restitution, held to closed solutions."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    BondGraph,
    C,
    Cvode,
    FitSettings,
    I,
    R,
    Radau,
    Recording,
    RungeKutta4,
    Sdirk2,
    Sdirk3,
    Se,
    Sf,
    WholeRecordings,
    bind_to,
    displacement,
    f,
    fit,
    simulate_sparse,
    steady_state,
    to_nonlinear_io,
)
from bondgraph.equations.deriving.derivation import derive
from bondgraph.errors import EquationError
from bondgraph.numeric.model import compile_model
from bondgraph.simulation.engines import Interpreted, Native
from bondgraph.simulation.events import EventKind
from bondgraph.simulation.impact import complementary
from bondgraph.simulation.run import simulate_inputs
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold
from bondgraph.structure.hard_contact import hard_contact

GRAVITY = 9.81
m, g, e, gap = sympy.symbols("m g e_stop gap", real=True)


def ball(restitution=0.5, *, fit_it=False):
    """A ball above a floor, pushed."""
    graph = BondGraph("ball", domain="translation")
    floor = R("floor", law=-hard_contact(-displacement("ball"), e))
    graph.one("ball", Se("push"), Se("weight", value=-m * g), I("m"), floor)
    graph.measure("x", displacement="ball")
    if not fit_it:
        graph.measure("v", flow="ball")
        graph.measure("reaction", effort="floor")
    graph.parameter("m", 2.0, "kg", std=0.0)
    graph.parameter("g", GRAVITY, "m/s**2", std=0.0)
    graph.parameter("e_stop", restitution, std=None if fit_it else 0.0)
    return graph.finish()


def times(run, kind):
    return np.array([event.time for event in run.events if event.kind is kind])


def dropped(height, restitution, time):
    """Return the height of a dropped ball, by its flights."""
    speed = np.sqrt(2.0 * GRAVITY * height)
    start, flight, up = 0.0, speed / GRAVITY, 0.0
    found, origin = np.zeros(len(time)), height
    while flight > 1e-9:
        inside = (time >= start) & (time < start + flight)
        s = time[inside] - start
        found[inside] = origin + up * s - 0.5 * GRAVITY * s**2
        start += flight
        speed *= restitution
        up, flight, origin = speed, 2.0 * speed / GRAVITY, 0.0
    return found


@pytest.mark.parametrize("kind", [Sdirk2, Sdirk3])
def test_a_bouncing_ball_bounces_when_it_must_and_comes_to_rest(kind):
    time = np.arange(0.0, 2.0, 0.01)
    run = simulate_inputs(ball(), time, initial={"q_ball": 1.0}, solver=kind())
    first = np.sqrt(2.0 / GRAVITY)
    impacts = times(run, EventKind.IMPACT)
    flights = first * 2.0 * 0.5 ** np.arange(1, 20)
    closed = first + np.concatenate([[0.0], np.cumsum(flights)])
    assert impacts[:20] == pytest.approx(closed, abs=1e-10)
    (rest,) = times(run, EventKind.RESTS)
    assert rest == pytest.approx(first * (1.0 + 2.0 * 0.5 / (1.0 - 0.5)), abs=2e-8)
    assert run.output("x") == pytest.approx(dropped(1.0, 0.5, time), abs=1e-10)
    resting = time > rest
    assert np.abs(run.output("x")[resting]).max() < 1e-12
    assert np.all(run.output("v")[resting] == 0.0)
    assert run.output("reaction")[resting] == pytest.approx(-2.0 * GRAVITY)
    assert run.audit.dissipated == pytest.approx(2.0 * GRAVITY)
    assert run.audit.relative < 1e-12


def test_an_elastic_ball_keeps_its_energy():
    time = np.arange(0.0, 20.0, 0.01)
    run = simulate_inputs(ball(1.0), time, initial={"q_ball": 1.0})
    x, v = run.output("x"), run.output("v")
    total = 2.0 * GRAVITY * x + v**2
    assert total == pytest.approx(np.full(len(time), 2.0 * GRAVITY), rel=1e-9)
    assert len(times(run, EventKind.IMPACT)) == 22
    assert abs(run.audit.dissipated) < 1e-9


def test_a_ball_that_rests_is_lifted_when_the_push_passes_its_weight():
    time = np.arange(0.0, 2.0, 0.01)
    rising = {"push": 20.0 * time}
    run = simulate_inputs(ball(), time, inputs=rising, solver=Sdirk3())
    lifted = 2.0 * GRAVITY / 20.0
    assert [e.kind for e in run.events] == [EventKind.RESTS, EventKind.RELEASE]
    assert run.events[1].time == pytest.approx(lifted, abs=1e-9)
    later = np.maximum(time - lifted, 0.0)
    # 2 x'' = 20 (t - lifted)
    assert run.output("x") == pytest.approx(10.0 * later**3 / 6.0, abs=1e-8)
    held = simulate_inputs(
        ball(), time, inputs={"push": np.where(time < 1.0, 10.0, 30.0)}, hold=Hold.ZERO
    )
    assert times(held, EventKind.RELEASE) == pytest.approx([1.0])
    flying = 0.5 * (30.0 / 2.0 - GRAVITY) * np.maximum(time - 1.0, 0.0) ** 2
    assert held.output("x") == pytest.approx(flying, abs=1e-9)


def between_stops(restitution, *extra):
    graph = BondGraph("between stops", domain="translation")
    x = displacement("mass")
    upper = R("upper", law=hard_contact(x - gap, e))
    lower = R("lower", law=-hard_contact(-x - gap, e))
    graph.one("mass", I("m"), upper, lower, *extra)
    graph.measure("x", displacement="mass")
    graph.measure("v", flow="mass")
    graph.parameter("m", 0.5, "kg")
    graph.parameter("gap", 0.3, "m")
    graph.parameter("e_stop", restitution)
    return graph


def test_a_mass_between_two_stops_loses_a_share_of_its_speed_at_each():
    time = np.arange(0.0, 3.0, 0.02)
    graph = between_stops(0.8).finish()
    run = simulate_inputs(graph, time, initial={"p_m": 1.0})
    spent, speed, closed = 0.15, 2.0, []
    while spent < time[-1]:
        closed.append(spent)
        speed *= 0.8
        spent += 0.6 / speed
    assert times(run, EventKind.IMPACT) == pytest.approx(closed, abs=1e-10)
    assert [e.place for e in run.events[:3]] == ["upper", "lower", "upper"]
    assert np.abs(run.output("x")).max() <= 0.3 + 1e-12
    lost = 0.25 * (4.0 - speed**2)
    assert run.audit.dissipated == pytest.approx(lost, rel=1e-10)
    assert run.audit.relative < 1e-12


def test_a_mass_that_sticks_to_a_stop_stays_there():
    time = np.arange(0.0, 1.0, 0.02)
    run = simulate_inputs(between_stops(0.0).finish(), time, initial={"p_m": 1.0})
    assert run.output("x")[time > 0.15] == pytest.approx(0.3, abs=1e-12)
    assert [e.kind for e in run.events] == [EventKind.IMPACT, EventKind.RESTS]


def test_dry_friction_and_stops_act_together():
    tau = sympy.Symbol("tau", real=True)
    graph = between_stops(0.8, R("rub", law=tau * sympy.sign(f)))
    graph.parameter("tau", 0.4, "N")
    time = np.arange(0.0, 4.0, 0.01)
    run = simulate_inputs(graph.finish(), time, initial={"p_m": 1.0})
    speed, there, closed = 2.0, 0.0, []
    for way in (0.3, *[0.6] * 20):  # v'' = -0.8 m/s² while it slides
        left = speed**2 - 2.0 * 0.8 * way
        if left < 0.0:
            break
        there += (speed - np.sqrt(left)) / 0.8
        closed.append(there)
        speed = 0.8 * np.sqrt(left)
    assert times(run, EventKind.IMPACT) == pytest.approx(closed, abs=1e-9)
    assert times(run, EventKind.STICKS) == pytest.approx([there + speed / 0.8])
    assert np.ptp(run.output("x")[time > there + speed / 0.8]) < 1e-12
    assert run.audit.dissipated == pytest.approx(1.0, rel=1e-9)


def two_masses(restitution):
    graph = BondGraph("two masses", domain="translation")
    graph.one("left", I("m_left"))
    graph.one("right", I("m_right"))
    graph.one("way", R("bump", law=hard_contact(displacement("way") - gap, e)))
    graph.zero("press")
    graph.bond("left", "press")
    graph.bond("press", "right")
    graph.bond("press", "way")
    graph.measure("v_left", flow="left")
    graph.measure("v_right", flow="right")
    graph.parameter("m_left", 2.0, "kg")
    graph.parameter("m_right", 3.0, "kg")
    graph.parameter("gap", 0.5, "m")
    graph.parameter("e_stop", restitution)
    return graph.finish()


@pytest.mark.parametrize("restitution", [0.0, 0.35, 1.0])
def test_two_masses_that_collide_keep_their_momentum(restitution):
    time = np.arange(0.0, 1.0, 0.01)
    start = {"p_m_left": 2.0 * 1.5, "p_m_right": -3.0 * 0.5}
    run = simulate_inputs(two_masses(restitution), time, initial=start)
    assert times(run, EventKind.IMPACT) == pytest.approx([0.25])
    left, right = run.output("v_left")[-1], run.output("v_right")[-1]
    assert 2.0 * left + 3.0 * right == pytest.approx(1.5, rel=1e-13)
    assert right - left == pytest.approx(restitution * 2.0, abs=1e-13)
    lost = 0.5 * (2.0 * 3.0 / 5.0) * (1.0 - restitution**2) * 4.0
    assert run.audit.dissipated == pytest.approx(lost, abs=1e-12)
    assert run.audit.relative < 1e-12


def test_a_table_that_moves_gives_energy_at_each_impact():
    graph = BondGraph("on a table", domain="translation")
    graph.one("ball", I("m"), Se("weight", value=-m * g))
    graph.one("table", Sf("table_speed"))
    graph.one("gap", R("bump", law=-hard_contact(-displacement("gap"), e)))
    graph.zero("press")
    graph.bond("ball", "press")
    graph.bond("press", "table")
    graph.bond("press", "gap")
    graph.measure("above", displacement="gap")
    graph.parameter("m", 2.0, "kg")
    graph.parameter("g", GRAVITY, "m/s**2")
    graph.parameter("e_stop", 0.6)
    time, speed = np.arange(0.0, 1.0, 0.01), 0.3
    start = {"q_gap": 1.0, "p_m": 2.0 * speed}
    given = {"table_speed": speed}
    run = simulate_inputs(graph.finish(), time, initial=start, inputs=given)
    assert run.output("above") == pytest.approx(dropped(1.0, 0.6, time), abs=1e-10)
    struck = len(times(run, EventKind.IMPACT))
    lost = 2.0 * GRAVITY * (1.0 - 0.6 ** (2 * struck))
    assert run.audit.dissipated == pytest.approx(lost, rel=1e-10)
    assert run.audit.relative < 1e-12


def test_slopes_pass_an_impact_as_the_closed_solution_says():
    graph = ball(0.7)
    model = compile_model(derive(graph))
    time = np.arange(0.0, 1.5, 0.01)
    names = ("m", "g", "e_stop")
    wanted = np.array([model.parameter_names.index(n) for n in names], np.int64)
    shots = Shots(time, np.zeros((len(time), 1)), np.zeros((len(time), 1)), (0, 150))
    values = graph.parameters.values_by_name()
    shot = shoot(
        model,
        shots,
        parameters=np.array([values[name] for name in model.parameter_names]),
        initial=np.array([[0.0, 1.0]]),
        directions=wanted,
        solver=Sdirk2(),
        hold=Hold.FIRST,
    )
    assert len(shot.impacts[0]) == 2
    first = np.sqrt(2.0 / GRAVITY)
    # after the first impact: x = e g t1 (t - t1) - g (t - t1)² / 2
    s = time - first
    flying = (s > 0.0) & (s < 2.0 * 0.7 * first)
    by_e = GRAVITY * first * s
    by_first = 0.7 * GRAVITY * (s - first) + GRAVITY * s
    by_g = 0.7 * first * s - 0.5 * s**2 - by_first * first / (2.0 * GRAVITY)
    by_height = by_first * first / 2.0
    slopes = shot.sensitivities[:, model.output_names.index("x")]
    assert slopes[flying, 0] == pytest.approx(0.0, abs=1e-8)
    assert slopes[flying, 1] == pytest.approx(by_g[flying], rel=1e-6, abs=1e-7)
    assert slopes[flying, 2] == pytest.approx(by_e[flying], rel=1e-6, abs=1e-7)
    assert slopes[flying, 4] == pytest.approx(by_height[flying], rel=1e-6)


def test_both_engines_agree():
    graph = ball(0.6)
    model = compile_model(derive(graph))
    time = np.arange(0.0, 1.0, 0.01)
    shots = Shots(time, np.zeros((len(time), 1)), np.zeros((len(time), 1)), (0, 100))
    values = graph.parameters.values_by_name()
    runs = [
        shoot(
            model,
            shots,
            parameters=np.array([values[name] for name in model.parameter_names]),
            initial=np.array([[0.0, 1.0]]),
            directions=None,
            solver=Sdirk2(),
            hold=Hold.FIRST,
            engine=engine,
        )
        for engine in (Interpreted(), Native())
    ]
    assert runs[0].outputs == pytest.approx(runs[1].outputs, abs=1e-11)


def test_a_restitution_is_fitted():
    time = np.arange(0.0, 1.2, 0.02)
    x = dropped(1.0, 0.63, time) + 1e-3 * np.random.default_rng(3).normal(size=60)
    made = {"x": (x, "m"), "push": (np.zeros(60), "N")}
    recording = Recording.from_arrays("dropped", time, made)
    graph = ball(0.5, fit_it=True)
    settings = FitSettings(horizon=WholeRecordings())
    result = fit(graph, [bind_to(graph, recording)], settings=settings)
    (found,) = result.estimates
    assert abs(found.value - 0.63) < 4.0 * found.std
    assert found.std < 2e-3


def test_what_cannot_be_followed_is_refused_by_name():
    time = np.arange(0.0, 1.0, 0.01)
    for solver in (RungeKutta4(), Cvode(), Radau()):
        with pytest.raises(EquationError, match=r"hard contact of floor.*Sdirk2"):
            simulate_inputs(ball(), time, initial={"q_ball": 1.0}, solver=solver)
    graph = BondGraph("the wrong way", domain="translation")
    graph.one("ball", I("m"), R("floor", law=hard_contact(-displacement("ball"), e)))
    graph.parameter("m", 2.0, "kg")
    graph.parameter("e_stop", 0.5)
    graph.measure("x", displacement="ball")
    with pytest.raises(EquationError, match="floor pulls its gap further shut"):
        simulate_inputs(graph.finish(), time, initial={"q_ball": 1.0})


def test_a_contact_without_a_mass_is_refused():
    graph = BondGraph("no mass", domain="translation")
    stop = R("stop", law=hard_contact(displacement("tip") - gap, e))
    graph.one("tip", Se("push"), R("damper"), C("spring"), stop)
    graph.measure("x", displacement="tip")
    graph.parameter("damper", 1.0, "N*s/m")
    graph.parameter("spring", 1.0, "m/N")
    graph.parameter("gap", 0.1, "m")
    graph.parameter("e_stop", 0.0)
    with pytest.raises(EquationError, match="stop presses on no mass"):
        compile_model(derive(graph.finish()))


@pytest.mark.parametrize("seed", range(5))
def test_complementarity_is_solved(seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(5, 5))
    matrix, offset = root @ root.T + 0.1 * np.eye(5), rng.normal(size=5)
    z = complementary(matrix, offset)
    w = matrix @ z + offset
    assert z.min() >= 0.0
    assert w.min() >= -1e-9
    assert abs(z @ w) < 1e-9


@pytest.mark.parametrize("asked", [simulate_sparse, steady_state, to_nonlinear_io])
def test_what_does_not_know_hard_contacts_refuses_them_by_name(asked):
    more = (np.arange(0.0, 1.0, 0.1),) if asked is simulate_sparse else ()
    with pytest.raises(EquationError, match="hard contact of floor"):
        asked(ball(), *more)
