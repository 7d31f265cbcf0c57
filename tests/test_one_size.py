"""One size: recordings whose steps are all alike do not tell what bends from a lag."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to
from bondgraph.diagnosis.answer import one_size
from bondgraph.diagnosis.answer.one_size import (
    AS_WELL,
    BESIDE,
    LEFT,
    all_alike,
    bends,
    doubted_in_one_size,
    passes_once,
)
from bondgraph.diagnosis.candidates import CURVE, Candidate, propose_all
from bondgraph.diagnosis.records import Finding
from bondgraph.diagnosis.search.trials.trying import Start, Trial, restored
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.library import LIBRARY
from bondgraph.simulation.shots import Shots

TIME = np.arange(800.0)
SQUARE = np.where(TIME % 400 < 200, 1.0, 0.0)
SIZES = np.select([TIME < 200, TIME < 400, TIME < 600], [1.0, 0.0, 0.4], 0.0)
RAMP = TIME / 800.0
CONSTANT = np.ones(TIME.size)


def heated(heat):
    """A block that is heated and loses heat, fitted to what it does."""
    g = BondGraph("block", domain="thermal")
    g.zero("block", Sf("heater"), C("capacity"), R("loss"))
    g.measure("temperature", effort="block")
    g.parameter("capacity", 20.0, "J/K", bounds=(1, 100))
    g.parameter("loss", 1.0, "K/W", bounds=(0.1, 100))
    answer, own = np.zeros(TIME.size), 0.0
    for k, now in enumerate(heat):
        answer[k] = own
        own += (now - own) / 20.0
    noise = 0.003 * np.random.default_rng(1).standard_normal(TIME.size)
    channels = {"heater": (heat, "W"), "temperature": (answer + noise, "K")}
    run = Recording.from_arrays("run", TIME, channels)
    return fit_model(g.finish(), [bind_to(g.finish(), run)], FitSettings())


def proposed(base, words):
    """The candidate that the library proposes in these words, as it begins."""
    law = next(h for h in propose_all(base, LIBRARY) if words in h.words)
    values = {**base.values, **law.starts[-1]}
    return Candidate(law, restored(base, Trial(law, (Start(values),))), 1)


@pytest.mark.parametrize(
    ("heat", "alike"),
    [(SQUARE, True), (CONSTANT, True), (SIZES, False), (RAMP, False)],
)
def test_steps_of_one_size_are_alike_and_of_two_are_not(heat, alike):
    assert all_alike(heated(heat)) == alike


def test_a_decay_with_a_hole_in_it_is_one():
    fitted = heated(CONSTANT)
    whole = fitted.problem.shots
    kept = (TIME < 15.0) | (TIME >= 30.0)
    shots = Shots(
        TIME[kept], whole.inputs[kept], whole.outputs[kept], (0, int(kept.sum()))
    )
    holed = SimpleNamespace(
        problem=SimpleNamespace(shots=shots), residuals=lambda: fitted.residuals()[kept]
    )
    assert all_alike(holed)


def test_what_swings_as_it_decays_goes_through_all_sizes():
    fitted = heated(CONSTANT)
    swing = np.exp(-TIME / 200.0) * np.cos(TIME / 10.0)
    shots = replace(fitted.problem.shots, outputs=swing[:, None])
    still = SimpleNamespace(
        problem=SimpleNamespace(shots=shots), residuals=lambda: np.zeros((800, 1))
    )
    assert not all_alike(still)


def test_a_bent_store_bends_and_a_lag_does_not():
    base = heated(SQUARE)
    assert bends(proposed(base, "temperature reads what is there along a bent curve"))
    assert bends(proposed(base, "holds along an unnamed curve"))
    assert not bends(proposed(base, "temperature reads with a lag"))


def test_a_curve_along_what_comes_back_is_none_of_time():
    assert not passes_once(proposed(heated(SQUARE), "holds along an unnamed curve"))
    assert passes_once(proposed(heated(CONSTANT), "holds along an unnamed curve"))


def finding(physics):
    return Finding(
        physics=physics, place="temperature", element="", statement="It was left out.",
        law="", indistinguishable_places=(), alternatives=(), estimates=(),
        in_proportion=(), probability=0.8, domain="thermal",
    )  # fmt: skip


def found(candidate):
    chosen = SimpleNamespace(candidate=candidate)
    return SimpleNamespace(chosen=chosen, removed=())


@pytest.mark.parametrize(("heat", "left"), [(SQUARE, LEFT), (SIZES, 1.0)])
def test_what_bends_is_half_as_sure_and_what_is_found_beside_it(heat, left):
    base = heated(heat)
    bent = proposed(base, "temperature reads what is there along a bent curve")
    late = proposed(base, "temperature reads with a lag")
    findings = [finding("sensor_nonlinearity"), finding("lag")]
    first, second = doubted_in_one_size(findings, [found(bent), found(late)])
    assert first.probability == second.probability == pytest.approx(0.8 * left)
    assert (AS_WELL in first.statement) == (left < 1.0)
    assert (BESIDE in second.statement) == (left < 1.0)


def test_beside_a_curve_of_time_what_steps_of_many_sizes_tell_is_believed(monkeypatch):
    base = heated(SIZES)
    curve = proposed(base, "holds along an unnamed curve")
    late = proposed(base, "temperature reads with a lag")
    monkeypatch.setattr(one_size, "passes_once", lambda one: one is curve)
    findings = [finding(CURVE), finding("lag")]
    first, second = doubted_in_one_size(findings, [found(curve), found(late)])
    assert first.probability == pytest.approx(0.8 * LEFT)
    assert second == findings[1]


def test_a_lag_alone_is_as_sure_as_before():
    late = proposed(heated(SQUARE), "temperature reads with a lag")
    assert doubted_in_one_size([finding("lag")], [found(late)]) == [finding("lag")]


def test_what_models_of_a_domain_leave_out_most_is_believed():
    base = heated(SQUARE)
    bent = proposed(base, "heat lost with the fourth power")
    (told,) = doubted_in_one_size([finding("radiation")], [found(bent)])
    assert told.probability == 0.8
