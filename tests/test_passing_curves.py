"""Curves of resistances that let a flow pass, and edits of sensors that were edited."""

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, C, I, R, Se, Sf, effort
from bondgraph.fitting.estimate import prepare
from bondgraph.physics.dynamics import MOST, Delay
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.sensing import SensorBias, SensorNonlinearity
from bondgraph.physics.smooth import Smooth
from bondgraph.physics.unknown import UnknownRelation
from bondgraph.structure.signals import e, parameter_symbol


def vessel(*, heavy=False, law=None):
    """Return a vessel that empties through an outlet, a heavy column or a free one."""
    g = BondGraph("vessel", domain="hydraulic")
    g.zero("pool", Sf("pump"), C("area"))
    column = [I("column")] if heavy else []
    g.one("outlet", R("pipe", law=law), Se("outside", value=sympy.S.Zero), *column)
    g.join("pool", "outlet")
    g.measure("pressure", 2 * effort("pool"))
    g.parameter("area", 2.0, "m^3/Pa")
    g.parameter("pipe", 3.0, "Pa*s/m^3")
    if heavy:
        g.parameter("column", 1.0, "Pa*s^2/m^3")
    return g.finish()


def proposed(graph, physics, place, scales=None):
    places = all_places(graph, scales or Scales())
    return [law for at in places if at.name == place for law in physics.propose(at)]


def test_a_resistance_whose_efforts_are_given_has_a_curve_of_its_effort():
    (curve,) = (
        one
        for one in proposed(vessel(), UnknownRelation(), "pipe")
        if "pass" in one.words
    )
    assert not proposed(vessel(), UnknownRelation(), "outlet")
    assert curve.also == ("outlet",)
    assert curve.law.subs({parameter_symbol(n): 0 for n in curve.strengths}) == (
        e / parameter_symbol("pipe")
    )
    model = prepare(curve.apply(vessel()))
    assert (model.n_states, model.n_unknowns) == (1, 0)


def test_a_resistance_with_an_inertance_has_a_curve_of_the_flow():
    words = [h.words for h in proposed(vessel(heavy=True), UnknownRelation(), "outlet")]
    assert any("function of volume flow" in one for one in words)
    in_pipe = proposed(vessel(heavy=True), UnknownRelation(), "pipe")
    assert not any("pass" in one.words for one in in_pipe)


def test_a_finely_drawn_one_goes_both_ways_where_that_is_asked_for():
    smooth = Smooth((-1.0,) * 4 + (1.0,) * 4, pieces=2, roughness=1.0, odd=True)
    scales = Scales(ranges={"effort(outlet>pipe)": (-2.0, 2.0)})
    (curve,) = (
        one
        for one in proposed(vessel(), UnknownRelation(smooth), "pipe", scales)
        if "pass" in one.words
    )
    assert curve.words.endswith("the same both ways")
    assert curve.shape is not None
    assert curve.shape.value_unit == "m^3/s"


def test_a_law_of_a_sensor_stays_where_an_earlier_one_is_taken_out():
    g = vessel()
    (bias,) = proposed(g, SensorBias(), "pressure")
    biased = bias.apply(g)
    bent = proposed(biased, SensorNonlinearity(), "pressure")[0]
    both, alone = bent.apply(biased), bent.apply(g)
    names = set(bias.parameters)
    assert names <= {p.name for p in both.parameters.members}
    assert not names & {p.name for p in alone.parameters.members}
    again = proposed(g, SensorNonlinearity(), "pressure")[0].apply(g)
    here, there = (m.measurements[0].expression for m in (alone, again))
    values = {
        s: 0.7 + 0.1 * k for k, s in enumerate(sorted(here.free_symbols, key=str))
    }
    told, wanted = (float(one.subs(values)) for one in (here, there))
    assert told == pytest.approx(wanted)
    assert np.isfinite(told)


def test_no_delay_is_longer_than_half_the_longest_recording():
    scales = Scales(interval=0.1, duration=40.0)
    (delay,) = proposed(vessel(), Delay(), "pump", scales)
    (time,) = (p for p in delay.edit.parameters if not p.exact)
    assert time.bounds == (0.1 * 0.05, MOST * 40.0)


def test_a_bent_sensor_may_have_another_slope_as_well():
    bent, *_, sloped = proposed(vessel(), SensorNonlinearity(), "pressure")
    assert sloped.contains(bent)
    assert not bent.contains(sloped)
    slope = next(name for name in sloped.strengths if "slope" in name)
    assert sloped.law.subs(parameter_symbol(slope), 0) == bent.law


def test_a_sensor_that_bends_about_the_middle_of_its_range_has_its_slope():
    scales = Scales(ranges={"pressure": (290.0, 310.0)})
    laws = proposed(vessel(), SensorNonlinearity(), "pressure", scales)
    assert not any("sensor_slope_pressure" in law.parameters for law in laws)
