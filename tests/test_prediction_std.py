"""What a fit leaves open of its numbers moves what it predicts of other recordings."""

from dataclasses import replace

import numpy as np
import pytest
from rubbing_slider import slider

from bondgraph import BondGraph, C, Recording, Sf, bind_to
from bondgraph.fitting.certainty.prediction import prediction_std
from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FitSettings, fit_model


def pulled(graph, speed, noise=0.05):
    rng = np.random.default_rng(3)
    time = 0.01 * np.arange(len(speed))
    force = 2.0 * speed + noise * rng.normal(size=len(speed))
    channels = {"speed": (speed, "m/s"), "force": (force, "N")}
    return bind_to(graph, Recording.from_arrays("run", time, channels))


def test_a_slope_misses_by_its_own_error_times_what_it_multiplies():
    graph, speed = slider(), 0.1 * np.sin(0.05 * np.arange(600))
    fitted = fit_model(graph, [pulled(graph, speed)], FitSettings())
    std = float(uncertainty(fitted.problem, fitted.optimum).std[0])
    further = 30.0 * speed
    found = prediction_std(fitted, [pulled(graph, further)])
    assert found["force"] == pytest.approx(std * further.std(), rel=0.02)


def tank():
    g = BondGraph("tank", domain="hydraulic")
    g.zero("bottom", Sf("inflow"), C("capacity"))
    g.measure("pressure", effort="bottom", unit="Pa")
    g.parameter("capacity", 2.0, "m^3/Pa", bounds=(0.1, 100))
    return g.finish()


def filled(inflow):
    rng = np.random.default_rng(5)
    time = np.arange(len(inflow), dtype=float)
    level = np.cumsum(inflow) - inflow
    pressure = (7.0 + level) / 2.0 + 0.1 * rng.normal(size=len(inflow))
    channels = {"inflow": (inflow, "m^3/s"), "pressure": (pressure, "Pa")}
    return bind_to(tank(), Recording.from_arrays("run", time, channels))


def test_what_the_initial_state_takes_up_does_not_count():
    fitted = fit_model(tank(), [filled(np.full(200, 0.01))], FitSettings())
    nothing_flows = prediction_std(fitted, [filled(np.zeros(200))])
    # However large the capacity is, it begins where it is seen to.
    assert nothing_flows["pressure"] == pytest.approx(0.0, abs=1e-6)
    much_flows = prediction_std(fitted, [filled(np.full(200, 1.0))])
    assert much_flows["pressure"] > 0.1


def test_what_cannot_be_simulated_is_not_known():
    graph, speed = slider(), np.full(60, 0.2)
    fitted = fit_model(graph, [pulled(graph, speed)], FitSettings())
    broken = pulled(graph, speed)
    broken = replace(broken, inputs=np.full_like(broken.inputs, 1e300))
    assert not np.isfinite(prediction_std(fitted, [broken])["force"])
