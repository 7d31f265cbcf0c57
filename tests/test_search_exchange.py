"""A law that was found first gives way to the one that does better in its place."""

from dataclasses import replace

import numpy as np
import pytest

from bondgraph import BondGraph, R, Recording, Sf, bind_to
from bondgraph.diagnosis.answer.found import nearest
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.judged import Rule, judge
from bondgraph.diagnosis.evidence.left_out import chunk_count, left_out_errors
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.remaining import remaining
from bondgraph.diagnosis.search.revising.exchange import Reached, exchanged
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.drag import QuadraticDrag, SpeedLimit
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.unknown import UnknownRelation

RULE = Rule()


def car():
    g = BondGraph("car", domain="translation")
    g.one("car", Sf("speed"), R("loss"))
    g.measure("force", effort="speed")
    g.parameter("loss", 15.0, "N*s/m", bounds=(0, 1000))
    return g.finish()


def driven(law):
    """Return the fit to a car that never stands still."""
    time = np.arange(1500) * 0.1
    speed = 21.0 + 7.0 * np.sin(0.11 * time) + 4.0 * np.sin(0.31 * time + 1)
    noise = 5.0 * np.random.default_rng(3).standard_normal(time.size)
    channels = {"speed": (speed, "m/s"), "force": (law(speed) + noise, "N")}
    recording = bind_to(car(), Recording.from_arrays("run", time, channels))
    return fit_model(car(), [recording], FitSettings())


def proposed(fitted, physics):
    places = all_places(fitted.graph, measure_scales(fitted))
    (place,) = (place for place in places if place.name == "car")
    (hypothesis, *_) = physics.propose(place)
    return hypothesis


def added(first, fitted, hypotheses):
    """Return the model with one more law, from the start that fits best."""
    starts = hypotheses[-1].starts
    fits = [fitted_with(first, fitted, hypotheses, start) for start in starts]
    return min(fits, key=lambda one: one.optimum.cost)


def judged_beside(current, newcomer, fitted, chunks=None):
    chunks = chunks or chunk_count(current)
    before, after = (left_out_errors(one, chunks) for one in (current, fitted))
    return judge(Candidate(newcomer, fitted, 1), before, after, 30.0, RULE)


def outcome(law, earlier, last, chunks=None):
    """Return the exchange for the `last` law, tried after the `earlier` ones."""
    base = current = driven(law)
    found = []
    for physics in earlier:
        found.append(proposed(base, physics))
        current = added(base, current, found)
    new = proposed(base, last)
    fitted = added(base, current, [*found, new])
    judged = judged_beside(current, new, fitted, chunks)
    reached = Reached(base, current, tuple(found), np.zeros(1))
    return judged, exchanged(reached, [judged], 30.0, RULE), found, new


def road(speed):
    return 170.0 + 0.42 * speed**2


def test_a_law_that_comes_too_late_takes_the_place_of_a_bent_one():
    limit_and_friction = (SpeedLimit(), CoulombFriction())
    _, instead, found, new = outcome(road, limit_and_friction, QuadraticDrag(), 9)
    # On the chunks of its round, or it could not be compared with the others there.
    assert instead.better.errors.chunks.size == instead.rival.errors.chunks.size == 9
    assert instead.rival.candidate.hypothesis is found[0]
    assert instead.kept == (found[1], new)
    assert instead.better.support is Support.SUPPORTED
    values = instead.fitted.values
    assert values["coulomb_car"] == pytest.approx(170.0, rel=0.05)
    assert values["quadratic_car"] == pytest.approx(0.42, rel=0.05)
    assert instead.probability > 0.9


def test_laws_that_are_both_there_keep_their_places():
    _, instead, _, _ = outcome(road, (CoulombFriction(),), QuadraticDrag())
    assert instead is None
    drag_then_limit = (QuadraticDrag(), CoulombFriction())
    assert outcome(road, drag_then_limit, SpeedLimit())[1] is None


def digressive(speed):
    return 40.0 * (speed - 21.0) + 900.0 * np.tanh((speed - 21.0) / 2.0)


def test_a_curve_takes_a_place_only_where_it_leaves_less_than_half():
    judged, instead, found, _ = outcome(digressive, (SpeedLimit(),), UnknownRelation())
    assert judged.gain.value > 0.5
    assert instead.rival.candidate.hypothesis is found[0]
    judged, instead, _, _ = outcome(road, (QuadraticDrag(),), UnknownRelation())
    assert instead is None or instead.better.gain.value > 0.5


def test_what_is_left_is_counted_from_the_first_model_to_the_last():
    base = driven(road)
    limit, drag = proposed(base, SpeedLimit()), proposed(base, QuadraticDrag())
    one = added(base, base, [limit])
    both = added(base, one, [limit, proposed(one, CoulombFriction())])
    instead = added(base, both, [proposed(base, CoulombFriction()), drag])
    rounds = [
        Round(base, chosen=judged_beside(base, limit, one)),
        Round(one, chosen=judged_beside(one, proposed(one, CoulombFriction()), both)),
        Round(both, chosen=judged_beside(both, drag, instead), removed=(limit,)),
        Round(instead),
    ]
    assert remaining(rounds, {"force": 5.0}) < 0.05
    assert remaining(rounds[-1:], {"force": 5.0}) == 1.0


def test_noise_is_no_larger_where_a_model_is_off_that_was_not_fitted_there():
    base = driven(road)
    limit = proposed(base, SpeedLimit())
    near = judged_beside(base, limit, added(base, base, [limit]))
    errors = replace(near.errors, chunks=10.0 * near.errors.chunks)
    off = replace(near, errors=errors)
    noise = {"force": 0.9 * float(base.residuals().std())}
    assert remaining([Round(base, chosen=near)], noise) == 0.0
    left = 1.0 - near.gain.value
    assert remaining([Round(base, chosen=off)], noise) == pytest.approx(left, abs=0.1)


def weighed_by(times, fitted, first, hypotheses):
    """Return the model fitted again, its output weighed so many times more."""
    heavier = replace(fitted.problem, sigma=fitted.problem.sigma / times)
    changed = replace(fitted, problem=heavier)
    return fitted_with(first, changed, hypotheses, {})


@pytest.mark.parametrize("times", [1.0, 7.0])
def test_what_is_left_is_the_same_however_outputs_are_weighed_on_the_way(times):
    base = driven(road)
    friction, drag = proposed(base, CoulombFriction()), proposed(base, QuadraticDrag())
    one = added(base, base, [friction])
    again = weighed_by(times, one, base, [friction])
    both = added(base, again, [friction, drag])
    rounds = [
        Round(base, chosen=judged_beside(base, friction, one)),
        Round(again, chosen=judged_beside(again, drag, both)),
    ]
    assert remaining(rounds[:1], {"force": 5.0}) > 0.2
    assert remaining(rounds, {"force": 5.0}) < 0.02


def test_beside_a_curve_the_nearest_law_with_a_name_is_told():
    base = driven(digressive)
    curve, limit = proposed(base, UnknownRelation()), proposed(base, SpeedLimit())
    judged = tuple(
        judged_beside(base, one, added(base, base, [one])) for one in (curve, limit)
    )
    told = nearest(Round(base, chosen=judged[0], judged=judged))
    assert "saturation comes nearest: it takes away" in told
    assert nearest(Round(base, chosen=judged[1], judged=judged)) == ""
    assert nearest(Round(base, chosen=judged[0], judged=judged[:1])) == ""
