"""Fits against machines simulated by scipy, whose parameters are known.

The data come from `scipy.signal.lsim`, exact for inputs joined by straight lines, so
nothing of the toolkit is used to make what it must find.
"""

import numpy as np
import pytest
import sympy
from scipy.signal import lfilter, lsim

from bondgraph import (
    GY,
    Automatic,
    BondGraph,
    C,
    FitSettings,
    FitStatus,
    I,
    R,
    Recording,
    Sdirk3,
    Se,
    Sf,
    WholeRecordings,
    Windows,
    bind_to,
    displacement,
    f,
    fit,
    q,
)
from bondgraph.errors import FitError, ParameterError
from bondgraph.fitting.estimate import accumulates, fit_model, prepare
from bondgraph.recordings.binding import BoundRecording

WHOLE = FitSettings(horizon=WholeRecordings())


def rng(seed):
    return np.random.default_rng(seed)


def excitation(n, *, seed, width=5):
    """Return noise smoothed over `width` samples, of size one."""
    rough = rng(seed).normal(size=n + width)
    smooth = np.convolve(rough, np.ones(width) / np.sqrt(width), mode="valid")
    return smooth[:n]


def coloured(n, *, seed, correlation, std=1.0):
    """Return AR(1) noise of a given standard deviation."""
    white = rng(seed).normal(size=n + 200) * np.sqrt(1 - correlation**2)
    return std * lfilter([1.0], [1.0, -correlation], white)[200:]


def recorded(graph, time, **channels):
    """Return channels in SI units of the graph as a bound recording."""
    units = {source.name: graph.input_unit(source.name) for source in graph.inputs}
    units |= {m.name: m.unit for m in graph.measurements}
    named = {name: (values, units[name]) for name, values in channels.items()}
    return bind_to(graph, Recording.from_arrays("made", time, named))


def masked(recording, outputs):
    """Return the recording with other outputs, where NaN means not measured."""
    return BoundRecording(
        name=recording.name,
        time=recording.time,
        inputs=recording.inputs,
        outputs=outputs,
        input_names=recording.input_names,
        output_names=recording.output_names,
        input_units=recording.input_units,
        output_units=recording.output_units,
    )


def within(result, truth, times=3.0):
    """Assert that every estimate lies within `times` of its own std of the truth."""
    assert result.status is FitStatus.CONVERGED
    for name, value in truth.items():
        found = result.estimate(name)
        assert found.std is not None, name
        assert abs(found.value - value) <= times * found.std, name
        assert found.std < 0.2 * abs(value), name


SPRING_MASS = {"m": 2.0, "k": 50.0, "b": 1.5}


def spring_mass(**declared):
    g = BondGraph("spring, mass, damper", domain="translation")
    k = sympy.Symbol("k")
    g.one("mass", Se("force"), I("m"), R("b"), C("spring", law=k * q))
    g.measure("x", displacement="mass")
    known = {"m": (1.0, "kg"), "k": (30.0, "N/m"), "b": (0.5, "N*s/m")}
    for name, (value, unit) in known.items():
        g.parameter(name, **{"value": value, "unit": unit, **declared.get(name, {})})
    return g.finish()


def spring_mass_recording(graph, *, n=1500, noise=2e-3, seed=0, x0=(0.05, 0.0)):
    m, k, b = SPRING_MASS.values()
    time, force = 0.01 * np.arange(n), 10 * excitation(n, seed=seed)
    a = [[0.0, 1.0], [-k / m, -b / m]]
    system = (a, [[0.0], [1 / m]], [[1.0, 0.0]], [[0.0]])
    x = lsim(system, force, time, X0=x0)[1]
    x = x + noise * rng(seed + 100).normal(size=n)
    return recorded(graph, time, force=force, x=x)


def test_a_spring_mass_damper_is_recovered():
    graph = spring_mass()
    result = fit(graph, [spring_mass_recording(graph)], settings=WHOLE)
    within(result, SPRING_MASS)
    assert result.unidentifiable == ()
    assert result.score.rmse["x"] == pytest.approx(2e-3, rel=0.1)
    assert result.estimate("m").start == 1.0
    assert result.estimate("k").unit == "N/m"
    # The fitted model is the graph with these values, and still free to be fitted.
    assert result.model.parameters["m"].value == result.estimate("m").value
    assert result.model.parameters["m"].std is None


