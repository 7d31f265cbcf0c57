"""The leading law is tried elsewhere, from its own optimum and with its numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import TF, BondGraph, R, Recording, Sf, bind_to
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.laws import beside_the_lead
from bondgraph.diagnosis.search.laws.beside_the_lead import with_fitted
from bondgraph.diagnosis.search.laws.other_places import at_other_places
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.unknown import UnknownRelation


def law(place, cost, physics="gravity"):
    """Return a law of one number that was fitted beside the model's own mass."""
    own = f"{physics}_{place}"
    fitted = SimpleNamespace(
        values={"mass": 3.0, own: 7.0},
        optimum=SimpleNamespace(initial=np.zeros(1)),
        problem=SimpleNamespace(solver=None),
        graph=SimpleNamespace(parameters={own: SimpleNamespace(unit="N")}),
    )
    hypothesis = SimpleNamespace(
        physics=physics, place=place, parameters=(own,), words=f"pulls at {place}"
    )
    return SimpleNamespace(
        hypothesis=hypothesis, fitted=fitted, cost=cost, reduction=lambda _: 1.0 - cost
    )


def proposed(place, unit="N", words="pulls at {}", physics="gravity"):
    """Return a law that was proposed and not kept."""
    own = f"{physics}_{place}"
    edit = SimpleNamespace(parameters=(SimpleNamespace(name=own, unit=unit),))
    return SimpleNamespace(
        physics=physics, place=place, parameters=(own,), edit=edit,
        words=words.format(place),
        is_elsewhere=lambda other: other.physics == physics and other.place != place,
    )  # fmt: skip


def tried(candidates, hypotheses):
    """Return where the leading law is to be tried, and with which values."""
    trials = at_other_places(None, candidates, hypotheses)
    return [(trial.hypothesis.place, trial.starts[0].values) for trial in trials]


def test_it_begins_with_the_numbers_it_has_ended_with():
    ((place, values),) = tried([law("dish", 0.05)], [proposed("vane")])
    assert place == "vane"
    assert values == {"mass": 3.0, "gravity_dish": 7.0, "gravity_vane": 7.0}


def test_only_the_same_form_in_the_same_unit_is_tried():
    others = [
        proposed("mast", unit="Pa"),
        proposed("mast", words="pushes at {}"),
        proposed("mast", physics="spring"),
    ]
    assert tried([law("dish", 0.05)], others) == []


@pytest.mark.parametrize(
    ("cost", "vanished", "kept"),
    [(0.1, False, True), (0.4, False, False), (0.1, True, False)],
)
def test_what_does_far_less_or_has_vanished_is_not_kept(
    monkeypatch, cost, vanished, kept
):
    monkeypatch.setattr(beside_the_lead, "has_vanished", lambda _: vanished)
    leading, there = law("dish", 0.05), law("vane", cost)
    bench = SimpleNamespace(
        base=None, run=lambda *_: [None], candidates=lambda *_: [there]
    )
    found = with_fitted(bench, [leading], ["a trial"], "the same elsewhere", keep=0.75)
    assert found == [leading, *([there] if kept else [])]
    assert with_fitted(None, [leading], [], "nothing", keep=0.75) == [leading]


def test_of_a_law_that_was_kept_the_better_fit_is(monkeypatch):
    monkeypatch.setattr(beside_the_lead, "has_vanished", lambda _: False)
    leading, known = law("dish", 0.05), law("vane", 0.2)
    for cost, better in ((0.1, True), (0.22, False)):
        again = law("vane", cost)
        again.hypothesis = known.hypothesis
        bench = SimpleNamespace(
            base=None, run=lambda *_: [None], candidates=lambda *_, one=again: [one]
        )
        found = with_fitted(bench, [leading, known], ["a trial"], "again", keep=0.75)
        assert found == [leading, again if better else known]


def geared():
    """Return a load that is driven through a gear; the torque at the motor is read."""
    g = BondGraph("geared", domain="rotation")
    g.one("motor", Sf("speed"), R("bearing"))
    g.one("load", R("drag"))
    g.join("motor", TF("ratio"), "load")
    g.measure("torque", effort="speed", unit="N*m")
    g.parameter("ratio", 5.0, std=0.0)
    g.parameter("bearing", 1.0, "N*m*s/rad", bounds=(0, 100))
    g.parameter("drag", 1.0, "N*m*s/rad", bounds=(0, 100))
    return g.finish()


@pytest.fixture(scope="module")
def base():
    time = 0.01 * np.arange(800)
    speed = 10.0 * np.sin(1.3 * time)
    channels = {"speed": (speed, "rad/s"), "torque": (1.04 * speed, "N*m")}
    run = bind_to(geared(), Recording.from_arrays("run", time, channels))
    return fit_model(geared(), [run], FitSettings())


def curve_at_motor(base):
    """Return a curve at the motor that its fit has bent, and the law itself."""
    places = all_places(base.graph, measure_scales(base))
    motor = next(place for place in places if place.name == "motor")
    law = next(one for one in UnknownRelation().propose(motor) if one.visited)
    bent = {name: 0.1 * i**2 for i, name in enumerate(law.strengths)}
    return Candidate(law, fitted_with(base, base, [law], bent), len(bent))


def test_a_curve_that_leads_takes_its_line_along(base):
    curve = curve_at_motor(base)
    (trial,) = at_other_places(base, [curve], [])
    assert trial.hypothesis.place == "load"
    # Where the speed is a fifth, the torque is five times as large.
    heights = [trial.starts[0].values[name] for name in trial.hypothesis.strengths]
    known = [curve.fitted.values[name] for name in curve.hypothesis.strengths]
    np.testing.assert_allclose(heights, 5.0 * np.array(known), rtol=0.02, atol=0.1)


def test_a_curve_that_a_named_law_comes_near_is_tried_nowhere_else(base):
    curve = curve_at_motor(base)
    named = SimpleNamespace(
        hypothesis=SimpleNamespace(physics="gravity", is_slip=False),
        cost=1.1 * curve.cost,
    )
    assert at_other_places(base, [curve, named], []) == []


def test_where_nothing_was_fitted_nothing_is_tried():
    assert tried([], [proposed("vane")]) == []
