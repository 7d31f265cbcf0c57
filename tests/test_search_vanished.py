"""A law that its fit has let go of, for states set anew in every window."""

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.candidates import Promised
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.laws.fits import fit_best
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.diagnosis.search.trials.vanished import (
    has_vanished,
    is_nothing,
    without_vanished,
)
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Windows
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.hysteresis import BoucWenHysteresis, DahlHysteresis
from bondgraph.physics.modes import FlexibleMode
from bondgraph.physics.places.everywhere import all_places

STEP, TROLLEY, LOAD, SWING = 0.05, 600.0, 350.0, 1.3


def hauled():
    """Return times, forces and positions of a trolley with a load that swings."""
    time = np.arange(1600) * STEP
    force = np.repeat(np.random.default_rng(2).uniform(-400, 400, 40), 40)
    x, v, hang, swing = 0.0, 0.0, 0.1, 0.0
    position = np.zeros(time.size)
    for k, pull in enumerate(force):
        position[k] = x
        for _ in range(20):
            tie = LOAD * SWING**2 * hang
            v += STEP / 20 * (pull + tie - 120.0 * v) / TROLLEY
            swing -= STEP / 20 * SWING**2 * hang
            x += STEP / 20 * v
            hang += STEP / 20 * (swing - v)
    return time, force, position + 1e-4 * np.random.default_rng(3).normal(size=1600)


def crane():
    g = BondGraph("crane", domain="translation")
    g.one("trolley", Se("force"), I("mass"), R("rail"))
    g.measure("position", displacement="trolley")
    g.parameter("mass", 900.0, "kg", bounds=(100, 1e4))
    g.parameter("rail", 100.0, "N*s/m", bounds=(0, 1e4))
    return g.finish()


@pytest.fixture(scope="module")
def bench():
    time, force, position = hauled()
    channels = {"force": (force, "N"), "position": (position, "m")}
    recording = bind_to(crane(), Recording.from_arrays("hauled", time, channels))
    base = fit_model(crane(), [recording], FitSettings(horizon=Windows(100)))
    with workshop(Here(), Journal(), lambda _: None) as shop:
        yield Bench.of(base, shop, "test")


def proposed(bench, physics):
    places = all_places(bench.base.graph, measure_scales(bench.base))
    (place,) = (place for place in places if place.name == "trolley")
    (hypothesis,) = physics.propose(place)
    return hypothesis


def fitted(bench, hypothesis, **start):
    known = Start({**hypothesis.starts[-1], **start})
    trial = Trial(hypothesis, (known,))
    (found,) = bench.candidates([trial], bench.run(fit_fully, [trial], "fits"))
    return found


def test_a_mass_of_nothing_that_swings_as_it_likes_is_set_aside(bench):
    mode = proposed(bench, FlexibleMode())
    nothing, rate = mode.starts[0]["mode_inertia_trolley"], "mode_frequency_trolley"
    lost = fitted(bench, mode, mode_inertia_trolley=1e-3 * nothing, **{rate: SWING})
    assert lost.reduction(bench.base) > 0.5
    assert has_vanished(lost)
    kept, (rejected,) = without_vanished([lost])
    assert kept == []
    assert rejected.hypothesis is mode


def test_a_fit_that_has_lost_its_law_begins_again_with_an_effect(bench):
    mode = proposed(bench, FlexibleMode())
    # A promise that is easily kept: the first start, of no effect, would do.
    (found,) = fit_best(bench, [Promised(mode, 0.8)], 0.75, 1)
    assert not has_vanished(found)
    assert found.fitted.values["mode_inertia_trolley"] == pytest.approx(LOAD, rel=0.02)
    assert found.fitted.values["mode_frequency_trolley"] == pytest.approx(
        SWING, rel=0.01
    )


def test_a_law_without_a_state_has_not_vanished_where_it_is_small(bench):
    drag = fitted(bench, proposed(bench, QuadraticDrag()))
    assert not has_vanished(drag)


def test_a_strength_of_next_to_nothing_is_none(bench):
    law = proposed(bench, DahlHysteresis())
    (size,) = law.strengths
    begun = law.starts[-1]
    assert begun[size] > 0.0
    assert is_nothing(law, {**begun, size: 1e-9 * begun[size]})
    assert not is_nothing(law, {**begun, size: 1e-3 * begun[size]})


def test_a_memory_far_beyond_what_it_can_be_is_another_laws(bench):
    law = proposed(bench, DahlHysteresis())
    begun = law.starts[-1]
    (size,) = law.strengths
    weak = fitted(bench, law, **{size: 1e-4 * begun[size]})
    memory = weak.fitted.problem.model.state_names.index(f"q_{law.memory.state}")
    along = weak.fitted.optimum.linearisation.states[:, memory]
    assert np.abs(along).max() > 100.0 * law.memory.most
    assert not is_nothing(law, weak.fitted.values)
    assert has_vanished(weak)


def test_loops_that_grow_stiffer_as_they_are_loaded_have_no_largest_memory(bench):
    assert proposed(bench, DahlHysteresis()).memory is not None
    assert proposed(bench, BoucWenHysteresis()).memory is None
