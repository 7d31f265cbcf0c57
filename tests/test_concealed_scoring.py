"""Scores of concealed cases: what counts as right, wrong, silent or a false alarm."""

import numpy as np
import pytest

from benchmarks.concealed.accepted import OUTSIDE, WORDS
from benchmarks.concealed.board import board
from benchmarks.concealed.machines import MACHINES
from benchmarks.concealed.pictures import draw
from benchmarks.concealed.reduced import CONCEALED, EMPTY, FLOOR, Reduced, reduced_cases
from benchmarks.concealed.reporting import markdown
from benchmarks.concealed.scoring import Outcome, score_case
from benchmarks.concealed.shares import wilson


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


def finding(physics, place, also=(), alternatives=(), probability=None):
    return {
        "physics": physics,
        "place": place,
        "indistinguishable_places": list(also),
        "alternatives": list(alternatives),
        "probability": probability,
    }


def other(physics, place="load", support="supported"):
    return {"physics": physics, "place": place, "support": support}


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
            finding("stribeck_friction", "load", alternatives=[other(DRY)]),
            Outcome.RIGHT,
        ),
        (
            finding("lag", "theta", alternatives=[other(DRY)]),
            Outcome.RIGHT,
        ),
        (
            finding("stribeck_friction", "load", alternatives=[other(DRY, "motor")]),
            Outcome.PLACE_ONLY,
        ),
        (
            finding("spring", "load", alternatives=[other(DRY, support="refuted")]),
            Outcome.PLACE_ONLY,
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


def test_one_finding_does_not_answer_for_two_effects():
    two = truth(effect(), effect("stribeck_friction"))
    one = finding(DRY, "load", alternatives=[other("stribeck_friction")])
    assert score_case(two, answer(MISSING, one), 1.0).outcome is Outcome.PARTLY


def test_what_an_answer_names_is_counted():
    wide = finding(DRY, "load", also=["motor"], alternatives=[other("spring", "x")])
    assert score_case(truth(effect()), answer(MISSING, wide), 1.0).breadth == 3


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
    assert numbers["strong"]["confidently wrong"]["share"] == 0.5
    assert numbers["weak"]["outcomes"] == {"missed": 1}
    assert numbers["empty_cases"]["false alarms"]["share"] == 0.0
    assert numbers["empty_cases"]["false alarms"]["trials"] == 1
    assert numbers["empty_cases"]["no answer"]["successes"] == 1
    assert numbers["seconds"]["sum"] == 8.0
    assert numbers["confusion"] == {DRY: {DRY: 1, "lag": 1, "adequate": 1}}


def test_laws_outside_the_library_are_accepted_as_unknown():
    for law in OUTSIDE:
        assert "unknown_relation" in WORDS[law][0]


def test_calibration_holds_stated_probabilities_against_what_is_right():
    sure = finding(DRY, "load", probability=0.97)
    unsure = finding("spring", "load", probability=0.6)
    cases = [
        score_case(truth(effect()), answer(MISSING, said), 1.0)
        for said in (sure, sure, unsure, finding("spring", "x", probability=0.97))
    ]
    found = board(cases)["calibration"]
    rows = {row["from"]: row["right"] for row in found["rows"]}
    assert (rows[0.95]["successes"], rows[0.95]["trials"]) == (2, 3)
    assert (rows[0.5]["successes"], rows[0.5]["trials"]) == (0, 1)
    brier = (2 * 0.03**2 + 0.6**2 + 0.97**2) / 4
    assert found["brier"] == pytest.approx(brier)


def curved(x, y, *, absorbed):
    shape = {"argument": "flow", "x": list(x), "y": list(y)}
    shape["linear_part_is_absorbed"] = absorbed
    return truth(effect("unknown_relation", outside=True, curve=shape))


def drawn(x, y, unit="m/s"):
    said = answer("physics_missing", finding("unknown_relation", "load"))
    law = {"place": "load", "argument": {"unit": unit}, "curve": [list(x), list(y)]}
    return {**said, "recovered": [law]}


@pytest.mark.parametrize(
    ("absorbed", "wrong", "error"),
    [(False, 0.05, 0.05), (True, 0.05, 0.05), (False, -0.3, 0.3)],
)
def test_a_curve_is_compared_over_the_range_visited(absorbed, wrong, error):
    x = np.linspace(-2, 2, 61)
    y = np.sin(3 * x)
    case = curved(x, y, absorbed=absorbed)
    said = drawn(x, (1 + wrong) * y)
    assert score_case(case, said, 1.0).curve_error == pytest.approx(error)


def test_what_a_free_damper_takes_is_no_error_of_a_curve():
    x = np.linspace(-2, 2, 61)
    bent, straight = np.sign(x), 0.7 * x
    said = drawn(x, bent - straight)
    assert score_case(curved(x, bent, absorbed=True), said, 1.0).curve_error < 1e-12
    assert score_case(curved(x, bent, absorbed=False), said, 1.0).curve_error > 0.5


def test_a_curve_must_cover_the_range_and_the_same_argument():
    x = np.linspace(-2, 2, 61)
    case = curved(x, x**3, absorbed=False)
    half = drawn(x[:30], x[:30] ** 3)
    assert score_case(case, half, 1.0).curve_error == np.inf
    assert score_case(case, drawn(x, x**3, unit="m"), 1.0).curve_error is None


def test_the_page_and_its_pictures_are_written(tmp_path):
    said = answer(MISSING, finding(DRY, "load", probability=0.9))
    scored = [score_case(truth(effect()), said, 2.0)]
    scored.append(score_case(truth(strength=0.0), answer("adequate"), 1.0))
    numbers = board(scored)
    draw(numbers, tmp_path)
    page = markdown(scored, numbers)
    assert "| both | 100 % | 21 % to 100 % | 1 |" in page
    assert "| 80 to 95 % | 90 % | 100 % |" in page
    for name in ("power", "reliability", "confusion"):
        assert (tmp_path / f"{name}.svg").read_text("utf-8").startswith("<?xml")
        assert (tmp_path / f"{name}.png").stat().st_size > 1000


def reduced(*, right, quiet=3, late=0):
    said = answer(MISSING, finding(DRY, "load"))
    scored = [score_case(truth(effect()), said, 1.0) for _ in range(right)]
    missed = len(CONCEALED) - right - late
    scored += [score_case(truth(effect()), answer("adequate"), 1.0)] * missed
    scored += [score_case(truth(effect()), None, 1.0)] * late
    empty = truth(strength=0.0)
    scored += [score_case(empty, answer("adequate"), 1.0)] * quiet
    scored += [score_case(empty, said, 1.0)] * (len(EMPTY) - quiet)
    return Reduced(tuple(scored))


def test_the_floor_of_the_reduced_run():
    assert reduced(right=FLOOR).held
    assert not reduced(right=FLOOR - 1).held
    assert not reduced(right=len(CONCEALED), quiet=2).held
    assert not reduced(right=FLOOR, late=1).held
    assert not Reduced(reduced(right=FLOOR).scored[1:]).held
    assert "BROKEN" in str(reduced(right=0))


def test_the_reduced_cases_are_there():
    cases = reduced_cases()
    assert [len(case.sites) for case in cases] == [0, 0, 0, 1, 1, 1, 1, 1, 1]
    assert [case.sites[0].word for case in cases[3:]] == [w for _, w, _ in CONCEALED]


VOCABULARY = (
    "coulomb_friction stribeck_friction load_dependent_friction viscous_friction "
    "quadratic_drag gravity spring hardening_spring end_stop backlash compliance "
    "hysteresis added_inertia added_compliance constant_bias cogging delay lag "
    "saturation dead_zone leak overflow square_root_orifice saturating_inertia "
    "temperature_dependent_resistance voltage_drop sensor_scale sensor_bias "
    "sensor_nonlinearity unknown_relation"
).split()


@pytest.mark.parametrize("word", VOCABULARY)
def test_every_word_is_concealed_on_two_machines(word):
    """Where a base model's own parameter takes it, it does not count."""
    machines = {
        machine.name
        for machine in MACHINES.values()
        for site in machine.sites
        if not site.silent and word in WORDS.get(site.law, ((site.word,), ""))[0]
    }
    assert len(machines) >= 2
