"""Where an input's lag leads, the store it may be is fitted too, and both are told."""

import numpy as np
import pytest
from scipy.signal import lsim

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to, diagnose
from bondgraph.diagnosis.candidates import Candidate, propose_all
from bondgraph.diagnosis.search.laws.lag_or_store import lag_or_store
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.contact import AddedCompliance
from bondgraph.physics.dynamics import Delay, Lag

CARTRIDGE, FIT, PLATE, LOSS = 250.0, 0.02, 5000.0, 0.5
"""What heats, in J/K, its fit in K/W, what it heats, and what that loses by."""


def plate():
    graph = BondGraph("hot plate", domain="thermal")
    graph.zero("cartridge", Sf("power"))
    graph.one("bore", R("fit"))
    graph.zero("steel", C("plate"), R("loss"))
    graph.join("cartridge", "bore")
    graph.join("bore", "steel")
    graph.measure("cartridge_temperature", effort="cartridge")
    graph.parameter("fit", 0.018, "K/W", bounds=(0.002, 0.3))
    graph.parameter("plate", 5400.0, "J/K")
    graph.parameter("loss", 0.6, "K/W", bounds=(0.05, 8.0))
    return graph.finish()


def heated(graph, seed):
    """Return a recording of the plate whose cartridge stores heat."""
    rng = np.random.default_rng(seed)
    time = np.arange(900.0)
    power = np.repeat(rng.choice([0.0, 150.0, 400.0, 600.0], 30), 30)
    a = np.array(
        [
            [-1 / (FIT * CARTRIDGE), 1 / (FIT * CARTRIDGE)],
            [1 / (FIT * PLATE), -1 / (FIT * PLATE) - 1 / (LOSS * PLATE)],
        ]
    )
    b = np.array([[1 / CARTRIDGE], [0.0]])
    system = a, b, np.array([[1.0, 0.0]]), np.zeros((1, 1))
    _, warm, _ = lsim(system, power, time, interp=False)
    channels = {
        "power": (power, "W"),
        "cartridge_temperature": (warm + 0.1 * rng.normal(size=time.size), "K"),
    }
    return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))


def test_each_leads_to_the_other_where_the_input_enters():
    graph = plate()
    run = heated(graph, 1)
    base = fit_model(graph, [run], FitSettings())
    laws = propose_all(base, [AddedCompliance(), Lag(), Delay()])

    def met(leading):
        """Return what is fitted beside a law that leads."""
        return [
            (trial.hypothesis.physics, trial.hypothesis.place)
            for trial in lag_or_store(base, [Candidate(leading, base, 1)], laws)
        ]

    for law in laws:
        expected = {
            ("lag", "power"): [("added_compliance", "cartridge")],
            ("added_compliance", "cartridge"): [("lag", "power")] * 2,
        }.get((law.physics, law.place), [])
        assert met(law) == expected, law.words


@pytest.mark.parametrize("library", [(AddedCompliance(), Lag()), (AddedCompliance(),)])
def test_a_store_where_an_input_enters_is_told_beside_its_lag(library):
    graph = plate()
    run, other = (heated(graph, seed) for seed in (1, 2))
    found = diagnose(graph, [run], held_out=[other], options=Options(library=library))
    (one,) = found.findings
    told = {(x.physics, x.place) for x in (one, *one.alternatives)}
    assert ("added_compliance", "cartridge") in told
    assert (("lag", "power") in told) == (len(library) == 2)
