"""An edge that all above it flows over at once: found with numbers, though a step."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to, effort
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.physics.orifice import Overflow

EDGE, AREA, OUTLET, NOISE = 9000.0, 2e-6, 5e7, 2.0
FINE = 100


def tank():
    graph = BondGraph("tank", domain="hydraulic")
    graph.zero("water", Sf("pump"), C("area"), R("outlet"))
    graph.measure("level", effort("water"))
    graph.parameter("area", 1.7e-6, "m^3/Pa", bounds=(1e-8, 1e-3))
    graph.parameter("outlet", 5.8e7, "Pa*s/m^3", bounds=(1e5, 1e10))
    return graph.finish()


def recorded(seed):
    """Of a tank that is never fuller than full."""
    random = np.random.default_rng(seed)
    inflow = np.repeat(random.uniform(0.2, 2.6, 15), 60) * 1e-4
    pressure, level = 2000.0, []
    for flow in inflow:
        level.append(pressure)
        for _ in range(FINE):
            pressure += (flow - pressure / OUTLET) / AREA / FINE
            pressure = min(pressure, EDGE)
    read = np.array(level) + NOISE * random.standard_normal(len(level))
    channels = {"pump": (inflow, "m^3/s"), "level": (read, "Pa")}
    time = np.arange(len(level), dtype=float)
    return bind_to(tank(), Recording.from_arrays(f"run {seed}", time, channels))


def test_what_is_as_steep_as_can_be_is_told_with_its_numbers():
    training, held_out = recorded(0), recorded(1)
    options = Options(library=(Overflow(),))
    diagnosis = diagnose(tank(), [training], held_out=[held_out], options=options)
    (finding,) = diagnosis.findings
    level, over = finding.estimates
    assert level.value == pytest.approx(EDGE, rel=0.01)
    assert over.std is not None
    assert over.std < 3.0 * over.value  # Not a slope that has run away.
    assert diagnosis.held_out.after.rmse["level"] < 2.0 * NOISE
