"""Laws of many forms begin with those that promise most; a play's contact is left."""

from dataclasses import replace

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, R, Recording, Se, Sf, bind_to
from bondgraph.diagnosis.candidates import CURVE, Promised, propose_all
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.considered import Setting, _is_late, considered
from bondgraph.diagnosis.search.laws.fits import fit_remembering, fit_whatever
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.screening import screen
from bondgraph.diagnosis.search.trials.trying import FORMS
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.physics.contact import Backlash
from bondgraph.physics.dynamics import Delay
from bondgraph.physics.load import LoadDependentFriction
from bondgraph.physics.modes import FlexibleMode
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.position import Cogging
from bondgraph.structure.edits import InsertElement

STEP, WAVE, RIPPLE = 0.01, 120.0, 0.4


def track():
    """Return a carriage of 2 kg on a motor whose magnets are 52 mm apart."""
    g = BondGraph("track", domain="translation")
    g.one("motor", Se("force"), I("slider"))
    g.one("carriage", I("mass"), R("rail"))
    g.join("motor", "carriage")
    g.measure("position", displacement="carriage")
    g.parameter("slider", 0.5, "kg", std=0.0)
    g.parameter("mass", 1.5, "kg", bounds=(0.1, 10))
    g.parameter("rail", 6.0, "N*s/m", bounds=(0, 100))
    return g.finish()


@pytest.fixture(scope="module")
def recordings():
    time = np.arange(2000) * STEP
    force = 3.0 * np.sin(0.9 * time) + 1.5 * np.sin(2.3 * time + 0.4)
    x, v = 0.0, 0.0
    position = np.zeros(time.size)
    for k, pull in enumerate(force):
        position[k] = x
        for _ in range(20):
            v += STEP / 20 * (pull - 6.0 * v - RIPPLE * np.sin(WAVE * x)) / 2.0
            x += STEP / 20 * v
    position += 2e-4 * np.random.default_rng(3).normal(size=time.size)
    channels = {"force": (force, "N"), "position": (position, "m")}
    return [bind_to(track(), Recording.from_arrays("run", time, channels))]


@pytest.fixture(scope="module")
def bench(recordings):
    base = fit_model(track(), recordings, FitSettings())
    with workshop(Here(), Journal(), lambda _: None) as shop:
        yield Bench.of(base, shop, "test")


def proposed(bench, physics, place):
    places = all_places(bench.base.graph, measure_scales(bench.base))
    return [h for p in places if p.name == place for h in physics.propose(p)]


def test_a_ripple_is_begun_near_its_length(bench, recordings):
    (ripple,) = proposed(bench, Cogging(), "carriage")
    travel = np.ptp(recordings[0].outputs[:, 0])
    assert len(ripple.starts) > 50
    (first,) = screen(bench, [ripple]).promised
    assert len(first.hypothesis.starts) == FORMS
    begun = first.hypothesis.starts[0]["cogging_wave_carriage"]
    assert abs(begun - WAVE) < 2 * np.pi / travel
    (found,) = fit_whatever(bench, [first], 0.75, 1)
    assert found.fitted.values["cogging_wave_carriage"] == pytest.approx(WAVE, rel=0.01)


def test_laws_with_states_and_without_are_fitted_apart(bench):
    (ripple,) = proposed(bench, Cogging(), "carriage")
    (swinging,) = proposed(bench, FlexibleMode(), "carriage")
    both = [Promised(one, 0.5) for one in (ripple, swinging)]
    assert [one.hypothesis for one in fit_whatever(bench, both, 0.0, 2)] == [ripple]
    assert [one.hypothesis for one in fit_remembering(bench, both, 0.0, 2)] == [
        swinging
    ]


def test_nothing_is_hung_on_the_contact_of_a_play(bench, recordings):
    (play,) = proposed(bench, Backlash(), "motor")
    loose = fit_model(play.apply(bench.base.graph), recordings, FitSettings())
    zero = np.zeros(1)
    setting = Setting(loose, recordings, zero, Options(), 2, (play,), False)
    places = {one.place for one in considered(setting)}
    assert {"motor", "carriage"} <= places
    assert not {name for name in places if "backlash" in name}
    setting = Setting(loose, recordings, zero, Options(), 2, (), False)
    assert {one.place for one in considered(setting) if "backlash" in one.place}


