"""Scores of concealed cases: what counts as right, wrong, silent or a false alarm."""

import pytest

from benchmarks.concealed.accepted import OUTSIDE, WORDS
from benchmarks.concealed.scoring import (
    Outcome,
    board,
    score_case,
    wilson,
)


def effect(physics="coulomb_friction", place="load", **changes):
    accepted = [{"words": [physics], "places": [place, "J_load"], "reason": ""}]
    return {
        "physics": physics,
        "law": physics,
        "place": place,
        "silent": False,
        "outside": False,
        "accepted": accepted,
        **changes,
    }


def truth(*effects, strength=8.0):
    return {
        "case": "dev_000",
        "machine": "two_mass_drive",
        "effect_over_noise": strength,
        "achievable_held_out_rmse": {"theta": 1.0},
        "effects": list(effects),
    }


def finding(physics, place, also=(), alternatives=()):
    return {
        "physics": physics,
        "place": place,
        "indistinguishable_places": list(also),
        "alternatives": [{"physics": word} for word in alternatives],
    }


def answer(verdict, *findings, before=10.0, after=10.0):
    return {
        "verdict": verdict,
        "findings": list(findings),
        "fit": {
            "held_out": {
                "before": {"rmse": {"theta": before}},
                "after": {"rmse": {"theta": after}},
            }
        },
    }


MISSING = "physics_missing"
DRY = "coulomb_friction"


@pytest.mark.parametrize(
    ("said", "outcome"),
    [
        (finding(DRY, "load"), Outcome.RIGHT),
        (finding(DRY, "J_load"), Outcome.RIGHT),
        (finding(DRY, "motor", also=["load"]), Outcome.RIGHT),
        (
            finding("stribeck_friction", "load", alternatives=[DRY]),
            Outcome.RIGHT,
        ),
        (finding("stribeck_friction", "load"), Outcome.PLACE_ONLY),
        (finding(DRY, "motor"), Outcome.PHYSICS_ONLY),
        (finding("spring", "motor"), Outcome.WRONG),
        (finding("unknown_relation", "load"), Outcome.UNEXPLAINED),
    ],
)
def test_a_finding_is_held_against_the_effect(said, outcome):
    assert score_case(truth(effect()), answer(MISSING, said), 1.0).outcome is outcome


@pytest.mark.parametrize(
    ("verdict", "outcome"),
    [
        ("adequate", Outcome.MISSED),
        ("cannot_tell", Outcome.CANNOT_TELL),
        ("unexplained", Outcome.UNEXPLAINED),
    ],
)
def test_silence_about_an_effect_is_not_called_wrong(verdict, outcome):
    assert score_case(truth(effect()), answer(verdict), 1.0).outcome is outcome


@pytest.mark.parametrize("concealed", [(), (effect(silent=True),)])
def test_anything_said_of_an_empty_case_is_a_false_alarm(concealed):
    empty = truth(*concealed, strength=0.0)
    outcomes = {
        verdict: score_case(empty, answer(verdict), 1.0).outcome
        for verdict in ("adequate", "cannot_tell", "unexplained", MISSING)
    }
    assert outcomes == {
        "adequate": Outcome.QUIET,
        "cannot_tell": Outcome.UNSURE,
        "unexplained": Outcome.FALSE_ALARM,
        MISSING: Outcome.FALSE_ALARM,
    }


def test_of_two_effects_both_must_be_found():
    both = truth(effect(), effect("backlash", "twist"))
    one = finding(DRY, "load")
    other = finding("backlash", "twist")
    assert score_case(both, answer(MISSING, one), 1.0).outcome is Outcome.PARTLY
    full = score_case(both, answer(MISSING, one, other), 1.0)
    assert (full.outcome, full.spurious) == (Outcome.RIGHT, 0)


def test_a_finding_beside_the_right_one_is_counted_as_spurious():
    said = answer(MISSING, finding(DRY, "load"), finding("spring", "motor"))
    scored = score_case(truth(effect()), said, 1.0)
    assert (scored.outcome, scored.spurious) == (Outcome.RIGHT, 1)


def test_outside_the_library_a_curve_at_the_place_is_right():
    odd = effect("unknown_relation", "load", outside=True)
    curve = finding("unknown_relation", "load")
    elsewhere = finding("unknown_relation", "motor")
    assert score_case(truth(odd), answer("unexplained", curve), 1).outcome is (
        Outcome.RIGHT
    )
    assert score_case(truth(odd), answer("unexplained", elsewhere), 1).outcome is (
        Outcome.UNEXPLAINED
    )


def test_no_answer_is_neither_right_nor_wrong():
    assert score_case(truth(effect()), None, 180.0).outcome is Outcome.NO_ANSWER


@pytest.mark.parametrize(
    ("after", "share"), [(1.0, 1.0), (10.0, 0.0), (5.5, 0.5), (19.0, -1.0)]
)
def test_the_achieved_share_is_of_what_noise_leaves_to_achieve(after, share):
    said = answer(MISSING, finding(DRY, "load"), after=after)
    assert score_case(truth(effect()), said, 1.0).achieved == pytest.approx(share)


def test_nothing_can_be_achieved_where_the_base_model_is_at_the_noise():
    said = answer(MISSING, finding(DRY, "load"), before=1.2, after=1.0)
    assert score_case(truth(effect()), said, 1.0).achieved is None


def test_wilson_intervals_as_published():
    """Wilson 1927; the values are those of Newcombe 1998, Table I, method 3."""
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert wilson(15, 148) == pytest.approx((0.0624, 0.1605), abs=5e-5)
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=5e-5)
    assert wilson(1, 29) == pytest.approx((0.0061, 0.1718), abs=5e-5)


def test_the_board_counts_weak_strong_outside_and_empty_apart():
    right = score_case(truth(effect()), answer(MISSING, finding(DRY, "load")), 2.0)
    wrong = score_case(truth(effect()), answer(MISSING, finding("lag", "x")), 4.0)
    weak = score_case(truth(effect(), strength=0.5), answer("adequate"), 1.0)
    quiet = score_case(truth(strength=0.0), answer("adequate"), 1.0)
    late = score_case(truth(strength=0.0), None, 0.0)
    numbers = board([right, wrong, weak, quiet, late])
    assert numbers["strong"]["both"]["trials"] == 2
    assert numbers["strong"]["both"]["share"] == 0.5
    assert numbers["strong"]["confidently_wrong"]["share"] == 0.5
    assert numbers["weak"]["outcomes"] == {"missed": 1}
    assert numbers["empty_cases"]["false_alarms"]["share"] == 0.0
    assert numbers["empty_cases"]["false_alarms"]["trials"] == 1
    assert numbers["empty_cases"]["no_answer"]["successes"] == 1
    assert numbers["seconds"]["sum"] == 8.0
    assert numbers["confusion"] == {DRY: {DRY: 1, "lag": 1, "adequate": 1}}


def test_laws_outside_the_library_are_accepted_as_unknown():
    for law in OUTSIDE:
        assert "unknown_relation" in WORDS[law][0]
