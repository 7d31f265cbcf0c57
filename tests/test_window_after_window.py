"""Windows in which friction began on the wrong side go on where the last one ended."""

import numpy as np
import pytest
import sympy
from carts import recorded

from bondgraph import BondGraph, FitSettings, I, R, Se, Windows, f
from bondgraph.fitting.estimate import fit_model
from bondgraph.fitting.window_after_window import follows
from bondgraph.simulation.shooting import Shots

SLIP = 1.5e-4
"""m/s: ten thousand times less than the cart goes, as a diagnosis writes friction."""


def cart(coulomb):
    size, b = sympy.symbols("coulomb b")
    graph = BondGraph("cart", domain="translation")
    law = size * sympy.tanh(f / SLIP) + b * f
    graph.one("wheel", Se("force"), I("mass"), R("friction", law=law))
    graph.measure("position", displacement="wheel")
    graph.parameter("mass", 1.3, "kg", bounds=(0.01, 100))
    graph.parameter("b", 2.0, "N*s/m", bounds=(0, 100))
    graph.parameter("coulomb", coulomb, "N", bounds=(0, 100))
    return graph.finish()


@pytest.mark.parametrize("start", [0.5, 1.0, 2.0])
def test_sharp_friction_is_fitted_to_the_noise(start):
    settings = FitSettings(horizon=Windows(50))
    fitted = fit_model(cart(start), [recorded(1, coulomb=1.0)], settings)
    _, b, coulomb = fitted.optimum.theta
    assert coulomb == pytest.approx(1.0, rel=0.01)
    assert b == pytest.approx(2.0, rel=0.02)
    assert fitted.problem.sigma[0] == pytest.approx(2e-4, rel=0.1)


def test_no_window_goes_on_where_another_recording_ended():
    time = np.concatenate([0.1 * np.arange(30), 0.1 * np.arange(20)])
    shots = Shots(time, np.zeros((50, 0)), np.zeros((50, 1)), (0, 10, 20, 30, 40, 50))
    assert follows(shots).tolist() == [False, True, True, False, True]