def test_the_covariance_says_what_is_known_only_together():
    graph = spring_mass()
    result = fit(graph, [spring_mass_recording(graph)], settings=WHOLE)
    covariance = np.array(result.covariance)
    std = [estimate.std for estimate in result.estimates]
    assert np.sqrt(np.diag(covariance)) == pytest.approx(std)
    assert np.allclose(covariance, covariance.T, rtol=1e-9, atol=0.0)
    # k/m is the natural frequency squared: known better than either of them
    names = [estimate.name for estimate in result.estimates]
    relative = covariance / np.outer(*2 * [[e.value for e in result.estimates]])
    m, k = names.index("m"), names.index("k")
    ratio = relative[k, k] + relative[m, m] - 2 * relative[k, m]
    assert ratio < min(relative[k, k], relative[m, m])


def test_several_recordings_share_parameters_and_not_initial_states():
    graph = spring_mass()
    recordings = [
        spring_mass_recording(graph, n=500, seed=seed, x0=x0)
        for seed, x0 in ((1, (0.3, 0.0)), (2, (-0.4, 1.0)), (3, (0.0, 0.0)))
    ]
    settings = FitSettings(horizon=WholeRecordings())
    fitted = fit_model(graph, recordings, settings)
    assert fitted.optimum.initial.shape == (3, 2)
    within(fit(graph, recordings, settings=settings), SPRING_MASS)


MOTOR = {"R_a": 1.2, "L_a": 0.02, "k_m": 0.15, "J": 4e-3, "b": 2e-3}


def motor():
    g = BondGraph("DC motor", domain="electrical")
    g.one("winding", Se("voltage"), R("R_a"), I("L_a"))
    g.one("shaft", I("J"), R("b"), domain="rotation")
    g.join("winding", GY("k_m"), "shaft")
    g.measure("current", flow="winding")
    g.measure("speed", flow="shaft")
    starts = {"R_a": 2.0, "L_a": 0.05, "k_m": 0.1, "J": 2e-3, "b": 5e-3}
    units = {"R_a": "ohm", "L_a": "H", "k_m": "N*m/A"}
    for name, value in starts.items():
        g.parameter(
            name,
            value,
            {**units, "J": "kg*m^2", "b": "N*m*s/rad"}[name],
            bounds=(0, np.inf),
        )
    return g.finish()


def motor_recording(graph, *, n=2000, noise=(0.02, 0.05), seed=4):
    r, inductance, k, j, b = MOTOR.values()
    time, voltage = 0.005 * np.arange(n), 6 * excitation(n, seed=seed, width=20)
    a = [[-r / inductance, -k / inductance], [k / j, -b / j]]
    system = (a, [[1 / inductance], [0.0]], np.eye(2), np.zeros((2, 1)))
    y = lsim(system, voltage, time)[1]
    y = y + np.array(noise) * rng(seed + 100).normal(size=(n, 2))
    return recorded(graph, time, voltage=voltage, current=y[:, 0], speed=y[:, 1])


def test_a_motor_is_recovered_from_current_and_speed():
    graph = motor()
    recording = motor_recording(graph)
    # The noise is so small that the error of Sdirk2 at this step would be seen.
    settings = FitSettings(horizon=WholeRecordings(), solver=Sdirk3(substeps=2))
    result = fit(graph, [recording], settings=settings)
    within(result, MOTOR)
    # Each channel is weighed by its own residual.
    fitted = fit_model(graph, [recording], settings)
    assert fitted.problem.sigma == pytest.approx([0.02, 0.05], rel=0.1)


def cart(**declared):
    g = BondGraph("cart on a rail", domain="translation")
    g.one("cart", Se("force"), I("m"), R("b"))
    g.measure("x", displacement="cart")
    known = {"m": (3.0, "kg"), "b": (1.0, "N*s/m")}
    for name, (value, unit) in known.items():
        g.parameter(name, **{"value": value, "unit": unit, **declared.get(name, {})})
    return g.finish()


CART = {"m": 5.0, "b": 2.0}


