"""A capacitor amid a loop that loses its charge, though no 0-junction is there."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, Options, R, Recording, Se, bind_to, diagnose
from bondgraph.physics.dynamics import Lag
from bondgraph.physics.leakage import Leak, Slip
from bondgraph.physics.orifice import SquareLaw
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales

STEP, LEAK, NOISE = 0.05, 0.2, 2e-3


def loop(*, coil=False):
    g = BondGraph("loop", domain="electrical")
    g.one("loop", Se("supply"), R("resistor"), C("capacitor"), *([I("coil")] * coil))
    g.measure("voltage", effort="capacitor")
    g.parameter("resistor", 1.0, "ohm", std=0.0)
    g.parameter("capacitor", 0.7, "F", bounds=(0.1, 10.0))
    if coil:
        g.parameter("coil", 0.01, "H", std=0.0)
    return g.finish()


def branch():
    """Return the capacitor in series with its resistance, on a node of others."""
    g = BondGraph("branch", domain="electrical")
    g.zero("node", Se("supply"))
    g.one("series", R("resistor"), C("capacitor"))
    g.join("node", "series")
    g.measure("voltage", effort="capacitor")
    g.parameter("resistor", 1.0, "ohm")
    g.parameter("capacitor", 1.0, "F")
    return g.finish()


def proposed(graph):
    return [
        hypothesis
        for place in all_places(graph, Scales())
        for physics in (Leak(), Slip())
        for hypothesis in physics.propose(place)
        if place.name == "capacitor"
    ]


@pytest.mark.parametrize("graph", [loop(), loop(coil=True)], ids=["RC", "RLC"])
def test_it_is_proposed_past_a_store_that_a_loop_goes_through(graph):
    (hypothesis,) = proposed(graph)
    assert "loses what it holds in proportion to its voltage" in hypothesis.words


def test_what_a_branch_loses_is_lost_where_it_hangs():
    assert proposed(branch()) == []


def shaken(graph, seed):
    """Return the loop with a leak past its capacitor, stepped exactly."""
    random = np.random.default_rng(seed)
    supply = np.repeat(random.normal(size=40), 20)
    voltage, u = np.zeros(supply.size), 0.0
    conductance = 1.0 + LEAK
    for k, source in enumerate(supply):
        voltage[k] = u
        rest = source / conductance
        u = rest + (u - rest) * np.exp(-STEP * conductance)
    voltage += NOISE * random.normal(size=supply.size)
    channels = {"supply": (supply, "V"), "voltage": (voltage, "V")}
    return bind_to(
        graph, Recording.from_arrays(f"run{seed}", STEP * np.arange(800), channels)
    )


def test_it_is_found_with_its_size():
    graph = loop()
    options = Options(library=(Lag(), SquareLaw(), Leak()))
    recordings = [shaken(graph, seed) for seed in (1, 2)]
    answer = diagnose(graph, recordings[:1], held_out=recordings[1:], options=options)
    (finding,) = answer.findings
    assert (finding.physics, finding.place) == ("leak", "capacitor")
    (leak,) = finding.estimates
    assert leak.value == pytest.approx(LEAK, abs=4 * leak.std)
    assert leak.std < 0.05 * LEAK
    assert answer.held_out.after.rmse["voltage"] < 1.3 * NOISE
