"""A machine that is switched may jump: no such reading is taken for a misreading."""

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Recording, Se, bind_to
from bondgraph.recordings.misreadings import without_misreadings

COUNT, EVERY = 1200, 60
RANDOM = np.random.default_rng(11)
STEPPING = np.repeat(RANDOM.uniform(2.0, 9.0, COUNT // EVERY), EVERY)
STEPS = np.flatnonzero(np.diff(STEPPING)) + 1
WRITHING = RANDOM.standard_normal(COUNT)
NOISE = 0.01 * RANDOM.standard_normal(COUNT)


def coil():
    g = BondGraph("coil", domain="electrical")
    g.one("loop", Se("supply"), I("coil"), R("wire"))
    g.measure("current", flow="loop")
    g.parameter("coil", 0.01, "H")
    g.parameter("wire", 2.0, "ohm")
    return g.finish()


def noted(current, supply):
    channels = {"supply": (supply, "V"), "current": (current, "A")}
    recording = Recording.from_arrays("bench", 0.5 * np.arange(COUNT), channels)
    cleared = without_misreadings([bind_to(coil(), recording)])
    return np.flatnonzero(np.isnan(cleared.recordings[0].outputs)), cleared.notes


@pytest.mark.parametrize("late", [0, 1])
def test_an_inrush_that_lasts_one_row_is_kept(late):
    current = 0.1 * STEPPING + NOISE
    current[STEPS + late] += 3.0
    rows, notes = noted(current, STEPPING)
    assert not rows.size
    assert not notes


@pytest.mark.parametrize("supply", [STEPPING, WRITHING], ids=["steps", "any row"])
def test_where_nothing_was_switched_a_jump_is_left_out(supply):
    current = 0.1 * STEPPING + NOISE
    away = STEPS[:5] + 20
    current[away] += 3.0
    rows, notes = noted(current, supply)
    assert np.array_equal(rows, away)
    assert "jumps away and back" in notes[0]


def test_a_rest_that_ends_as_a_machine_is_switched_on_is_no_ice():
    current = 0.1 * STEPPING + NOISE
    rest = slice(int(STEPS[3]), int(STEPS[4]))
    current[rest] = current[rest.start]
    current[rest.stop :] += 4.0
    rows, notes = noted(current, STEPPING)
    assert not rows.size
    rows, notes = noted(current, WRITHING)
    assert rows.size == rest.stop - rest.start - 1
    assert "frozen" in notes[0]
