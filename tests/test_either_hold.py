"""How inputs go on between samples: what is read well says, not what is read badly."""

import numpy as np
from rc_circuit import rc_circuit
from scipy.signal import lfilter

from bondgraph import FitSettings, Recording, bind_to, effort
from bondgraph.fitting.either_hold import simulated_either_way
from bondgraph.simulation.solvers import Hold

STEP, COUNT, TIME_CONSTANT = 0.1, 1500, 0.4


def circuit():
    g = rc_circuit()
    g.measure("fine", effort="node")
    g.measure("coarse", effort("node"), unit="V")
    g.parameter("resistance", 2.0, "ohm", std=0.0)
    g.parameter("capacitance", TIME_CONSTANT / 2.0, "F", std=0.0)
    return g.finish()


def test_a_noisy_reading_does_not_hide_that_an_input_is_held():
    random = np.random.default_rng(2)
    time = STEP * np.arange(COUNT)
    voltage = np.sin(time) + np.sin(0.37 * time + 1.0)
    kept = np.exp(-STEP / TIME_CONSTANT)
    true = lfilter([0.0, 1.0 - kept], [1.0, -kept], voltage)
    noise = random.standard_normal((2, COUNT))
    channels = {
        "voltage": (voltage, "V"),
        "fine": (true + 0.01 * noise[0], "V"),
        "coarse": (true + 2.0 * noise[1], "V"),
    }
    bound = bind_to(circuit(), Recording.from_arrays("run", time, channels))
    solution, hold = simulated_either_way(circuit(), bound, FitSettings())
    assert hold is Hold.ZERO
    assert solution.score.rmse["fine"] < 0.015
