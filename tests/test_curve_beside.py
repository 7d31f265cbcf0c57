"""A relation that a named law only comes near to is told as a curve, or said to be."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from judged_candidates import judged
from rubbing_slider import place_of, proposed, slider

from bondgraph import Recording, bind_to, diagnose
from bondgraph.diagnosis.answer import found as found_there
from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.drawn_laws import law_curve
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search import rounds as searched
from bondgraph.diagnosis.search.laws import curve_from_law
from bondgraph.diagnosis.search.laws.curve_from_law import with_curve_drawn
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising import curve_beside
from bondgraph.diagnosis.search.revising.curve_beside import (
    better_curve,
    told_if_fine,
    told_instead,
)
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.judging import Verdicts, judge_all
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.hysteresis import DahlHysteresis
from bondgraph.physics.unknown import UnknownRelation

LIBRARY = (CoulombFriction(), QuadraticDrag(), UnknownRelation())


def recorded(graph, force_of, seed):
    rng = np.random.default_rng(seed)
    time = np.arange(1500) * 0.01
    speed = 0.5 * np.sin(1.3 * time + seed) * (1.0 + 0.5 * np.sin(0.2 * time))
    force = force_of(speed) + 0.01 * rng.normal(size=time.size)
    channels = {"speed": (speed, "m/s"), "force": (force, "N")}
    return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))


def said(force_of):
    graph, options = slider(), Options(library=LIBRARY)
    run, other = (recorded(graph, force_of, seed) for seed in (1, 2))
    return diagnose(graph, [run], held_out=[other], options=options)


def eddies(speed):
    """Return the force of an eddy-current brake: beyond 0.2 m/s it grows weaker."""
    return 8.0 * speed / (1.0 + (speed / 0.2) ** 2)


def test_a_relation_far_from_every_law_is_told_as_a_curve():
    found = said(eddies)
    assert found.verdict is Verdict.UNEXPLAINED
    (curve,) = found.findings
    assert (curve.physics, curve.place) == ("unknown_relation", "cart")
    assert "comes nearest" in curve.statement
    # Drawn as finely as any curve that is chosen, from few knots while it competed.
    assert len(curve.estimates) > 8
    # What is proportional is the damper's alone: no share of it is left to chance.
    assert found.fit_after.unidentifiable == ()
    damper = next(one for one in found.fit_after.estimates if one.name == "damper")
    assert damper.std < 0.2 * damper.value


def test_a_law_that_comes_near_is_doubted_beside_a_curve():
    # A damper of a root of the speed, which dry friction comes near to.
    found = said(lambda speed: 3.0 * np.sign(speed) * np.abs(speed) ** 0.2)
    (rub,) = found.findings
    assert rub.physics == "coulomb_friction"
    assert rub.probability < 0.65
    assert "comes near to what is there" in rub.statement
    assert "unknown_relation" in [one.physics for one in rub.alternatives]


@pytest.mark.long
def test_a_curve_of_a_speed_leaves_no_other_law_of_that_speed_there():
    found = said(lambda speed: 3.0 * np.sign(speed) * np.abs(speed) ** 0.3)
    (curve,) = found.findings
    assert curve.physics == "unknown_relation"
    assert curve.probability > 0.8


def test_a_curve_told_for_how_it_is_drawn_is_as_sure_as_it_is_drawn(monkeypatch):
    # With few knots it leaves more than the law that it takes the place of.
    beside, pairs = [], searched.or_two

    def seen(setting, *rest):
        beside.extend(one.physics for one in setting.found)
        return pairs(setting, *rest)

    monkeypatch.setattr(searched, "or_two", seen)

    def dented(speed):
        dent = np.exp(-(((np.abs(speed) - 0.3) / 0.08) ** 2))
        return 3.0 * speed * np.abs(speed) * (1.0 - 0.5 * dent)

    found = said(dented)
    (curve,) = found.findings
    assert curve.physics == "unknown_relation"
    assert curve.probability > 0.7
    # Nor were there any two laws to try beside that one first.
    assert "quadratic_drag" not in beside


def test_a_law_that_a_curve_mends_is_told_to_be_a_piece_of_it(monkeypatch):
    def told():
        (found,) = said(lambda speed: 3.0 * speed * np.abs(speed)).findings
        assert found.physics == "quadratic_drag"
        return found

    alone, piece = told(), "may be one relation"
    assert piece not in alone.statement
    monkeypatch.setattr(found_there, "one_relation", lambda _: SimpleNamespace(index=0))
    mended = told()
    assert piece in mended.statement
    assert mended.probability == pytest.approx(0.5 * alone.probability)


def test_a_law_that_is_found_twice_at_one_place_is_doubted(monkeypatch):
    (alone,) = said(lambda speed: 3.0 * speed * np.abs(speed)).findings
    # As if a later round had found the same once more.
    monkeypatch.setattr(found_there, "Counter", lambda laws: dict.fromkeys(laws, 2))
    (twice,) = said(lambda speed: 3.0 * speed * np.abs(speed)).findings
    assert "It is said twice of one place" in twice.statement
    assert twice.probability == pytest.approx(0.5 * alone.probability)


@pytest.mark.parametrize("drag", [0.0, 3.0])
def test_what_named_laws_explain_needs_no_curve(drag):
    found = said(
        lambda speed: 1.5 * speed + 0.4 * np.sign(speed) + drag * speed * np.abs(speed)
    )
    assert {one.physics for one in found.findings} <= {
        "coulomb_friction",
        "quadratic_drag",
    }
    assert "comes near" not in " ".join(one.statement for one in found.findings)
    assert all(one.probability > 0.7 for one in found.findings)


def rounds_of(first, curve, second):
    """Return two rounds; the curve was judged in the first and not chosen."""
    return [
        Round(None, judged=(first, curve), chosen=first),
        Round(None, judged=(second,), chosen=second),
    ]


@pytest.mark.parametrize(
    ("physics", "laws_leave", "few_leave", "curve_leaves", "told"),
    [
        ("sensor_nonlinearity", 0.97, 0.99, 0.1, True),
        ("sensor_nonlinearity", 0.97, 0.99, 0.8, False),
        ("sensor_nonlinearity", 0.5, 0.9, 0.1, False),
        ("coulomb_friction", 0.97, 0.9, 0.1, True),
        ("coulomb_friction", 0.97, 0.9, 0.3, False),
        ("coulomb_friction", 0.97, 0.99, 0.1, False),
    ],
    ids=[
        "all there is", "leaves much itself", "laws leave noise",
        "all there is of a friction", "a real friction", "out of reach of a friction",
    ],
)  # fmt: skip
def test_a_curve_that_leaves_noise_alone_is_told_though_few_knots_left_as_much(
    monkeypatch, physics, laws_leave, few_leave, curve_leaves, told
):
    law = judged(0.02, physics=physics, place="outlet")
    rough = judged(0.021, physics=CURVE, place="film", complexity=4)
    fine = judged(0.001, physics=CURVE, place="film", complexity=30)
    rounds = [Round("first", judged=(law, rough), chosen=law), Round("last")]
    left = {
        "last": laws_leave,
        id(rough.candidate.fitted): few_leave,
        id(fine.candidate.fitted): curve_leaves,
    }
    for name, stand_in in {
        "explainable": lambda fit, _: left.get(id(fit), left["last"]),
        "left_out_errors": lambda *_: law.errors,
        "drawn_as_near": lambda _, __, judged, ___: (
            [(rough, fine)] if rough in judged else []
        ),
        "clearly_better": lambda *_: True,
    }.items():
        monkeypatch.setattr(curve_beside, name, stand_in)
    monkeypatch.setattr(curve_beside.Bench, "of", lambda *_: None)
    found = told_if_fine(rounds, np.zeros(1), Rule(), None)
    assert (found is not None and found.curve is rough) == told


def test_a_curve_found_elsewhere_does_not_hide_a_better_one():
    first = judged(0.15, physics="dead_zone", place="pump")
    curve = judged(0.01, physics=CURVE, place="pump", complexity=6)
    elsewhere = judged(0.1, physics=CURVE, place="pipe", complexity=8)
    better = better_curve(rounds_of(first, curve, elsewhere), Rule())
    assert better.curve is curve
    assert better.times == pytest.approx(10.0, rel=0.05)
    there = judged(0.1, physics=CURVE, place="pump", complexity=8)
    assert better_curve(rounds_of(first, curve, there), Rule()) is None


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        # Comes near; what follows mends its shape and still leaves thrice the curve's.
        (0.15, 0.03, True),
        # Two laws that are both there leave as little as the curve, or little more.
        (0.15, 0.016, False),
        # What leaves hardly anything is not told as a curve, whatever that leaves.
        (0.03, 0.025, False),
    ],
)
def test_laws_that_mend_the_shape_of_a_first_one_make_no_cause(first, second, told):
    one = judged(first, physics="coulomb_friction", place="shaft")
    curve = judged(0.01, physics=CURVE, place="shaft", complexity=6)
    two = judged(second, physics="sensor_nonlinearity", place="speed")
    gain = replace(two.gain, value=1.0 - second / first)
    better = better_curve(rounds_of(one, curve, replace(two, gain=gain)), Rule())
    assert (better is not None and better.is_told) is told


def test_one_relation_is_likelier_than_three_laws_that_leave_as_much():
    one = judged(0.15, physics="overflow", place="shaft")
    curve = judged(0.01, physics=CURVE, place="shaft", complexity=6)
    two, three = (
        replace(law, gain=replace(law.gain, value=gain))
        for law, gain in (
            (judged(0.03, physics="coulomb_friction", place="shaft"), 0.8),
            (judged(0.004, physics="sensor_nonlinearity", place="speed"), 0.87),
        )
    )
    rounds = rounds_of(one, curve, two)
    less = Round(None, judged=(three,), chosen=three)
    assert told_instead([*rounds, less], Rule()) is None
    as_much = judged(0.008, physics="sensor_nonlinearity", place="speed")
    as_much = replace(as_much, gain=replace(as_much.gain, value=0.73))
    three_laws = [*rounds, replace(less, chosen=as_much)]
    assert better_curve(three_laws, Rule()) is None
    assert told_instead(three_laws, Rule()).curve is curve
    # Where few samples were read a curve follows them, whatever they are of.
    few = judged(0.01, physics=CURVE, place="shaft", complexity=6, samples=59)
    assert told_instead([rounds_of(one, few, two)[0], *three_laws[1:]], Rule()) is None
    # A machine that rubs, and has a ripple and a spring besides, keeps their names.
    rubs = judged(0.04, physics="coulomb_friction", place="shaft")
    assert not told_instead(
        [Round(None, judged=(rubs, curve), chosen=rubs), *three_laws[1:]], Rule()
    )


def test_the_better_a_curve_the_less_need_a_law_leave():
    # Friction of a real machine is not all dry, and is called so for all that.
    for physics, left, told in (
        ("saturation", 0.004, True),
        ("saturation", 0.009, False),
        ("coulomb_friction", 0.004, False),
    ):
        first = judged(0.03, physics=physics, place="bus")
        curve = judged(left, physics=CURVE, place="bus", complexity=6)
        rounds = [Round(None, judged=(first, curve), chosen=first)]
        assert better_curve(rounds, Rule()).is_told is told


def test_a_curve_is_compared_however_the_data_were_dealt_later(monkeypatch):
    first = judged(0.15, physics="dead_zone", place="pump")
    curve = judged(0.01, physics=CURVE, place="pump", complexity=6)
    last = judged(0.1, physics="drag", place="pipe")
    halved = last.errors.chunks.reshape(-1, 2).sum(axis=1)
    later = replace(last, errors=replace(last.errors, chunks=halved))
    asked = []

    def dealt(fitted, chunks):
        asked.append(chunks)
        return last.errors

    monkeypatch.setattr(curve_beside, "left_out_errors", dealt)
    better = better_curve(rounds_of(first, curve, later), Rule())
    assert asked == [curve.errors.chunks.size]
    assert better.times == pytest.approx(10.0, rel=0.05)


def test_a_curve_begins_as_the_best_law_of_its_own_variable():
    base = fit_model(slider(), [recorded(slider(), eddies, 1)], FitSettings())
    laws = [proposed(base, one) for one in (CoulombFriction(), DahlHysteresis())]
    added = [fitted_with(base, base, [law], law.starts[-1]) for law in laws]
    candidates = [Candidate(*one, 1) for one in zip(laws, added, strict=True)]
    rule, nothing = Rule(), np.zeros(1)
    with workshop(Here(), Journal(), lambda _: None) as shop:
        bench = Bench.of(base, shop, "round 1")
        seen = judge_all(
            bench, candidates, 1.0, rule, nothing, lambda *_: None, Verdicts()
        )
        # Of hysteresis, whatever it explains, there is no curve of one variable.
        seen = replace(seen, chosen=seen.judged[-1])
        drawn = with_curve_drawn(bench, seen, 1.0, rule, nothing)
        again = with_curve_drawn(bench, replace(seen, judged=drawn), 1.0, rule, nothing)
        *before, curve = drawn
        # A curve that leaves more than the law has not come so far from where it began.
        behind = replace(curve, candidate=replace(curve.candidate, fitted=base))
        stuck = replace(seen, judged=(*before, behind))
        begun = with_curve_drawn(bench, stuck, 1.0, rule, nothing)
    assert tuple(before) == seen.judged
    assert (curve.physics, curve.place) == (CURVE, "cart")
    assert curve.gain.value > 0.99 > max(one.gain.value for one in before)
    assert again == drawn
    assert begun[:-1] == (*before, behind)
    assert begun[-1].candidate.cost == pytest.approx(curve.candidate.cost)


def test_a_curve_goes_over_the_range_that_a_law_goes_through(monkeypatch):
    base = fit_model(slider(), [recorded(slider(), eddies, 1)], FitSettings())
    law = proposed(base, CoulombFriction())
    added = fitted_with(base, base, [law], law.starts[-1])
    x, y = law_curve(added, Candidate(law, added, 1), "flow")
    usual = next(UnknownRelation().propose(place_of(base))).visited
    assert usual == pytest.approx((x.min(), x.max()), rel=0.01)
    with workshop(Here(), Journal(), lambda _: None) as shop:
        bench = Bench.of(base, shop, "round 1")
        seen = judge_all(
            bench, [Candidate(law, added, 1)], 1.0, Rule(), np.zeros(1),
            lambda *_: None, Verdicts(),
        )  # fmt: skip
        seen = replace(seen, chosen=seen.judged[0])
        known = with_curve_drawn(bench, seen, 1.0, Rule(), np.zeros(1))
        monkeypatch.setattr(curve_from_law, "law_curve", lambda *_: (3.0 * x, y))
        seen = replace(seen, judged=known)
        *_, curve = with_curve_drawn(bench, seen, 1.0, Rule(), np.zeros(1))
    assert curve.candidate.hypothesis.visited == pytest.approx((3 * x[0], 3 * x[-1]))
