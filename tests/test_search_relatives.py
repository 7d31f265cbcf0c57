"""A law that comes close to the best at its place is fitted from there as well."""

from types import SimpleNamespace

import numpy as np
import pytest
from physics_machines import MACHINES, scales_of

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search.laws import relatives
from bondgraph.physics.dynamics import Delay, Lag
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.everywhere import all_places


def law(physics, cost, place="dish", coupling=0.0, complexity=1):
    """Return a fitted law of one number, beside the model's own coupling."""
    own = f"{physics}_{place}"
    hypothesis = SimpleNamespace(
        physics=physics, place=place, parameters=(own,), strengths=(own,),
        contains=lambda other: False,
    )  # fmt: skip
    theta, names = np.array([coupling, 7.0]), ("coupling", own)
    fitted = SimpleNamespace(
        optimum=SimpleNamespace(theta=theta, initial=None, cost=cost),
        problem=SimpleNamespace(free_names=names, solver=None),
        values={},
        graph=SimpleNamespace(parameters={own: SimpleNamespace(unit="N")}),
    )
    return SimpleNamespace(
        hypothesis=hypothesis, fitted=fitted, cost=cost, complexity=complexity,
        reduction=lambda base: 1.0 - cost / base.optimum.cost,
    )  # fmt: skip


@pytest.fixture
def refitted(monkeypatch):
    """Return a function that says what was fitted again, and from which coupling."""
    monkeypatch.setattr(relatives, "begun_again", lambda _: [])

    def refitted(*laws):
        asked = []

        def run(work, trials, what):
            asked.extend(
                (t.hypothesis.physics, t.starts[0].values["coupling"]) for t in trials
            )
            return []

        base = SimpleNamespace(optimum=SimpleNamespace(cost=1.0))
        bench = SimpleNamespace(base=base, run=run, candidates=lambda *_: [])
        relatives.related(bench, list(laws), ())
        return asked

    return refitted


def test_a_close_rival_begins_again_in_the_valley_of_the_best(refitted):
    bends = law("hardening_spring", 0.058, coupling=0.024, complexity=4)
    weight = law("gravity", 0.064, coupling=0.0004)
    assert refitted(bends, weight) == [("gravity", 0.024)]


def test_what_is_far_behind_or_elsewhere_or_a_curve_does_not(refitted):
    best = law("hardening_spring", 0.058, coupling=0.024, complexity=4)
    assert refitted(best, law("gravity", 0.064, complexity=4)) == []
    assert refitted(best, law("spring", 0.31)) == []
    assert refitted(best, law("gravity", 0.064, place="vane")) == []
    assert refitted(best, law(CURVE, 0.064)) == []


def test_a_law_with_a_name_begins_again_where_a_curve_there_leads(refitted):
    curve = law(CURVE, 0.05, coupling=0.3)
    assert refitted(curve, law("gravity", 0.064)) == [("gravity", 0.3)]
    assert refitted(curve, law("gravity", 0.064, place="vane")) == []
    # Another law leads: that curve says nothing.
    ahead = law("spring", 0.01, place="vane", coupling=0.9)
    assert refitted(curve, law("gravity", 0.064), ahead) == []


@pytest.mark.parametrize(("leads", "late"), [(0, 0.04), (1, 0.08), (2, 0.04)])
def test_other_forms_of_what_comes_late_begin_as_late(leads, late, monkeypatch):
    graph, asked = MACHINES["dc_drive"], []
    places = all_places(graph, scales_of(graph))
    place = next(one for one in places if isinstance(one, InputPlace))
    laws = [law for late in (Lag(), Delay()) for law in late.propose(place)]
    names = [next(iter(law.starts[0])) for law in laws]
    assert [law.physics for law in laws] == ["lag", "lag", "delay"]
    fitted = SimpleNamespace(
        values={"friction": 0.3, names[leads]: 0.04},
        optimum=SimpleNamespace(initial=None),
        problem=SimpleNamespace(solver=None),
    )
    leading = SimpleNamespace(hypothesis=laws[leads], fitted=fitted, cost=0.1)
    bench = SimpleNamespace(
        run=lambda _, trials, __: asked.extend(trials), candidates=lambda *_: []
    )
    monkeypatch.setattr(relatives, "begun_again", lambda _: [])
    relatives.related(bench, [leading], laws)
    begun = {t.hypothesis.words: t.starts[0].values for t in asked}
    others = [i for i in range(3) if i != leads]
    assert [*begun] == [laws[i].words for i in others]
    for i, values in zip(others, begun.values(), strict=True):
        assert values["friction"] == 0.3
        assert values[names[i]] == pytest.approx(late / 2 if i == 1 else late)
