"""A resistance is as warm as a body of the model that holds heat."""

import numpy as np
import pytest

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    Hold,
    MSf,
    R,
    Recording,
    Se,
    bind_to,
    effort,
    fit,
    flow,
)
from bondgraph.diagnosis.probing import Scales
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.thermal import TemperatureDependentResistance

STEP, COUNT, OHM, HEAT, LOSS = 1.0, 400, 5.0, 40.0, 4.0
ROOM = 293.15


def stove():
    """Return a plate that a wire warms; its current and temperature are measured."""
    graph = BondGraph("stove", domain="thermal")
    graph.one("loop", Se("u"), R("wire"), domain="electrical")
    heat = MSf("joule", value=effort("wire") * flow("loop"))
    graph.zero("plate", heat, C("capacity"))
    graph.zero("kitchen", Se("room"))
    graph.one("air", R("loss"))
    graph.join("plate", "air")
    graph.join("air", "kitchen")
    for name, value, unit in (
        ("wire", OHM, "ohm"),
        ("capacity", HEAT, "J/K"),
        ("loss", LOSS, "K/W"),
    ):
        graph.parameter(name, value, unit)
    graph.measure("current", flow="loop")
    graph.measure("temperature", effort="plate")
    return graph.finish()


def heated(slope, zero):
    """Return a recording of a stove whose wire gets worse from 20 degC on."""
    room = ROOM - zero
    volts = 12.0 * (np.arange(COUNT) // 50 % 3)
    warm, told = room, []
    for u in volts:
        now = u / (OHM * (1.0 + slope * (warm + zero - ROOM)))
        told.append((now, warm))
        for _ in range(20):
            now = u / (OHM * (1.0 + slope * (warm + zero - ROOM)))
            warm += STEP / 20 * (u * now - (warm - room) / LOSS) / HEAT
    told = np.array(told) + np.random.default_rng(3).normal(size=(COUNT, 2)) * 1e-3
    channels = {
        "u": (volts, "V"),
        "room": (np.full(COUNT, room), "K"),
        "current": (told[:, 0], "A"),
        "temperature": (told[:, 1], "K"),
    }
    time = STEP * np.arange(COUNT)
    return bind_to(stove(), Recording.from_arrays("run", time, channels))


def proposed(typical):
    """Return what may warm of the wire, where plates are typically so warm."""
    scales = Scales({"effort(plate)": typical})
    (wire,) = (p for p in all_places(stove(), scales) if p.name == "wire")
    return list(TemperatureDependentResistance().propose(wire))


def test_a_body_is_what_holds_heat_and_no_room():
    said = [one.words for one in proposed(400.0)]
    assert said == [
        "wire changes as it warms",
        "wire changes with the temperature of plate",
    ]


@pytest.mark.parametrize("zero", [0.0, ROOM])
def test_how_it_changes_is_found_from_absolute_zero_and_from_the_room(zero):
    by_plate = proposed(ROOM - zero + 100.0)[1]
    settings = FitSettings(hold=Hold.ZERO)
    found = fit(by_plate.apply(stove()), [heated(0.004, zero)], settings=settings)
    slope, wire = map(found.estimate, ("temperature_slope_plate_wire", "wire"))
    assert slope.value == pytest.approx(0.004, rel=0.01)
    assert wire.value == pytest.approx(OHM, rel=0.002)
