"""Simulation from Python: inputs, statuses, energy audits, events, adaptive solvers."""

import sys

import numpy as np
import pytest
import sympy
from catalogue import CASES, somewhere
from scipy.integrate import solve_ivp

from bondgraph import BondGraph, C, I, R, Sdirk2, Sdirk3, Se, Sf, e, f, p, q, t
from bondgraph.errors import EquationError, MissingExtraError, ParameterError
from bondgraph.simulation.adaptive import Cvode, Ida, Radau
from bondgraph.simulation.events import EventKind
from bondgraph.simulation.run import simulate_inputs
from bondgraph.simulation.solvers import Hold, RungeKutta4
from bondgraph.simulation.trouble import RunStatus

SUNDIALS = [Cvode(), Ida()]
ADAPTIVE = [*SUNDIALS, Radau()]


def named(solver):
    return type(solver).__name__


def symbols(names):
    return sympy.symbols(names, real=True)


def oscillator(**values):
    g = BondGraph("oscillator", domain="translation")
    known = {"m": 2.0, "c": 0.1, "b": 0.3, **values}
    g.one("mass", Se("force"), I("m"), C("c"), R("b"))
    g.measure("x", displacement="mass")
    g.measure("v", flow="mass")
    return g.finish().with_parameters(known)


def numbered(case):
    graph = case.graph()
    values = {
        str(s): value
        for s, value in somewhere({sympy.Symbol(n) for n in graph.parameters}).items()
    }
    values |= {k: v for k, v in case.where.items() if k in graph.parameters}
    return graph.with_parameters(values)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_energy_audit_closes_on_every_graph_of_the_catalogue(case):
    graph = numbered(case)
    time = np.linspace(0, 1, 501)
    inputs = {
        source.name: 0.1 * k + 0.5 * np.sin((3 + k) * time)
        for k, source in enumerate(graph.inputs)
    }
    names = simulate_inputs(graph, [0.0], inputs=dict.fromkeys(inputs, 0.0)).state_names
    start = dict(zip(names, np.linspace(0.1, 0.3, len(names)), strict=True))
    start |= {k: v for k, v in case.where.items() if k in names}
    run = simulate_inputs(
        graph, time, inputs=inputs, initial=start, solver=Sdirk3(substeps=4)
    )
    assert run.status is RunStatus.SUCCESSFUL, run.reason
    assert run.audit.relative < 1e-6


def test_the_audit_of_a_free_swing_is_what_was_lost():
    graph = oscillator()
    time = np.linspace(0, 2, 401)
    run = simulate_inputs(graph, time, initial={"q_c": 0.2}, solver=Sdirk3())
    held = run.state("q_c") ** 2 / (2 * 0.1) + run.state("p_m") ** 2 / (2 * 2.0)
    assert run.audit.supplied == 0.0
    assert run.audit.stored == pytest.approx(held[-1] - held[0])
    lost = np.trapezoid(0.3 * run.output("v") ** 2, time)
    assert run.audit.dissipated == pytest.approx(lost, rel=1e-4)
    assert run.audit.relative < 1e-6


def test_coarse_steps_show_in_the_audit():
    graph = oscillator(b=0.0)
    audits = [
        simulate_inputs(graph, np.linspace(0, 2, n), initial={"q_c": 0.2}).audit
        for n in (21, 41, 81)
    ]
    sizes = [audit.relative for audit in audits]
    assert sizes[0] > 1e-4
    assert sizes[0] > 6 * sizes[1] > 36 * sizes[2]


