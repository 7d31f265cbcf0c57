"""A law that explains little of a large error is not called the cause."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from handmade_diagnosis import cart_diagnosis
from judged_candidates import judged

from bondgraph.diagnosis.adequacy.records import Adequacy, AdequacyStatus
from bondgraph.diagnosis.answer import left_open
from bondgraph.diagnosis.answer.carrying import Shown, worse_held_out
from bondgraph.diagnosis.answer.doubt import doubted
from bondgraph.diagnosis.answer.notes import notes_on
from bondgraph.diagnosis.answer.telling import left_of_whole
from bondgraph.diagnosis.answer.verdict import (
    hardly_believed,
    verdict_of,
    without_size,
)
from bondgraph.diagnosis.answer.wording import next_experiment
from bondgraph.diagnosis.candidates import CURVE, Rejected
from bondgraph.diagnosis.evidence.leftover import excusable
from bondgraph.diagnosis.records import Support, Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.recordings.binding import bind
from bondgraph.recordings.recording import Recording


@pytest.mark.parametrize(
    ("remaining", "verdict"),
    [
        (0.0, Verdict.PHYSICS_MISSING),
        (0.2, Verdict.PHYSICS_MISSING),
        (0.8, Verdict.UNEXPLAINED),
    ],
)
def test_what_explains_less_than_half_is_not_the_cause(remaining, verdict):
    findings = cart_diagnosis().findings
    answer, statement = verdict_of(findings, None, {}, Round(None), remaining)
    assert answer is verdict
    assert findings[0].statement in statement
    assert ("only 20 %" in statement) == (verdict is Verdict.UNEXPLAINED)
    doubt = "20 % of the error on left-out data remains: something is missing beside it"
    assert (doubt in statement) == (remaining == 0.2)
    assert ("or it only comes near" in statement) == (remaining == 0.2)


def _found(*estimates):
    finding = cart_diagnosis().findings[0]
    some = finding.estimates[0]
    told = tuple(replace(some, value=value, std=std) for value, std in estimates)
    return replace(finding, estimates=told)


def test_a_law_without_a_single_known_number_is_not_relied_on():
    known, hollow = _found((2.0, 0.1), (0.3, None)), _found((2.0, 30.0), (0.3, None))
    missing = Verdict.PHYSICS_MISSING
    assert without_size(missing, "Found.", [known]) == (missing, "Found.")
    verdict, statement = without_size(missing, "Found.", [hollow, known])
    assert verdict is Verdict.UNEXPLAINED
    assert "do not rely on it" in statement
    # A later one says so and leaves the first what it is.
    verdict, statement = without_size(missing, "Found.", [known, hollow])
    assert verdict is missing
    assert "determine no number of" in statement
    # Two channels swapped have no number to be known.
    assert without_size(missing, "Found.", [_found()]) == (missing, "Found.")


def _recorded(values):
    time = np.arange(len(values)) * 0.01
    recording = Recording.from_arrays("slow", time, {"x": (values, "m")})
    return bind(recording, {}, {"x": "m"})


def test_white_noise_and_half_a_quantisation_step_are_excused():
    slow = np.sin(np.arange(4000) * 0.002)
    noisy = slow + 1e-3 * np.random.default_rng(0).standard_normal(4000)
    assert excusable([_recorded(noisy)])[0] == pytest.approx(1e-3, rel=0.1)
    stepped = np.round(slow / 0.02) * 0.02
    assert excusable([_recorded(stepped)])[0] == pytest.approx(0.01, rel=0.05)


@pytest.mark.parametrize(
    ("size", "verdict"), [(0.05, Verdict.ADEQUATE), (0.4, Verdict.CANNOT_TELL)]
)
def test_coloured_noise_as_large_as_the_motion_is_not_called_noise(size, verdict):
    moves = np.sin(np.arange(4000) * 0.01)[:, None]
    base = SimpleNamespace(
        residuals=lambda: size * np.cos(np.arange(4000) * 0.003)[:, None],
        problem=SimpleNamespace(
            model=SimpleNamespace(output_names=("x",)),
            shots=SimpleNamespace(outputs=moves),
        ),
    )
    coloured = _checked(AdequacyStatus.COLOURED)
    answer, statement = verdict_of([], base, {"x": 1e-3}, Round(None), 1.0, coloured)
    assert answer is verdict
    assert ("not recorded" in statement) == (verdict is Verdict.CANNOT_TELL)


@pytest.mark.parametrize(
    ("p_value", "residual", "verdict"),
    [
        (0.3, 0.05, Verdict.ADEQUATE),
        (0.04, 0.05, Verdict.CANNOT_TELL),
        (0.04, 0.012, Verdict.ADEQUATE),
    ],
)
def test_what_noise_makes_only_now_and_then_is_not_called_noise(
    p_value, residual, verdict
):
    checked = _checked(AdequacyStatus.COLOURED, p_value=p_value)
    base = _leaving(residual)
    answer, statement = verdict_of([], base, {"x": 0.01}, Round(None), 1.0, checked)
    assert answer is verdict
    assert ("4 of 100 recordings only" in statement) == (verdict is Verdict.CANNOT_TELL)


def _checked(status, *dependences, p_value=0.4):
    return Adequacy(
        status=status,
        p_value=p_value,
        level=0.01,
        draws=100,
        outputs=(),
        dependences=dependences,
        unconverged=0.0,
        reasons=(),
    )


def _leaving(residual):
    return SimpleNamespace(
        residuals=lambda: np.full((400, 1), residual),
        problem=SimpleNamespace(
            model=SimpleNamespace(output_names=("x",)),
            shots=SimpleNamespace(outputs=np.sin(np.arange(400))[:, None]),
        ),
    )


@pytest.mark.parametrize(
    ("share", "verdict"), [(0.35, Verdict.UNEXPLAINED), (0.08, Verdict.CANNOT_TELL)]
)
def test_a_large_residual_that_hardly_follows_the_machine_may_be_noise(share, verdict):
    follows = SimpleNamespace(share=share, variable="flow", place="wall")
    checked = _checked(AdequacyStatus.STRUCTURE, follows)
    tried = Round(None, tried=30)
    answer, statement = verdict_of([], _leaving(4.0), {"x": 1.0}, tried, 1.0, checked)
    assert answer is verdict
    assert "4.0 times" in statement
    hardly = "at most flow at wall (8 % of it). None of the 30" in statement
    assert hardly == (verdict is Verdict.CANNOT_TELL)


@pytest.mark.parametrize(
    ("share", "verdict"), [(0.35, Verdict.CANNOT_TELL), (0.01, Verdict.ADEQUATE)]
)
def test_what_follows_the_machine_is_not_nothing_however_near_the_noise(share, verdict):
    base = _leaving(2.0)
    follows = SimpleNamespace(share=share, variable="flow", place="wall")
    checked = _checked(AdequacyStatus.STRUCTURE, follows)
    tried = Round(None, tried=30)
    answer, statement = verdict_of([], base, {"x": 1.0}, tried, 1.0, checked)
    assert answer is verdict
    # What was not worth a search is within the noise.
    untried, _ = verdict_of([], base, {"x": 1.0}, Round(None), 1.0, checked)
    assert untried is Verdict.ADEQUATE
    follows = "follows flow at wall (35 % of it), and none of the 30" in statement
    assert follows == (verdict is Verdict.CANNOT_TELL)


def test_a_law_that_came_short_only_by_the_number_tried_is_not_nothing():
    noise = _checked(AdequacyStatus.ADEQUATE)
    base = _leaving(1.0)
    few = SimpleNamespace(value=0.7, std=0.12, p_value=0.002)
    near = replace(judged(0.3, Support.UNDECIDED, physics="overflow"), gain=few)
    seen = Round(None, tried=40, independent=12.0, judged=(near,))
    answer, statement = verdict_of([], base, {"x": 1.0}, seen, 1.0, noise)
    assert answer is Verdict.CANNOT_TELL
    assert "too few to decide: overflow at body would help" in statement
    by_chance = replace(near, gain=SimpleNamespace(value=0.7, std=0.4, p_value=0.05))
    seen = replace(seen, judged=(by_chance,))
    answer, _ = verdict_of([], base, {"x": 1.0}, seen, 1.0, noise)
    assert answer is Verdict.ADEQUATE


def _errors(before, after):
    return SimpleNamespace(
        before=SimpleNamespace(nrmse=before, rmse={"x": before}),
        after=SimpleNamespace(nrmse=after, rmse={"x": after}),
    )


@pytest.mark.parametrize(
    ("after", "left"), [(0.7, 0.0), (0.95, 0.95**2), (1.0, 1.0), (3.0, 1.0)]
)
def test_what_whole_training_recordings_keep_is_left(after, left):
    trained = _errors(1.0, after)
    assert left_of_whole(trained, {"x": 0.0}) == pytest.approx(left)


@pytest.mark.parametrize(("after", "left"), [(0.90, 0.0), (0.95, 0.0), (0.99, 0.9)])
def test_what_noise_leaves_of_a_recording_is_not_left_of_a_weak_effect(after, left):
    # Of a squared error of 1 noise makes 0.81, and an effect the rest.
    trained = _errors(1.0, after)
    kept = left_of_whole(trained, {"x": 0.9})
    assert kept == pytest.approx((after**2 - 0.81) / 0.19 if left else 0.0)
    assert left_of_whole(trained, {"x": 1.1}) == 0.0


@pytest.mark.parametrize(
    ("after", "verdict", "told"),
    [
        (0.10, Verdict.PHYSICS_MISSING, False),
        (0.22, Verdict.PHYSICS_MISSING, True),
        (0.50, Verdict.UNEXPLAINED, True),
    ],
)
def test_what_makes_held_out_data_worse_is_not_the_cause(after, verdict, told):
    shown = Shown(_errors(0.2, after), trained=_errors(0.2, 0.18))
    answer, statement = worse_held_out(Verdict.PHYSICS_MISSING, "Friction.", shown)
    assert answer is verdict
    assert ("does not carry over" in statement) == told


@pytest.mark.parametrize(
    ("held_out", "trained", "idle"),
    [
        (_errors(0.30, 0.299), _errors(0.1, 0.01), True),
        (_errors(0.30, 0.20), _errors(0.1, 0.01), False),
        (_errors(0.30, 0.299), _errors(0.1, 0.08), False),
        (_errors(0.02, 0.0199), _errors(0.1, 0.01), False),
    ],
)
def test_what_mends_only_what_it_was_fitted_to_is_not_the_cause(
    held_out, trained, idle
):
    # Held-out data that have no more than noise to explain say nothing against it.
    shown = Shown(held_out, trained)
    answer, statement = worse_held_out(Verdict.PHYSICS_MISSING, "A store.", shown)
    assert (answer is Verdict.UNEXPLAINED) == idle
    assert ("no better" in statement) == idle
    assert shown.carries_over == (not idle)
    # Over stretches it helps: a drive that turns freely is off in the long run.
    assert replace(shown, stretches=_errors(0.05, 0.004)).carries_over


@pytest.mark.parametrize(
    ("held_out", "trained", "partly"),
    [
        (_errors(0.30, 0.20), _errors(0.1, 0.005), True),
        (_errors(0.30, 0.14), _errors(0.1, 0.005), False),
        (_errors(0.30, 0.20), _errors(0.1, 0.02), False),
        # Hardly anything to explain, and nothing left of it.
        (_errors(0.012, 0.009), _errors(0.1, 0.005), False),
    ],
)
def test_what_keeps_half_of_the_held_out_error_alone_carries_over_in_part(
    held_out, trained, partly
):
    shown = Shown(held_out, trained)
    answer, statement = worse_held_out(Verdict.PHYSICS_MISSING, "A bias.", shown)
    assert answer is Verdict.PHYSICS_MISSING
    assert ("carries over in part only" in statement) == partly
    assert shown.stands == (not partly)
    assert replace(shown, left_open=True).stands


@pytest.mark.parametrize(("std", "speaks"), [(0.2, False), (0.1, True), (np.nan, True)])
def test_held_out_data_that_open_numbers_miss_as_far_say_nothing(
    monkeypatch, std, speaks
):
    shown = Shown(_errors(0.30, 0.299), trained=_errors(0.1, 0.01))
    monkeypatch.setattr(left_open, "prediction_std", lambda *_: {"x": std})
    # What mends held-out data is asked no more.
    mended = replace(shown, held_out=_errors(0.30, 0.20))
    assert not left_open.is_left_open(None, [], mended)
    open_there = left_open.is_left_open(None, [], shown)
    assert open_there == (not speaks)
    shown = replace(shown, left_open=open_there)
    answer, statement = worse_held_out(Verdict.PHYSICS_MISSING, "A lag.", shown)
    assert (answer is Verdict.UNEXPLAINED) == speaks
    assert ("tell nothing of it" in statement) == (not speaks)
    assert shown.carries_over == (not speaks)
    # What spoils them is not the cause, whatever is open.
    spoilt = replace(shown, held_out=_errors(0.3, 0.5), left_open=True)
    assert not spoilt.carries_over


def test_what_carries_over_in_stretches_is_not_held_to_whole_recordings():
    # One slip that is missed, and a drive that turns freely is off for good.
    shown = Shown(_errors(0.85, 0.846), _errors(0.33, 0.006), _errors(0.05, 0.004))
    found = Verdict.PHYSICS_MISSING, "Friction."
    answer, statement = worse_held_out(*found, shown)
    assert answer is Verdict.PHYSICS_MISSING
    assert "over stretches" in statement
    assert "(5 % became 0.4 %)" in statement
    shown = replace(shown, stretches=_errors(0.05, 0.049))
    answer, statement = worse_held_out(*found, shown)
    assert answer is Verdict.UNEXPLAINED


def test_a_curve_that_makes_held_out_data_worse_says_so_too():
    # It is no cause anyway, but its place would be believed.
    shown = Shown(_errors(0.2, 0.22), trained=_errors(0.2, 0.18))
    answer, statement = worse_held_out(Verdict.UNEXPLAINED, "A curve.", shown)
    assert answer is Verdict.UNEXPLAINED
    assert "does not carry over" in statement


@pytest.mark.parametrize("against", [{"carried": False}, {"within": False}], ids=str)
def test_what_does_not_carry_over_or_rests_on_bounds_is_believed_half(against):
    (finding, *_) = cart_diagnosis().findings
    sure = replace(finding, probability=0.8, statement="Friction was left out: some.")
    (told,) = doubted([sure], 0.0, **against)
    assert told.probability == pytest.approx(0.4)
    assert "may have been left out" in told.statement


@pytest.mark.parametrize(
    ("left", "believed"), [(0.005, 1.0), (0.04, 0.8), (0.36, 0.4), (3.0, 0.0)]
)
def test_what_remains_beside_findings_counts_against_each(left, believed):
    (finding, *_) = cart_diagnosis().findings
    both = [replace(finding, probability=stated) for stated in (0.8, None)]
    known, silent = doubted(both, left)
    assert known.probability == pytest.approx(believed * 0.8)
    assert silent.probability is None


def test_a_law_without_a_known_number_is_believed_half():
    known, hollow = _found((2.0, 0.1), (0.3, None)), _found((2.0, 30.0), (0.3, None))
    curve = replace(hollow, physics=CURVE)
    order = (known, curve, hollow, known)
    told = [replace(one, probability=0.8) for one in order]
    stated = [one.probability for one in doubted(told, 0.0)]
    # What is found after it is built on it.
    assert stated == pytest.approx([0.8, 0.8, 0.4, 0.4])


@pytest.mark.parametrize(
    ("sure", "verdict"), [(0.02, Verdict.CANNOT_TELL), (0.3, Verdict.PHYSICS_MISSING)]
)
def test_what_the_answer_itself_does_not_believe_is_not_told_as_found(sure, verdict):
    first, *_ = cart_diagnosis().findings
    found = [replace(first, probability=sure)]
    answer, told = hardly_believed(Verdict.PHYSICS_MISSING, "Friction.", found)
    assert answer is verdict
    assert ("no more than a guess" in told) == (verdict is Verdict.CANNOT_TELL)


def test_a_law_that_was_found_is_not_told_as_left_aside_in_another_form():
    def law(place):
        return SimpleNamespace(
            physics="hardening_spring", place=place, contains=lambda other: False
        )

    chosen = SimpleNamespace(
        physics="hardening_spring",
        place="mass",
        candidate=SimpleNamespace(hypothesis=law("mass")),
    )
    others = tuple(Rejected(law(place), "not determined") for place in ("mass", "arm"))
    found = Round(SimpleNamespace(), judged=(chosen,), rejected=others, chosen=chosen)
    notes = notes_on([found], SimpleNamespace(unidentifiable=()), Options())
    assert notes == ("A hardening spring at arm was left aside: not determined",)


def test_a_law_that_was_chosen_again_is_not_told_as_taken_out():
    def law(place):
        return SimpleNamespace(
            physics="lag", place=place, contains=lambda other: False, parameters=()
        )

    def chose(place):
        hypothesis = law(place)
        chosen = SimpleNamespace(
            physics="lag",
            place=place,
            candidate=SimpleNamespace(hypothesis=hypothesis),
        )
        return Round(SimpleNamespace(), judged=(chosen,), chosen=chosen), hypothesis

    (first, lag), (other, elsewhere), (again, _) = map(chose, ("x", "y", "x"))
    again = replace(again, removed=(lag,))
    fit = SimpleNamespace(unidentifiable=())
    assert notes_on([first, again], fit, Options()) == ()
    again = replace(again, removed=(elsewhere,))
    (note,) = notes_on([other, again], fit, Options())
    assert note.startswith("Lag at y was added first and taken out again")


def test_laws_left_aside_for_one_reason_are_told_together():
    def aside(physics, place, reason):
        law = SimpleNamespace(physics=physics, place=place)
        return Rejected(law, reason)

    rejected = (
        aside("lag", "x", "not determined"),
        aside("delay", "x", "not determined"),
        aside("compliance", "arm", "nothing is left of it"),
    )
    rounds = [Round(SimpleNamespace(), rejected=rejected)] * 2
    notes = notes_on(rounds, SimpleNamespace(unidentifiable=()), Options())
    assert notes == (
        "Lag at x and delay at x were left aside: not determined",
        "Compliance at arm was left aside: nothing is left of it",
    )


def test_no_one_is_asked_to_vary_what_only_a_law_has():
    names = {"cart", "slide"}
    base = SimpleNamespace(graph=SimpleNamespace(has_place=names.__contains__))
    found = SimpleNamespace(
        physics="delay", element="late", place="cart", indistinguishable_places=()
    )

    def advice(*variables):
        law = SimpleNamespace(depends_on=variables)
        candidate = SimpleNamespace(hypothesis=law)
        close = SimpleNamespace(physics="lag", place="cart", candidate=candidate)
        return next_experiment([found], {"late": [close]}, base)

    told = advice("flow", "displacement(lagged_x)", "effort(slide)")
    assert told.endswith("depend on: flow at cart, effort at slide.")
    assert advice("displacement(lagged_x)") == ""
