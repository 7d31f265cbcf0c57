"""The simulator of concealed physics against closed solutions, and its independence."""

import ast
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import bondgraph
from benchmarks.concealed.effects import Effect, Scales
from benchmarks.concealed.machine import Site
from benchmarks.concealed.machines import MACHINES
from benchmarks.concealed.making import _model, _write_csv
from benchmarks.concealed.recording import (
    Nuisance,
    plan,
    replayed,
    scales_of,
    simulate,
)
from benchmarks.concealed.strength import Absorbed, Truth, amplitude_for

CART = MACHINES["cart"]
FOLDER = Path(__file__).parents[1] / "benchmarks" / "concealed"
UNIT = {name: Scales(1.0, 1.0, -1.0, 1.0, 1.0) for name in ("cart", "force")}


def quiet_plan(machine, *, samples, force=0.0):
    short = replace(machine, samples=samples)
    drawn = plan(short, "multisine", 1, Nuisance(noise=0.0))
    feed = np.full_like(drawn.feed, force)
    return replace(drawn, feed=feed, closed=False)


def test_it_shares_no_code_with_the_toolkit():
    for file in FOLDER.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            if isinstance(node, ast.ImportFrom):
                names = [node.module or ""]
            roots = {name.split(".")[0] for name in names}
            assert not roots & {"bondgraph", "flegx_models"}, file


def test_a_linear_machine_follows_its_exact_solution():
    m, d, k = 1.3, 4.0, 60.0
    drawn = plan(replace(CART, samples=800), "random_steps", 3, Nuisance(noise=0.0))
    run = simulate(CART, drawn, exact=True)
    A = np.array([[0, 1, 0], [-k / m, -d / m, 1 / m], [0, 0, 0]])
    step = expm(A / CART.rate)
    state = np.zeros(3)
    expected = []
    for force in run.commands[:, 0]:
        expected.append(state[0])
        state = step @ np.array([state[0], state[1], force])
    expected = np.array(expected)
    assert np.abs(expected).max() > 0.05
    assert np.abs(run.readings[:, 0] - expected).max() < 1e-6


def test_smaller_steps_converge_with_second_order():
    drawn = plan(replace(CART, samples=400), "multisine", 3, Nuisance(noise=0.0))
    drag = Effect(Site(word="quadratic_drag", place="cart"), 5.0)

    def reading(fine):
        machine = replace(CART, fine=fine)
        return simulate(machine, drawn, [drag], scales=UNIT, exact=True).readings

    reference = reading(160)
    coarse, finer = (np.abs(reading(n) - reference).max() for n in (5, 10))
    assert coarse / finer == pytest.approx(4.0, rel=0.15)


def test_dry_friction_stops_a_sliding_mass_where_it_must_and_holds_it():
    m, c, v0 = 1.3, 2.0, 0.8
    still = quiet_plan(CART, samples=400)
    run = simulate(
        CART,
        still,
        [Effect(Site(word="coulomb_friction", place="cart"), c)],
        values={"damper": 0.0, "compliance": 1e12},
        scales=UNIT,
        start={"v": np.array([v0])},
        exact=True,
    )
    stop = m * v0 / c
    after = run.time > stop + 1e-3
    assert run.readings[after, 0] == pytest.approx(m * v0**2 / (2 * c), abs=1e-6)
    assert np.all(run.states[after, 1] == 0.0)


@pytest.mark.parametrize(("force", "moves"), [(1.99, False), (2.01, True)])
def test_dry_friction_holds_up_to_its_limit(force, moves):
    run = simulate(
        CART,
        quiet_plan(CART, samples=100, force=force),
        [Effect(Site(word="coulomb_friction", place="cart"), 2.0)],
        values={"damper": 0.0, "compliance": 1e12},
        scales=UNIT,
        exact=True,
    )
    assert (run.readings[-1, 0] != 0.0) == moves


def test_two_dry_places_settle_to_the_smallest_holding_force():
    chain = MACHINES["mass_chain"]
    sites = [Site(word="coulomb_friction", place=p) for p in ("mass1", "mass3")]
    scales = {name: Scales(1.0, 1.0, -1.0, 1.0, 1.0) for name in ("mass1", "mass3")}
    run = simulate(
        chain,
        quiet_plan(chain, samples=1500, force=1.5),
        [Effect(sites[0], 2.0), Effect(sites[1], 2.0)],
        scales=scales,
        exact=True,
    )
    assert np.abs(run.readings).max() == 0.0


def test_an_end_stop_is_not_passed():
    stop = Effect(Site(word="end_stop", place="cart"), 0.4)
    run = simulate(
        CART,
        plan(replace(CART, samples=1500), "multisine", 5, Nuisance(noise=0.0)),
        [stop],
        scales={"cart": Scales(1.0, 1.0, -0.2, 0.2, 1.0)},
        exact=True,
    )
    limit = 0.2 - 0.4 * 0.4
    assert run.readings.min() < -2 * limit
    assert limit - 1e-4 < run.readings.max() < limit + 1e-3