def drifting_cart(graph, *, n=4000, disturbance=0.5, noise=1e-4, seed=7):
    """A cart whose force has a part that wanders and that nobody recorded."""
    time, force = 0.01 * np.arange(n), 20 * excitation(n, seed=seed, width=10)
    wander = disturbance * np.cumsum(rng(seed + 1).normal(size=n)) / np.sqrt(n)
    m, b = CART.values()
    system = ([[0, 1], [0, -b / m]], [[0], [1 / m]], [[1, 0]], [[0]])
    x = lsim(system, force + wander, time)[1]
    x = x + noise * rng(seed + 2).normal(size=n)
    return recorded(graph, time, force=force, x=x)


def test_a_cart_that_drifts_is_recovered_in_windows():
    graph = cart()
    recording = drifting_cart(graph)
    result = fit(graph, [recording])
    within(result, CART)
    assert result.window is not None
    assert result.window < 0.25 * recording.duration
    # Over the whole recording the unknown force is worth metres.
    whole = fit(graph, [recording], settings=WHOLE)
    assert whole.window is None
    assert whole.score.rmse["x"] > 20 * result.score.rmse["x"]


def test_automatic_horizon_is_whole_for_a_plant_that_forgets():
    graph = spring_mass()
    recording = spring_mass_recording(graph)
    fitted = fit_model(graph, [recording], FitSettings(horizon=Automatic()))
    assert fitted.horizon == WholeRecordings()
    model = prepare(graph)
    assert not accumulates(graph, model, [recording], FitSettings())
    assert fit(graph, [recording]).window is None


def test_automatic_horizon_is_windows_for_an_integrator():
    graph = cart()
    recording = drifting_cart(graph)
    assert accumulates(graph, prepare(graph), [recording], FitSettings())
    fitted = fit_model(graph, [recording], FitSettings(horizon=Automatic()))
    assert isinstance(fitted.horizon, Windows)
    # The choice is kept for variants of the model, so that they can be compared.
    assert fitted.settings.horizon == fitted.horizon


def gain_bench(**declared):
    """A model without states: its fit is a linear regression, known in closed form."""
    g = BondGraph("brake bench", domain="rotation")
    bias = sympy.Symbol("bias")
    g.one("axle", Sf("speed"), R("b"), Se("offset", value=-bias))
    g.measure("torque", effort="speed")
    known = {"b": (1.0, "N*m*s"), "bias": (0.0, "N*m")}
    for name, (value, unit) in known.items():
        g.parameter(name, **{"value": value, "unit": unit, **declared.get(name, {})})
    return g.finish()


def bench_recording(graph, *, n=400, noise=0.3, seed=11, correlation=0.0):
    time, speed = 0.01 * np.arange(n), excitation(n, seed=seed)
    error = coloured(n, seed=seed + 1000, correlation=correlation, std=noise)
    return recorded(graph, time, speed=speed, torque=1.7 * speed + 0.4 + error)


def test_a_static_model_is_linear_regression():
    graph = gain_bench()
    recording = bench_recording(graph)
    result = fit(graph, [recording])
    u, y = recording.inputs[:, 0], recording.outputs[:, 0]
    known, *_ = np.linalg.lstsq(np.stack([u, np.ones_like(u)], axis=1), y, rcond=None)
    assert [result.estimate(n).value for n in ("b", "bias")] == pytest.approx(known)


def test_prior_knowledge_and_data_are_weighed_by_their_stds():
    graph = gain_bench(b={"value": 1.6, "std": 0.05}, bias={"value": 0.4, "std": 0.0})
    recording = bench_recording(graph, n=60)
    result = fit(graph, [recording])
    (sigma,) = fit_model(graph, [recording], FitSettings()).problem.sigma
    u, y = recording.inputs[:, 0], recording.outputs[:, 0] - 0.4
    found = result.estimate("b")
    assert sigma == pytest.approx(np.sqrt(np.mean((y - found.value * u) ** 2)), rel=0.1)
    data, prior = u @ u / sigma**2, 1 / 0.05**2
    expected = ((u @ y) / sigma**2 + prior * 1.6) / (data + prior)
    assert found.value == pytest.approx(expected, rel=1e-5)
    alone = (u @ y) / (u @ u)
    assert 0.2 < (found.value - 1.6) / (alone - 1.6) < 0.8
    assert found.std == pytest.approx(1 / np.sqrt(data + prior), rel=0.3)


def test_a_tight_prior_holds_a_parameter():
    graph = spring_mass(m={"value": 2.4, "std": 1e-6})
    result = fit(graph, [spring_mass_recording(graph, n=400)], settings=WHOLE)
    assert result.estimate("m").value == pytest.approx(2.4, rel=1e-3)
    assert result.estimate("m").std < 1e-4


