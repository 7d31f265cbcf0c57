"""A reading worked out in proportion to something may go with a power of it."""

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, I, R, Recording, Se, bind_to, fit, flow
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.sensing import SensorNonlinearity

STEP, COUNT, INERTIA, DRAG, LIFT = 0.02, 800, 1e-3, 4e-3, 3e-4


def stand():
    """A propeller whose thrust is taken to be in proportion to its speed."""
    g = BondGraph("thrust stand", domain="rotation")
    g.one("rotor", Se("torque"), I("inertia"), R("drag"))
    g.measure("thrust", sympy.Symbol("lift") * flow("rotor"), unit="N")
    g.measure("speed", flow="rotor")
    g.parameter("inertia", 1.2e-3, "kg*m^2", bounds=(1e-5, 1))
    g.parameter("drag", 5e-3, "N*m*s/rad", bounds=(0, 1))
    g.parameter("lift", 0.05, "N*s/rad", bounds=(1e-6, 1))
    return g.finish()


def powers(name):
    """Return the laws of a power of the reading `name`."""
    places = [place for place in all_places(stand(), Scales()) if place.name == name]
    return [
        law
        for place in places
        for law in SensorNonlinearity().propose(place)
        if "a power of what is there" in law.words
    ]


def test_only_what_is_worked_out_may_be_a_power():
    assert len(powers("thrust")) == 1
    assert powers("speed") == []


def test_the_square_of_the_speed_is_found():
    random = np.random.default_rng(3)
    torque = np.repeat(random.uniform(0.1, 0.9, COUNT // 40), 40)
    speed, told = 0.0, np.zeros(COUNT)
    for k, drive in enumerate(torque):
        told[k] = speed
        fade = np.exp(-STEP * DRAG / INERTIA)
        speed = drive / DRAG + fade * (speed - drive / DRAG)
    thrust = LIFT * told**2 + 1e-3 * random.standard_normal(COUNT)
    told += 0.05 * random.standard_normal(COUNT)
    channels = {
        "torque": (torque, "N*m"),
        "thrust": (thrust, "N"),
        "speed": (told, "rad/s"),
    }
    run = Recording.from_arrays("run", STEP * np.arange(COUNT), channels)
    (law,) = powers("thrust")
    model = law.apply(stand())
    power = fit(model, [bind_to(model, run)]).estimate("sensor_power_thrust")
    assert power.value == pytest.approx(1.0, abs=0.02)
