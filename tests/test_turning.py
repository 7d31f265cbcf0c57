"""What drives a machine is missed where its one store turns and nothing drives it."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to, derive, effort
from bondgraph.diagnosis.answer.turning import turns_of
from bondgraph.numeric.model import compile_model

TIME = np.arange(0.0, 200.0, 0.5)
FILLED = 40.0
"""Seconds for which a pump runs that only some models have."""


def tank(*, pumped):
    graph = BondGraph("tank", domain="hydraulic")
    pump = [Sf("pump")] if pumped else []
    graph.zero("water", C("area"), R("hole"), *pump)
    graph.measure("level", effort("water") / 9810, unit="m")
    graph.parameter("area", 1e-6, "m^3/Pa")
    graph.parameter("hole", 5e7, "Pa*s/m^3")
    return graph.finish()


def level(noise=0.0):
    """Return a level that rises while a pump runs, and falls by itself then."""
    full = 0.3 * (1.0 - np.exp(-FILLED / 50.0))
    rising = 0.3 * (1.0 - np.exp(-TIME / 50.0))
    falling = full * np.exp(-(TIME - FILLED) / 50.0)
    clean = np.where(TIME < FILLED, rising, falling)
    return clean + noise * np.random.default_rng(3).standard_normal(TIME.size)


def turns(graph, values, **inputs):
    channels = {"level": (values, "m"), **inputs}
    recording = bind_to(graph, Recording.from_arrays("run", TIME, channels))
    return turns_of(compile_model(derive(graph)), [recording])


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_tank_that_is_filled_by_nothing_is_told(noise):
    (turn,) = turns(tank(pumped=False), level(noise))
    assert turn.seconds == pytest.approx(FILLED, abs=TIME[-1] / 40)
    assert "level turns in run" in str(turn)
    assert "source" in str(turn)
    assert "--begin" in str(turn)


def test_nothing_is_told_from_where_it_falls():
    after = level(1e-3) * (TIME >= FILLED) + level(1e-3)[80] * (TIME < FILLED)
    assert turns(tank(pumped=False), after) == ()


@pytest.mark.parametrize(
    "spoil",
    [
        lambda y: np.where(np.arange(y.size) % 97 == 0, 0.9, y),
        lambda y: y + 0.02 * np.sin(3.0 * TIME),
    ],
    ids=["wrong readings", "a ripple"],
)
def test_what_comes_back_at_once_is_no_turn(spoil):
    falling = 0.3 * np.exp(-TIME / 50.0)
    assert turns(tank(pumped=False), spoil(falling)) == ()


def test_a_recorded_pump_may_turn_it_and_a_constant_one_not():
    graph = tank(pumped=True)
    running = np.where(TIME < FILLED, 1e-4, 0.0)
    assert turns(graph, level(), pump=(running, "m^3/s")) == ()
    assert len(turns(graph, level(), pump=(0.0 * TIME, "m^3/s"))) == 1
