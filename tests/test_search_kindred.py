"""The same law at two places that are built alike is tried as one.

Two drives push one carriage; both have dry friction. What is left out at one is left
out at the other: that is one supposition among few, not one among all pairs of laws.
"""

import re
import sys

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, R, Recording, Se, Sf, bind_to
from bondgraph.diagnosis.candidates import propose_all
from bondgraph.diagnosis.search.pairs.kindred import Kindreds, as_one, kindred
from bondgraph.diagnosis.search.pairs.pairs import Pairing
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.dynamics import Lag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.orifice import SquareLaw
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales

FRICTION = {"left": 0.8, "right": 1.3}


def gantry():
    """Return two driven carts; the frame between them is built otherwise."""
    g = BondGraph("gantry", domain="translation")
    for side in FRICTION:
        g.one(side, Sf(f"speed_{side}"), R(f"damper_{side}"))
        g.measure(f"force_{side}", effort=f"speed_{side}")
        g.parameter(f"damper_{side}", 1.0, "N*s/m", bounds=(0, 100))
    g.one("frame", Se("wind"), I("mass"), C("anchor"))
    g.measure("sway", displacement="anchor")
    g.parameter("mass", 2.0, "kg", std=0.0)
    g.parameter("anchor", 0.1, "m/N", std=0.0)
    return g.finish()


def recorded(graph, samples=800):
    rng = np.random.default_rng(3)
    time = np.arange(samples) * 0.01
    channels = {"wind": (np.zeros(samples), "N")}
    sway = 0.05 * np.cos(time / np.sqrt(0.2)) + 1e-4 * rng.normal(size=samples)
    channels["sway"] = (sway, "m")
    for side, friction in FRICTION.items():
        speed = 0.5 * np.sin(2.1 * time + friction)
        force = 1.5 * speed + friction * np.sign(speed)
        channels[f"speed_{side}"] = speed, "m/s"
        channels[f"force_{side}"] = force + 0.02 * rng.normal(size=samples), "N"
    return bind_to(graph, Recording.from_arrays("run", time, channels))


@pytest.fixture(scope="module")
def base():
    graph = gantry()
    return fit_model(graph, [recorded(graph)], FitSettings())


def hypotheses(base):
    return propose_all(base, (CoulombFriction(), Lag()))


def test_kindred_laws_sit_at_places_that_are_built_alike(base):
    pairs = kindred(base.graph, hypotheses(base))
    told = {(one.physics, one.place, other.place) for one, other in pairs}
    assert told == {
        ("coulomb_friction", "left", "right"),
        ("lag", "speed_left", "speed_right"),
        ("lag", "force_left", "force_right"),
    }


def test_two_laws_as_one_begin_where_both_begin(base):
    one, other = kindred(base.graph, hypotheses(base))[0]
    both = as_one((one, other))
    assert both.parameters == (*one.parameters, *other.parameters)
    assert both.starts[0] == {**one.starts[0], **other.starts[0]}
    assert len(both.starts) == len(one.starts)
    assert both.apply(base.graph) == other.apply(one.apply(base.graph))


def test_those_that_help_most_as_one_go_on_and_have_few_rivals(base):
    with workshop(Here(), Journal(), lambda _: None) as shop:
        bench = Bench.of(base, shop, "round 1")
        pairing = Pairing.of(bench, [], hypotheses(base))
        (pair,) = pairing.best(10)
    assert pairing.kin.tried == 5  # Coulomb friction, and both forms of a lag twice.
    values = pair.both.fitted.values
    found = {side: values[f"coulomb_{side}"] for side in FRICTION}
    assert found == pytest.approx(FRICTION, rel=0.02)
    assert pairing.rivals(pair, 100.0) == 10.0
    assert (
        pairing.rivals(pair.__class__(pair.second, pair.first, pair.both), 100.0) > 9e3
    )


def test_of_many_kindred_laws_every_law_keeps_its_share(base, monkeypatch):
    module = sys.modules[Kindreds.__module__]
    monkeypatch.setattr(module, "MOST", 2)
    physics = [one.physics for one, _ in kindred(base.graph, hypotheses(base))]
    assert physics == ["coulomb_friction", "lag"]


def test_no_more_are_left_out_than_are_too_many(base, monkeypatch):
    proposed = propose_all(base, LIBRARY)
    every = kindred(base.graph, proposed)
    monkeypatch.setattr(sys.modules[Kindreds.__module__], "MOST", len(every) - 1)
    assert len(kindred(base.graph, proposed)) == len(every) - 1


def test_kindred_laws_are_of_one_form(base):
    """An upper limit of one sensor and a lower one of the other are two laws."""
    for one, other in kindred(base.graph, propose_all(base, LIBRARY)):
        mine, its = (
            [re.sub("left|right", "", name) for name in law.parameters]
            for law in (one, other)
        )
        assert mine == its


def test_a_law_that_is_called_by_its_element_is_kindred_too():
    g = BondGraph("two tanks", domain="hydraulic")
    for n in "12":
        g.zero(f"tank{n}", Sf(f"pump{n}"), C(f"area{n}"), R(f"outlet{n}"))
        g.measure(f"level{n}", effort=f"tank{n}")
        g.parameter(f"area{n}", 0.5, "m^3/Pa")
        g.parameter(f"outlet{n}", 2.0, "Pa*s/m^3")
    graph = g.finish()
    places = all_places(graph, Scales())
    laws = [law for place in places for law in SquareLaw().propose(place)]
    ((one, other),) = kindred(graph, laws)
    assert (one.place, other.place) == ("tank1", "tank2")
    assert "outlet1_flow_tank1" in one.parameters


def test_what_is_read_at_a_bond_has_places_built_alike_too():
    g = BondGraph("wound shaft", domain="rotation")
    g.one("motor", Se("torque"), I("rotor"))
    g.zero("shaft", C("twist"))
    g.one("load", I("wheel"), R("bearing"))
    g.join("motor", "shaft")
    g.join("shaft", "load")
    g.measure("passed_on", effort="shaft>load")
    g.measure("turned", displacement="motor>shaft")
    values = {"rotor": "kg*m^2", "wheel": "kg*m^2", "bearing": "N*m*s/rad"}
    for name, unit in {**values, "twist": "rad/(N*m)"}.items():
        g.parameter(name, 1.0, unit, bounds=(0, 10))
    graph = g.finish()
    rng = np.random.default_rng(3)
    units = {"torque": "N*m", "passed_on": "N*m", "turned": "rad"}
    channels = {name: (rng.normal(size=200), unit) for name, unit in units.items()}
    time = 0.01 * np.arange(200)
    run = bind_to(graph, Recording.from_arrays("run", time, channels))
    fitted = fit_model(graph, [run], FitSettings())
    proposed = propose_all(fitted, LIBRARY)
    sensed = {one.place for one in proposed} & {"passed_on", "turned"}
    assert sensed == {"passed_on", "turned"}
    assert all(a.physics == b.physics for a, b in kindred(graph, proposed))
