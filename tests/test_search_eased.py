"""Dry friction stops a machine at some sample: a fit that is caught there is eased."""

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, I, MSe, R, Recording, bind_to, displacement
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.laws.eased import eased
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import (
    CoulombFriction,
    DirectionDependentFriction,
)
from bondgraph.physics.hysteresis import DahlHysteresis
from bondgraph.physics.places.everywhere import all_places

STEP, FINE = 0.02, 50
INERTIA, WEIGHT, LEVEL, DRY, VISCOUS = 5e-3, 0.12, 0.27, 0.08, 0.0037


def dropped(begun):
    """Return times and angles of an arm that falls and rests before it hangs.

    Set-valued friction, stepped by hand.
    """
    angle, speed, told = begun, 0.0, []
    for k in range(80 * FINE):
        if k % FINE == 0:
            told.append(angle)
        pull = -WEIGHT * np.cos(angle + LEVEL) - VISCOUS * speed
        free = speed + STEP / FINE * pull / INERTIA
        held = STEP / FINE * DRY / INERTIA
        speed = float(np.sign(free) * max(abs(free) - held, 0.0))
        angle += STEP / FINE * speed
    noise = 7e-4 * np.random.default_rng(7).standard_normal(80)
    return STEP * np.arange(80), np.array(told) + noise


def arm():
    g = BondGraph("arm", domain="rotation")
    weight, level = sympy.symbols("weight level")
    pull = -weight * sympy.cos(displacement("joint") + level)
    g.one("joint", I("inertia"), R("viscous"), MSe("gravity", value=pull))
    g.parameter("inertia", INERTIA, "kg*m^2", std=0.0)
    g.parameter("viscous", 0.01, "N*m*s/rad", bounds=(0, 1))
    g.parameter("weight", 0.05, "N*m", bounds=(0, 5))
    g.parameter("level", 0.0, "rad", bounds=(-0.6, 0.6))
    g.measure("angle", displacement="joint")
    return g.finish()


@pytest.fixture(scope="module")
def bench():
    runs = []
    for begun in (0.0, 0.1, -0.1):
        time, angle = dropped(begun)
        channels = {"angle": (angle, "rad")}
        runs.append(Recording.from_arrays(f"from {begun}", time, channels))
    recordings = [bind_to(arm(), run) for run in runs]
    base = fit_model(arm(), recordings, FitSettings(horizon=WholeRecordings()))
    with workshop(Here(), Journal(None), lambda _: None) as shop:
        yield Bench.of(base, shop, "round 1")


def proposed(bench, physics):
    """Return the law at the joint."""
    places = all_places(bench.base.graph, measure_scales(bench.base))
    (place,) = (place for place in places if place.name == "joint")
    return next(iter(physics.propose(place)))


def ended(bench, law, starts=()):
    """Return the candidate that a fit to the end of a law comes to."""
    trial = Trial(law, starts)
    (candidate,) = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    return candidate


CAUGHT = {"viscous": 0.0062, "weight": 0.079, "level": -0.12, "coulomb_joint": 0.0226}
"""From here a fit meets an edge in the error, and stays."""


def test_a_fit_that_was_caught_at_an_edge_goes_past_it(bench):
    law, rival = proposed(bench, CoulombFriction()), proposed(bench, CoulombFriction())
    caught, better = ended(bench, law, (Start(CAUGHT),)), ended(bench, rival)
    assert caught.cost > 20.0 * better.cost
    told, other = eased(bench, [caught, better])
    assert other is better
    assert told.hypothesis is law
    assert told.cost < 3.0 * better.cost
    assert told.fitted.values["coulomb_joint"] == pytest.approx(DRY, rel=0.05)


def test_where_nothing_leaves_less_nothing_is_fitted_again(bench):
    (only,) = eased(bench, [caught := ended(bench, proposed(bench, QuadraticDrag()))])
    assert only is caught
    dry = ended(bench, proposed(bench, CoulombFriction()))
    assert eased(bench, [dry, caught]) == [dry, caught]


@pytest.mark.parametrize("times", [1.0, 3.0])
def test_a_memory_of_next_to_no_way_is_dry_friction(bench, times):
    law = proposed(bench, DahlHysteresis())
    assert law.limit is not None
    told = law.told_with({law.limit.parameter: times * law.limit.least})
    dry = times <= 1.0
    assert told.physics == ("coulomb_friction" if dry else "hysteresis")
    assert ("holds at rest" in told.words) is dry


@pytest.mark.parametrize("asymmetry", [-0.1, -0.01, 0.01, 0.1])
def test_dry_friction_that_is_alike_both_ways_is_coulomb_friction(bench, asymmetry):
    law = proposed(bench, DirectionDependentFriction())
    told = law.told_with({"asymmetry_joint": asymmetry})
    alike = abs(asymmetry) < 0.02
    assert (told.physics == "coulomb_friction") is alike
    assert ("of constant size" in told.words) is alike
