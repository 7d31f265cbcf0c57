"""Stiff, singular, unstable and badly scaled machines: an answer, or why there is none.

The answers follow from the equations by hand.
"""

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, R, Sdirk2, Sdirk3, Se, displacement
from bondgraph.simulation.run import simulate_inputs
from bondgraph.simulation.trouble import RunStatus

TIME = np.linspace(0.0, 1.0, 101)


def cart(mass, viscous):
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("viscous"))
    graph.measure("velocity", flow="carriage")
    return graph.finish().with_parameters({"mass": mass, "viscous": viscous})


def circuit(resistance, capacitance):
    graph = BondGraph("filter", domain="electrical")
    graph.one("line", Se("u"), R("r"))
    graph.zero("node", C("c"))
    graph.join("line", "node")
    graph.measure("voltage", effort="node")
    values = {"r": resistance, "c": capacitance}
    return graph.finish().with_parameters(values)


def loop(second):
    graph = BondGraph("loop", domain="electrical")
    graph.one("line", Se("u"), R("r1"), R("r2"))
    graph.measure("current", flow="line")
    return graph.finish().with_parameters({"r1": 1.0, "r2": second})


def shaft(second):
    graph = BondGraph("shaft", domain="translation")
    graph.one("line", Se("u"), I("m1"), I("m2"), R("r"))
    graph.measure("velocity", flow="line")
    values = {"m1": 1.0, "m2": second, "r": 1.0}
    return graph.finish().with_parameters(values)


@pytest.mark.parametrize(("mass", "viscous"), [(1.0, 1e9), (1e-9, 1.0)])
def test_rates_of_a_billion_a_second_are_stepped_over(mass, viscous):
    force = {"force": lambda t: 1.0 + t}
    run = simulate_inputs(cart(mass, viscous), TIME, inputs=force)
    assert run.status is RunStatus.SUCCESSFUL, run.reason
    # Long after the first nanoseconds the damper takes all of the force.
    assert run.output("velocity")[5:] * viscous == pytest.approx(1 + TIME[5:], rel=1e-6)


def test_what_grows_beyond_all_numbers_says_when_and_what():
    time = np.linspace(0.0, 1.0, 10_001)
    run = simulate_inputs(cart(1.0, -1e3), time, initial={"p_mass": 1.0})
    assert run.status is RunStatus.NOT_FINITE
    # The largest double is e^709.8, and the energy goes with the square of the speed.
    assert run.reached == pytest.approx(0.3549, abs=0.005)
    assert "rate of p_mass" in run.reason
    assert np.isnan(run.outputs[-1]).all()


@pytest.mark.parametrize("solver", [Sdirk2(), Sdirk3()])
def test_growth_that_steps_are_too_coarse_for_is_told(solver):
    # An implicit step of a hundred time constants calms what grows.
    start = {"p_mass": 1.0}
    run = simulate_inputs(cart(1.0, -1e4), TIME, initial=start, solver=solver)
    assert np.abs(run.output("velocity")[1:]).max() < 1.0
    assert run.status is RunStatus.GROWTH_NOT_FOLLOWED
    assert "p_mass grows e-fold in 0.0001 s, and a step takes 0.01 s" in run.reason
    assert run.audit.relative > 0.5


@pytest.mark.parametrize("viscous", [1e9, -200.0])
def test_decay_that_is_stepped_over_and_growth_that_is_followed_are_no_trouble(viscous):
    # Both are ten or more time constants in the 10 ms of a sample; growth has substeps.
    solver = Sdirk2(substeps=20)
    start = {"p_mass": 1.0}
    time = TIME[:20]
    run = simulate_inputs(cart(1.0, viscous), time, initial=start, solver=solver)
    assert run.status is RunStatus.SUCCESSFUL, run.reason
    if viscous < 0.0:
        expected = np.exp(-viscous * time)
        assert run.output("velocity") == pytest.approx(expected, rel=0.02)


def latch(grip):
    """A mass that a spring throws from the middle to one of two rests, x = ±1."""
    x = displacement("middle")
    graph = BondGraph("latch", domain="translation")
    graph.one("middle", I("mass"), C("spring", law=grip * (x**3 - x)), R("viscous"))
    graph.measure("position", displacement="middle")
    return graph.finish().with_parameters({"mass": 1e-9, "viscous": 1.0})


def test_a_latch_that_stays_open_is_told_and_one_that_falls_shut_is_not():
    start = {"q_spring": 1e-3}
    held = simulate_inputs(latch(1e4), TIME, initial=start)
    assert abs(held.output("position")[-1]) < 0.5
    assert held.status is RunStatus.GROWTH_NOT_FOLLOWED
    shut = simulate_inputs(latch(50.0), TIME, initial=start)
    assert shut.output("position")[-1] == pytest.approx(1.0, rel=1e-3)
    assert shut.status is RunStatus.SUCCESSFUL, shut.reason


def test_a_loop_without_a_solution_is_singular_and_names_its_unknown():
    run = simulate_inputs(loop(-1.0), TIME, inputs={"u": 1.0})
    assert run.status is RunStatus.SINGULAR
    assert "r1" in run.reason
    assert np.isnan(run.outputs).all()


def test_a_nearly_singular_loop_is_as_good_as_its_numbers():
    second = -1.0 + 1e-12
    run = simulate_inputs(loop(second), TIME, inputs={"u": 1.0})
    assert run.status is RunStatus.SUCCESSFUL, run.reason
    expected = 1.0 / (1.0 + second)  # 1e12, to the four digits that doubles leave
    assert run.output("current") == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("left", [1e-9, 0.0])
def test_masses_that_cancel_leave_the_damper(left):
    run = simulate_inputs(shaft(-1.0 + left), TIME, inputs={"u": 1.0})
    assert run.status is RunStatus.SUCCESSFUL, run.reason
    assert run.output("velocity")[1:] == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("scale", [1e12, 1e-12, 1e150])
def test_other_units_of_resistance_change_no_digit_of_a_voltage(scale):
    drive = {"u": lambda t: np.sin(9.0 * t)}
    plain, scaled = (
        simulate_inputs(circuit(r, c), TIME, inputs=drive)
        for r, c in ((1.0, 1.0), (scale, 1.0 / scale))
    )
    assert scaled.status is RunStatus.SUCCESSFUL, scaled.reason
    assert scaled.output("voltage") == pytest.approx(
        plain.output("voltage"), rel=1e-12, abs=1e-15
    )
