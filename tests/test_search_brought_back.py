"""What ran away for want of a law is put back where that law has been fitted."""

from types import SimpleNamespace

import numpy as np

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search.laws.brought_back import brought_back

STATED = {"mass": 2.0, "damping": 100.0}


def fit(cost, physics="coulomb_friction", **values):
    """Return a law whose fit has ended at these values of the model's parameters."""
    names = tuple(STATED)
    problem = SimpleNamespace(
        model=SimpleNamespace(parameter_names=names),
        free=np.arange(len(names)),
        start=np.array(list(STATED.values())),
    )
    at = {**STATED, "dry": 3.0, **values}
    told = {name: SimpleNamespace(source=None) for name in names}
    fitted = SimpleNamespace(
        problem=problem,
        values=at,
        optimum=SimpleNamespace(cost=cost),
        graph=SimpleNamespace(parameters=told),
    )
    hypothesis = SimpleNamespace(
        physics=physics, place="cabin", strengths=("dry",), starts=({"dry": 1.0},),
        silent_starts=(), parameters=("dry",), memory=None,
    )  # fmt: skip
    return SimpleNamespace(hypothesis=hypothesis, fitted=fitted, cost=cost)


class Fits:
    """A bench whose fits end at what is given, and that remembers where they began."""

    def __init__(self, *costs):
        self.costs, self.begun = costs, []

    def run(self, work, trials, what):
        self.begun = [trial.starts[0].values for trial in trials]
        return list(self.costs[: len(trials)])

    def candidates(self, trials, results):
        pairs = zip(trials, results, strict=True)
        ended = ((trial, fit(cost)) for trial, cost in pairs)
        return [
            SimpleNamespace(hypothesis=t.hypothesis, fitted=e.fitted, cost=e.cost)
            for t, e in ended
        ]


def test_it_begins_where_the_fit_has_ended_with_what_ran_away_as_stated():
    bench = Fits(4.0)
    (better,) = brought_back(bench, [fit(10.0, mass=3.0, damping=2e4, dry=2.5)])
    assert bench.begun == [{"mass": 3.0, "damping": 100.0, "dry": 2.5}]
    assert better.cost == 4.0


def test_what_leaves_more_from_there_is_not_taken():
    away = fit(10.0, damping=2e4)
    assert brought_back(Fits(11.0), [away]) == [away]


def test_what_has_not_run_away_is_left_as_it_is():
    near, curve = fit(10.0, damping=250.0), fit(1.0, CURVE, damping=2e4)
    bench = Fits()
    assert brought_back(bench, [near, curve]) == [near, curve]
    assert bench.begun == []
