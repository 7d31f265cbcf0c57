"""The leading law is tried elsewhere, from its own optimum and with its numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search.laws import other_places


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


def test_a_curve_that_leads_is_tried_nowhere_else(tried):
    curve = law("dish", 0.05, physics=CURVE)
    asked, _ = tried([curve], [proposed("vane", physics=CURVE)])
    assert asked == []
    assert tried([], [proposed("vane")]) == ([], [])
