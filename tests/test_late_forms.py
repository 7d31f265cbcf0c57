"""Where a lag leads, a delay is tried that is as long: alone it looks like nothing."""

from types import SimpleNamespace

import pytest

from bondgraph.diagnosis.search.laws.late_forms import other_forms


def law(physics, place="encoder", name=None):
    own = name or f"{physics}_{place}"
    return SimpleNamespace(physics=physics, place=place, parameters=(own,))


def fitted(hypothesis, cost):
    values = {"mass": 3.0, hypothesis.parameters[0]: 0.02}
    ended = SimpleNamespace(
        values=values,
        optimum=SimpleNamespace(initial=None),
        problem=SimpleNamespace(solver=None),
    )
    return SimpleNamespace(hypothesis=hypothesis, cost=cost, fitted=ended)


LAG, TWICE, DELAY = law("lag"), law("lag", name="lag_each_encoder"), law("delay")
LIBRARY = (LAG, TWICE, DELAY, law("delay", "voltage"), law("slip", "belt"))


@pytest.mark.parametrize("slip", [1.5, 0.995], ids=["leads", "ties"])
def test_other_forms_begin_about_where_the_best_one_ended(slip):
    found = [fitted(law("slip", "belt"), slip), fitted(LAG, 1.0)]
    trials = other_forms(found, LIBRARY)
    assert [trial.hypothesis for trial in trials] == [TWICE, DELAY]
    for trial in trials:
        (own,) = trial.hypothesis.parameters
        assert [start.values[own] for start in trial.starts] == [0.01, 0.02, 0.04]
        assert all(start.values["mass"] == 3.0 for start in trial.starts)


def test_what_was_kept_is_not_tried_again():
    found = [fitted(LAG, 1.0), fitted(DELAY, 1.2), fitted(TWICE, 1.1)]
    assert other_forms(found, LIBRARY) == []


def test_nothing_is_tried_where_another_law_leads_or_none_is_late():
    slip = fitted(law("slip", "belt"), 0.9)
    assert other_forms([slip, fitted(LAG, 1.0)], LIBRARY) == []
    assert other_forms([slip], LIBRARY) == []
