"""Free motions with dry friction that sticks, fitted without knowing how they began.

The truth is in closed form: on a spring every half swing is a cosine about the point
where friction holds the spring, and a block that slides on a floor slows down evenly.
"""

import numpy as np
import pytest
import sympy

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    I,
    R,
    Recording,
    WholeRecordings,
    bind_to,
    f,
    fit,
)
from bondgraph.fitting.horizon import Automatic
from bondgraph.fitting.result import FitStatus
from bondgraph.fitting.strategy import Direct, GrowingWindows, MultipleShooting

MASS, STIFFNESS, FRICTION, NOISE = 2.0, 50.0, 1.5, 1e-4
TIME = 5e-3 * np.arange(400)


def machine(*elements, friction):
    graph = BondGraph("rubbing", domain="translation")
    law = sympy.Symbol("tau") * sympy.sign(f)
    graph.one("mass", I("m"), R("rub", law=law), *elements)
    graph.measure("x", displacement="mass")
    graph.parameter("m", MASS, "kg", std=0.0)
    if elements:
        graph.parameter("c", 1.0 / STIFFNESS, "m/N", std=0.0)
    graph.parameter("tau", friction, "N", bounds=(0.0, np.inf))
    return graph.finish()


def let_go(start):
    """Return the position of the mass on its spring, at rest at `start` before."""
    band, half = FRICTION / STIFFNESS, np.pi / np.sqrt(STIFFNESS / MASS)
    x, at, place = np.full(len(TIME), np.nan), 0.0, start
    while abs(place) > band:
        centre = np.sign(place) * band
        now = (at <= TIME) & (at + half > TIME)
        swing = np.cos(np.pi / half * (TIME[now] - at))
        x[now] = centre + (place - centre) * swing
        place, at = 2 * centre - place, at + half
    x[at <= TIME] = place
    return x


def pushed(speed):
    """Return the position of a block that slides from 0.3 m until it stops."""
    slows = FRICTION / MASS
    moving = np.minimum(TIME, speed / slows)
    return 0.3 + speed * moving - slows / 2 * moving**2


def fitted(graph, x, **settings):
    noisy = x + NOISE * np.random.default_rng(3).normal(size=len(x))
    recording = Recording.from_arrays("free", TIME, {"x": (noisy, "m")})
    return fit(graph, [bind_to(graph, recording)], settings=FitSettings(**settings))


def check(result):
    found = result.estimate("tau")
    assert result.status is FitStatus.CONVERGED
    assert abs(found.value - FRICTION) < 4 * found.std
    assert found.std < 0.01 * FRICTION
    assert result.score.rmse["x"] == pytest.approx(NOISE, rel=0.15)


# With the largest friction nothing would move from anywhere that was measured.
@pytest.mark.parametrize("friction", [0.3, 5.0, 100.0])
@pytest.mark.parametrize("horizon", [WholeRecordings(), Automatic()])
def test_a_mass_let_go_on_a_spring_tells_its_friction(friction, horizon):
    graph = machine(C("c"), friction=friction)
    result = fitted(graph, let_go(0.4), horizon=horizon)
    check(result)
    momentum, place = result.fitted.optimum.initial[0]
    assert place == pytest.approx(0.4, abs=NOISE)
    assert momentum == pytest.approx(0.0, abs=1e-2)


@pytest.mark.parametrize("strategy", [GrowingWindows(), Direct(), MultipleShooting()])
def test_a_block_that_slides_to_rest_tells_its_friction(strategy):
    graph = machine(friction=12.0)
    result = fitted(graph, pushed(1.0), horizon=WholeRecordings(), strategy=strategy)
    check(result)
    assert result.fitted.optimum.initial[0, 0] == pytest.approx(MASS * 1.0, rel=1e-3)


def test_a_block_that_never_moved_does_not_tell_its_friction():
    graph = machine(friction=12.0)
    result = fitted(graph, np.full(len(TIME), 0.3), horizon=WholeRecordings())
    found = result.estimate("tau")
    assert found.std is None or found.std > 0.3 * FRICTION


def test_a_parameter_without_any_effect_is_not_called_converged():
    graph = machine(C("c"), friction=12.0)
    rest = Recording.from_arrays("rest", TIME, {"x": (np.zeros(len(TIME)), "m")})
    result = fit(graph, [bind_to(graph, rest)])
    assert result.status is FitStatus.NO_EFFECT
    assert result.unidentifiable == ("tau has no effect on these recordings",)
    assert result.estimate("tau").value == 12.0
