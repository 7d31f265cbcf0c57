"""What is explained where an input jumps may be what it did between two samples."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from handmade_diagnosis import cart_diagnosis

from bondgraph.diagnosis.answer.at_jumps import (
    LEFT,
    after_jumps,
    doubted_at_jumps,
    explained_at_jumps,
)
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.simulation.shots import Shots
from bondgraph.simulation.solvers import Hold

SAMPLES = 400
SQUARE = np.repeat([0.0, 1.0, -1.0, 1.0], SAMPLES // 4)
JUMPED = [SAMPLES // 4 * k + later for k in (1, 2, 3) for later in (0, 1)]


def shots(signal, edges=(0, SAMPLES)):
    time = 0.01 * np.arange(SAMPLES)
    return Shots(time, signal[:, None], np.zeros((SAMPLES, 1)), edges)


def model(residuals, signal=SQUARE, hold=Hold.FIRST):
    problem = SimpleNamespace(shots=shots(signal), hold=hold, sigma=np.ones(1))
    return SimpleNamespace(problem=problem, residuals=lambda: residuals[:, None])


def missed(at_jumps, elsewhere):
    """Return residuals with so much of their square at jumps, and elsewhere."""
    residuals = np.full(SAMPLES, np.sqrt(elsewhere / (SAMPLES - len(JUMPED))))
    residuals[JUMPED] = np.sqrt(at_jumps / len(JUMPED))
    return residuals


def found(before, after):
    return Round(
        before,
        chosen=SimpleNamespace(candidate=SimpleNamespace(fitted=after)),
    )


def test_jumps_are_found_but_for_where_a_window_begins():
    assert np.flatnonzero(after_jumps(shots(SQUARE))).tolist() == JUMPED
    cut = shots(SQUARE, (0, SAMPLES // 4, SAMPLES))
    assert np.flatnonzero(after_jumps(cut)).tolist() == JUMPED[2:]


def test_an_input_that_stands_still_never_jumps():
    assert not after_jumps(shots(np.ones(SAMPLES))).any()


@pytest.mark.parametrize(("at_jumps", "elsewhere"), [(9.0, 1.0), (1.0, 9.0)])
def test_the_share_explained_at_jumps(at_jumps, elsewhere):
    before, after = model(missed(at_jumps, elsewhere)), model(np.zeros(SAMPLES))
    assert explained_at_jumps(before, after) == pytest.approx(at_jumps / 10.0)


def test_inputs_that_are_held_or_always_jump_say_nothing():
    residuals, nothing = missed(9.0, 1.0), np.zeros(SAMPLES)
    held = (model(residuals, hold=Hold.ZERO), model(nothing, hold=Hold.ZERO))
    noise = np.random.default_rng(3).standard_normal(SAMPLES)
    lively = (model(residuals, noise), model(nothing, noise))
    assert explained_at_jumps(*held) == explained_at_jumps(*lively) == 0.0


def test_a_law_that_explains_jumps_alone_is_doubted_and_a_delay_is_not():
    finding = replace(cart_diagnosis().findings[0], probability=0.8)
    late = replace(finding, physics="delay")
    nothing = model(np.zeros(SAMPLES))
    jumps, all_over = model(missed(9.0, 1.0)), model(missed(1.0, 9.0))
    (doubted,) = doubted_at_jumps([finding], [found(jumps, nothing)])
    assert doubted.probability == pytest.approx(LEFT * 0.8)
    assert "was not recorded" in doubted.statement
    assert doubted_at_jumps([late], [found(jumps, nothing)]) == [late]
    assert doubted_at_jumps([finding], [found(all_over, nothing)]) == [finding]
    assert doubted_at_jumps([], []) == []
