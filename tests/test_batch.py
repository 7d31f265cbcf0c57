"""A batch gives for every set what a simulation of that set alone gives."""

import ctypes
import math
from dataclasses import replace

import numpy as np
import pytest
import sympy
from sympy import symbols

from bondgraph import BondGraph, C, I, R, Sdirk2, Se, derive, e, f, q
from bondgraph.errors import EquationError, ParameterError, RecordingError
from bondgraph.numeric.model import compile_model
from bondgraph.numeric.native.compiling import compiled_text, module_text, values_of
from bondgraph.numeric.tape import record_tape
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.batch import SetStatus, simulate_batch
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, RungeKutta4

LANES = 8


def on_lanes(expression, points):
    """Evaluate an expression of x and y at eight points by vector code."""
    x, y = symbols("x y")
    tape = record_tape([x, y], [], [expression], lambda _: True)
    code = compiled_text(module_text([values_of(tape, "values", LANES)], LANES))
    v = np.zeros((3, LANES))
    v[0], v[1] = points
    ctypes.CFUNCTYPE(None, ctypes.c_void_p)(code["values"])(v.ctypes.data)
    return v[2]


FUNCTIONS = {
    "exp": math.exp, "tanh": math.tanh, "sin": math.sin, "cos": math.cos,
    "atan": math.atan, "sinh": math.sinh, "log": lambda x: math.log(abs(x)),
}  # fmt: skip


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 0.3, 1.0, 5.0, 40.0, 1e5, 1e9])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_on_lanes_are_right_to_the_last_places(name, scale):
    x = symbols("x")
    law = sympy.log(sympy.Abs(x)) if name == "log" else getattr(sympy, name)(x)
    points = np.random.default_rng(3).normal(scale=scale, size=LANES)
    if name in {"exp", "sinh"}:
        points = np.clip(points, -600, 600)
    exact = np.array([FUNCTIONS[name](point) for point in points])
    found = on_lanes(law, (points, np.zeros(LANES)))
    assert np.abs(found - exact).max() <= 2 * np.spacing(np.abs(exact)).max()


def test_functions_on_lanes_at_the_edges_of_their_domain():
    points = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, -800.0, 650.0, 1.0])
    x = symbols("x")
    tanh = on_lanes(sympy.tanh(x), (points, points))
    assert np.array_equal(tanh, np.tanh(points), equal_nan=True)
    sine = on_lanes(sympy.sin(x), (points, points))
    assert np.isnan(sine[:3]).all()
    assert sine[3:] == pytest.approx(np.sin(points[3:]), abs=1e-15)
    power = on_lanes(sympy.exp(x), (points, points))
    assert power[1:6].tolist() == [math.inf, 0.0, 1.0, 1.0, 0.0]
    assert power[6:] == pytest.approx(np.exp(points[6:]), rel=1e-15)


def test_two_arguments_and_branches_on_lanes():
    x, y = symbols("x y")
    draw = np.random.default_rng(0)
    a, b = draw.normal(size=(2, LANES))
    assert on_lanes(sympy.atan2(x, y), (a, b)) == pytest.approx(np.arctan2(a, b))
    law = sympy.Piecewise((x, x < y), (-y, True))
    assert on_lanes(law, (a, b)) == pytest.approx(np.where(a < b, a, -b))


KNOWN = {"J": 0.1, "weight": 4.0, "coulomb": 0.3, "viscous": 0.02, "slip": 0.01}


def pendulum():
    weight, coulomb, viscous, slip = symbols("weight coulomb viscous slip")
    g = BondGraph("pendulum", domain="rotation")
    friction = coulomb * sympy.tanh(f / slip) + viscous * f
    g.one(
        "axle",
        Se("torque"),
        I("J"),
        R("friction", law=friction),
        C("mass", law=weight * sympy.sin(q)),
    )
    g.measure("angle", displacement="axle")
    g.measure("net", effort="J")
    g.parameter("viscous", 0.02, "N*m*s/rad")
    return g.finish()


def recorded(samples=200):
    draw = np.random.default_rng(8)
    time = 1e-3 * np.cumsum(draw.uniform(0.5, 1.5, samples))
    torque = 1.5 * np.sin(20 * time) + 0.3 * draw.normal(size=samples)
    return BoundRecording(
        name="bench",
        time=time,
        inputs=torque[:, None],
        outputs=np.full((samples, 2), np.nan),
        input_names=("torque",),
        output_names=("angle", "net"),
        input_units=("N*m",),
        output_units=("rad", "N*m"),
    )