@pytest.mark.parametrize("solver", ADAPTIVE, ids=named)
def test_adaptive_solvers_agree_with_an_independent_solution(solver):
    if solver in SUNDIALS:
        pytest.importorskip("sksundae", reason="scikit-sundae brings SUNDIALS")
    run = simulate_inputs(
        oscillator(),
        np.linspace(0, 3, 31),
        inputs={"force": lambda t: np.sin(3 * t)},
        initial={"q_c": 0.2},
        solver=solver,
    )
    known = solve_ivp(
        lambda t, y: [y[1], (np.sin(3 * t) - 10 * y[0] - 0.3 * y[1]) / 2.0],
        (0, 3),
        [0.2, 0.0],
        t_eval=run.time,
        rtol=1e-11,
        atol=1e-13,
    ).y
    assert run.status is RunStatus.SUCCESSFUL
    assert run.output("x") == pytest.approx(known[0], abs=2e-7)
    assert run.output("v") == pytest.approx(known[1], abs=2e-7)
    assert run.audit.relative < 1e-6


@pytest.mark.parametrize("solver", [Ida(), Radau()], ids=named)
def test_stiff_loops_of_index_one_are_solved(solver):
    if solver in SUNDIALS:
        pytest.importorskip("sksundae", reason="scikit-sundae brings SUNDIALS")
    g = BondGraph("divider")
    k, s = symbols("k s")
    g.one("line", Se("u"), R("valve", law=k * (f + f**3)))
    g.zero("node", R("shunt", law=s * (e + e**3)))
    g.one("coil", I("l"), R("r"))
    g.join("line", "node")
    g.join("node", "coil")
    g.measure("i", flow="coil")
    g.measure("v", effort="node")
    graph = g.finish().with_parameters({"k": 1.5, "s": 0.6, "l": 1e-3, "r": 0.9})
    drive = {"u": lambda t: 2 * np.sin(9 * t)}
    time = np.linspace(0, 1, 41)
    run = simulate_inputs(graph, time, inputs=drive, solver=solver)
    assert run.status is RunStatus.SUCCESSFUL, run.reason
    current, v = run.output("i"), run.output("v")
    line = current + 0.6 * (v + v**3)
    assert 1.5 * (line + line**3) == pytest.approx(2 * np.sin(9 * time) - v, abs=1e-7)
    fixed = simulate_inputs(
        graph, time, inputs=drive, solver=Sdirk3(substeps=400), hold=Hold.FIRST
    )
    assert fixed.output("i") == pytest.approx(current, abs=5e-3)


@pytest.mark.parametrize("solver", [Sdirk3(substeps=20), *ADAPTIVE], ids=named)
@pytest.mark.parametrize("hold", Hold)
def test_held_and_joined_inputs_are_met_exactly(solver, hold):
    if solver in SUNDIALS:
        pytest.importorskip("sksundae", reason="scikit-sundae brings SUNDIALS")
    g = BondGraph("integrator", domain="translation")
    g.one("mass", Se("force"), I("m"))
    g.measure("v", flow="mass")
    graph = g.finish().with_parameters({"m": 0.5})
    time = np.array([0.0, 0.3, 0.4, 1.0, 1.5])
    force = np.array([1.0, -2.0, 4.0, 0.5, 9.0])
    run = simulate_inputs(
        graph, time, inputs={"force": force}, solver=solver, hold=hold
    )
    area = np.diff(time) * force[:-1]
    if hold is Hold.FIRST:
        area = np.diff(time) * (force[:-1] + force[1:]) / 2
    assert run.output("v")[1:] == pytest.approx(np.cumsum(area) / 0.5, abs=1e-7)


def test_sundials_missing_is_said_with_the_way_out(monkeypatch):
    monkeypatch.setitem(sys.modules, "sksundae.cvode", None)
    with pytest.raises(MissingExtraError, match=r"\[stiff\].*Radau"):
        simulate_inputs(oscillator(), [0.0, 1.0], solver=Cvode())


def runaway():
    g = BondGraph("runaway", domain="translation")
    (k,) = symbols(["k"])
    g.one("cart", Se("force"), I("m"), R("push", law=-k * f**3))
    g.measure("v", flow="cart")
    return g.finish().with_parameters({"k": 1.0, "m": 1.0})


