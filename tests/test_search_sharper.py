"""Dry friction holds: a smooth edge that creeps is sharpened after the fit."""

from dataclasses import replace

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.candidates import CURVE, Promised
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.laws.fits import (
    ShortFit,
    _from_what_they_contain,
    _kept,
    fit_best,
)
from bondgraph.diagnosis.search.laws.relatives import from_relative
from bondgraph.diagnosis.search.laws.sharper import sharpened
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Trial, fit_fully
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction, StribeckFriction
from bondgraph.physics.places.everywhere import all_places

STEP, MASS, VISCOUS, DRY = 0.002, 2.0, 1.0, 3.0


def pushed():
    """Return times, forces and positions of a cart that slides and then is held.

    Set-valued friction, stepped by hand: what force is left cannot turn the motion.
    """
    time = np.arange(5000) * STEP
    force = np.where(time % 5.0 < 1.5, 8.0 * np.sin(4.0 * time), 2.7)
    speed, position, x = 0.0, np.zeros(time.size), 0.0
    for k, push in enumerate(force):
        position[k] = x
        free = speed + STEP / MASS * (push - VISCOUS * speed)
        held = STEP / MASS * DRY
        speed = float(np.sign(free) * max(abs(free) - held, 0.0))
        x += STEP * speed
    noise = 2e-5 * np.random.default_rng(5).standard_normal(time.size)
    return time, force, position + noise


def cart():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"), R("viscous"))
    g.measure("position", displacement="cart")
    g.parameter("mass", MASS, "kg", bounds=(1, 5))
    g.parameter("viscous", VISCOUS, "N*s/m", bounds=(0, 50))
    return g.finish()


@pytest.fixture(scope="module")
def bench():
    time, force, position = pushed()
    channels = {"force": (force, "N"), "position": (position, "m")}
    recording = Recording.from_arrays("held", time, channels)
    base = fit_model(cart(), [bind_to(cart(), recording)], FitSettings())
    with workshop(Here(), Journal(), lambda _: None) as shop:
        yield Bench.of(base, shop, "test")


def proposed(bench, physics):
    places = all_places(bench.base.graph, measure_scales(bench.base))
    (place,) = (place for place in places if place.name == "cart")
    return list(physics.propose(place))


def width_of(candidate):
    (name,) = candidate.hypothesis.smoothing
    return candidate.fitted.graph.parameters[name].value


def test_friction_that_holds_is_sharpened_until_it_does(bench):
    (dry,) = proposed(bench, CoulombFriction())
    trial = Trial(dry)
    (smooth,) = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    (sharp,) = sharpened(bench, [smooth])
    assert width_of(sharp) < width_of(smooth) / 5
    assert sharp.fitted.optimum.cost < 0.9 * smooth.fitted.optimum.cost
    assert sharp.hypothesis.told_by == smooth.hypothesis.told_by
    assert sharp.fitted.values["coulomb_cart"] == pytest.approx(DRY, rel=0.01)


def test_a_curve_that_leads_by_its_freedom_keeps_no_law_from_being_sharpened(bench):
    (dry,) = proposed(bench, CoulombFriction())
    trial = Trial(dry)
    (smooth,) = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    # So little is left of it that no sharper edge tells anything.
    least = replace(smooth.fitted.optimum, cost=1e-6 * smooth.cost)
    fitted = replace(smooth.fitted, optimum=least)
    curve = replace(smooth, hypothesis=replace(dry, physics=CURVE), fitted=fitted)
    _, sharp = sharpened(bench, [curve, smooth])
    assert width_of(sharp) < width_of(smooth) / 5


def test_a_wider_law_that_makes_up_for_its_edge_keeps_no_plain_one_smooth(bench):
    (dry,) = proposed(bench, CoulombFriction())
    trial = Trial(dry)
    (smooth,) = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    least = replace(smooth.fitted.optimum, cost=1e-6 * smooth.cost)
    wider = replace(smooth, complexity=2, fitted=replace(smooth.fitted, optimum=least))
    kept, sharp = sharpened(bench, [wider, smooth])
    assert kept is wider
    assert width_of(sharp) < width_of(smooth) / 5


def test_what_has_no_edge_is_left_as_it_is(bench):
    (drag,) = proposed(bench, QuadraticDrag())
    assert drag.sharper(10.0) is drag
    trial = Trial(drag)
    fitted = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    assert sharpened(bench, fitted) == fitted


def test_the_narrower_law_is_judged_beside_a_wider_one_that_is_kept(bench):
    laws = [
        Promised(hypothesis, 0.9)
        for physics in (CoulombFriction(), StribeckFriction())
        for hypothesis in proposed(bench, physics)
    ]
    fitted = fit_best(bench, laws, 0.75, 1)
    assert {one.hypothesis.physics for one in fitted} == {
        "coulomb_friction",
        "stribeck_friction",
    }


def test_the_narrower_law_is_kept_however_far_behind_its_short_fit_is(bench):
    (dry,), (wide,), (drag,) = (
        proposed(bench, physics)
        for physics in (CoulombFriction(), StribeckFriction(), QuadraticDrag())
    )
    ahead, behind, other = (
        ShortFit(share, law, {"values": dict.fromkeys(law.parameters, 1.0)})
        for share, law in ((0.8, wide), (0.1, dry), (0.1, drag))
    )
    assert _kept([ahead, behind, other], 0.75, 5) == [ahead, behind]


def test_a_wider_law_is_tried_from_the_one_it_contains_without_its_additions(bench):
    trials = [
        Trial(hypothesis)
        for physics in (CoulombFriction(), StribeckFriction())
        for hypothesis in proposed(bench, physics)
    ]
    narrow, wide = bench.candidates(trials, bench.run(fit_fully, trials, "fits"))
    own, none = from_relative(wide, narrow)
    coulomb, rise = narrow.fitted.values["coulomb_cart"], "stribeck_rise_cart"
    assert own.values["coulomb_cart"] == none.values["coulomb_cart"] == coulomb
    assert own.values[rise] == wide.fitted.values[rise] != 0.0
    assert none.values[rise] == 0.0
    assert len(from_relative(narrow, wide)) == 1


def test_a_short_fit_of_a_wider_law_begins_where_a_narrower_one_has_ended(bench):
    (dry,), (wide,) = (
        proposed(bench, physics) for physics in (CoulombFriction(), StribeckFriction())
    )
    ended = {
        "values": {"coulomb_cart": DRY},
        "initial": [],
        "solver": ("RungeKutta4", 1),
    }
    ahead, behind = ShortFit(0.8, dry, ended), ShortFit(0.4, wide, ended)
    (trial,) = _from_what_they_contain([ahead, behind], 0.1)
    assert trial.hypothesis is wide
    assert trial.starts[0].values == {"coulomb_cart": DRY}
    ahead_too = replace(behind, reduction=0.9)
    assert _from_what_they_contain([ahead_too, ahead], 0.1) == []
    assert _from_what_they_contain([ahead, behind], 0.9) == []
