"""Sensors that are slow, or have frozen: what is repeated is not read anew."""

import numpy as np
import pytest
from scipy.linalg import expm

from bondgraph import BondGraph, C, FitSettings, I, R, Recording, Se, bind_to, fit
from bondgraph.recordings.held import frozen, held, stale
from bondgraph.recordings.misreadings import without_misreadings
from bondgraph.simulation.solvers import Hold

STEP, COUNT, MASS, NOISE = 0.02, 2000, 1.3, 2e-4
RANDOM = np.random.default_rng(4)
SLOW = np.cumsum(RANDOM.standard_normal(COUNT)) + 0.1 * RANDOM.standard_normal(COUNT)


def every(count):
    """Return the slow signal as a sensor tells it that is updated every so often."""
    return np.repeat(SLOW[::count], count)[:COUNT]


@pytest.mark.parametrize("count", [2, 5, 30])
def test_what_is_repeated_is_held(count):
    found = held(every(count))
    assert found.every == count
    assert np.array_equal(found.rows, np.flatnonzero(np.arange(COUNT) % count))


def test_updates_need_not_be_regular():
    lasting = RANDOM.integers(4, 8, COUNT)
    told = np.repeat(SLOW, lasting)[:COUNT]
    assert held(told).every in (5, 6)


def test_a_grid_does_not_hide_what_is_held():
    assert held(np.round(every(5), 2)).every == 5


@pytest.mark.parametrize(
    "values",
    [
        SLOW,
        np.round(SLOW / 10.0) * 10.0,
        np.round(np.sin(np.arange(COUNT) / 300.0) * 40.0),
        np.repeat([0.0, 5.0], COUNT // 2),
        np.full(COUNT, np.nan),
    ],
    ids=["read anew", "coarse", "slow and coarse", "a step", "nothing"],
)
def test_what_is_read_anew_is_not_held(values):
    assert held(values) is None


def cart():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"), C("spring"), R("rail"))
    g.measure("position", displacement="cart")
    g.parameter("mass", 1.1, "kg", bounds=(0.1, 10))
    g.parameter("spring", 0.4, "m/N", bounds=(0.01, 10))
    g.parameter("rail", 1.5, "N*s/m", bounds=(0, 50))
    return g.finish()


def logged(count):
    """Return the recording of the cart whose position is updated every so often."""
    random = np.random.default_rng(1)
    force = np.repeat(random.uniform(-3, 3, COUNT // 25), 25)
    over_a_step = expm(STEP * np.array([[0, 1], [-3 / MASS, -2 / MASS]]))
    state, position = np.zeros(2), np.zeros(COUNT)
    for k, pull in enumerate(force):
        position[k] = state[0]
        rest = np.array([pull / 3.0, 0.0])
        state = rest + over_a_step @ (state - rest)
    position += NOISE * random.standard_normal(COUNT)
    told = np.repeat(position[::count], count)[:COUNT]
    channels = {"force": (force, "N"), "position": (told, "m")}
    time = STEP * np.arange(COUNT)
    return bind_to(cart(), Recording.from_arrays("run", time, channels))


def test_a_slow_sensor_is_not_taken_for_a_late_one():
    cleared = without_misreadings([logged(5)])
    (note,) = cleared.notes
    assert note.startswith("position of run changes only every 5 samples or so: ")
    result = fit(cart(), cleared.recordings, settings=FitSettings(hold=Hold.ZERO))
    mass = result.estimate("mass")
    assert abs(mass.value - MASS) < 3 * mass.std
    assert result.score.rmse["position"] < 1.1 * NOISE


def frozen_at(*stretches):
    """Return a noisy signal that stands still over stretches of rows, and its time."""
    time = 0.1 * np.arange(COUNT)
    told = np.sin(0.3 * time) + 1e-3 * np.random.default_rng(6).standard_normal(COUNT)
    for begin, end in stretches:
        told[begin:end] = told[begin]
    return time, told


def test_what_stands_still_and_jumps_was_frozen():
    time, told = frozen_at((200, 240), (1500, 1525))
    assert frozen(time, told) == [range(200, 240), range(1500, 1525)]


def test_what_rests_and_starts_again_was_not():
    time, told = frozen_at()
    told[900:] += told[899] - told[900:].mean()
    told[600:900] = told[600]
    told[900:] += told[600] - told[900]  # it goes on from where it has rested
    assert frozen(time, told) == []


def test_a_short_stretch_and_the_end_of_a_range_are_no_ice():
    time, told = frozen_at((200, 210))
    assert frozen(time, told) == []
    assert frozen(time, np.minimum(told, 0.6)) == []


def test_frozen_readings_are_left_out_and_told():
    time, told = frozen_at((200, 240))
    run = Recording.from_arrays(
        "run", time, {"force": (np.sin(time), "N"), "position": (told, "m")}
    )
    cleared = without_misreadings([bind_to(cart(), run)])
    (note,) = cleared.notes
    assert "stands still from 20 to 23.9 s and then jumps" in note
    left_out = np.flatnonzero(np.isnan(cleared.recordings[0].output("position")))
    assert np.array_equal(left_out, np.arange(201, 240))


def held_up(*rows, late=False):
    """Return a turning wheel's angle with gaps in time before rows, and its time."""
    steps = np.full(400, 0.01)
    steps[list(rows)] = 0.3
    time = np.cumsum(steps)
    angle = 6.0 * time + 1e-3 * np.random.default_rng(8).standard_normal(time.size)
    if late:
        angle[list(rows)] = angle[[row - 1 for row in rows]] + 0.06
    return time, angle


def test_a_reading_of_before_a_gap_is_stale():
    time, angle = held_up(90, 200, 310, late=True)
    assert stale(time, angle).tolist() == [90, 200, 310]
    assert stale(*held_up(90, 200, 310)).size == 0
    assert stale(*held_up()).size == 0


def test_a_machine_that_goes_on_otherwise_behind_a_gap_is_not_stale():
    time, angle = held_up(90, 200)
    angle[200:] += 40.0 * (time[200:] - time[200])
    assert stale(time, angle).size == 0


def test_stale_readings_are_left_out_and_told():
    time, angle = held_up(90, late=True)
    channels = {"force": (np.ones(time.size), "N"), "position": (angle, "m")}
    run = Recording.from_arrays("run", time, channels)
    cleared = without_misreadings([bind_to(cart(), run)])
    left_out = np.flatnonzero(np.isnan(cleared.recordings[0].output("position")))
    assert left_out.tolist() == [90]
    assert "(sample 90, counted from 0), behind a gap" in cleared.notes[0]