@pytest.mark.parametrize("solver", [Sdirk2(), Radau()], ids=named)
def test_a_failure_says_where_and_what_and_the_way_out(solver):
    # v̇ = v³ from 1 m/s is infinite after half a second.
    run = simulate_inputs(
        runaway(), np.linspace(0, 2, 201), initial={"p_m": 1.0}, solver=solver
    )
    assert run.status is not RunStatus.SUCCESSFUL
    assert 0.4 < run.reached < 0.55
    assert f"t = {run.reached:.6g}"[:6] in run.reason
    assert run.reason.count(".") >= 2
    assert np.isnan(run.outputs[-1]).all()
    assert np.isfinite(run.outputs[run.time <= run.reached]).all()


def test_the_failing_unknown_is_named():
    run = simulate_inputs(runaway(), np.linspace(0, 2, 201), initial={"p_m": 1.0})
    assert "rate of p_m" in run.reason


def test_an_output_that_is_not_a_number_is_no_success():
    g = BondGraph("logged", domain="translation")
    g.one("mass", Se("force"), I("m"))
    g.measure("v", flow="mass")
    from bondgraph import flow  # noqa: PLC0415

    g.measure("log", sympy.log(flow("mass")), unit="1")
    graph = g.finish().with_parameters({"m": 1.0})
    run = simulate_inputs(
        graph, np.linspace(0, 2, 21), inputs={"force": -1.0}, initial={"p_m": 1.05}
    )
    assert run.status is RunStatus.OUTPUT_NOT_FINITE
    assert "log" in run.reason
    assert run.reached == 2.0


def test_half_the_step_tells_the_solver_s_error():
    graph = oscillator(b=0.0)
    time = np.linspace(0, 3, 61)
    run = simulate_inputs(
        graph, time, initial={"q_c": 0.2}, solver=Sdirk2(), estimate_error=True
    )
    exact = 0.2 * np.cos(np.sqrt(5.0) * time)
    true = np.abs(run.output("x") - exact).max()
    # Of second order: half the step leaves a quarter, so three quarters are seen.
    assert run.solver_error[0] == pytest.approx(0.75 * true, rel=0.1)


def stop(hard):
    """A mass thrown against a damped spring that only pushes, 0.1 m away."""
    g = BondGraph("end stop", domain="translation")
    k, gap = symbols("k gap")
    pushes = k * sympy.Max(q - gap, 0)
    if not hard:
        pushes = sympy.Piecewise((k * (q - gap), q > gap), (0, True))
    g.one("mass", I("m"), C("stop", law=pushes))
    g.measure("x", displacement="mass")
    g.measure("v", flow="mass")
    return g.finish().with_parameters({"m": 1.0, "k": 1e4, "gap": 0.1})


@pytest.mark.parametrize("hard", [True, False])
def test_an_end_stop_touches_and_lets_go(hard):
    time = np.linspace(0, 0.3, 3001)
    run = simulate_inputs(
        stop(hard), time, initial={"p_m": 1.0}, solver=Sdirk3(substeps=4)
    )
    kinds = [event.kind for event in run.events]
    assert kinds == [EventKind.CONTACT, EventKind.RELEASE]
    contact, release = (event.time for event in run.events)
    assert contact == pytest.approx(0.1, abs=2e-4)
    # Half a period of the spring, then it flies back as fast as it came.
    assert release == pytest.approx(0.1 + np.pi / 100, abs=2e-4)
    assert run.output("v")[-1] == pytest.approx(-1.0, abs=1e-5)
    assert run.output("x").max() == pytest.approx(0.1 + 1 / 100, abs=1e-6)
    assert run.audit.relative < 1e-6


def braked():
    g = BondGraph("braked", domain="translation")
    (tau,) = symbols(["tau"])
    g.one("mass", Se("force"), I("m"), R("rub", law=tau * sympy.sign(f)))
    g.measure("v", flow="mass")
    return g.finish().with_parameters({"tau": 1.0, "m": 2.0})


