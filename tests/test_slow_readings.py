"""A thermometer that lags, read so seldom that no step follows a lag of none.

A time of which hardly a number is told is there if the model does clearly worse without
it; and where the model alone has run away, if the law brings that back.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import BondGraph, C, FitSettings, Hold, R, Recording, Se, Sf, bind_to
from bondgraph.diagnosis.candidates import Candidate, propose_all
from bondgraph.diagnosis.search.trials import determined as module
from bondgraph.diagnosis.search.trials.determined import AT_ONCE, determined
from bondgraph.fitting.estimate import fit_model
from bondgraph.physics.dynamics import Lag
from bondgraph.simulation.solvers import RungeKutta4

STEP, COUNT, NOISE = 2.7, 210, 0.023
CAPACITY, LOSS, POWER, LATE = 1000.0, 1.3, 2.4, 100.0
SETTINGS = FitSettings(hold=Hold.ZERO, solver=RungeKutta4())


def blanket():
    graph = BondGraph("blanket", domain="thermal")
    graph.zero("blanket", Sf("heating"), C("capacity"))
    graph.one("leak", R("insulation"), Se("room"))
    graph.join("leak", "blanket")
    graph.parameter("capacity", CAPACITY, "J/K", std=0.0)
    graph.parameter("insulation", 1.0, "K/W", bounds=(0.01, 1000.0))
    graph.measure("temperature", effort="blanket")
    return graph.finish()


def heated():
    """Return what is read of a blanket from when its heating is switched on."""
    fine = 100
    warm = read = 0.0
    told = []
    for _ in range(COUNT):
        told.append(read)
        for _ in range(fine):
            warm += STEP / fine * (POWER - warm / LOSS) / CAPACITY
            read += STEP / fine * (warm - read) / LATE
    noise = NOISE * np.random.default_rng(5).normal(size=COUNT)
    channels = {
        "heating": (np.full(COUNT, POWER), "W"),
        "room": (np.zeros(COUNT), "K"),
        "temperature": (np.array(told) + noise, "K"),
    }
    run = Recording.from_arrays("run", STEP * np.arange(COUNT), channels)
    return bind_to(blanket(), run)


def with_lag(base, run):
    """Return the model with a lag of one stage in its reading, fitted."""
    law = next(h for h in propose_all(base, (Lag(),)) if h.place == "temperature")
    graph = law.apply(base.graph)
    start = {"insulation": 1.0, **law.starts[-1]}
    begun = graph.with_parameters(
        [replace(p, value=start.get(p.name, p.value)) for p in graph.parameters.members]
    )
    return Candidate(law, fit_model(begun, [run], SETTINGS), 1)


@pytest.mark.parametrize(
    ("stated", "kept"),
    [({}, True), ({"insulation": 1.0}, True), ({"insulation": 0.1}, False)],
    ids=["nothing ran away", "the lag brings it back", "it is as far with the lag"],
)
def test_a_lag_is_held_to_none_where_steps_can_follow(monkeypatch, stated, kept):
    run = heated()
    base = fit_model(blanket(), [run], SETTINGS)
    candidate = with_lag(base, run)
    assert candidate.fitted.values["lag_temperature"] == pytest.approx(LATE, rel=0.15)
    # As if hardly a number of it were told.
    unknown = SimpleNamespace(null=np.zeros((0, 2)), std=np.array([0.01, 1e9]))
    monkeypatch.setattr(module, "uncertainty", lambda *_: unknown)
    monkeypatch.setattr(module, "run_away", lambda _: stated)
    left, others = determined(base, [candidate])
    assert (left == [candidate]) == kept
    assert [one.reason for one in others] == ([] if kept else [AT_ONCE])
