"""Sizes of signals: one that cannot be told is left out and takes none along."""

import numpy as np

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to
from bondgraph.diagnosis import probing
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.simulation.shooting import Shots
from bondgraph.structure.signals import effort, flow


def vessel():
    g = BondGraph("vessel", domain="hydraulic")
    g.zero("vessel", Sf("inflow"), C("volume"), R("outlet"))
    g.measure("pressure", effort="vessel")
    g.parameter("volume", 2.0, "m^3/Pa")
    g.parameter("outlet", 3.0, "Pa*s/m^3")
    return g.finish()


def test_a_signal_that_cannot_be_told_takes_no_other_with_it(monkeypatch):
    time = 0.1 * np.arange(60)
    channels = {"inflow": (1.0 + np.sin(time), "m^3/s"), "pressure": (time, "Pa")}
    graph = vessel()
    run = bind_to(graph, Recording.from_arrays("run", time, channels))
    fitted = fit_model(graph, [run], FitSettings(iterations=1))
    together = probing._probed_together
    untold = flow("outlet")

    def lost(fitted, signals):
        found = together(fitted, signals)
        return {s: x * np.nan if untold in signals else x for s, x in found.items()}

    monkeypatch.setattr(probing, "_probed_together", lost)
    found = probing.probe(fitted, [effort("vessel"), untold, flow("volume")])
    told = [bool(np.isfinite(x).all()) for x in found.values()]
    assert told == [True, False, True]
    monkeypatch.setattr(
        probing, "_probed_together", lambda _, s: dict.fromkeys(s, time * np.nan)
    )
    assert probing.measure_scales(fitted).sizes["flow(vessel)"] == 0.0


def test_what_a_stiff_state_begins_at_is_no_size_of_a_signal():
    usual = np.sin(np.arange(1000.0))
    begun = np.array([-8e3, 900.0, *usual])
    told = probing._without_strays(begun)
    assert np.isnan(told[:2]).all()
    np.testing.assert_array_equal(told[2:], usual)
    hit = np.array([20.0, *usual])
    np.testing.assert_array_equal(probing._without_strays(hit), hit)
    for nothing in (np.zeros(5), np.full(5, np.nan)):
        np.testing.assert_array_equal(probing._without_strays(nothing), nothing)


def test_nor_what_it_is_until_it_is_where_it_belongs():
    usual = 2.0 + np.sin(np.arange(500.0))
    window = np.array([-8.0e3, 80.0, -5.0, *usual, 40.0])
    mild = np.array([5.0, *usual])
    values = np.concatenate([window, mild])
    edges = (0, len(window), len(values))
    nothing = np.zeros((len(values), 0))
    shots = Shots(np.arange(float(len(values))), nothing, nothing, edges)
    told = probing._once_begun(values, shots)
    assert np.isnan(told[:3]).all()
    np.testing.assert_array_equal(told[3:], values[3:])
    for untold in (np.zeros(len(values)), np.full(len(values), np.nan)):
        np.testing.assert_array_equal(probing._once_begun(untold, shots), untold)