def test_stick_and_slip_are_events():
    time = np.linspace(0, 10, 1001)
    run = simulate_inputs(
        braked(), time, inputs={"force": 1.05 * np.sin(time)}, initial={"p_m": 1.0}
    )
    assert run.status is RunStatus.SUCCESSFUL
    kinds = [event.kind for event in run.events]
    assert EventKind.STICKS in kinds
    assert EventKind.SLIPS in kinds
    assert {event.place for event in run.events} == {"rub"}
    v = run.output("v")
    for event in run.events:
        row = np.searchsorted(time, event.time)
        if event.kind is EventKind.SLIPS:
            assert abs(abs(1.05 * np.sin(event.time)) - 1.0) < 0.01
            assert np.abs(v[row - 3]) < 1e-12 < np.abs(v[row + 3])
    stick = next(x for x in run.events if x.kind is EventKind.STICKS)
    free = solve_ivp(
        lambda t, y: [(1.05 * np.sin(t) - 1.0) / 2.0],
        (0, 10),
        [0.5],
        events=lambda t, y: y[0],
        rtol=1e-11,
        atol=1e-13,
    )
    crossings = free.t_events[0]
    assert min(abs(crossings - stick.time)) < 1e-4


def test_adaptive_solvers_refuse_friction_that_sticks():
    with pytest.raises(EquationError, match=r"rub.*Sdirk2.*tanh"):
        simulate_inputs(braked(), [0.0, 1.0], solver=Radau())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"inputs": {"forse": 1.0}}, "force"),
        ({"inputs": {"force": [1.0, 2.0, 3.0]}}, "one value per sample"),
        ({"initial": {"p_x": 1.0}}, "p_m"),
    ],
)
def test_wrong_names_and_shapes_are_refused(arguments, words):
    with pytest.raises(EquationError, match=words):
        simulate_inputs(oscillator(), [0.0, 1.0], **arguments)


def test_time_must_increase_and_parameters_have_values():
    with pytest.raises(EquationError, match="do not increase"):
        simulate_inputs(oscillator(), [0.0, 1.0, 1.0])
    g = BondGraph("bare")
    g.one("loop", Se("u"), R("r"), I("l"))
    with pytest.raises(ParameterError, match="r"):
        simulate_inputs(g.finish(), [0.0, 1.0])


def test_an_explicit_solver_runs_too_and_a_storage_may_depend_on_time():
    g = BondGraph("warming", domain="translation")
    k, m = symbols("k m")
    g.one("mass", I("body", law=p / m), C("spring", law=k * (1 + t) * q))
    g.measure("x", displacement="mass")
    graph = g.finish().with_parameters({"k": 4.0, "m": 1.2})
    time = np.linspace(0, 2, 401)
    runs = [
        simulate_inputs(graph, time, initial={"q_spring": 0.3}, solver=solver)
        for solver in (RungeKutta4(), Sdirk3())
    ]
    assert runs[0].output("x") == pytest.approx(runs[1].output("x"), abs=1e-6)
    for run in runs:
        assert run.audit.exchanged != 0.0
        assert run.audit.relative < 1e-6


def test_a_source_of_flow_supplies_what_its_load_takes():
    g = BondGraph("pump", domain="hydraulic")
    g.zero("tank", Sf("inflow"), C("area"), R("leak"))
    g.measure("level", effort="tank")
    graph = g.finish().with_parameters({"area": 2.0, "leak": 3.0})
    run = simulate_inputs(graph, np.linspace(0, 5, 501), inputs={"inflow": 1.0})
    level = 3.0 * (1 - np.exp(-run.time / 6))
    assert run.output("level") == pytest.approx(level, abs=1e-6)
    assert run.audit.supplied == pytest.approx(np.trapezoid(level, run.time), rel=1e-5)