def test_bounds_are_respected_and_the_rest_still_fitted():
    graph = spring_mass(b={"bounds": [0.0, 1.0]})  # a list does as well as a pair
    result = fit(graph, [spring_mass_recording(graph)], settings=WHOLE)
    assert result.estimate("b").value == 1.0
    assert result.estimate("k").value == pytest.approx(50.0, rel=0.05)
    free = fit(spring_mass(), [spring_mass_recording(graph)], settings=WHOLE)
    assert free.cost <= result.cost * 1.01


def test_exact_parameters_stay_and_are_not_estimated():
    graph = spring_mass(m={"value": 2.0, "std": 0.0})
    result = fit(graph, [spring_mass_recording(graph)], settings=WHOLE)
    assert {e.name for e in result.estimates} == {"b", "k"}
    assert result.model.parameters["m"].value == 2.0
    within(result, {"k": 50.0, "b": 1.5})


def test_nothing_is_fitted_where_everything_is_exact():
    graph = gain_bench(b={"std": 0.0}, bias={"std": 0.0})
    result = fit(graph, [bench_recording(graph)])
    assert result.status is FitStatus.NO_FREE_PARAMETERS
    assert result.estimates == ()


def lowpass():
    g = BondGraph("filter", domain="electrical")
    gain = sympy.Symbol("gain")
    g.one("loop", Se("u"), R("r"), C("c"))
    g.measure("v", gain * displacement("c"), unit="V")
    g.parameter("r", 1.5, "ohm")
    g.parameter("c", 0.1, "F", std=0.0)
    g.parameter("gain", 8.0, "V/(A*s)")
    return g.finish()


def test_intervals_cover_the_truth_under_coloured_noise():
    graph = lowpass()
    n, repeats, truth = 600, 40, {"r": 2.0, "gain": 10.0}
    time = 0.02 * np.arange(n)
    hits = {"r": 0, "gain": 0}
    naive_hits = 0
    for seed in range(repeats):
        u = excitation(n, seed=seed, width=20)
        tau = truth["r"] * 0.1
        system = ([[-1 / tau]], [[1 / truth["r"]]], [[truth["gain"]]], [[0.0]])
        noise = coloured(n, seed=seed + 500, correlation=0.9, std=0.1)
        v = lsim(system, u, time)[1] + noise
        result = fit(graph, [recorded(graph, time, u=u, v=v)], settings=WHOLE)
        assert result.status is FitStatus.CONVERGED
        for name, value in truth.items():
            found = result.estimate(name)
            hits[name] += abs(found.value - value) <= 1.96 * found.std
        naive_hits += _white_interval_covers(result, u, time, v, truth)
    for name, count in hits.items():
        assert 0.8 <= count / repeats <= 1.0, name
    # The noise is coloured enough to matter: white-noise intervals miss far oftener.
    assert naive_hits < min(hits.values())


def _white_interval_covers(result, u, time, v, truth):
    """Return whether the gain's textbook interval, for white noise, holds the truth."""

    def simulated(r, gain):
        return lsim(([[-1 / (r * 0.1)]], [[1 / r]], [[gain]], [[0.0]]), u, time)[1]

    r, gain = (result.estimate(name).value for name in ("r", "gain"))
    columns = [
        (simulated(r * 1.001, gain) - simulated(r * 0.999, gain)) / (0.002 * r),
        simulated(r, 1.0),
    ]
    j = np.stack(columns, axis=1)
    variance = np.mean((v - simulated(r, gain)) ** 2)
    std = np.sqrt(variance * np.linalg.inv(j.T @ j)[1, 1])
    return abs(gain - truth["gain"]) <= 1.96 * std


def free_motion():
    g = BondGraph("mass on a spring, let go", domain="translation")
    k = sympy.Symbol("k")
    g.one("mass", I("m"), C("spring", law=k * q))
    g.measure("x", displacement="mass")
    g.parameter("m", 1.0, "kg")
    g.parameter("k", 20.0, "N/m")
    return g.finish()


