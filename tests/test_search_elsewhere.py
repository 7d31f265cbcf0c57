"""Fits of laws with several numbers, begun again elsewhere."""

import numpy as np
import pytest
from test_search_vanished import SWING, bench, fitted, proposed

from bondgraph.diagnosis.search.laws.elsewhere import begun_elsewhere
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.modes import FlexibleMode

__all__ = ["bench"]
RATE, INERTIA = "mode_frequency_trolley", "mode_inertia_trolley"


@pytest.fixture(scope="module")
def wrong(bench):
    """A swinging load in another minimum: far too slow, and too light."""
    slow_and_light = {RATE: 0.05 * SWING, INERTIA: 40.0}
    return fitted(bench, proposed(bench, FlexibleMode()), **slow_and_light)


def test_a_law_in_a_wrong_minimum_is_found_from_elsewhere(bench, wrong):
    assert wrong.fitted.values[RATE] < 0.1 * SWING
    (found,) = begun_elsewhere(bench, [wrong], np.array([1e-4]))
    assert found.fitted.values[RATE] == pytest.approx(SWING, rel=0.01)
    assert found.cost < 0.1 * wrong.cost


def test_what_leaves_no_more_than_noise_is_not_begun_again(bench, wrong):
    left = np.sqrt(np.mean(wrong.fitted.residuals() ** 2))
    assert begun_elsewhere(bench, [wrong], np.array([left])) == [wrong]


def test_a_law_of_one_number_is_not_begun_again(bench):
    drag = fitted(bench, proposed(bench, QuadraticDrag()))
    assert begun_elsewhere(bench, [drag], np.array([1e-4])) == [drag]
