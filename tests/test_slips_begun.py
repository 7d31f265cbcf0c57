"""What was plugged wrong begins as the author has stated, and in states of its own."""

import numpy as np
import pytest
from scipy.linalg import expm

from bondgraph import BondGraph, C, FitSettings, R, Recording, Se, Sf, bind_to, fit
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.trials.trying import Trial, fit_fully
from bondgraph.fitting.estimate import fit_model
from bondgraph.physics.dynamics import Lag
from bondgraph.physics.places.base import PROPOSED
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.sensing import SensorNonlinearity
from bondgraph.physics.wiring import SensorSwap

STEP, COUNT, NOISE, ROOM = 8.0, 700, 0.3, 293.0
CAPACITY, LOSS, PATH = (2600.0, 3100.0, 2200.0), (2.6, 3.2, 1.9), (0.55, 0.7)


def barrel():
    g = BondGraph("barrel", domain="thermal")
    g.zero("room", Se("air"))
    for n in "123":
        g.zero(f"zone{n}", Sf(f"heater{n}"), C(f"capacity{n}"))
        g.one(f"skin{n}", R(f"loss{n}"))
        g.join(f"zone{n}", f"skin{n}")
        g.join(f"skin{n}", "room")
        g.measure(f"T{n}", effort=f"zone{n}")
        g.parameter(f"capacity{n}", 2700.0, "J/K")
        g.parameter(f"loss{n}", 2.5, "K/W")
    for one, other in ("12", "23"):
        g.one(f"path{one}", R(f"passage{one}"))
        g.join(f"zone{one}", f"path{one}")
        g.join(f"path{one}", f"zone{other}")
        g.parameter(f"passage{one}", 0.6, "K/W")
    return g.finish()


@pytest.fixture(scope="module")
def swapped():
    """Return the barrel's recording, two of its thermometers in each other's place."""
    random = np.random.default_rng(3)
    out = np.diag(1.0 / np.array(LOSS))
    for k, path in enumerate(PATH):
        out[k : k + 2, k : k + 2] += np.array([[1, -1], [-1, 1]]) / path
    rates = -out / np.array(CAPACITY)[:, None]
    over = expm(STEP * rates)
    heat = np.repeat(random.uniform(0, 160, (COUNT // 35, 3)), 35, axis=0)
    warm, told = np.array([20.0, 25.0, 15.0]), np.zeros((COUNT, 3))
    for k, power in enumerate(heat):
        told[k] = warm
        rest = np.linalg.solve(out, power)
        warm = rest + over @ (warm - rest)
    told += ROOM + NOISE * random.standard_normal(told.shape)
    channels = {f"heater{n + 1}": (heat[:, n], "W") for n in range(3)}
    channels |= {"air": (np.full(COUNT, ROOM), "K")}
    channels |= {
        f"T{n}": (told[:, k], "K") for n, k in zip("123", (0, 2, 1), strict=True)
    }
    time = STEP * np.arange(COUNT)
    return bind_to(barrel(), Recording.from_arrays("swapped", time, channels))


def proposed(base, physics, name):
    places = all_places(base.graph, measure_scales(base))
    return [law for p in places if p.name == name for law in physics.propose(p)]


def test_two_thermometers_that_are_swapped_are_found_from_a_fit_far_off(swapped):
    base = fit_model(barrel(), [swapped], FitSettings())
    assert run_away(base)
    costs = {
        law.words: fit_fully(base, Trial(law))["cost"] / base.optimum.cost
        for name in ("T1", "T2")
        for law in proposed(base, SensorSwap(), name)
    }
    best = min(costs, key=costs.get)
    assert "T2 and T3" in best
    assert costs.pop(best) < 0.2
    assert all(cost > 1.0 for cost in costs.values())


def test_what_a_law_begins_with_has_not_run_away(swapped):
    base = fit_model(barrel(), [swapped], FitSettings())
    law = proposed(base, Lag(), "T1")[0]
    graph = law.apply(base.graph)
    (tau,) = law.parameters
    assert graph.parameters[tau].source == PROPOSED
    later = fit(graph, [swapped]).model
    assert tau not in run_away(fit_model(later, [swapped], FitSettings()), 1.01)


def test_a_thermometer_bends_about_the_middle_of_its_range(swapped):
    base = fit_model(barrel(), [swapped], FitSettings())
    bent = proposed(base, SensorNonlinearity(), "T1")[0]
    told = bent.apply(base.graph).parameters
    low, high = np.min(swapped.output("T1")), np.max(swapped.output("T1"))
    assert told["sensor_right_at_T1"].value == pytest.approx((low + high) / 2)
    assert told["sensor_size_T1"].value == pytest.approx((high - low) / 2)
