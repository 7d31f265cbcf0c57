"""A step of a held input reaches stores that have no state of their own at once."""

import numpy as np
import pytest

from bondgraph.fitting.estimate import FitSettings, fit
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.recordings.model_channels import bind_to
from bondgraph.recordings.recording import Recording
from bondgraph.simulation.adaptive import Radau
from bondgraph.simulation.jumps import SHARE, ramped
from bondgraph.simulation.run import simulate_inputs
from bondgraph.simulation.solvers import Hold, Sdirk2, Sdirk3
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import C, I, R, Se, Sf

TIME = 0.1 * np.arange(40)


def divider():
    """Two capacitors in series, the second with a resistor: v/u = s / (2 s + 1)."""
    graph = BondGraph("divider", domain="electrical")
    graph.zero("source", Se("u"))
    graph.one("loop", C("c1"))
    graph.zero("node", C("c2"), R("r"))
    graph.join("source", "loop")
    graph.join("loop", "node")
    graph.measure("v", effort="node")
    for name, unit in (("c1", "F"), ("c2", "F"), ("r", "ohm")):
        graph.parameter(name, 1.0, unit, std=None if name == "r" else 0.0)
    return graph.finish()


def stepped(at=10):
    return np.where(np.arange(len(TIME)) < at, 0.0, 1.0)


def answered(steps):
    """Return the exact answer to held steps: half of each at once, then it decays."""
    response, v = np.zeros(len(TIME)), 0.0
    for k in range(1, len(TIME)):
        v = v * np.exp(-(TIME[k] - TIME[k - 1]) / 2) + (steps[k] - steps[k - 1]) / 2
        response[k] = v
    return response


@pytest.mark.parametrize("solver", [Sdirk2(), Sdirk3(), Radau()], ids=repr)
def test_half_of_a_step_arrives_at_once(solver):
    steps = stepped() - 0.4 * stepped(25)
    run = simulate_inputs(
        divider(), TIME, inputs={"u": steps}, hold=Hold.ZERO, solver=solver
    )
    assert run.output("v") == pytest.approx(answered(steps), abs=2e-4)
    assert run.audit.relative < 1e-3
    assert len(run.time) == len(run.states) == len(TIME)


def test_a_driven_inertia_is_at_its_speed_with_the_command():
    graph = BondGraph("driven", domain="translation")
    graph.one("cart", Sf("speed"), I("mass"))
    graph.measure("force", effort="mass")
    graph.parameter("mass", 2.0, "kg")
    run = simulate_inputs(
        graph.finish(), TIME, inputs={"speed": stepped()}, hold=Hold.ZERO
    )
    assert run.audit.stored == pytest.approx(1.0, rel=1e-6)  # m v² / 2
    assert run.audit.supplied == pytest.approx(1.0, rel=1e-3)
    assert run.output("force") == pytest.approx(np.zeros(len(TIME)), abs=1e-9)


def test_what_was_recorded_of_held_steps_is_fitted():
    steps = np.random.default_rng(2).normal(size=len(TIME) // 4).repeat(4)
    channels = {"u": (steps, "V"), "v": (answered(steps), "V")}
    graph = divider()
    bound = bind_to(graph, Recording.from_arrays("steps", TIME, channels))
    wrong = graph.with_parameters({"r": 2.0})
    settings = FitSettings(hold=Hold.ZERO, horizon=WholeRecordings())
    found = fit(wrong, [bound], settings=settings)
    (r,) = found.estimates
    assert r.value == pytest.approx(1.0, rel=0.01)
    assert found.score.nrmse < 0.01


def test_a_ramp_stands_before_each_jump_and_windows_begin_after_theirs():
    inputs = np.array([[0.0], [0.0], [1.0], [1.0], [3.0], [2.0]])
    lines, rows = ramped(np.arange(6.0), inputs, (0, 4, 6))
    assert lines.time == pytest.approx([0, 1, 2 - SHARE, 2, 3, 4, 5 - SHARE, 5])
    assert lines.inputs[:, 0].tolist() == [0, 0, 0, 1, 1, 3, 3, 2]
    assert lines.edges == (0, 5, 8)
    assert lines.time[rows].tolist() == list(range(6))
    assert np.array_equal(lines.inputs[rows], inputs)