def late_again(base, recordings, found):
    """Return where a delay is considered beside what was found."""
    setting = Setting(base, recordings, np.zeros(2), Options(), 2, found, False)
    return {one.place for one in considered(setting) if one.physics == Delay.word}


def test_the_only_way_to_a_reading_is_late_once(bench, recordings):
    (late,) = proposed(bench, Delay(), "force")
    base = bench.base
    assert late_again(base, recordings, ()) == {"force", "position"}
    assert late_again(base, recordings, (late,)) == set()
    shots = base.problem.shots
    twice = replace(shots, outputs=np.repeat(shots.outputs, 2, axis=1))
    two = replace(base, problem=replace(base.problem, shots=twice))
    assert _is_late(
        Setting(base, recordings, np.zeros(1), Options(), 2, (late,), False)
    )
    other = Setting(two, recordings, np.zeros(2), Options(), 2, (late,), False)
    assert not _is_late(other)


def polarised(setting):
    """Return the polarisations that are considered of a cell."""
    return [one for one in considered(setting) if "polarisation" in one.words]


def test_a_store_behind_a_resistance_may_be_found_twice():
    g = BondGraph("cell", domain="electrical")
    g.one("cell", Sf("current"), R("ohmic"), C("charge"))
    g.measure("voltage", effort="current")
    g.parameter("ohmic", 0.03, "ohm", bounds=(1e-3, 1))
    g.parameter("charge", 3000.0, "F", bounds=(1.0, 1e6))
    model, found = g.finish(), ()
    current = np.repeat(np.random.default_rng(2).uniform(-2, 2, 20), 20)
    channels = {"current": (current, "A"), "voltage": (0.03 * current, "V")}
    run = bind_to(model, Recording.from_arrays("run", np.arange(400.0), channels))
    for number in (1, 2, 3):
        base = fit_model(model, [run], FitSettings(iterations=1))
        setting = Setting(base, [run], np.zeros(1), Options(), number, found, False)
        proposals = polarised(setting)
        assert len(proposals) == (number < 3)
        found = (*found, *proposals)
        model = proposals[0].apply(model) if proposals else model
    assert len(set(found[0].parameters + found[1].parameters)) == 4


@pytest.mark.parametrize(("rows", "curves"), [(11, False), (60, True)])
def test_no_law_has_as_many_numbers_as_there_are_samples_to_spare(rows, curves):
    g = BondGraph("discharge", domain="electrical")
    g.zero("node", C("capacitor"), R("resistor"))
    g.measure("voltage", effort="node")
    g.parameter("capacitor", 2e-3, "F", bounds=(1e-3, 5e-3))
    g.parameter("resistor", 5e4, "ohm", std=0.0)
    model, time = g.finish(), np.linspace(0.0, 100.0, rows)
    channels = {"voltage": (5.5 * np.exp(-time / 105.0), "V")}
    run = bind_to(model, Recording.from_arrays("run", time, channels))
    base = fit_model(model, [run], FitSettings(horizon=WholeRecordings()))
    setting = Setting(base, [run], np.zeros(1), Options(), 1, (), curves=True)
    laws = considered(setting)
    assert any(one.physics == "constant_bias" for one in laws)
    assert any(one.physics == "unknown_relation" for one in laws) is curves


def test_no_curve_bends_what_a_law_has_hung_at_a_place():
    graph = track()
    pushed = np.sin(np.arange(200) / 9.0)
    channels = {"force": (pushed, "N"), "position": (0.01 * pushed, "m")}
    time = STEP * np.arange(200)
    recording = Recording.from_arrays("run", time, channels)
    run = bind_to(graph, recording)
    base = fit_model(graph, [run], FitSettings(iterations=1))
    laws = propose_all(base, [LoadDependentFriction()])
    law = next(one for one in laws if isinstance(one.edit, InsertElement))
    after = fit_model(law.apply(graph), [run], FitSettings(iterations=1))

    def curves(found):
        setting = Setting(after, [run], np.zeros(1), Options(), 2, found, curves=True)
        return {one.place for one in considered(setting) if one.physics == CURVE}

    hung = law.edit.element.name
    assert hung in curves(())
    assert curves(()) - curves((law,)) == {hung}
