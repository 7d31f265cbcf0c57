"""Steps between samples: fine enough for what is told, and no finer."""

import numpy as np
import pytest
from scipy.signal import lfilter

from bondgraph import BondGraph, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.search.base.between_samples import finely_stepped
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.fine_steps import told_finely
from bondgraph.simulation.solvers import Hold, Sdirk2

STEP, RESISTANCE, INDUCTANCE, NOISE = 2.5e-3, 2.0, 1.2e-3, 3e-3


def winding():
    graph = BondGraph("winding", domain="electrical")
    graph.one("coil", Se("voltage"), R("resistance"), I("inductance"))
    graph.measure("current", flow="coil")
    graph.parameter("resistance", 2.1, "ohm", bounds=(0.1, 100))
    graph.parameter("inductance", 1e-3, "H", bounds=(1e-5, 1))
    return graph.finish()


@pytest.fixture(scope="module")
def recording():
    """Of a current that follows a held voltage within a fifth of a sample."""
    random = np.random.default_rng(5)
    time = STEP * np.arange(6000)
    voltage = 2.0 * sum(
        np.sin(rate * time + random.uniform(0, 6)) for rate in (3.0, 11.0, 31.0)
    )
    kept = np.exp(-STEP * RESISTANCE / INDUCTANCE)
    current = lfilter([0.0, (1.0 - kept) / RESISTANCE], [1.0, -kept], voltage)
    current += NOISE * random.standard_normal(time.size)
    channels = {"voltage": (voltage, "V"), "current": (current, "A")}
    return bind_to(winding(), Recording.from_arrays("run", time, channels))


def test_a_step_that_noise_excuses_does_not_bend_what_is_told(recording):
    settings = FitSettings(hold=Hold.ZERO, solver=Sdirk2())
    coarse = fit_model(winding(), [recording], settings)
    searched = finely_stepped(coarse, np.array([NOISE]))
    assert searched.values["inductance"] != pytest.approx(INDUCTANCE, rel=0.1)
    told = told_finely(searched)
    assert told.values["inductance"] == pytest.approx(INDUCTANCE, rel=0.03)
    assert told.values["resistance"] == pytest.approx(RESISTANCE, rel=0.001)
    assert told_finely(told) is told
