"""A gain of one of two sensors is the other's as well, where nothing else is known."""

import numpy as np
import pytest
from scipy.linalg import expm

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to, diagnose
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.actuation import InputScale
from bondgraph.physics.dynamics import Lag
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.sensing import SensorScale

STEP, SAMPLES = 2.0, 1500
AREAS, RESISTANCES, GAIN = (1.5e-6, 1.9e-6), (4.4e7, 6.5e7), 1.6


def tanks():
    g = BondGraph("two tanks", domain="hydraulic")
    g.zero("upper", Sf("pump"), C("area_upper"))
    g.one("pipe", R("pipe_resistance"))
    g.zero("lower", C("area_lower"), R("outlet"))
    g.join("upper", "pipe")
    g.join("pipe", "lower")
    g.measure("p_upper", effort="upper")
    g.measure("p_lower", effort="lower")
    g.parameter("area_upper", 1.3e-6, "m^3/Pa")
    g.parameter("area_lower", 2.1e-6, "m^3/Pa")
    g.parameter("pipe_resistance", 4.7e7, "Pa*s/m^3")
    g.parameter("outlet", 6.0e7, "Pa*s/m^3")
    return g.finish()


def recorded(seed):
    """Return a run under held steps of the pump, the upper gauge reading too much."""
    random = np.random.default_rng(seed)
    pump = np.repeat(random.uniform(0.0, 1e-5, SAMPLES // 50), 50)
    (upper, lower), (pipe, outlet) = AREAS, RESISTANCES
    whole = np.zeros((3, 3))
    whole[0] = [-1 / (pipe * upper), 1 / (pipe * upper), 1 / upper]
    whole[1, :2] = [1 / (pipe * lower), -(1 / pipe + 1 / outlet) / lower]
    over = expm(whole * STEP)
    pressures, now = np.empty((SAMPLES, 2)), np.array([200.0, 100.0])
    for i, flow in enumerate(pump):
        pressures[i] = now
        now = over[:2, :2] @ now + over[:2, 2] * flow
    read = pressures * [GAIN, 1.0] + random.normal(size=(SAMPLES, 2))
    channels = {
        "pump": (pump, "m^3/s"),
        "p_upper": (read[:, 0], "Pa"),
        "p_lower": (read[:, 1], "Pa"),
    }
    time = STEP * np.arange(SAMPLES)
    return bind_to(tanks(), Recording.from_arrays(f"run {seed}", time, channels))


def test_a_gain_of_either_sensor_is_told_for_both():
    options = Options(library=(SensorScale(), Lag()))
    found = diagnose(tanks(), [recorded(1)], held_out=[recorded(2)], options=options)
    (finding,) = found.findings
    places = {finding.place, *finding.indistinguishable_places}
    assert finding.physics == "sensor_scale"
    assert places == {"p_upper", "p_lower"}
    (scale,) = finding.estimates
    true = {"p_upper": GAIN, "p_lower": 1 / GAIN}[finding.place]
    assert scale.value == pytest.approx(true, rel=0.01)


@pytest.mark.parametrize("physics", [SensorScale(), InputScale()])
def test_a_gain_is_begun_on_either_side_and_at_none(physics):
    gains = [
        gain
        for place in all_places(tanks(), Scales())
        for gain in physics.propose(place)
        if gain.edit.nested and gain.parameters
    ]
    assert gains
    for gain in gains:
        (name,) = gain.parameters
        assert [dict(start) for start in gain.silent_starts] == [{name: 1.0}]
        begun = [start[name] for start in gain.starts]
        assert min(begun) < 1.0 < max(begun)