@pytest.mark.parametrize("law", ["hysteresis", "maxwell_slip", "lugre"])
def test_laws_with_memory_take_energy_out_and_stay_bounded(law):
    site = Site(word="hysteresis", place="cart", law="" if law == "hysteresis" else law)
    still = quiet_plan(CART, samples=3000)
    wave = 8.0 * np.sin(2 * math.pi * 0.5 * still.time)
    drawn = replace(still, feed=wave[:, None])
    scales = {"cart": Scales(3.0, 0.3, -0.1, 0.1, 1.0)}
    with_memory = simulate(CART, drawn, [Effect(site, 0.5)], scales=scales, exact=True)
    without = simulate(CART, drawn, exact=True)

    def work(run):
        return float(np.sum(run.commands[:-1, 0] * np.diff(run.readings[:, 0])))

    assert np.abs(with_memory.readings).max() < 0.3
    assert work(with_memory) > work(without) + 0.5


def test_a_delay_shifts_and_a_lag_has_its_time_constant():
    still = quiet_plan(CART, samples=200, force=0.0)
    feed = np.where(still.time[:, None] > 0.1, 10.0, 0.0)
    drawn = replace(still, feed=feed)
    period = 1.0 / CART.drive.band[1]
    samples = 5
    amplitude = samples / CART.rate / (0.3 * period)
    plain = simulate(CART, drawn, exact=True).readings[:, 0]
    for place in ("force", "position"):
        known = {"force": UNIT["force"], "position": UNIT["cart"]}
        delay = Effect(Site(word="delay", place=place), amplitude)
        late = simulate(CART, drawn, [delay], scales=known, exact=True).readings[:, 0]
        assert late[samples:] == pytest.approx(plain[:-samples], abs=1e-7)


@pytest.mark.parametrize("name", ["two_mass_drive", "flegx_drive"])
def test_a_recorded_loop_replays_to_the_same_readings(name):
    machine = replace(MACHINES[name], samples=600)
    drawn = plan(machine, "splines", 4, Nuisance())
    closed = simulate(machine, drawn)
    opened = simulate(machine, replayed(drawn, closed.commands), exact=True)
    error = (closed.readings - opened.readings) / [s.noise for s in machine.sensors]
    assert np.ptp(closed.readings) > 500 * machine.sensors[0].noise
    assert np.sqrt(np.mean(error**2)) == pytest.approx(1.1, abs=0.15)


@pytest.mark.parametrize("name", MACHINES)
def test_the_base_model_is_the_machine_without_effects(name, tmp_path):
    """Two codes that share nothing give the same motion."""
    machine = replace(MACHINES[name], samples=300)
    drawn = plan(machine, "multisine", 9, Nuisance(noise=0.0))
    closed = simulate(machine, drawn, exact=True)
    run = simulate(machine, replayed(drawn, closed.commands), exact=True)
    text = _model(machine, machine.values)
    for number in machine.numbers:  # values with all their digits
        if number.free:
            short = f'"{number.name}", {float(f"{number.value:.3g}")!r},'
            assert short in text
            text = text.replace(short, f'"{number.name}", {number.value!r},')
    (tmp_path / "model.py").write_text(text, "utf-8")
    _write_csv(tmp_path / "run.csv", machine, run)
    graph = bondgraph.load_model(f"{tmp_path}/model.py")
    recording = bondgraph.read_for(graph, tmp_path / "run.csv")
    settings = bondgraph.FitSettings(
        horizon=bondgraph.WholeRecordings(), hold=bondgraph.Hold.ZERO
    )
    solution = bondgraph.simulate(graph, recording, settings=settings)
    assert solution.output_names == tuple(sensor.name for sensor in machine.sensors)
    error = np.abs(solution.simulated - run.readings).max(axis=0)
    assert np.all(error < 2e-3 * np.ptp(run.readings, axis=0))


def test_strength_is_what_parameters_cannot_take():
    """A damper on the cart is taken by its own damper; dry friction is not."""
    machine = replace(CART, samples=1500)
    plans = (plan(machine, "multisine", 1, Nuisance()),)
    truth = Truth(
        machine=machine,
        values=machine.values,
        scales=scales_of(machine, plans),
        plans=plans,
    )
    absorbed = Absorbed.of(truth)
    viscous = Site(word="viscous_friction", place="cart")
    dry = Site(word="coulomb_friction", place="cart")
    assert absorbed.strength([Effect(viscous, 0.001)]).max() < 0.01
    assert absorbed.strength([Effect(dry, 0.001)]).max() > 0.2
    amplitude = amplitude_for(absorbed, dry, 6.0)
    reached = absorbed.strength([Effect(dry, amplitude)]).max()
    assert reached == pytest.approx(6.0, rel=0.12)
