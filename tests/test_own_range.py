"""A curve that takes its machine farther than its knots is drawn as far as it goes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import BondGraph, C, Hold, R, Recording, Se, bind_to
from bondgraph.diagnosis.drawn_laws import law_curve
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.laws import own_range
from bondgraph.diagnosis.search.laws.drawing import drawn_finely, is_fine
from bondgraph.diagnosis.search.laws.own_range import over_its_own_range
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.smooth import Smooth
from bondgraph.physics.unknown import UnknownRelation
from bondgraph.structure.signals import f

STEP = 0.01


def bellows():
    """Return bellows that a known force draws out against a stated spring."""
    g = BondGraph("bellows", domain="translation")
    g.one("plate", Se("force"), C("bellows"), R("damper"))
    g.measure("speed", flow="plate")
    g.parameter("bellows", 0.01, "m/N")
    g.parameter("damper", 20.0, "N*s/m")
    return g.finish()


def drawn_out(force_of, seed=1):
    """Return a recording of bellows that give ``force_of`` how far they are out."""
    time = STEP * np.arange(1500)
    force = 4.0 * np.sin(1.1 * time) + 2.0 * np.sin(2.9 * time + 1.0)
    out, speed = 0.0, np.zeros(time.size)
    for k, push in enumerate(force):
        for _ in range(20):
            now = (push - force_of(out)) / 20.0
            out += now * STEP / 20
        speed[k] = now
    speed += 1e-4 * np.random.default_rng(seed).normal(size=time.size)
    channels = {"force": (force, "N"), "speed": (speed, "m/s")}
    return bind_to(bellows(), Recording.from_arrays("run", time, channels))


@pytest.fixture
def bench():
    """Return what bellows that give way are searched on, fitted from the stated."""
    settings = FitSettings(hold=Hold.ZERO)
    run = drawn_out(lambda out: 6.0 * np.tanh(out / 0.05))
    base = fit_model(bellows(), [run], settings)
    with workshop(Here(), Journal(), lambda _: None) as shop:
        yield Bench.of(base, shop, "round 1")


def curve_over(bench, visited=None):
    """Return the curve of the displacement, fitted."""
    places = all_places(bench.base.graph, measure_scales(bench.base))
    (place,) = (one for one in places if one.name == "plate")
    curve = next(
        one
        for one in UnknownRelation(visited=visited).propose(place)
        if one.depends_on == ("displacement",) and one.factor == 1
    )
    trial = Trial(curve, (Start.where_ended(bench.base),))
    (found,) = bench.candidates([trial], bench.run(fit_fully, [trial], "a curve"))
    return found


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
