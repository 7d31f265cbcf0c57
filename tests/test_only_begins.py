"""A law whose own state takes up a misread start explains nothing else."""

import numpy as np
import pytest
from rc_circuit import rc_circuit
from scipy.signal import lfilter

from bondgraph import FitSettings, Recording, bind_to
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.memory import ONLY_BEGINS, remembering
from bondgraph.diagnosis.search.trials.trying import Trial, fit_fully
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import fit_model
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.physics.dynamics import Lag
from bondgraph.physics.places.everywhere import all_places
from bondgraph.simulation.solvers import Hold

STEP, COUNT, SLOW, LATE, NOISE = 0.1, 400, 3.0, 0.6, 1e-3


def circuit():
    g = rc_circuit()
    g.measure("reading", effort="node")
    g.parameter("resistance", 2.0, "ohm", std=0.0)
    g.parameter("capacitance", 1.2, "F", bounds=(0.1, 10.0))
    return g.finish()


def follows(signal, time, first):
    """Return what follows a held signal with a time constant."""
    kept = np.exp(-STEP / time)
    told, _ = lfilter([0.0, 1.0 - kept], [1.0, -kept], signal, zi=[kept * first])
    told[0] = first
    return told


def lag_tried(voltage, reading):
    """Return the base model, a lag of the reading fitted beside it, and the runs."""
    random = np.random.default_rng(3)
    read = reading + NOISE * random.standard_normal(COUNT)
    channels = {"voltage": (voltage, "V"), "reading": (read, "V")}
    run = Recording.from_arrays("run", STEP * np.arange(COUNT), channels)
    runs = [bind_to(circuit(), run)]
    settings = FitSettings(hold=Hold.ZERO, horizon=WholeRecordings())
    base = fit_model(circuit(), runs, settings)
    (place,) = (
        one
        for one in all_places(base.graph, measure_scales(base))
        if one.name == "reading"
    )
    law = next(iter(Lag().propose(place)))
    with workshop(Here(), Journal(None), lambda _: None) as shop:
        bench = Bench.of(base, shop, "test")
        trial = Trial(law)
        (found,) = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    return base, found, runs


def test_a_misread_start_is_no_lag():
    decay = np.exp(-STEP * np.arange(COUNT) / SLOW)
    decay[0] -= 0.1
    base, lag, runs = lag_tried(np.zeros(COUNT), decay)
    assert lag.cost < 0.9 * base.optimum.cost
    kept, (rejected,) = remembering(base, [lag], runs)
    assert not kept
    assert rejected.reason == ONLY_BEGINS


@pytest.mark.parametrize("first", [0.0, 0.5])
def test_a_lag_of_a_driven_machine_stays(first):
    random = np.random.default_rng(4)
    voltage = np.repeat(random.uniform(-1.0, 1.0, COUNT // 20), 20)
    there = follows(voltage, SLOW, first)
    base, lag, runs = lag_tried(voltage, follows(there, LATE, first))
    assert lag.cost < 0.2 * base.optimum.cost
    kept, rejected = remembering(base, [lag], runs)
    assert kept == [lag]
    assert not rejected
