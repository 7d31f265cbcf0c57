"""A model beside a recording: its energy audit, events and reason, in text and JSON."""

import json
import re

import numpy as np
import pytest
from click.testing import CliRunner

from bondgraph import (
    BondGraph,
    FitSettings,
    I,
    R,
    Recording,
    Se,
    Windows,
    bind_to,
    load_model,
    simulate,
)
from bondgraph.cli.program import program
from bondgraph.fitting.simulate import SolveStatus

MASS, VISCOUS, STEP = 2.0, 0.8, 0.01
MODEL = """
import sympy
from bondgraph import BondGraph, I, R, Se, f

def cart() -> BondGraph:
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("viscous"))
    graph.measure("velocity", flow="carriage")
    graph.parameter("mass", 2.0, "kg")
    graph.parameter("viscous", 0.8, "N*s/m")
    return graph

def dry() -> BondGraph:
    graph = BondGraph("dry", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("dry", law=sympy.sign(f)))
    graph.measure("velocity", flow="carriage")
    graph.parameter("mass", 2.0, "kg")
    return graph

def runaway() -> BondGraph:
    graph = BondGraph("runaway", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("drive", law=-1e6 * f**3))
    graph.measure("velocity", flow="carriage")
    graph.parameter("mass", 2.0, "kg")
    return graph
"""


def exact_cart(count=400):
    """Return time, force and velocity of the cart under a sine, solved by hand."""
    time = STEP * np.arange(count)
    rate, omega = VISCOUS / MASS, 5.0
    size = 1.0 / (MASS * (rate**2 + omega**2))
    steady = size * (rate * np.sin(omega * time) - omega * np.cos(omega * time))
    velocity = steady + (0.3 - steady[0]) * np.exp(-rate * time)
    return time, np.sin(omega * time), velocity


def cart():
    g = BondGraph("cart", domain="translation")
    g.one("carriage", Se("force"), I("mass"), R("viscous"))
    g.measure("velocity", flow="carriage")
    g.parameter("mass", MASS, "kg")
    g.parameter("viscous", VISCOUS, "N*s/m")
    return g.finish()


def recording(graph):
    time, force, velocity = exact_cart()
    channels = {"force": (force, "N"), "velocity": (velocity, "m/s")}
    return bind_to(graph, Recording.from_arrays("sine", time, channels))


def test_the_audit_is_the_energy_of_the_exact_solution():
    graph = cart()
    solution = simulate(graph, recording(graph))
    time, force, velocity = exact_cart()
    assert solution.status is SolveStatus.SUCCESSFUL
    assert solution.reason == ""
    assert solution.events == ()
    (ran,) = solution.runs
    np.testing.assert_allclose(ran.outputs, solution.simulated, rtol=0, atol=1e-12)
    gained = 0.5 * MASS * (velocity[-1] ** 2 - velocity[0] ** 2)
    lost = np.trapezoid(VISCOUS * velocity**2, time)
    given = np.trapezoid(force * velocity, time)
    assert solution.audit.stored == pytest.approx(gained, rel=1e-3)
    assert solution.audit.dissipated == pytest.approx(lost, rel=1e-3)
    assert solution.audit.supplied == pytest.approx(given, rel=1e-3)
    assert solution.audit.relative < 1e-3


def test_the_audit_of_windows_is_the_sum_of_their_audits():
    graph = cart()
    settings = FitSettings(horizon=Windows(100))
    solution = simulate(graph, recording(graph), settings=settings)
    assert len(solution.runs) == 4
    total = sum(run.audit.dissipated for run in solution.runs)
    assert solution.audit.dissipated == pytest.approx(total)
    assert solution.audit.relative == max(run.audit.relative for run in solution.runs)


def test_a_run_that_fails_says_when_and_why(tmp_path):
    path = tmp_path / "cart.py"
    path.write_text(MODEL)
    graph = load_model(f"{path}:runaway")
    solution = simulate(graph, bound_to_runaway(graph))
    assert solution.status is SolveStatus.FAILED
    assert "after t = " in solution.reason
    assert np.isnan(solution.simulated).all()


def bound_to_runaway(graph):
    time, force, velocity = exact_cart(50)
    channels = {"force": (force, "N"), "velocity": (velocity + 1.0, "m/s")}
    return bind_to(graph, Recording.from_arrays("sine", time, channels))


def answer(*words):
    return CliRunner().invoke(program, [str(word) for word in words])


@pytest.fixture
def files(tmp_path):
    model, table = tmp_path / "cart.py", tmp_path / "sine.csv"
    model.write_text(MODEL)
    header = "time [s],force [N],velocity [m/s]"
    np.savetxt(
        table, np.column_stack(exact_cart()), delimiter=",", header=header, comments=""
    )
    return model, table


def test_the_command_tells_energy_and_events(files):
    model, table = files
    shown = answer("simulate", f"{model}:cart", table).stdout
    assert "J supplied" in shown
    assert "J dissipated" in shown
    assert "the balance closes to" in shown
    assert "Events: none." in shown
    told = json.loads(answer("simulate", f"{model}:cart", table, "--json", "-").stdout)
    _, force, velocity = exact_cart()
    given = STEP * float(np.sum(force * velocity))
    assert told["energy"]["supplied"] == pytest.approx(given, rel=0.02)
    assert told["events"] == []
    assert told["reason"] == ""


def test_the_command_lists_few_events_and_counts_many(files, tmp_path):
    model, _ = files
    # Coasting at 0.5 m/s against 1 N, 2 kg stop after 1 s; then ten pushes of 2 N.
    time = STEP * np.arange(2000)
    pushes = 2.0 * ((time > 2.0) & (time % 1.8 < 0.2))
    velocity = np.maximum(0.5 - 0.5 * time, 0.0)
    for name, force in (("coast", 0.0 * time), ("pushed", pushes)):
        table = np.column_stack([time, force, velocity])
        header = "time [s],force [N],velocity [m/s]"
        path = tmp_path / f"{name}.csv"
        np.savetxt(path, table, delimiter=",", header=header, comments="")
        words = ("simulate", f"{model}:dry", path, "--hold", "zero")
        shown = answer(*words).stdout
        events = json.loads(answer(*words, "--json", "-").stdout)["events"]
        assert [e["kind"] for e in events[:1]] == ["sticks"]
        assert events[0]["place"] == "dry"
        if name == "coast":
            assert len(events) == 1
            assert events[0]["time"] == pytest.approx(1.0, abs=0.02)
            assert "Events: dry sticks at 1" in shown
        else:
            assert re.search(r"dry \(.*slips 10 times", shown)


def test_the_command_refuses_with_the_reason(files):
    model, table = files
    result = answer("simulate", f"{model}:runaway", table)
    assert result.exit_code == 2
    assert "after t = " in result.stderr
