"""A linear store or loss keeps the sign that is stated, in every fit."""

import math
from dataclasses import replace

import numpy as np
import pytest
from sympy import symbols

from bondgraph.fitting.estimate import fit
from bondgraph.fitting.natural_bounds import LEAST, bounds_by_name, gone
from bondgraph.recordings.model_channels import bind_to
from bondgraph.recordings.recording import Recording
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import TF, C, I, R, Se
from bondgraph.structure.signals import f


def machine(**stated):
    """Return an axis with a friction law; keywords are bounds by parameter."""
    graph = BondGraph("axis", domain="rotation")
    graph.one("motor", Se("torque"), I("rotor"), R("bearing", law=f * symbols("drag")))
    graph.one("joint", I("link"), R("seal"), C("spring"))
    graph.join("motor", TF("gear"), "joint")
    graph.measure("angle", displacement="joint")
    values = {"rotor": 1e-3, "drag": 0.1, "link": 0.1, "seal": -0.2, "spring": 0.0}
    units = {"rotor": "kg*m^2", "link": "kg*m^2", "seal": "N*m*s/rad"}
    for name, value in values.items():
        unit = units.get(name, "rad/(N*m)" if name == "spring" else "N*m*s/rad")
        bounds = stated.get(name, (-math.inf, math.inf))
        graph.parameter(name, value, unit, bounds=bounds)
    graph.parameter("gear", -10.0)
    return graph.finish()


def test_only_linear_stores_and_losses_keep_their_sign():
    free = (-math.inf, math.inf)
    assert bounds_by_name(machine()) == {
        "rotor": (LEAST * 1e-3, math.inf),
        "link": (LEAST * 0.1, math.inf),
        "seal": (-math.inf, LEAST * -0.2),  # As stated: something drives there.
        "spring": free,
        "drag": free,
        "gear": free,
    }


def test_what_the_author_states_comes_first():
    stated = bounds_by_name(machine(link=(-1.0, math.inf), rotor=(0.0, 1.0)))
    assert stated["link"] == (-1.0, math.inf)
    assert stated["rotor"] == (0.0, 1.0)


@pytest.fixture(scope="module")
def pushed():
    """A mass that is pushed by more than its one force says: it speeds up by itself."""
    graph = BondGraph("cart", domain="translation")
    graph.one("cart", Se("force"), I("mass"), R("viscous"))
    graph.measure("speed", flow="cart")
    graph.parameter("mass", 2.0, "kg", std=0.0)
    graph.parameter("viscous", 0.8, "N*s/m")
    time = 0.02 * np.arange(300)
    channels = {"force": (np.zeros(300), "N"), "speed": (np.exp(0.2 * time), "m/s")}
    graph = graph.finish()
    return graph, bind_to(graph, Recording.from_arrays("run", time, channels))


def test_a_loss_that_would_give_power_comes_down_to_nothing_and_that_is_told(pushed):
    graph, recording = pushed
    found = fit(graph, [recording])
    (viscous,) = found.estimates
    assert viscous.value == pytest.approx(LEAST * 0.8)
    assert gone(graph, found.estimates) == ["viscous"]


def test_one_with_bounds_may_give_power(pushed):
    graph, recording = pushed
    member = graph.parameters["viscous"]
    free = graph.with_parameters([replace(member, bounds=(-10.0, 10.0))])
    (viscous,) = fit(free, [recording]).estimates
    assert viscous.value == pytest.approx(-0.4, rel=1e-3)
    assert gone(free, [viscous]) == []
