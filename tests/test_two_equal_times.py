"""Air that comes late, taken for a slow sensor: two equal times, of which none is none.

Two lags in a row come nearest to a delay where both are the same. There only their sum
shows, to first order, so a covariance says that nothing is known of either.
"""

import numpy as np
import pytest

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to, effort
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.determined import AT_ONCE, determined
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.physics.dynamics import Lag
from bondgraph.physics.places.everywhere import all_places
from bondgraph.simulation.solvers import Hold

STEP, COUNT, TIME, NOISE = 1.0, 1200, 12.0, 0.02
LATE = 20
"""Samples."""


def block(known=None):
    g = BondGraph("a block in a stream of air", domain="thermal")
    g.zero("block", Sf("heater"), C("capacity"), R("carried_off"))
    g.measure("warmer", effort("block"))
    std = None if known is None else 0.0
    g.parameter("capacity", known or 20.0, "J/K", std=std, bounds=(1.0, 1e4))
    g.parameter("carried_off", 1.0, "K/W", std=0.0)
    return g.finish()


def heated(model, late):
    """Return the recording of air that comes `late` samples late."""
    random = np.random.default_rng(5)
    heat = np.repeat(random.uniform(0.0, 40.0, COUNT // 40), 40)
    warm, told = 0.0, np.zeros(COUNT)
    for k in range(COUNT):
        told[k] = warm
        fade = np.exp(-STEP / TIME)
        warm = fade * warm + (1.0 - fade) * heat[k - late] * (k >= late)
    told += NOISE * random.standard_normal(COUNT)
    channels = {"heater": (heat, "W"), "warmer": (told, "K")}
    time = STEP * np.arange(COUNT)
    return bind_to(model, Recording.from_arrays("block", time, channels))


def said_of_a_lag(model, late):
    """Return the fit with a lag of the reading, and why it is left aside, if it is."""
    settings = FitSettings(horizon=WholeRecordings(), hold=Hold.ZERO)
    base = fit_model(model, [heated(model, late)], settings)
    places = all_places(base.graph, measure_scales(base))
    (reading,) = (place for place in places if place.name == "warmer")
    lag, _ = Lag().propose(reading)
    with workshop(Here(), Journal(), lambda _: None) as shop:
        bench = Bench.of(base, shop, "test")
        trial = Trial(lag, (Start(lag.starts[-1]),))
        found = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    _, aside = determined(base, found)
    return found[0].fitted, aside[0].reason if aside else None


def test_neither_of_two_equal_times_is_none():
    fitted, aside = said_of_a_lag(block(), LATE)
    assert fitted.values["lag_warmer"] == pytest.approx(
        fitted.values["capacity"], rel=0.01
    )
    told = uncertainty(fitted.problem, fitted.optimum)
    own = list(fitted.problem.free_names).index("lag_warmer")
    alone = np.abs(told.null[:, own]).max(initial=0.0) < 1e-3
    assert not (alone and told.std[own] <= fitted.values["lag_warmer"])
    assert aside is None


def test_a_time_that_is_not_there_is_left_aside():
    fitted, aside = said_of_a_lag(block(known=TIME), 0)
    assert fitted.values["lag_warmer"] < 0.1
    assert aside == AT_ONCE