def test_mass_and_stiffness_are_known_only_as_a_ratio_in_free_motion():
    graph = free_motion()
    time = 0.01 * np.arange(600)
    x = 0.1 * np.cos(np.sqrt(50.0 / 2.0) * time) + 1e-3 * rng(5).normal(size=600)
    result = fit(graph, [recorded(graph, time, x=x)], settings=WHOLE)
    m, k = result.estimate("m"), result.estimate("k")
    assert k.value / m.value == pytest.approx(25.0, rel=0.01)
    assert (m.std, k.std) == (None, None)
    assert result.unidentifiable == ("m and k only as k/m",)


def test_a_parameter_that_does_nothing_is_named():
    g = BondGraph("mass before a stop", domain="translation")
    k, stop = sympy.symbols("k stop")
    law = k * q + stop * sympy.Max(q - 10, 0)
    g.one("mass", Se("force"), I("m"), R("b"), C("spring", law=law))
    g.measure("x", displacement="mass")
    for name, value, unit in (
        ("m", 1.0, "kg"), ("k", 30.0, "N/m"), ("b", 0.5, "N*s/m"),
        ("stop", 1e3, "N/m"),
    ):  # fmt: skip
        g.parameter(name, value, unit)
    graph = g.finish()
    result = fit(graph, [spring_mass_recording(graph)], settings=WHOLE)
    within(result, SPRING_MASS)
    assert result.estimate("stop").std is None
    assert result.estimate("stop").value == 1e3
    assert result.unidentifiable == ("stop has no effect on these recordings",)


def test_a_parameter_without_a_value_is_refused_by_name():
    graph = cart(m={"value": None})
    recording = drifting_cart(graph, n=200)
    for horizon in (Automatic(), WholeRecordings()):
        with pytest.raises(ParameterError, match="No value is given for m"):
            fit(graph, [recording], settings=FitSettings(horizon=horizon))


def test_a_model_that_measures_nothing_is_refused():
    g = BondGraph("silent", domain="translation")
    g.one("cart", Se("force"), I("m"))
    g.parameter("m", 1.0, "kg")
    graph = g.finish()
    recording = recorded(graph, 0.1 * np.arange(50), force=np.ones(50))
    for horizon in (Automatic(), WholeRecordings()):
        with pytest.raises(FitError, match="'silent' measures nothing"):
            fit(graph, [recording], settings=FitSettings(horizon=horizon))


def test_a_model_that_cannot_be_simulated_says_so():
    g = BondGraph("runaway", domain="translation")
    a = sympy.Symbol("a")
    g.one("cart", Se("force"), I("m"), R("push", law=-a * f**3))
    g.measure("v", flow="cart")
    g.parameter("m", 1.0, "kg", std=0.0)
    g.parameter("a", 1e4, "N*s^3/m^3")
    graph = g.finish()
    time = 0.01 * np.arange(300)
    recording = recorded(graph, time, force=np.ones(300), v=np.sin(time))
    result = fit(graph, [recording], settings=WHOLE)
    assert result.status is FitStatus.SIMULATION_FAILED


def test_samples_that_were_not_measured_do_not_count():
    graph = spring_mass()
    recording = spring_mass_recording(graph)
    holes = recording.outputs.copy()
    holes[300:700] = np.nan
    result = fit(graph, [masked(recording, holes)], settings=WHOLE)
    within(result, SPRING_MASS)
    assert result.score.rmse["x"] == pytest.approx(2e-3, rel=0.1)
    # What is measured counts as it would alone: here without states, exactly so.
    bench = gain_bench()
    full = bench_recording(bench)
    outputs = full.outputs.copy()
    outputs[::3] = np.nan
    kept = np.flatnonzero(np.isfinite(outputs[:, 0])).tolist()
    with_holes = fit(bench, [masked(full, outputs)])
    alone = fit(bench, [full.rows(kept)])
    for name in ("b", "bias"):
        a, b = with_holes.estimate(name), alone.estimate(name)
        assert a.value == pytest.approx(b.value, rel=1e-6)
        assert a.std == pytest.approx(b.std, rel=0.3)
    assert with_holes.score.rmse == pytest.approx(alone.score.rmse, rel=1e-6)


def test_a_channel_with_holes_keeps_its_weight():
    graph = motor()
    recording = motor_recording(graph)
    outputs = recording.outputs.copy()
    outputs[np.arange(len(outputs)) % 10 > 0, 0] = np.nan
    fitted = fit_model(graph, [masked(recording, outputs)], WHOLE)
    assert fitted.problem.sigma == pytest.approx([0.02, 0.05], rel=0.2)
