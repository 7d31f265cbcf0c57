"""Readings that come late: on machines far from zero, and beside other effects."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, R, Recording, Se, Sf, bind_to, diagnose
from bondgraph.diagnosis.candidates import propose_all
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.screening import screen
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.dynamics import Delay, Lag
from bondgraph.physics.friction import CoulombFriction

STEP, LATE = 4.0, 30.0


def pot():
    graph = BondGraph("pot", domain="thermal")
    graph.zero("kitchen", Se("air", value=293.0))
    graph.zero("water", Sf("heater"), C("capacity"))
    graph.one("wall", R("loss"))
    graph.join("water", "wall")
    graph.join("wall", "kitchen")
    graph.measure("thermometer", effort="water")
    graph.parameter("capacity", 4000.0, "J/K")
    graph.parameter("loss", 0.25, "K/W")
    return graph.finish()


def heated():
    """Return a pot that is heated in steps; its thermometer lags by half a minute."""
    random = np.random.default_rng(1)
    time = STEP * np.arange(700)
    power = np.repeat(random.uniform(0.0, 500.0, 35), 20)
    warm = late = 293.0
    readings = []
    for heat in power:
        readings.append(late + 0.05 * random.normal())
        for _ in range(20):
            warm += STEP / 20 * (heat - (warm - 293.0) / 0.25) / 4000.0
            late += STEP / 20 * (warm - late) / LATE
    channels = {"heater": (power, "W"), "thermometer": (np.array(readings), "K")}
    return bind_to(pot(), Recording.from_arrays("run", time, channels))


def test_a_late_reading_promises_as_much_as_a_late_heater_far_from_zero():
    # Its state begins at 293 K. From nothing, explicit steps never found it, and what
    # a reading's lag promised was what its first value did wrong.
    base = fit_model(pot(), [heated()], FitSettings())
    laws = propose_all(base, (Lag(), Delay()))
    with workshop(Here(), Journal(), lambda _: None) as shop:
        screened = screen(Bench.of(base, shop, "round 1"), laws)
    promised = {
        (one.hypothesis.physics, one.hypothesis.place): one.reduction
        for one in screened.promised
    }
    for law in ("lag", "delay"):
        there, source = promised[law, "thermometer"], promised[law, "heater"]
        assert there > 0.5
        assert there == pytest.approx(source, abs=0.2)


def sledge():
    graph = BondGraph("sledge", domain="translation")
    graph.one("body", Se("force"), I("mass"), R("grease"))
    graph.measure("speed", flow="body")
    graph.measure("position", displacement="body")
    graph.parameter("mass", 12.0, "kg")
    graph.parameter("grease", 18.0, "N*s/m", bounds=(0, 1e3))
    return graph.finish()


def pulled(seed):
    """Return a sledge that rubs, with 9 N, and whose position is read 60 ms late."""
    random = np.random.default_rng(seed)
    step, fine = 0.01, 20
    force = np.repeat(random.uniform(-60.0, 60.0, 40), 40)
    speed = way = late = 0.0
    rows = []
    for pull in force:
        rows.append((speed, late))
        for _ in range(fine):
            free = speed + step / fine * (pull - 20.0 * speed) / 10.0
            rubbed = step / fine * 9.0 / 10.0
            speed = np.sign(free) * max(abs(free) - rubbed, 0.0)
            way += step / fine * speed
            late += step / fine * (way - late) / 0.06
    speeds, ways = np.array(rows).T
    channels = {
        "force": (force, "N"),
        "speed": (speeds + 0.005 * random.normal(size=len(force)), "m/s"),
        "position": (ways + 5e-4 * random.normal(size=len(force)), "m"),
    }
    time = step * np.arange(len(force))
    return bind_to(sledge(), Recording.from_arrays(f"run {seed}", time, channels))


@pytest.mark.long
def test_a_late_position_shows_beside_friction():
    # Over short windows free first positions take what a lag does to a ramp: behind
    # friction it promised nothing, and a half of the misfit had no name.
    options = Options(library=(CoulombFriction(), Lag()))
    found = diagnose(sledge(), [pulled(1)], held_out=[pulled(2)], options=options)
    said = {(one.physics, one.place): one for one in found.findings}
    assert set(said) == {("coulomb_friction", "body"), ("lag", "position")}
    assert said["lag", "position"].estimates[0].value == pytest.approx(0.06, rel=0.03)
    friction = said["coulomb_friction", "body"]
    assert friction.estimates[0].value == pytest.approx(9.0, rel=0.05)
    assert all(one.probability > 0.6 for one in found.findings)
    assert found.held_out.after.nrmse < 0.1 * found.held_out.before.nrmse
