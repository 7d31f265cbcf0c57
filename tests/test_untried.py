"""What is not tried because recordings could not show it, and what is told of that."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, C, I, R, Recording, Se, Sf, bind_to, flow
from bondgraph.diagnosis.answer.untried import unread_inputs, untried
from bondgraph.diagnosis.answer.wording import hedged
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.considered import promising
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.either_hold import fitted_either_way
from bondgraph.fitting.estimate import FitSettings
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.simulation.solvers import Hold


def cart(*, law=None):
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"), R("damper", law=law))
    g.one("fan", Sf("wind"), domain="analogue")
    g.measure("speed", flow("cart"))
    g.parameter("mass", 1.0, "kg", bounds=(0.01, 100.0))
    g.parameter("damper", 1.0, "N*s/m", bounds=(0.0, 100.0))
    return g.finish()


def proposed(ranges):
    scales = Scales(ranges=ranges)
    return {
        (hypothesis.physics, hypothesis.place)
        for place in all_places(cart(), scales)
        for physics in LIBRARY
        for hypothesis in physics.propose(place)
    }


LATE = {
    (word, "force")
    for word in ("lag", "delay", "saturation", "dead_zone", "input_nonlinearity")
}


def test_an_input_that_never_changes_shows_not_how_it_would():
    moving, held = (
        proposed({"effort(force)": (0.0, 2.0)}),
        proposed({"effort(force)": (2.0, 2.0)}),
    )
    assert moving >= LATE
    assert held == moving - LATE
    assert ("input_scale", "force") in held


@pytest.mark.parametrize(
    ("low", "high", "shows"),
    [(-1.0, 2.0, True), (0.0, 2.0, False), (-2.0, 0.01, False)],
)
def test_motion_that_goes_one_way_shows_no_memory(low, high, shows):
    assert (("hysteresis", "cart") in proposed({"flow(cart)": (low, high)})) == shows
    assert ("coulomb_friction", "cart") in proposed({"flow(cart)": (low, high)})


def test_laws_without_a_position_and_inputs_that_nothing_reads_are_told():
    position, idle = untried(cart(), Verdict.CANNOT_TELL)
    assert "at cart: no displacement is measured" in position
    assert "Nothing in the model depends on wind, which is recorded" in idle
    assert untried(cart(), Verdict.PHYSICS_MISSING) == ()
    assert untried(cart(), Verdict.ADEQUATE) == ()


def test_an_input_that_a_law_reads_is_not_idle():
    law = sympy.Symbol("damper") * sympy.Symbol("f") * flow("fan")
    assert unread_inputs(cart()) == ("wind",)
    assert unread_inputs(cart(law=law)) == ()


def test_what_is_less_probable_than_not_is_told_as_what_may_be():
    said = "Drag at cart was left out: a force (c = 1 ± 2). It was left out: twice."
    assert hedged(said).startswith("Drag at cart may have been left out: a force")
    assert hedged(said).count("may have been") == 1
    curve = "A relation is missing at cart that has no name here."
    assert hedged(curve) == curve


def test_what_a_promising_law_contains_is_fitted_whatever_it_promises():
    def promised(word, reduction, inside=()):
        law = SimpleNamespace(
            physics=word, contains=lambda other: other.physics in inside
        )
        return SimpleNamespace(hypothesis=law, reduction=reduction)

    wide = promised("backlash", 0.6, ("compliance",))
    spring, drag = promised("compliance", 0.0), promised("drag", 0.0)
    assert promising([wide, spring, drag], Options()) == [wide, spring]
    assert promising([drag, spring], Options()) == []


def test_where_a_lag_promises_much_a_delay_of_the_same_signal_is_fitted_too():
    def promised(word, place, reduction):
        law = SimpleNamespace(
            physics=word,
            place=place,
            contains=lambda _: False,
            is_elsewhere=lambda _: False,
        )
        return SimpleNamespace(hypothesis=law, reduction=reduction)

    lag, delay = promised("lag", "encoder", 0.6), promised("delay", "encoder", 0.0)
    others = [promised("delay", "voltage", 0.0), promised("slip", "encoder", 0.0)]
    assert promising([lag, delay, *others], Options()) == [lag, delay]


def test_what_promises_much_at_one_place_is_fitted_at_others_too():
    def promised(place, reduction, numbers=("size",)):
        law = SimpleNamespace(
            physics="mode", place=place, parameters=numbers, contains=lambda _: False
        )
        law.is_elsewhere = partial(Hypothesis.is_elsewhere, law)
        return SimpleNamespace(hypothesis=law, reduction=reduction)

    motor, carriage = promised("motor", 0.03), promised("carriage", 0.02)
    table, wider = promised("table", 0.001), promised("idler", 0.02, ("size", "skew"))
    assert promising([motor, carriage, wider, table], Options()) == [motor, carriage]


def test_of_two_ways_that_fit_alike_a_command_in_steps_is_held():
    time = 0.02 * np.arange(400)
    steps = np.repeat([1.0, -1.0, 2.0, 0.0, 1.5], 80)
    swept = np.sin(time**2)
    for force, hold in ((steps, Hold.ZERO), (swept, Hold.FIRST)):
        g = BondGraph("loop", domain="electrical")
        g.one("loop", Se("force"), R("damper"), C("store"))
        g.measure("current", flow("loop"))
        g.parameter("damper", 1.0, "ohm", bounds=(0.1, 10.0))
        g.parameter("store", 1.0, "F", bounds=(0.1, 10.0))
        noise = np.random.default_rng(3).standard_normal(400)
        channels = {"force": (force, "V"), "current": (noise, "A")}
        run = bind_to(g.finish(), Recording.from_arrays("r", time, channels))
        fitted = fitted_either_way(g.finish(), [run], FitSettings())
        assert fitted.problem.hold is hold
