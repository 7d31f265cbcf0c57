"""Further looks: where the first was blind, and nowhere else."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy
from carts import free_cart

from bondgraph import BondGraph, C, R, Recording, Se, Sf, bind_to, effort
from bondgraph.diagnosis.candidates import propose_all
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search import looks, one_round
from bondgraph.diagnosis.search.base.beginnings import Known
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.laws import brought_back
from bondgraph.diagnosis.search.looks import Look
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.search.trials import trying
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Automatic, WholeRecordings, Windows
from bondgraph.physics.library import LIBRARY
from bondgraph.simulation.solvers import Hold

STEP, COUNT, NOISE = 4.0, 400, 0.05
CAPACITY, LOSS, LEAK, ROOM = 180.0, 0.9, 0.4, 294.0


def two_blocks(*, joined=False):
    """Two blocks that each lose heat to a room, with or without a path between them."""
    g = BondGraph("two blocks", domain="thermal")
    g.zero("block1", Sf("heater"), C("capacity1"))
    g.zero("block2", C("capacity2"))
    g.zero("room", Se("air", value=sympy.Symbol("room_temperature")))
    for n in "12":
        g.one(f"surface{n}", R(f"loss{n}"))
        g.join(f"block{n}", f"surface{n}")
        g.join(f"surface{n}", "room")
        g.measure(f"T{n}", effort(f"block{n}"))
        g.parameter(f"capacity{n}", 200.0, "J/K", bounds=(1.0, 1e5))
        g.parameter(f"loss{n}", 0.8, "K/W", bounds=(0.0, 100.0))
    if joined:
        g.one("between", R("path"))
        g.join("block1", "between")
        g.join("between", "block2")
        g.parameter("path", 2.0, "K/W", bounds=(0.0, 100.0))
    g.parameter("room_temperature", ROOM, "K", std=0.0)
    return g.finish()


def heated(model):
    """Return both temperatures of joined blocks, stepped finely by hand."""
    random = np.random.default_rng(8)
    heat = np.repeat(random.uniform(0.0, 40.0, COUNT // 40), 40)
    warm, told = np.zeros(2), np.zeros((COUNT, 2))
    for k, heater in enumerate(heat):
        told[k] = warm
        for _ in range(40):
            passes = LEAK * (warm[0] - warm[1])
            flow = np.array([heater - passes, passes]) - warm / LOSS
            warm = warm + STEP / 40 * flow / CAPACITY
    told += ROOM + NOISE * random.standard_normal(told.shape)
    channels = {"heater": (heat, "W"), "T1": (told[:, 0], "K"), "T2": (told[:, 1], "K")}
    time = STEP * np.arange(COUNT)
    return bind_to(model, Recording.from_arrays("blocks", time, channels))


HELD = FitSettings(hold=Hold.ZERO)
WORDS = ("leak", "delay", "constant_bias", "sensor_scale")


def found(model):
    run = heated(model)
    library = tuple(physics for physics in LIBRARY if physics.word in WORDS)
    said = []
    options = Options(settings=HELD, library=library, either_hold=False)
    diagnosis = diagnose(
        model, [run], held_out=[run], options=options, progress=said.append
    )
    return diagnosis, sum("another look" in sentence for sentence in said)


def test_a_path_into_a_store_that_has_run_away_is_found_from_what_is_stated():
    # Without a path to it the second block fits best as one that never gets warm.
    diagnosis, looks = found(two_blocks())
    (leak,) = diagnosis.findings
    assert looks == 0
    assert diagnosis.verdict is Verdict.PHYSICS_MISSING
    ends = {leak.place, leak.other_end}
    assert (leak.physics, ends) == ("leak", {"block1", "block2"})
    (size,) = leak.estimates
    assert size.value == pytest.approx(LEAK, abs=3 * size.std)
    assert diagnosis.train.after.nrmse < 0.1 * diagnosis.train.before.nrmse
    after = {one.name: one for one in diagnosis.fit_after.estimates}
    assert after["capacity2"].value == pytest.approx(CAPACITY, rel=0.1)


def begun_where_fitted_only(monkeypatch):
    for module in (trying, one_round, brought_back):
        monkeypatch.setattr(module, "run_away", lambda fitted, times=3.0: {})
    monkeypatch.setattr(trying, "_or_early", lambda problem, theta, states: states)


def test_a_further_look_finds_it_too(monkeypatch):
    begun_where_fitted_only(monkeypatch)
    diagnosis, looks = found(two_blocks())
    assert looks == 1
    assert [one.physics for one in diagnosis.findings] == ["leak"]


def test_from_where_the_fit_has_run_away_nothing_is_found(monkeypatch):
    begun_where_fitted_only(monkeypatch)
    monkeypatch.setattr(Known, "as_stated", lambda known, long: ())
    diagnosis, _ = found(two_blocks())
    assert diagnosis.verdict is Verdict.CANNOT_TELL
    assert not diagnosis.findings


def test_what_ran_away_is_held_weakly_to_what_is_stated():
    run = heated(two_blocks())
    base = fit_model(two_blocks(), [run], HELD)
    known = Known(two_blocks(), [run], np.zeros(2), Options(settings=HELD))
    (held,) = known.as_stated(base)
    weakly = {one.name: one.std for one in held.graph.parameters.members if one.std}
    assert weakly == {"capacity2": 200.0, "loss2": 0.8}
    assert held.values["capacity2"] < 0.1 * base.values["capacity2"]


def test_what_has_run_away_is_known_by_what_was_stated():
    base = fit_model(two_blocks(), [heated(two_blocks())], HELD)
    assert run_away(base) == {"capacity2": 200.0, "loss2": 0.8}
    assert run_away(base, times=1e9) == {}
    # Many samples of a wrong model outweigh a tolerance.
    stated = two_blocks().parameters["capacity2"]
    for std, left in (1e9, True), (1.0, False):
        held = two_blocks().with_parameters([replace(stated, std=std)])
        away = run_away(fit_model(held, [heated(held)], HELD))
        assert ("capacity2" in away) is left


def test_a_window_that_is_asked_for_is_kept_in_further_looks():
    run = heated(two_blocks())
    for horizon, used in ((Automatic(), WholeRecordings()), (Windows(50), Windows(50))):
        options = Options(settings=replace(HELD, horizon=horizon))
        known = Known(two_blocks(), [run], np.zeros(2), options)
        assert known.settings.horizon == used
        windows = fit_model(two_blocks(), [run], replace(HELD, horizon=Windows(50)))
        again = known.fitted_again(windows)
        assert again.horizon == used
        assert (again is windows) == (horizon == used)


def test_where_nothing_is_missing_one_look_is_enough():
    diagnosis, looks = found(two_blocks(joined=True))
    assert looks == 0
    assert diagnosis.verdict is Verdict.ADEQUATE


CART = free_cart().with_parameters({"mass": 1.1, "viscous": 0.05})
SOFT, WANDERS = 2e-4, 4e-5
"""A spring in N/m, and what a draught changes by per sample in N."""


def floated(stiffness, walk, samples=2400, step=0.05):
    """Return a cart on an air cushion, on a soft spring, in a draught that wanders."""
    random = np.random.default_rng(2)
    force = 0.05 * np.repeat(random.uniform(-1.0, 1.0, samples // 40), 40)
    draught = np.cumsum(walk * random.standard_normal(samples))
    draught -= draught.mean()
    place, speed, told = 0.0, 0.0, np.zeros(samples)
    for k in range(samples):
        told[k] = place
        for _ in range(10):
            push = force[k] + draught[k] - stiffness * place - 0.04 * speed
            speed += step / 10 * push / 1.0
            place += step / 10 * speed
    told += 2e-3 * random.standard_normal(samples)
    channels = {"force": (force, "N"), "position": (told, "m")}
    time = step * np.arange(samples)
    return bind_to(CART, Recording.from_arrays("run", time, channels))


def springs(stiffness, walk):
    """Return what is said of the cart, and how many further looks it took."""
    run = floated(stiffness, walk)
    words = ("spring", "coulomb_friction", "quadratic_drag", "hardening_spring")
    library = tuple(physics for physics in LIBRARY if physics.word in words)
    options, said = Options(settings=HELD, library=library), []
    diagnosis = diagnose(
        CART, [run], held_out=[run], options=options, progress=said.append
    )
    return diagnosis, sum("another look" in sentence for sentence in said)


def test_what_is_too_soft_for_windows_is_found_in_whole_recordings():
    diagnosis, looks = springs(SOFT, 0.0)
    assert looks == 1
    (spring,) = diagnosis.findings
    assert spring.physics == "spring"
    size = next(one for one in spring.estimates if one.name.startswith("stiffness"))
    assert size.value == pytest.approx(SOFT, rel=0.05)


def test_a_draught_that_wanders_slowly_is_no_spring():
    # Whole recordings are left with more than windows are: no law is believed.
    diagnosis, looks = springs(0.0, WANDERS)
    assert looks == 1
    assert diagnosis.verdict is Verdict.CANNOT_TELL
    assert not diagnosis.findings


def seen_with(*physics):
    """Return a look that has found laws of these words."""
    law = [SimpleNamespace(physics=word) for word in physics]
    chosen = [SimpleNamespace(candidate=SimpleNamespace(hypothesis=one)) for one in law]
    return Look([Round(None, chosen=one) for one in chosen] or [Round(None)], None)


@pytest.mark.parametrize(
    ("best", "seen", "error", "taken"),
    [
        ("compliance", "lag", 0.85, True),
        ("compliance", "lag", 0.95, False),
        ("unknown_relation", "compliance", 1.05, True),
        ("unknown_relation", "compliance", 1.2, False),
        ("unknown_relation", "unknown_relation", 0.95, False),
    ],
)
def test_a_law_with_a_name_need_do_no_better_than_a_curve(best, seen, error, taken):
    # A curve bends to what windows leave of a beam that swings more slowly.
    assert looks.is_better(seen_with(seen), error, seen_with(best), 1.0) is taken


def test_where_nothing_was_found_a_named_law_has_to_be_clearly_better():
    assert not looks.is_better(seen_with("compliance"), 0.95, seen_with(), 1.0)


def test_what_led_by_new_states_in_every_window_does_not_hide_what_came_behind(
    monkeypatch,
):
    soft, loose, weight = (SimpleNamespace(told_by=(w,)) for w in "abc")
    rounds = iter([[soft], [loose], []])
    asked = []

    def judged(*_):
        left = next(rounds)
        chosen = None if left else weight
        verdicts = one_round.Verdicts(chosen=chosen)
        return one_round._Seen(verdicts, tuple(map(forgotten, left)))

    def forgotten(law):
        return one_round.Rejected(law, one_round.FORGETS)

    def fitted(_, leading, *__):
        asked.append([one.hypothesis for one in leading])
        return []

    monkeypatch.setattr(one_round, "fit_best", fitted)
    monkeypatch.setattr(one_round, "begun_elsewhere", lambda *_: [])
    monkeypatch.setattr(one_round, "_judged", judged)
    setting = SimpleNamespace(base=None, options=Options(), noise=None)
    leading = [one_round.Promised(law, 0.9) for law in (soft, loose, weight)]
    seen = one_round._led(setting, None, leading, {}, 1.0)
    assert asked == [[soft, loose, weight], [loose, weight], [weight]]
    assert seen.verdicts.chosen is weight


def looked_further(monkeypatch, without_number):
    """Return from which fits further looks begin where a spring mended the long run.

    Parameters
    ----------
    without_number
        Whether the first look has told no number of it.
    """
    run = floated(SOFT, 0.0)
    windows = replace(HELD, horizon=Windows(40))
    base = fit_model(CART, [run], windows)
    (spring,) = (
        one
        for one in propose_all(base, LIBRARY)
        if (one.physics, one.place) == ("spring", "wheel")
    )
    sprung = spring.apply(base.graph)
    final = fit_model(sprung, [run], replace(HELD, horizon=WholeRecordings()))
    chosen = SimpleNamespace(candidate=SimpleNamespace(hypothesis=spring))
    first, begun = Look([Round(base, chosen=chosen)], final), []
    monkeypatch.setattr(looks, "ends_as_nothing", lambda *_: without_number)
    monkeypatch.setattr(looks, "remaining", lambda *_: 1.0)

    def seen(other, *_):
        begun.append(other)
        return first

    monkeypatch.setattr(looks, "look", seen)
    shop = SimpleNamespace(limit=SimpleNamespace(passed=False), progress=lambda _: None)
    noise = np.zeros(1)
    looks.second_look(CART, first, [run], noise, Options(settings=HELD), shop)
    return begun


def test_a_law_without_a_number_that_mends_the_long_run_ends_no_search(monkeypatch):
    assert looked_further(monkeypatch, without_number=True)
    assert not looked_further(monkeypatch, without_number=False)


def test_whether_a_disturbance_goes_on_growing_is_asked_of_either_fit(
    monkeypatch,
):
    # Windows take what slows a machine for states of their own: it seems to run free.
    run = floated(SOFT, 0.0)
    long = fit_model(CART, [run], replace(HELD, horizon=WholeRecordings()))
    holds = pytest.approx(long.values["viscous"])

    def grows(fitted, _):
        return fitted.values["viscous"] != holds

    monkeypatch.setattr(looks, "goes_on_growing", grows)
    assert looked_further(monkeypatch, without_number=True)
    monkeypatch.setattr(looks, "goes_on_growing", lambda *_: True)
    assert not looked_further(monkeypatch, without_number=True)


@pytest.mark.parametrize(("explained", "kept"), [(True, False), (False, True)])
def test_what_windows_were_not_explained_by_need_not_be_kept(
    monkeypatch, explained, kept
):
    # Play may take up in each window what a friction does in the long run.
    base = SimpleNamespace()
    first = Look([Round(base)], SimpleNamespace())
    seen = Look([Round(base)], SimpleNamespace())
    monkeypatch.setattr(looks, "explains", lambda *_: explained)
    monkeypatch.setattr(looks, "keeps_what_windows_show", lambda *_: False)
    assert looks._still_shows(seen, first, []) is kept


@pytest.mark.parametrize(("heavier", "kept"), [(1.0, True), (5.0, False)])
def test_what_ends_worse_than_it_began_is_not_handed_on(heavier, kept):
    run, whole = floated(0.0, 0.0), replace(HELD, horizon=WholeRecordings())
    base = fit_model(CART, [run], whole)
    fitted = base.graph.with_parameters(base.values).parameters
    ended = [replace(p, value=heavier * p.value, std=0.0) for p in fitted.values()]
    final = fit_model(CART.with_parameters(ended), [run], whole)
    chosen = SimpleNamespace()
    seen = looks._as_begun(Look([Round(base, chosen=chosen)], final), base, [run])
    assert seen.final is (final if kept else base)
    assert seen.rounds[0].chosen is (chosen if kept else None)
