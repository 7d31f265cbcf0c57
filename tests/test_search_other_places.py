"""The leading law is tried elsewhere, from its own optimum and with its numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import TF, BondGraph, R, Recording, Sf, bind_to
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.laws import other_places
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


@pytest.fixture
def tried(monkeypatch):
    """Return a function that says where the leading law was tried, and what stays."""
    monkeypatch.setattr(other_places, "has_vanished", lambda _: False)

    def tried(candidates, hypotheses, cost=0.1):
        asked = []

        def run(work, trials, what):
            asked.extend((t.hypothesis.place, t.starts[0].values) for t in trials)
            return [None] * len(trials)

        def fitted(trials, results):
            return [law(trial.hypothesis.place, cost) for trial in trials]

        bench = SimpleNamespace(base=None, run=run, candidates=fitted)
        found = other_places.at_other_places(bench, candidates, hypotheses, keep=0.75)
        return asked, [one.hypothesis.place for one in found]

    return tried


def test_it_begins_with_the_numbers_it_has_ended_with(tried):
    asked, places = tried([law("dish", 0.05)], [proposed("vane")])
    ((place, values),) = asked
    assert place == "vane"
    assert values == {"mass": 3.0, "gravity_dish": 7.0, "gravity_vane": 7.0}
    assert places == ["dish", "vane"]


def test_what_does_far_less_there_is_not_kept(tried):
    _, places = tried([law("dish", 0.05)], [proposed("vane")], cost=0.4)
    assert places == ["dish"]


def test_only_the_same_form_in_the_same_unit_is_tried(tried):
    others = [
        proposed("mast", unit="Pa"),
        proposed("mast", words="pushes at {}"),
        proposed("mast", physics="spring"),
    ]
    assert tried([law("dish", 0.05)], others) == ([], ["dish"])


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
    asked = []

    def run(work, trials, what):
        asked.extend(trials)
        return [{"refused": "asked only"}] * len(trials)

    bench = SimpleNamespace(base=base, run=run, candidates=lambda *_: [])
    assert at_other_places(bench, [curve], [], keep=0.75) == [curve]
    (trial,) = asked
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
    bench = SimpleNamespace(base=base)
    found = at_other_places(bench, [curve, named], [], keep=0.75)
    assert found == [curve, named]


def test_where_nothing_was_fitted_nothing_is_tried(tried):
    assert tried([], [proposed("vane")]) == ([], [])
