"""A round is made again with inputs that behave as its best law wants."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.search.base.beginnings import base_fit
from bondgraph.diagnosis.search.considered import Setting
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.exchange import Reached
from bondgraph.diagnosis.search.revising.otherwise_held import held_as_found
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.simulation.solvers import Hold

MASS, VISCOUS, STEP, SAMPLES = 2.0, 3.0, 0.05, 400


def cart(*, rubs):
    """Return a cart; as its author knows it, it does not rub."""
    g = BondGraph("cart", domain="translation")
    rub = [R("rub")] if rubs else []
    g.one("wheels", Se("force"), I("mass"), *rub)
    g.measure("speed", flow="wheels")
    g.parameter("mass", MASS, "kg", bounds=(0.1, 10))
    if rubs:
        g.parameter("rub", 1.0, "N*s/m", bounds=(0, 100))
    return g.finish()


def driven(within=1):
    """Return its answer to a command that is always another, held or joined by lines.

    It is held over so many parts of a sample: over many it follows the line.
    """
    random = np.random.default_rng(2)
    time, force = STEP * np.arange(SAMPLES), random.normal(size=SAMPLES)
    speed, decay = np.zeros(SAMPLES), np.exp(-VISCOUS / MASS * STEP / within)
    for k in range(SAMPLES - 1):
        now = speed[k]
        for part in range(within):
            along = (part + 0.5) / within if within > 1 else 0.0
            push = (1 - along) * force[k] + along * force[k + 1]
            now = decay * now + (1 - decay) / VISCOUS * push
        speed[k + 1] = now
    channels = {"force": (force, "N"), "speed": (speed, "m/s")}
    recording = Recording.from_arrays("driven", time, channels)
    return bind_to(cart(rubs=True), recording)


def fitted(hold, *, rubs):
    return fit_model(cart(rubs=rubs), [driven()], FitSettings(hold=hold))


def found_with(model, **what):
    """Return a round that has judged one law, of which that model is the fit."""
    candidate = SimpleNamespace(fitted=model, cost=model.optimum.cost)
    judged = (SimpleNamespace(candidate=candidate),)
    return Round(model, judged=judged, **what)


@pytest.fixture
def begun():
    """Return the setting of a round whose model has its inputs joined by lines."""
    base = fitted(Hold.FIRST, rubs=False)
    noise = np.zeros(1)
    setting = Setting(base, [driven()], noise, Options(), 1, (), False)
    return setting, Reached(base, base, (), noise)


def test_a_round_whose_best_law_wants_inputs_held_is_made_again_so(begun):
    asked = []

    def again(setting):
        asked.append(setting.base.problem.hold)
        return found_with(fitted(Hold.ZERO, rubs=True))

    first = found_with(fitted(Hold.FIRST, rubs=True))
    setting, reached, found = held_as_found(*begun, first, again)
    assert asked == [Hold.ZERO]
    assert found is not first
    assert setting.base is reached.current
    assert reached.first.problem.hold is reached.current.problem.hold is Hold.ZERO


def test_it_stands_where_the_other_way_leaves_no_less(begun):
    first = found_with(fitted(Hold.FIRST, rubs=True))
    unchanged = (*begun, first)
    assert held_as_found(*begun, first, lambda _: first) == unchanged
    assert held_as_found(*begun, first, lambda _: Round(begun[0].base)) == unchanged


def test_nothing_is_made_again_without_need_or_time(begun):
    def again(setting):
        raise AssertionError("made again")

    nothing = Round(begun[0].base)
    assert held_as_found(*begun, nothing, again)[2] is nothing
    held = fitted(Hold.ZERO, rubs=True)
    as_wanted = replace(begun[0], base=held)
    there = found_with(held)
    assert held_as_found(as_wanted, begun[1], there, again)[2] is there
    late = found_with(fitted(Hold.FIRST, rubs=True), cut_short=True)
    assert held_as_found(*begun, late, again)[2] is late


@pytest.mark.parametrize(
    ("options", "hold"),
    [
        (Options(), Hold.ZERO),
        (Options(either_hold=False), Hold.FIRST),
        (Options(settings=FitSettings(hold=Hold.ZERO)), Hold.ZERO),
    ],
    ids=["nothing said", "as settings say", "held"],
)
def test_recordings_say_how_inputs_go_on_where_nobody_else_does(options, hold):
    there = base_fit(
        cart(rubs=True), [driven()], options.settings, np.full(1, 1e-6), options
    )
    assert there.problem.hold is hold


def test_inputs_that_settings_hold_are_held_whatever_fits_better():
    told = FitSettings(hold=Hold.ZERO)
    for options, hold in [
        (Options(settings=told), Hold.ZERO),
        (Options(settings=told, either_hold=True), Hold.FIRST),
    ]:
        joined = [driven(within=20)]
        there = base_fit(cart(rubs=True), joined, told, np.full(1, 1e-6), options)
        assert there.problem.hold is hold
