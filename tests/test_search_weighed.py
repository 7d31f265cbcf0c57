"""After a finding, what is left of an output is weighed by its own size."""

import numpy as np
import pytest

from bondgraph import GY, BondGraph, FitSettings, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.search.base.weighed import weighed_anew
from bondgraph.fitting.estimate import FittedModel, fit_model
from bondgraph.simulation.solvers import Hold

TIME = 0.01 * np.arange(800)
OFFSET, SPEED_NOISE, CURRENT_NOISE = 0.3, 0.05, 0.05


def motor():
    graph = BondGraph("motor", domain="rotation")
    graph.one("winding", Se("voltage"), R("resistance"), domain="electrical")
    graph.one("shaft", I("inertia"), R("bearing"))
    graph.join("winding", GY("constant"), "shaft")
    graph.measure("speed", flow="shaft")
    graph.measure("current", flow="winding")
    graph.parameter("resistance", 2.0, "ohm")
    graph.parameter("constant", 0.05, "N*m/A", std=0.0)
    graph.parameter("inertia", 1.0e-4, "kg*m^2", bounds=(1e-7, 1))
    graph.parameter("bearing", 1e-4, "N*m*s/rad", bounds=(0, 1))
    return graph.finish()


@pytest.fixture(scope="module")
def fitted() -> FittedModel:
    """A motor whose speed reads ten times its noise beside, and the current right."""
    random = np.random.default_rng(1)
    voltage = np.repeat(random.uniform(-12, 12, 20), 40)
    speed, current, w = [], [], 0.0
    for u in voltage:
        speed.append(w + OFFSET * np.sin(w))
        current.append((u - 0.05 * w) / 2.0)
        for _ in range(10):
            torque = 0.05 * (u - 0.05 * w) / 2.0 - 1e-4 * w
            w += 1e-3 * torque / 1e-4
    noise = random.standard_normal((2, TIME.size))
    channels = {
        "voltage": (voltage, "V"),
        "speed": (np.array(speed) + SPEED_NOISE * noise[0], "rad/s"),
        "current": (np.array(current) + CURRENT_NOISE * noise[1], "A"),
    }
    graph = motor()
    recording = bind_to(graph, Recording.from_arrays("run", TIME, channels))
    settings = FitSettings(hold=Hold.ZERO)
    # As a first model that had left ten times as much of the speed would weigh it.
    sigma = np.array([20 * OFFSET, CURRENT_NOISE])
    return fit_model(graph, [recording], settings, sigma=sigma)


def test_what_is_hidden_is_weighed_by_what_is_left_of_it(fitted):
    noise = np.array([SPEED_NOISE, CURRENT_NOISE])
    anew = weighed_anew(fitted, noise)
    before, after = (
        np.sqrt(np.mean(one.residuals() ** 2, axis=0)) for one in (fitted, anew)
    )
    assert anew.problem.sigma == pytest.approx(after, rel=0.06)
    # In units of their own noise both outputs count, and the speed is fitted better.
    assert after[0] < before[0]


def test_what_is_noise_is_left_as_it_is(fitted):
    assert weighed_anew(fitted, np.array([OFFSET, CURRENT_NOISE])) is fitted
