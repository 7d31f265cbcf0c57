"""A storage that the model lacks: nearly empty it promises nothing, larger it does."""

import numpy as np
import pytest
from scipy.signal import cont2discrete, dlsim

from bondgraph import BondGraph, C, R, Recording, Se, bind_to, effort
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.physics.contact import AddedCompliance
from bondgraph.physics.dynamics import Lag

STEP, NOISE = 5.0, 0.01
WALL, PAD, MODULE, HIDDEN = 0.12, 0.13, 2900.0, 1500.0


def pack():
    graph = BondGraph("pack", domain="thermal")
    graph.zero("bath", Se("coolant"))
    graph.zero("plate")
    graph.zero("module", C("capacity"))
    graph.one("wall", R("channel"))
    graph.one("glue", R("pad"))
    graph.join("bath", "wall")
    graph.join("wall", "plate")
    graph.join("plate", "glue")
    graph.join("glue", "module")
    graph.parameter("capacity", 2500.0, "J/K", bounds=(300, 30000))
    graph.parameter("channel", WALL, "K/W", std=0.0)
    graph.parameter("pad", PAD, "K/W", std=0.0)
    graph.measure("hot", effort("module"))
    graph.measure("near", effort("plate"))
    return graph.finish()


def rates():
    """Return the rates' matrices of module and plate, the plate with a mass."""
    flow = np.array([[1.0, -1.0], [-1.0, 1.0]]) / PAD
    flow[1, 1] += 1.0 / WALL
    stores = np.array([[MODULE], [HIDDEN]])
    return -flow / stores, np.array([[0.0], [1.0 / WALL]]) / stores


def recorded(seed):
    """Of a coolant that jumps now and then, far from zero."""
    random = np.random.default_rng(seed)
    coolant = np.repeat(random.uniform(296.0, 304.0, 12), 50)
    system = cont2discrete((*rates(), np.eye(2), np.zeros((2, 1))), STEP)
    begin = np.full(2, coolant[0])
    _, temperatures, _ = dlsim(system, coolant[:, None], x0=begin)
    temperatures = temperatures + NOISE * random.standard_normal(temperatures.shape)
    channels = {
        "coolant": (coolant, "K"),
        "hot": (temperatures[:, 0], "K"),
        "near": (temperatures[:, 1], "K"),
    }
    time = STEP * np.arange(len(coolant))
    return bind_to(pack(), Recording.from_arrays(f"run {seed}", time, channels))


def test_a_mass_is_found_where_the_model_has_none():
    training, held_out = recorded(1), recorded(2)
    options = Options(library=(AddedCompliance(), Lag()))
    diagnosis = diagnose(pack(), [training], held_out=[held_out], options=options)
    (finding,) = diagnosis.findings
    assert (finding.physics, finding.place) == ("added_compliance", "plate")
    (mass,) = finding.estimates
    assert mass.value == pytest.approx(HIDDEN, rel=0.03)
    assert diagnosis.held_out.after.rmse["near"] < 1.5 * NOISE
