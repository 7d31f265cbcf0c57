"""A ripple that adds up over long windows is looked for over short ones as well."""

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, I, R, Recording, Se, bind_to, f
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.posing import divided
from bondgraph.diagnosis.search.trials.screening import screen
from bondgraph.diagnosis.search.trials.trying import FORMS, Trial, fit_briefly
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import SHORTEST, Windows
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.everywhere import all_places
from bondgraph.simulation.solvers import Hold

MASS, VISCOUS, DRY, STRENGTH, WAVE = 4.4, 24.0, 13.0, 5.2, 262.0
STEP, PARTS = 1e-3, 10


def axis():
    viscous, dry = sympy.symbols("viscous dry")
    graph = BondGraph("axis", domain="translation")
    law = viscous * f + dry * sympy.sign(f)
    graph.one("carriage", Se("force"), I("mass"), R("rails", law=law))
    graph.measure("position", displacement="carriage")
    graph.parameter("mass", 3.4, "kg", bounds=(0.1, 100))
    graph.parameter("viscous", 32.0, "N*s/m", bounds=(0, 1e3))
    graph.parameter("dry", 10.0, "N", bounds=(0, 100))
    return graph.finish()


def recorded():
    """Return an axis in a position loop, whose motor cogs along its way."""
    random = np.random.default_rng(4)
    goals = np.repeat(random.uniform(0.0, 0.3, 12), 500)
    x, v, wanted = 0.15, 0.0, 0.15
    force, position = np.zeros(goals.size), np.zeros(goals.size)
    for k, goal in enumerate(goals):
        wanted += np.clip(goal - wanted, -6e-4, 6e-4)
        force[k] = 4000.0 * (wanted - x) - 150.0 * v
        position[k] = x
        for _ in range(PARTS):
            push = force[k] - STRENGTH * np.sin(WAVE * x + 0.7) - VISCOUS * v
            free = v + STEP / PARTS * push / MASS
            rubbed = STEP / PARTS * DRY / MASS
            v = np.sign(free) * max(abs(free) - rubbed, 0.0)
            x += STEP / PARTS * v
    position += 2e-5 * random.normal(size=goals.size)
    channels = {"force": (force, "N"), "position": (position, "m")}
    time = STEP * np.arange(goals.size)
    return bind_to(axis(), Recording.from_arrays("run", time, channels))


INERTIA, RUB, SINE, COSINE = 1.0, 0.42, 3.2, 2.2


def drum():
    graph = BondGraph("drum", domain="rotation")
    graph.one("drum", Se("torque"), I("inertia"), R("bearing"))
    graph.measure("angle", displacement="drum")
    graph.parameter("inertia", 1.2, "kg*m^2", bounds=(0.01, 100))
    graph.parameter("bearing", 0.36, "N*m*s/rad", bounds=(0.0, 100))
    return graph.finish()


def tumbled():
    """Return a drum that goes round many times, with a lump of laundry in it."""
    random = np.random.default_rng(2)
    goals = np.repeat(random.choice([-5.0, -4.0, 4.0, 5.0], 12), 500)
    angle, speed = 0.0, 0.0
    torque, told = np.zeros(goals.size), np.zeros(goals.size)
    for k, goal in enumerate(goals):
        torque[k], told[k] = np.clip(6.0 * (goal - speed), -15.0, 15.0), angle
        for _ in range(PARTS):
            weight = SINE * np.sin(angle) + COSINE * np.cos(angle)
            speed += 0.01 / PARTS * (torque[k] - weight - RUB * speed) / INERTIA
            angle += 0.01 / PARTS * speed
    told += 1e-3 * random.normal(size=goals.size)
    channels = {"torque": (torque, "N*m"), "angle": (told, "rad")}
    time = 0.01 * np.arange(goals.size)
    return bind_to(drum(), Recording.from_arrays("run", time, channels))


@pytest.fixture(scope="module")
def base():
    return fit_model(axis(), [recorded()], FitSettings(horizon=Windows(3000)))


def test_windows_are_divided_where_they_are_long_enough(base):
    near = divided(base, 8)
    assert near.problem.shots.n_windows == 8 * base.problem.shots.n_windows == 16
    assert near.optimum.cost < 0.2 * base.optimum.cost
    short = divided(base, 1000)
    assert np.diff(short.problem.shots.edges).min() == SHORTEST
    assert divided(short, 8) is None


def test_a_fit_of_the_true_length_over_short_windows_is_begun_from(base):
    places = all_places(base.graph, measure_scales(base))
    (place,) = (one for one in places if one.name == "carriage")
    cogging = next(one for one in LIBRARY if one.word == "cogging")
    (law, *_) = cogging.propose(place)
    assert len(law.starts) > FORMS
    with workshop(Here(), Journal(), lambda _: None) as shop:
        (promised,) = screen(Bench.of(base, shop, "test"), [law]).promised
    begun = promised.hypothesis.starts
    assert len(begun) == FORMS + 1
    assert begun[0]["cogging_wave_carriage"] == pytest.approx(WAVE, rel=0.01)
    found = np.hypot(*(begun[0][f"cogging_{w}_carriage"] for w in ("sine", "cosine")))
    assert found == pytest.approx(STRENGTH, rel=0.25)


def test_a_weight_that_goes_round_is_fitted_at_once_over_long_windows():
    settings = FitSettings(horizon=Windows(2000), hold=Hold.ZERO)
    base = fit_model(drum(), [tumbled()], settings)
    places = all_places(base.graph, measure_scales(base))
    (place,) = (one for one in places if one.name == "drum")
    gravity = next(one for one in LIBRARY if one.word == "gravity")
    with workshop(Here(), Journal(), lambda _: None) as shop:
        bench = Bench.of(base, shop, "test")
        (promised,) = screen(bench, [*gravity.propose(place)]).promised
    begun = promised.hypothesis.starts[0]
    assert begun["gravity_sine_drum"] == pytest.approx(SINE, rel=0.05)
    trial = Trial(promised.hypothesis, enough=0.8)
    short = fit_briefly(bench.few, trial)
    assert short["cost"] < 0.01 * bench.few.optimum.cost
