"""A law that bends an input by less than its last digit may be that rounding."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy
from handmade_diagnosis import cart_diagnosis

from bondgraph import BondGraph, C, FitSettings, Recording, Sf, bind_to
from bondgraph.diagnosis.answer.rounded_inputs import (
    LEFT,
    covering_step,
    doubted_within_rounding,
)
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.estimate import fit_model
from bondgraph.simulation.solvers import Hold
from bondgraph.structure.edits import WrapInput
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import flow, parameter_symbol

CURRENT = np.repeat(np.random.default_rng(2).uniform(-20, 20, 40), 10)


def store():
    graph = BondGraph("store", domain="electrical")
    graph.zero("cells", Sf("current"), C("capacity"))
    graph.measure("voltage", effort="cells")
    graph.parameter("capacity", 50.0, "F", bounds=(1.0, 1e3))
    return graph.finish()


def round_with(width, decimals):
    """Return a round that found a dead zone, of an input with so many decimals."""
    graph = store()
    given = np.round(CURRENT, decimals)
    voltage = np.concatenate([[0.0], np.cumsum(0.1 * CURRENT / 50.0)[:-1]])
    channels = {"current": (given, "A"), "voltage": (voltage, "V")}
    time = 0.1 * np.arange(CURRENT.size)
    recording = bind_to(graph, Recording.from_arrays("run", time, channels))
    fitted = fit_model(graph, [recording], FitSettings(hold=Hold.ZERO))
    size = Parameter(name="width", value=width, unit="A", std=0.0)
    read, half = flow("current"), parameter_symbol("width")
    law = sympy.Max(read - half, 0) + sympy.Min(read + half, 0)
    edit = WrapInput("current", law, "applied", (size,))
    wide = fit_model(edit.apply(graph), [recording], FitSettings(hold=Hold.ZERO))
    candidate = SimpleNamespace(fitted=wide, hypothesis=SimpleNamespace(edit=edit))
    return Round(fitted, chosen=SimpleNamespace(candidate=candidate))


@pytest.mark.parametrize(
    ("width", "decimals", "step"), [(0.05, 1, 0.1), (0.5, 1, None), (0.05, 0, None)]
)
def test_a_law_within_the_last_digit_is_seen(width, decimals, step):
    # A command in whole amperes is taken for what was commanded, not for rounded.
    assert covering_step(round_with(width, decimals)) == (
        None if step is None else pytest.approx(step)
    )


def test_what_lies_within_the_rounding_is_less_probable():
    finding = replace(cart_diagnosis().findings[0], probability=0.8)
    within, beyond = round_with(0.05, 1), round_with(0.5, 1)
    told, other = doubted_within_rounding([finding, finding], [within, beyond])
    assert told.probability == pytest.approx(LEFT * 0.8)
    assert "more digits" in told.statement
    assert other is finding