def some_sets(n):
    draw = np.random.default_rng(2)
    return [{k: v * draw.uniform(0.7, 1.4) for k, v in KNOWN.items()} for _ in range(n)]


@pytest.mark.parametrize("hold", Hold)
@pytest.mark.parametrize("solver", [RungeKutta4(2), Sdirk2()], ids=str)
def test_every_set_is_simulated_as_it_would_be_alone(solver, hold):
    graph, recording, sets = pendulum(), recorded(), some_sets(19)
    batch = simulate_batch(
        graph, sets, recording, initial={"q_mass": 0.3}, solver=solver, hold=hold
    )
    assert batch.simulated.shape == (19, 200, 2)
    assert set(batch.status) == {SetStatus.SUCCESSFUL}
    model = compile_model(derive(graph))
    shots = Shots(recording.time, recording.inputs, recording.outputs, (0, 200))
    for k in (0, 7, 8, 18):
        alone = shoot(
            model,
            shots,
            parameters=np.array([sets[k][name] for name in model.parameter_names]),
            initial=np.array(
                [[0.3 if s == "q_mass" else 0 for s in model.state_names]]
            ),
            directions=None,
            solver=solver,
            hold=hold,
        )
        assert batch.simulated[k] == pytest.approx(alone.outputs, rel=1e-11, abs=1e-12)
    assert np.array_equal(batch.output("net"), batch.simulated[:, :, 1])


def test_a_set_that_runs_away_has_its_own_status():
    k = symbols("k")
    g = BondGraph("runaway", domain="translation")
    g.one("cart", Se("torque"), I("m"), R("push", law=-k * f**3))
    g.measure("v", flow="cart")
    recording = recorded()
    still = {"k": 0.0, "m": 1.0}
    for solver in (RungeKutta4(), Sdirk2()):
        batch = simulate_batch(
            g.finish(),
            [still, {"k": 40.0, "m": 1.0}, still],
            recording,
            initial={"p_m": 1.0},
            solver=solver,
        )
        fine, bad = SetStatus.SUCCESSFUL, SetStatus.NOT_FINITE
        assert batch.status == (fine, bad, fine)
        done = batch.samples_done[1]
        # v̇ = 40 v³ reaches infinity after 1 / 80 s, but for the force of the recording.
        assert 0.005 < recording.time[done] - recording.time[0] < 0.03
        assert np.isfinite(batch.simulated[1, :done]).all()
        assert np.isnan(batch.simulated[1, done:]).all()


def test_what_a_set_leaves_out_is_the_graph_s():
    one, other = (
        simulate_batch(pendulum(), [known], recorded()).simulated
        for known in (KNOWN, {k: v for k, v in KNOWN.items() if k != "viscous"})
    )
    assert np.array_equal(one, other)


def test_no_sets_give_no_simulations():
    batch = simulate_batch(pendulum(), [], recorded())
    assert batch.simulated.shape == (0, 200, 2)
    assert batch.status == ()


def test_what_cannot_be_simulated_is_refused_by_name():
    graph, recording = pendulum(), recorded()
    with pytest.raises(ParameterError, match="'wieght'"):
        simulate_batch(graph, [{**KNOWN, "wieght": 1.0}], recording)
    with pytest.raises(ParameterError, match="coulomb"):
        simulate_batch(graph, [{"J": 1.0, "weight": 1.0, "slip": 1.0}], recording)
    with pytest.raises(ParameterError, match="'angle'"):
        simulate_batch(graph, [KNOWN], recording, initial={"angle": 1.0})
    gap = recording.inputs.copy()
    gap[3] = np.nan
    with pytest.raises(RecordingError, match="without"):
        simulate_batch(graph, [KNOWN], replace(recording, inputs=gap))


def test_an_implicit_model_needs_an_implicit_method():
    k, s = symbols("k s")
    g = BondGraph("divider")
    g.one("line", Se("torque"), R("valve", law=k * (f + f**3)))
    g.zero("node", R("shunt", law=s * (e + e**3)))
    g.one("coil", I("l"), R("r"))
    g.join("line", "node")
    g.join("node", "coil")
    g.measure("i", flow="coil")
    known = [{"k": 1.5, "s": 0.6, "l": 0.4, "r": 0.9}]
    with pytest.raises(EquationError, match="implicitly"):
        simulate_batch(g.finish(), known, recorded())
    batch = simulate_batch(g.finish(), known, recorded(), solver=Sdirk2())
    assert batch.status == (SetStatus.SUCCESSFUL,)
