"""The noise of a steady table, from rows at nearly the same operating point."""

import numpy as np
import pytest

from bondgraph import TF, BondGraph, R, Recording, Se, Sf, bind_to, diagnose
from bondgraph.diagnosis.records import Verdict
from bondgraph.recordings.table_noise import table_noise


def rows(count, variables, seed=0):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, variables))


def read(inputs, noise, seed=1):
    random = np.random.default_rng(seed)
    curved = np.sin(3.0 * inputs[:, 0]) + (inputs**2).sum(axis=1)
    return curved + noise * random.normal(size=len(inputs))


@pytest.mark.parametrize("noise", [1e-3, 0.05, 0.5])
def test_the_noise_of_a_table_is_told_beside_any_smooth_law(noise):
    inputs = rows(6000, 2)
    told = table_noise(inputs, read(inputs, noise))
    if noise < 0.01:  # Curvature between rows is as large: nothing is said.
        assert told is None
    else:
        assert told.std == pytest.approx(noise, rel=0.1)
        assert told.white


@pytest.mark.parametrize("count", [0, 3, 11])
def test_of_few_rows_nothing_is_said(count):
    inputs = rows(count, 1)
    assert table_noise(inputs, read(inputs, 0.1)) is None


def test_an_input_that_stays_and_missing_readings_do_not_count():
    inputs = rows(800, 1)
    held = np.column_stack([inputs, np.full(800, 7.0)])
    values = read(inputs, 0.05)
    values[::7] = np.nan
    assert table_noise(held, values).std == pytest.approx(0.05, rel=0.15)
    assert table_noise(held[:, 1:], values) is None


def test_operating_points_that_were_set_twice_are_no_trouble():
    inputs = np.repeat(rows(200, 2), 2, axis=0)
    told = table_noise(inputs, read(inputs, 0.2))
    assert told is None or told.std == pytest.approx(0.2, rel=0.25)


def test_a_coarse_sensor_is_no_finer_than_its_step():
    inputs = rows(2000, 1)
    values = np.round(read(inputs, 0.001) / 0.1) * 0.1
    told = table_noise(inputs, values)
    assert told is None or told.std >= 0.1 / np.sqrt(12.0) * 0.999


def pump():
    graph = BondGraph("pump", domain="rotation")
    graph.one("shaft", Sf("speed"), R("bearings"))
    graph.zero("outlet", domain="hydraulic")
    graph.zero("line", Se("pressure"), domain="hydraulic")
    graph.one("pipe", R("hose"), domain="hydraulic")
    graph.join("shaft", TF("turns"), "outlet")
    graph.join("outlet", "pipe")
    graph.join("pipe", "line")
    graph.measure("delivery", flow="pipe")
    graph.measure("torque", effort="speed")
    graph.parameter("bearings", 0.0138, "N*m*s/rad", bounds=(0, 1))
    graph.parameter("hose", 1e5, "Pa*s/m^3", std=0.0)
    graph.parameter("turns", 1.4e5, "1/m^3", std=2e3)
    return graph.finish()


def pump_table(seed):
    """Return readings of a pump that loses 1.1e-11 m^3/s for every pascal."""
    random = np.random.default_rng(seed)
    speed, pressure = random.uniform(40, 320, 500), random.uniform(5e5, 2e7, 500)
    flow = speed * 7.2e-6 - 1.1e-11 * pressure + 1.2e-5 * random.normal(size=500)
    torque = 0.012 * speed + 7.2e-6 * pressure + 0.4 * random.normal(size=500)
    channels = {
        "speed": (speed, "rad/s"),
        "pressure": (pressure, "Pa"),
        "delivery": (flow, "m^3/s"),
        "torque": (torque, "N*m"),
    }
    return Recording.from_arrays(f"table {seed}", None, channels)


@pytest.mark.long
def test_a_leak_shows_in_a_table_where_nothing_can_remember():
    # A state of its own in every row explains a table better than any cause: a pump
    # that leaked was "adequate", because a line that filled was fitted and laid aside.
    graph = pump()
    one, other = (bind_to(graph, pump_table(seed)) for seed in (1, 2))
    found = diagnose(graph, [one], held_out=[other])
    assert found.verdict is Verdict.PHYSICS_MISSING
    (leak,) = found.findings
    assert (leak.physics, leak.place) == ("leak", "outlet")
    (estimate,) = leak.estimates
    assert estimate.value == pytest.approx(1.1e-11, rel=0.05)
    # What is left is noise, which rows beside each other tell, and nothing more.
    assert found.noise_floor["delivery"] == pytest.approx(1.2e-5, rel=0.15)
    assert "remains" not in leak.statement
    assert any("nothing that remembers" in note for note in found.notes)
