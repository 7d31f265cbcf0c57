"""A curve that takes its machine farther than its knots is drawn as far as it goes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bellows import curve_over, searched

from bondgraph.diagnosis.drawn_laws import law_curve
from bondgraph.diagnosis.search.laws import own_range
from bondgraph.diagnosis.search.laws.drawing import drawn_finely, is_fine
from bondgraph.diagnosis.search.laws.own_range import over_its_own_range
from bondgraph.diagnosis.search.trials.trying import Start
from bondgraph.physics.smooth import Smooth
from bondgraph.structure.signals import f


@pytest.fixture
def bench():
    """Return what bellows that give way are searched on."""
    with searched(lambda out: 6.0 * np.tanh(out / 0.05)) as bench:
        yield bench


def test_a_curve_that_gives_way_is_drawn_as_far_as_it_goes(bench):
    found = curve_over(bench)
    anew = over_its_own_range(bench, found)
    (low, high), (down, up) = found.hypothesis.visited, anew.hypothesis.visited
    assert down < low - 0.1 * (high - low)
    assert up > high
    x, _ = law_curve(anew.fitted, anew, "displacement")
    assert down <= x.min() + 0.1 * (up - down)
    assert up >= x.max() - 0.1 * (up - down)
    assert over_its_own_range(bench, anew) is None


def test_few_knots_over_far_more_are_drawn_closer(bench):
    wide = curve_over(bench, (-0.2, 0.2))
    anew = over_its_own_range(bench, wide)
    assert anew.hypothesis.visited[0] > -0.1
    assert anew.cost < 0.5 * wide.cost


def test_where_hardly_anything_is_taken_away_so_it_was_no_range(bench, monkeypatch):
    found = curve_over(bench)
    taken = bench.base.optimum.cost - found.cost
    worse = SimpleNamespace(cost=found.cost + 0.11 * taken)
    monkeypatch.setattr(own_range, "_drawn_anew", lambda *_: worse)
    assert over_its_own_range(bench, found) is None


def test_what_has_no_knots_of_its_own_stays(bench):
    found = curve_over(bench)
    for change in (
        {"visited": None},
        {"factor": f},
        {"depends_on": ("flow", "effort")},
    ):
        other = replace(found, hypothesis=replace(found.hypothesis, **change))
        assert over_its_own_range(bench, other) is None


def test_what_is_drawn_finely_is_known_from_its_bends(bench):
    found = curve_over(bench)
    heights = tuple(found.fitted.values[name] for name in found.hypothesis.strengths)
    begin, smooth = Start.where_ended(found.fitted), Smooth(heights, 8, 3.0)
    drawn = drawn_finely(bench, found.hypothesis, smooth, begin)
    assert drawn.cost < 0.5 * found.cost
    assert (is_fine(found.hypothesis), is_fine(drawn.hypothesis)) == (False, True)
