"""The gain of a thermometer is wrong about 0 degrees Celsius, and not about 0 K."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, R, Recording, Se, Sf, bind_to
from bondgraph.diagnosis.candidates import propose_all
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.actuation import InputScale
from bondgraph.physics.places.channels import InputPlace, OutputPlace
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.sensing import SensorScale
from bondgraph.simulation.solvers import Hold

GAIN = 1.04


def oven():
    g = BondGraph("oven", domain="thermal")
    g.zero("room", Se("hall"))
    g.zero("oven", Sf("heater"), C("body"))
    g.one("wall", R("wool"))
    g.join("oven", "wall")
    g.join("wall", "room")
    g.measure("temperature", effort="oven")
    g.parameter("body", 200.0, "J/K", std=0.0)
    g.parameter("wool", 0.5, "K/W", std=0.0)
    return g.finish()


def law_of(place, physics):
    law = next(iter(physics.propose(place)))
    zeros = {p.name: p.value for p in law.edit.parameters if p.exact}
    return law.law.subs(
        {s: zeros[s.name] for s in law.law.free_symbols if s.name in zeros}
    )


@pytest.mark.parametrize("physics", [SensorScale(), InputScale()])
@pytest.mark.parametrize(
    ("between", "zero"), [((290.0, 350.0), 273.15), ((0.0, 60.0), 0.0)]
)
def test_absolute_temperatures_are_in_proportion_about_freezing(physics, between, zero):
    ranges = {"temperature": between, "hall": between, "effort(hall)": between}
    scales = Scales({"effort(oven)": between[1], "effort(hall)": between[1]}, ranges)
    kind, name = (
        (OutputPlace, "temperature")
        if isinstance(physics, SensorScale)
        else (InputPlace, "hall")
    )
    place = kind(oven(), name, scales)
    law = law_of(place, physics)
    assert float(law.subs(place.signal, zero)) == pytest.approx(zero)


def test_the_gain_is_found_in_degrees_celsius():
    time = 10.0 * np.arange(400)
    heat = np.where(np.sin(2e-3 * time) > 0.0, 60.0, 0.0)
    room = np.full_like(time, 20.0)
    true = np.empty_like(time)
    true[0] = 20.0
    fade = np.exp(-10.0 / 100.0)
    for k in range(len(time) - 1):
        end = 20.0 + 0.5 * heat[k]
        true[k + 1] = end + (true[k] - end) * fade
    read = GAIN * true + 0.01 * np.random.default_rng(1).standard_normal(len(time))
    graph = oven()
    channels = {
        "heater": (heat, "W"), "hall": (room, "degC"), "temperature": (read, "degC")
    }  # fmt: skip
    recorded = bind_to(graph, Recording.from_arrays("night", time, channels))
    settings = FitSettings(hold=Hold.ZERO)
    base = fit_model(graph, [recorded], settings)
    law = next(
        one for one in propose_all(base, (SensorScale(),)) if one.place == "temperature"
    )
    fitted = fit_model(law.apply(graph), [recorded], settings)
    assert fitted.values[law.parameters[0]] == pytest.approx(GAIN, abs=2e-3)
