"""A curve with corners is drawn with corners, one that is round stays round."""

import numpy as np
import pytest
from bellows import curve_over, searched

from bondgraph.diagnosis.drawn_laws import law_curve
from bondgraph.diagnosis.search.laws import corners
from bondgraph.diagnosis.search.laws.corners import with_corners
from bondgraph.diagnosis.search.laws.drawing import (
    Drawing,
    bends_in,
    drawn_finely,
    lines_in,
)
from bondgraph.diagnosis.search.trials.trying import Start
from bondgraph.physics.smooth import Smooth

CHUNKS = 24
ROUGHNESS = 10.0


def with_a_plateau(out):
    """Return the force of a spring that gives nothing more over a part of its way."""
    return np.interp(out, (-0.1, -0.01, 0.02, 0.11), (-9.0, 0.0, 0.0, 9.0))


def going_round(out):
    """Return the force of a spring that gives way as a wave, without a corner."""
    return 100.0 * out + 1.5 * np.sin(60.0 * out)


def drawn_smooth(bench):
    """Return the curve of the displacement with few knots, and drawn finely."""
    found = curve_over(bench)
    heights = tuple(found.fitted.values[name] for name in found.hypothesis.strengths)
    smooth = Smooth(heights, 8, ROUGHNESS)
    begin = Start.where_ended(found.fitted)
    fine = drawn_finely(bench, found.hypothesis, smooth, begin)
    return Drawing(found, CHUNKS), Drawing(fine, CHUNKS, smooth)


def distance(drawing, force_of):
    """Return how far a curve is from what the bellows give beside their own spring.

    Their speed is recorded alone: where they are, and a line, are left to the model.
    """
    x, y = law_curve(drawing.candidate.fitted, drawing.candidate, "displacement")

    def left(shift):
        beside = force_of(x + shift) - y
        return np.std(beside - np.polynomial.Polynomial.fit(x, beside, 1)(x))

    return min(map(left, np.linspace(-0.02, 0.02, 81)))


def test_a_curve_with_corners_is_drawn_with_them():
    with searched(with_a_plateau) as bench:
        first, smooth = drawn_smooth(bench)
        cornered = with_corners(bench, first, smooth)
    assert cornered.typical < smooth.typical
    assert cornered.candidate.cost < 0.8 * smooth.candidate.cost
    assert distance(cornered, with_a_plateau) < distance(smooth, with_a_plateau)
    sizes = np.array([size for _, size in cornered.smooth.corners])
    assert np.mean(sizes < 0.1) > 0.5


def test_a_curve_without_corners_is_drawn_no_worse():
    with searched(going_round) as bench:
        first, smooth = drawn_smooth(bench)
        drawn = with_corners(bench, first, smooth)
    assert distance(drawn, going_round) <= 1.1 * distance(smooth, going_round)


def test_few_knots_have_no_bends_of_their_own():
    with searched(with_a_plateau) as bench:
        first, smooth = drawn_smooth(bench)
        assert with_corners(bench, first, first) is first
    assert not bends_in(first.candidate.hypothesis.strengths)
    named = bends_in(smooth.candidate.hypothesis.strengths)
    assert [*named.values()] == [f"bend_{i}" for i in range(1, len(named) + 1)]


@pytest.mark.parametrize("first", [(), ("curve_level_bend", "curve_slope_bend")])
def test_bends_are_known_by_name_with_lines_and_without(first):
    bends = {f"curve_bend_{i}_bend": f"bend_{i}" for i in (1, 2, 12)}
    assert bends_in((*first, *bends)) == bends
    assert [*lines_in((*first, *bends))] == sorted(first, reverse=True)


@pytest.mark.parametrize("better", ["typical", "in_one"])
def test_corners_have_to_predict_all_that_is_left_out(better, monkeypatch):
    with searched(with_a_plateau) as bench:
        first, smooth = drawn_smooth(bench)

        class Worse(Drawing):
            def __init__(self, *given):
                super().__init__(*given)
                setattr(self, better, 10.0 + getattr(self, better))

        monkeypatch.setattr(corners, "Drawing", Worse)
        assert with_corners(bench, first, smooth) is smooth
