"""Angles that begin again after a whole turn go on; what else jumps is left alone."""

import numpy as np
import pytest

from bondgraph import Recording
from bondgraph.recordings.binding import bind
from bondgraph.recordings.misreadings import without_misreadings
from bondgraph.recordings.turns import unwrapped

TIME = np.linspace(0.0, 10.0, 500)
ANGLE = 4.0 + 9.0 * np.sin(0.9 * TIME)


@pytest.mark.parametrize("least", [0.0, -np.pi])
@pytest.mark.parametrize(("unit", "of_a_radian"), [("rad", 1.0), ("deg", 180 / np.pi)])
def test_an_angle_told_within_one_turn_goes_on(least, unit, of_a_radian):
    within = np.mod(ANGLE - least, 2 * np.pi) + least
    gone_on, times = unwrapped(of_a_radian * within, unit)
    moved = gone_on / of_a_radian - ANGLE
    assert np.ptp(moved) < 1e-9
    assert times == np.count_nonzero(np.abs(np.diff(within)) > np.pi)


def test_samples_that_are_missing_stay_so():
    within = np.mod(ANGLE, 2 * np.pi)
    within[100:140] = np.nan
    gone_on, _ = unwrapped(within, "rad")
    assert np.array_equal(np.isnan(gone_on), np.isnan(within))


@pytest.mark.parametrize(
    ("values", "unit"),
    [
        (ANGLE, "rad"),
        (np.mod(ANGLE, 2 * np.pi), "m"),
        (np.where(TIME < 5.0, 0.0, 6.2), "Pa"),
        (np.where(TIME < 5.0, 0.0, 13.0), "rad"),
        (4.0 * (np.arange(500) % 2), "rad"),
        (np.random.default_rng(1).uniform(0, 6.2, 500), "rad"),
        (np.full(500, np.nan), "rad"),
    ],
    ids=[
        "goes on",
        "metres",
        "pascals",
        "beyond a turn",
        "to and fro",
        "noise",
        "none",
    ],
)
def test_what_is_no_turn_is_left_alone(values, unit):
    assert unwrapped(values, unit) is None


def test_recordings_say_what_was_done_of_them():
    within = np.mod(ANGLE, 2 * np.pi)
    within[50] += 1.0
    channels = {"torque": (np.sin(TIME), "N*m"), "angle": (within, "rad")}
    recording = bind(
        Recording.from_arrays("run", TIME, channels),
        {"torque": "N*m"},
        {"angle": "rad"},
    )
    cleared = without_misreadings([recording])
    turned, misread = cleared.notes
    assert turned.startswith("angle of run jumps by a whole turn ")
    assert "(sample 50, counted from 0)" in misread
    (now,) = cleared.recordings
    good = np.isfinite(now.outputs[:, 0])
    assert np.ptp(now.outputs[good, 0] - ANGLE[good]) < 1e-9
    assert np.array_equal(now.inputs, recording.inputs)
