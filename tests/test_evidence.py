"""Evidence: errors on left-out data against least squares by hand, and the decision."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from judged_candidates import (
    BASE,
    RULE,
    candidate,
    errors,
    judged,
    slider,
    with_residuals,
)
from scipy import stats
from scipy.signal import lfilter

from bondgraph import BondGraph, C, Recording, Sf, bind_to
from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence import left_out
from bondgraph.diagnosis.evidence.alternatives import alternatives_to, curves_as_good
from bondgraph.diagnosis.evidence.confidence import beyond_resampling, probability
from bondgraph.diagnosis.evidence.decision import (
    best_supported,
    with_plainer,
)
from bondgraph.diagnosis.evidence.gain import (
    MERE_SHAPE,
    Gain,
    beside_earlier,
    compare,
)
from bondgraph.diagnosis.evidence.judged import Judged, judge
from bondgraph.diagnosis.evidence.leads import alike, clearly_better
from bondgraph.diagnosis.evidence.left_out import (
    FOLDS,
    LeftOutErrors,
    chunk_count,
    chunk_labels,
    left_out_errors,
)
from bondgraph.diagnosis.evidence.surprise import LOST, surprise
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.trials.judging import decide
from bondgraph.diagnosis.search.trials.worth import LOST_FROM_THE_START
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import SHORTEST, Windows


def by_hand(speed, force, labels, chunks, scored, shown=0):
    """Least squares without each fold in turn; the squared errors on it."""
    totals = np.zeros(chunks)
    for fold in range(FOLDS):
        out = labels % FOLDS == fold
        train = ~out | (np.arange(len(speed)) < shown)
        rub = speed[train] @ force[train] / (speed[train] @ speed[train])
        squared = (force - rub * speed) ** 2 * (out & scored)
        totals += np.bincount(labels, weights=squared, minlength=chunks)
    return totals


def test_errors_left_out_are_those_of_least_squares_without_the_fold():
    fitted, speed, force = slider()
    labels = np.arange(600) * 12 // 600
    # The first samples are never hidden: the window's state has to come from there.
    expected = by_hand(speed, force, labels, 12, np.ones(600, bool), SHORTEST)
    found = left_out_errors(fitted, 12).chunks * fitted.problem.sigma[0] ** 2
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_whole_windows_left_out_are_scored_on_their_second_halves():
    fitted, speed, force = slider(horizon=Windows(50))
    assert fitted.problem.shots.n_windows == 12
    labels = np.repeat(np.arange(12), 50)
    second = np.arange(600) % 50 >= 25
    expected = by_hand(speed, force, labels, 12, second)
    found = left_out_errors(fitted, 12).chunks * fitted.problem.sigma[0] ** 2
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def charged(windows):
    """Return a fitted compliance whose state nobody knows but its own windows."""
    graph = BondGraph("spring", domain="translation")
    graph.zero("end", Sf("speed"), C("give"))
    graph.measure("force", effort="end")
    graph.parameter("give", 0.5, "m/N", bounds=(0.01, 10))
    random = np.random.default_rng(2)
    time = 0.01 * np.arange(400)
    speed = np.sin(7 * time) + 0.5 * np.sin(23 * time)
    stretch = 3.0 + np.concatenate([[0], np.cumsum((speed[1:] + speed[:-1]) * 0.005)])
    force = stretch / 0.4 + 1e-3 * random.standard_normal(400)
    channels = {"speed": (speed, "m/s"), "force": (force, "N")}
    recording = bind_to(graph.finish(), Recording.from_arrays("a", time, channels))
    return fit_model(graph.finish(), [recording], FitSettings(horizon=windows))


def test_the_states_that_were_fitted_count_as_fitted(monkeypatch):
    fitted = charged(Windows(40))
    told, original = [], left_out.surprise

    def watched(residuals, windows, unknowns):
        told.append(unknowns)
        return original(residuals, windows, unknowns)

    monkeypatch.setattr(left_out, "surprise", watched)
    left_out_errors(fitted, 10)
    # One parameter, and one state at the begin of each of ten windows.
    assert told == [11] * FOLDS


def test_a_window_that_was_left_out_gets_its_state_from_its_first_half():
    fitted = charged(Windows(40))
    assert fitted.problem.shots.n_windows == 10
    found = left_out_errors(fitted, 10).chunks * fitted.problem.sigma[0] ** 2
    # 20 scored samples each, of noise and the error of a state known from 20.
    np.testing.assert_allclose(found.sum(), 10 * 20 * 1e-6 * (1 + 1 / 20), rtol=0.25)


def test_a_model_that_cannot_be_simulated_has_finite_and_huge_errors(monkeypatch):
    fitted, _, _ = slider(60)
    nowhere = SimpleNamespace(residuals=np.full((60, 1), np.nan))
    monkeypatch.setattr(left_out, "linearise_windows", lambda *_: nowhere)
    assert (left_out_errors(fitted, 6).chunks == 1e13).all()


def test_chunks_are_several_correlation_times_long():
    random = np.random.default_rng(3)
    white = random.standard_normal((4000, 1))
    assert chunk_count(with_residuals(white)) == 24
    assert chunk_count(with_residuals(white, windows=30)) == 24
    slow = np.convolve(white[:, 0], np.ones(150), "same")[:, None]
    few = chunk_count(with_residuals(slow))
    assert 6 <= few < 24
    # The slowest of the outputs decides.
    assert chunk_count(with_residuals(np.hstack([white, slow]))) == few
    assert (
        chunk_count(with_residuals(np.convolve(white[:, 0], np.ones(2000))[:, None]))
        == 6
    )


def problem_of(sizes):
    edges = np.cumsum([0, *sizes])
    slices = [slice(a, b) for a, b in pairwise(edges)]
    shots = SimpleNamespace(
        n_windows=len(sizes),
        timeless=False,
        time=np.zeros(edges[-1]),
        slices=slices,
    )
    return SimpleNamespace(shots=shots)


def test_chunks_are_equal_parts_or_runs_of_whole_windows():
    np.testing.assert_array_equal(
        chunk_labels(problem_of([12]), 4), np.repeat([0, 1, 2, 3], 3)
    )
    np.testing.assert_array_equal(
        chunk_labels(problem_of([2, 3, 1, 4]), 2), [0] * 5 + [1] * 5
    )
    np.testing.assert_array_equal(chunk_labels(problem_of([1, 2]), 2), [0, 1, 1])


def test_a_gain_is_the_share_of_the_error_with_its_jackknife_error():
    before, after = errors(4, 5, 6, 5, 7, 3), errors(2, 4, 3, 3, 5, 1)
    gain = compare(before, after)
    assert gain.value == pytest.approx(1 - 18 / 30)
    left = np.array([1 - (18 - a) / (30 - b) for a, b in zip(
        after.chunks, before.chunks, strict=True)])  # fmt: skip
    std = np.sqrt(5 / 6 * ((left - left.mean()) ** 2).sum())
    assert gain.std == pytest.approx(std)
    of_sum = stats.t.sf(gain.value / std, 5)
    ratios = stats.ttest_1samp(np.log(before.chunks / after.chunks), 0).statistic
    of_ratios = stats.t.sf(ratios, 5)
    assert gain.p_value == pytest.approx(2 * min(of_sum, of_ratios), rel=1e-6)
    nats = np.array([3.0, 2.5, 2.9, 3.3]), np.array([2.0, 1.0, 2.1, 1.8])
    told = [
        LeftOutErrors(errors.chunks, surprise)
        for errors, surprise in zip((before, after), nats, strict=True)
    ]
    of_steps = stats.ttest_1samp(nats[0] - nats[1], 0, alternative="greater").pvalue
    three = 3 * min(of_sum, of_ratios, of_steps)
    assert compare(*told).p_value == pytest.approx(three, rel=1e-6)


def test_white_errors_surprise_by_their_size_and_coloured_ones_by_their_steps():
    random = np.random.default_rng(5)
    steps = 0.2 * random.standard_normal(20_000)
    whole = [slice(0, 20_000)]
    expected = 0.5 + np.log(0.2)
    white = surprise(steps[:, None], whole, 1)
    assert white[50:].mean() == pytest.approx(expected, abs=0.02)
    slow = lfilter([1.0], [1.0, -0.98], steps)
    assert surprise(slow[:, None], whole, 1)[50:].mean() == pytest.approx(
        expected, abs=0.02
    )
    both = surprise(np.column_stack([steps, slow]), whole, 1)
    np.testing.assert_allclose(both.mean(), 2 * white.mean(), rtol=0.02)
    # The first samples of a window have no past.
    assert (white[:5] == 0).all()
    parts = surprise(steps[:, None], [slice(0, 9_000), slice(9_000, 20_000)], 1)
    assert (parts[9_000:9_005] == 0).all()
    # Rows of a table, each a window of its own, need no past: all are scored.
    rows = [slice(i, i + 1) for i in range(len(steps))]
    assert surprise(steps[:, None], rows, 1).mean() == pytest.approx(expected, abs=0.02)
    assert (surprise(steps[:20, None], rows[:20], 1) != 0.0).all()
    assert (surprise(np.full((30, 1), np.nan), [slice(0, 30)], 1) == LOST).all()
    assert (surprise(np.zeros((30, 1)), [slice(0, 30)], 1) == 0).all()


def test_a_gain_of_nothing_and_a_gain_of_the_same_everywhere():
    assert compare(errors(0, 0, 0), errors(1, 2, 3)) == Gain(0.0, 0.0, 1.0)
    assert compare(errors(2, 2, 2), errors(2, 2, 2)) == Gain(0.0, 0.0, 1.0)
    assert compare(errors(2, 2, 2), errors(1, 1, 1)) == Gain(0.5, 0.0, 0.0)
    assert compare(errors(1, 1, 1), errors(2, 2, 2)).p_value == 1.0
    worse = compare(errors(1, 2, 3, 4), errors(2, 3, 5, 9))
    assert worse.value < 0
    assert worse.p_value == 1.0


@pytest.mark.parametrize(
    ("left", "spread", "tried", "support", "said"),
    [
        (0.5, 0.01, 10, Support.SUPPORTED, "reduces"),
        (0.89, 0.001, 1, Support.SUPPORTED, "reduces"),
        (0.91, 0.001, 1, Support.REFUTED, "too little"),
        (1.2, 0.01, 1, Support.REFUTED, "too little"),
        (0.7, 1.5, 1000, Support.UNDECIDED, "among 1000"),
        (0.95, 0.9, 1, Support.UNDECIDED, "could be nothing"),
    ],
)
def test_what_left_out_chunks_say_of_a_candidate(left, spread, tried, support, said):
    random = np.random.default_rng(4)
    after = LeftOutErrors(
        BASE.chunks * left * np.exp(spread * random.standard_normal(24))
    )
    after.chunks[:] *= left * BASE.chunks.sum() / after.chunks.sum()
    found = judge(candidate(), BASE, after, tried, RULE)
    assert (found.support, said in found.reason) == (support, True)
    assert found.gain.value == pytest.approx(1 - left)


def test_the_number_tried_counts_against_each():
    after = LeftOutErrors(BASE.chunks * (0.8 + 0.3 * np.cos(np.arange(24) * 5)))
    p_value = compare(BASE, after).p_value
    just = RULE.false_alarm_probability / p_value
    assert (
        judge(candidate(), BASE, after, 0.99 * just, RULE).support is Support.SUPPORTED
    )
    assert (
        judge(candidate(), BASE, after, 1.01 * just, RULE).support is Support.UNDECIDED
    )


def test_nothing_is_chosen_where_nothing_is_supported():
    assert best_supported([], RULE) is None
    assert best_supported([judged(0.3, Support.UNDECIDED)], RULE) is None


def test_the_better_of_two_as_simple_is_chosen_and_the_simpler_of_two_as_good():
    good, better = judged(0.5), judged(0.2, physics="spring")
    assert best_supported([good, better], RULE) is better
    wide = judged(0.195, physics="backlash", complexity=2)
    assert best_supported([wide, good, better], RULE) is better
    much = judged(0.05, physics="backlash", complexity=2)
    assert best_supported([much, better], RULE) is much


def test_simpler_and_simpler_laws_are_preferred_step_by_step():
    wide = judged(0.200, physics="backlash", complexity=3)
    middle = judged(0.208, physics="hysteresis", complexity=2)
    simple = judged(0.215, physics="spring")
    assert clearly_better(wide, simple, RULE)
    assert best_supported([wide, middle, simple], RULE) is simple
    assert best_supported([wide, simple], RULE) is wide


def test_a_law_of_another_output_comes_before_a_curve_that_leaves_that():
    curve = judged(0.2, physics=CURVE, complexity=6, by_output=(0.02, 0.4))
    same = judged(0.6, physics="spring", by_output=(0.3, 0.4))
    other = judged(0.65, by_output=(0.5, 0.1))
    assert best_supported([curve, same], RULE) is curve
    assert best_supported([curve, same, other], RULE) is other
    # What is little beside all that the curve leaves is no reason.
    little = judged(0.65, by_output=(9.5, 0.1))
    curve = judged(0.2, physics=CURVE, complexity=6, by_output=(9.0, 0.4))
    assert best_supported([curve, little], RULE) is curve


def test_a_bent_sensor_is_not_told_from_a_curve_elsewhere_that_does_better():
    sensor = judged(0.1, physics="sensor_nonlinearity", place="temperature")
    better = judged(0.02, physics=CURVE, complexity=6, place="loss")
    worse = judged(0.3, physics=CURVE, complexity=6, place="store")
    assert curves_as_good(sensor, [sensor, better, worse], RULE) == (better,)
    # Another law at another place has its own evidence.
    drag = judged(0.1, place="body")
    assert curves_as_good(drag, [drag, better], RULE) == ()


def test_a_curve_is_not_told_from_one_elsewhere_that_does_as_well():
    chosen = judged(0.1, physics=CURVE, complexity=6, place="loss")
    as_well = judged(0.1, physics=CURVE, complexity=6, place="store")
    worse = judged(0.3, physics=CURVE, complexity=6, place="room")
    found = curves_as_good(chosen, [chosen, as_well, worse], RULE)
    assert found == (as_well,)


@pytest.mark.parametrize(("left", "noise"), [(0.2, 0.1), (0.02, 0.1), (0.2, 0.9)])
def test_what_is_still_missing_may_bend_a_wider_law_to_lead(left, noise):
    wide = judged(left, noise=noise, physics="backlash", complexity=2)
    far, bent = judged(1.4 * left, noise=noise), judged(1.2 * left, noise=noise)
    assert clearly_better(wide, far, RULE)
    # A lead of a fifth is much beside a tenth that is not noise, little beside nine.
    assert clearly_better(wide, bent, RULE) == (noise == 0.9)
    assert best_supported([wide, bent], RULE) is (wide if noise == 0.9 else bent)


ODD = np.where(np.arange(24) == 3, 9.0, 0.7)
"""A chunk that is much harder than the others."""


def hardly(left, **words):
    """A law that would be supported, had it been tried alone."""
    return judged(left, Support.UNDECIDED, **words)


def test_a_simpler_law_that_came_short_by_the_number_tried_is_told_for_a_wider_one():
    wide = judged(0.30, physics="hysteresis", complexity=3)
    near, far = hardly(0.31, physics="coulomb_friction"), hardly(0.5, physics="spring")
    promoted = with_plainer([wide, near, far], RULE)
    assert [j.support for j in promoted] == [
        Support.SUPPORTED,
        Support.SUPPORTED,
        Support.UNDECIDED,
    ]
    assert "hardly less than" in promoted[1].reason
    verdicts = decide([wide, near, far], BASE, RULE, lambda *_: None)
    assert verdicts.chosen.physics == "coulomb_friction"
    # Without anything that is supported nothing is.
    assert decide([near, far], BASE, RULE, lambda *_: None).chosen is None


def test_a_simpler_law_that_gives_little_of_a_wider_one_is_not_told_for_it():
    # Not clearly beaten, for the difference is not known; but by half.
    wide = judged(0.4, physics="hysteresis", complexity=3)
    wide = replace(wide, errors=replace(wide.errors, chunks=wide.errors.chunks * ODD))
    half = hardly(0.65, physics="coulomb_friction")
    assert not clearly_better(wide, half, RULE)
    assert with_plainer([wide, half], RULE)[1].support is Support.UNDECIDED


def test_what_a_zero_a_little_off_takes_across_the_line_is_not_told():
    wide = judged(0.89, physics="cogging", complexity=3)
    off = hardly(0.905, physics="constant_bias")
    kept, beside = with_plainer([wide, off], RULE)
    assert (kept.support, beside.support) == (Support.REFUTED, Support.UNDECIDED)
    assert "hardly more than a constant bias takes away" in kept.reason
    assert decide([wide, off], BASE, RULE, lambda *_: None).chosen is None
    # It is told where it takes away more, and beside what is not surely there itself.
    most = judged(0.85, physics="cogging", complexity=3)
    assert with_plainer([most, off], RULE)[0] is most
    by_chance = replace(off, gain=replace(off.gain, p_value=0.02))
    assert with_plainer([wide, by_chance], RULE)[0] is wide


def test_a_law_that_is_not_there_by_itself_is_told_for_none():
    wide = judged(0.30, physics="hysteresis", complexity=3)
    doubtful = hardly(0.31, physics="coulomb_friction")
    doubtful = replace(doubtful, gain=replace(doubtful.gain, p_value=0.02))
    assert with_plainer([wide, doubtful], RULE)[1].support is Support.UNDECIDED


def test_a_named_law_that_gives_most_of_a_curve_needs_not_be_the_best_of_all_tried():
    curve = judged(0.1, physics=CURVE, complexity=8)
    most, little = hardly(0.2, physics="drag"), hardly(0.4, physics="drag")
    assert with_plainer([curve, most], RULE)[1].support is Support.SUPPORTED
    assert with_plainer([curve, little], RULE)[1].support is Support.UNDECIDED


def test_what_loses_whole_recordings_is_refuted_and_the_next_is_told():
    best, next_best = judged(0.1, physics="runaway"), judged(0.3)
    verdicts = decide(
        [best, next_best],
        BASE,
        RULE,
        lambda candidate, _: (
            LOST_FROM_THE_START if candidate.hypothesis.physics == "runaway" else None
        ),
    )
    assert verdicts.chosen is next_best
    (lost,) = (j for j in verdicts.judged if j.physics == "runaway")
    assert lost.support is Support.REFUTED
    assert "whole recordings" in lost.reason
    nothing = decide([best], BASE, RULE, lambda *_: LOST_FROM_THE_START)
    assert nothing.chosen is None
    assert nothing.probability is None


def test_a_later_finding_counts_by_what_it_explains_beside_the_earlier():
    first, second = beside_earlier([0.9, 0.5])
    assert first == 1.0
    assert second == pytest.approx(0.05 / (0.05 + 0.01 * 0.9))
    _, little = beside_earlier([0.994, 0.45])
    assert little == pytest.approx(0.0027 / (0.0027 + 0.01 * 0.994))
    # Five times what shape may do is a finding, a quarter of it is none.
    assert little < MERE_SHAPE < second


def test_what_mends_a_shape_leaves_some_of_it():
    _, unknown = beside_earlier([0.997, 0.97])
    _, much_left = beside_earlier([0.997, 0.97], remaining=0.002)
    _, nothing_left = beside_earlier([0.997, 0.97], remaining=0.0)
    own = 0.003 * 0.97
    assert unknown == much_left == pytest.approx(own / (own + 0.01 * 0.997))
    assert nothing_left == pytest.approx(own / (own + 0.001 * 0.997))
    assert unknown < MERE_SHAPE < nothing_left


def test_what_was_added_beside_later_findings_counts_by_what_those_leave():
    # The second has explained all that the first left; the third took the first's
    # place, and without it the second leaves 0.4.
    *_, third = beside_earlier([0.5, 0.999, 0.99], [None, None, 0.4])
    assert third == pytest.approx(0.396 / (0.396 + 0.01 * 0.6))
    *_, as_before = beside_earlier([0.5, 0.999, 0.99], [None, None, None])
    assert as_before < 0.1


def test_of_laws_that_predict_alike_the_plainest_is_told_at_its_best_place():
    order = RULE.order
    plain, odd = order[0], order[-2]
    assert order.index(plain) < order.index(odd)
    told = judged(0.301, noise=0.0, physics=plain, place="a")
    best = judged(0.30, noise=0.0, physics=odd)
    assert best_supported([best, told], RULE) is told
    nearer = judged(0.3005, noise=0.0, physics=plain, place="b")
    assert best_supported([best, told, nearer], RULE) is nearer


def test_a_filtered_reading_is_told_before_parts_that_slip():
    slip = judged(0.301, noise=0.0, physics="slip", domain="rotation")
    lag = judged(0.30, noise=0.0, physics="lag", place="encoder")
    assert best_supported([slip, lag], RULE) is lag
    clearer = judged(0.2, noise=0.0, physics="slip", domain="rotation")
    assert best_supported([lag, clearer], RULE) is clearer


def test_what_is_typical_of_a_domain_is_plainer_there():
    typical = judged(0.3, physics="leak", domain="hydraulic")
    other = judged(0.3, physics=RULE.order[0], domain="hydraulic")
    assert RULE.plainness(typical) < RULE.plainness(other)
    nowhere = judged(0.3, physics="leak")
    assert RULE.plainness(nowhere) > RULE.plainness(judged(0.3, physics=RULE.order[0]))
    own = judged(0.3, physics="a law of the user's")
    assert RULE.plainness(own) == (True, len(RULE.order))


def test_a_curve_without_a_name_is_told_only_where_no_name_gives_most_of_it():
    curve = judged(0.1, physics=CURVE, complexity=8)
    most = judged(0.2, physics="drag")
    assert best_supported([curve, most], RULE) is most
    little = judged(0.5, physics="drag")
    assert best_supported([curve, little], RULE) is curve
    assert best_supported([curve], RULE) is curve


def test_clearly_better_is_material_and_significant():
    one, other = judged(0.30), judged(0.312, physics="spring")
    assert not clearly_better(one, other, RULE)
    assert not clearly_better(one, one, RULE)
    assert clearly_better(one, judged(0.35, physics="spring"), RULE)
    assert not clearly_better(judged(0.35, physics="spring"), one, RULE)
    noisy = LeftOutErrors(BASE.chunks * np.where(np.arange(24) == 3, 8.0, 0.3))
    rough = Judged(candidate(), noisy, compare(BASE, noisy), Support.SUPPORTED, "")
    assert not clearly_better(one, rough, RULE)


def test_alike_is_within_two_per_cent_or_an_error_either_way():
    one = judged(0.300, noise=0.0)
    near, far = (judged(left, noise=0.0, physics="spring") for left in (0.304, 0.32))
    assert alike(one, near)
    assert alike(near, one)
    assert not alike(one, far)
    assert not alike(far, one)


def test_where_both_leave_little_but_noise_little_tells():
    one, near = (judged(left, noise=0.9) for left in (0.300, 0.304))
    assert not alike(one, near)
    assert alike(one, judged(0.3004, noise=0.9))
    nothing = leaving_nothing()
    assert alike(nothing, nothing)


def leaving_nothing():
    gain = compare(BASE, BASE)
    errors = LeftOutErrors(BASE.chunks, noise=float(BASE.chunks.sum()))
    return Judged(candidate(), errors, gain, Support.SUPPORTED, "")


def test_alternatives_are_supported_close_and_no_extensions():
    chosen = judged(0.30, physics="coulomb_friction")
    close = judged(0.303, physics="spring")
    closer = judged(0.301, physics="gravity")
    others = [
        judged(0.9, physics="drag"),
        judged(0.30, Support.UNDECIDED, physics="slip"),
        judged(0.29, physics=CURVE, complexity=8),
        judged(0.30, physics="stribeck_friction", extends=("coulomb_friction",)),
        judged(0.30, physics="coulomb_friction", complexity=2),
    ]
    found = alternatives_to(chosen, [close, chosen, *others, closer], RULE)
    assert found == (closer, close)
    elsewhere = judged(0.302, physics="coulomb_friction", place="motor")
    assert alternatives_to(chosen, [chosen, elsewhere], RULE) == (elsewhere,)
    # A law in several forms, the wider of which extends its own word.
    form = judged(0.30, physics="hysteresis", complexity=2, extends=("hysteresis",))
    same = judged(
        0.30, physics="hysteresis", complexity=2, extends=("hysteresis",), place="motor"
    )
    assert alternatives_to(form, [form, same], RULE) == (same,)


def test_the_probability_counts_the_same_physics_where_it_cannot_be_told_apart():
    chosen = judged(0.30, physics="coulomb_friction")
    near = judged(0.301, physics="coulomb_friction", place="motor")
    assert probability(chosen, [chosen, near], BASE, RULE) == pytest.approx(1.0)
    rival = judged(0.30, physics="coulomb_friction")
    twin = Judged(candidate("spring"), rival.errors, rival.gain, rival.support, "")
    shared = probability(rival, [rival, twin], BASE, RULE)
    assert shared == pytest.approx(0.5)
    wider = Judged(candidate("spring", complexity=2), *twin_of(rival))
    assert probability(rival, [rival, wider], BASE, RULE) == pytest.approx(1.0)
    extending = Judged(
        candidate("stribeck", extends=("coulomb_friction",)), *twin_of(rival)
    )
    assert probability(rival, [rival, extending], BASE, RULE) == pytest.approx(1.0)
    curve = judged(0.27, physics=CURVE, complexity=8)
    assert probability(chosen, [chosen, curve], BASE, RULE) == pytest.approx(1.0)
    nothing = judged(0.95, physics="drag")
    assert probability(nothing, [nothing], BASE, RULE) == pytest.approx(0.0)


def test_no_more_is_stated_than_was_right_on_concealed_cases():
    many = LeftOutErrors(BASE.chunks, samples=2000)
    assert beyond_resampling(1.0, many) == pytest.approx(1.0 - 7 / 45, abs=0.01)
    assert beyond_resampling(0.5, many) == pytest.approx(
        beyond_resampling(1.0, many) / 2
    )
    assert beyond_resampling(0.0, many) == 0.0


def test_few_chunks_and_short_ones_are_believed_less():
    many = beyond_resampling(1.0, LeftOutErrors(BASE.chunks, samples=2000))
    few = beyond_resampling(1.0, LeftOutErrors(BASE.chunks[:6], samples=2000))
    assert few == pytest.approx(many * (6 / 8) / (24 / 26))
    # Fifteen samples are two chunks of eight, however they are cut.
    short = beyond_resampling(1.0, LeftOutErrors(BASE.chunks[:6], samples=15))
    assert short < 0.5


def twin_of(one):
    return one.errors, one.gain, one.support, ""


def on_three_chunks(*chunks, physics):
    after = errors(*chunks)
    gain = compare(errors(6.0, 6.0, 6.0), after)
    return Judged(candidate(physics), after, gain, Support.SUPPORTED, "")


def test_the_probability_is_the_share_of_resampled_chunks():
    """Two models that are better on one chunk of three each, by exact counting."""
    base = errors(6.0, 6.0, 6.0)
    first = on_three_chunks(1.0, 2.0, 2.0, physics="drag")
    second = on_three_chunks(2.0, 1.0, 2.0, physics="spring")
    # Of 27 draws of three chunks as many prefer the one as the other; ties are shared.
    both = [first, second]
    sure = [probability(one, both, base, RULE) for one in both]
    np.testing.assert_allclose(sure, [0.5, 0.5], atol=0.06)
    assert sum(sure) == pytest.approx(1.0)
    # Where the first is ever so little worse, and told for being plainer, it still
    # shares the 7 of 27 in which the two are drawn as often; clearly worse it does not.
    for less, share in ((1e-4, 10 / 27 + 7 / 54), (0.1, 10 / 27)):
        worse = on_three_chunks(1.0 + less, 2.0 + less, 2.0 + less, physics="drag")
        sure = probability(worse, [worse, second], base, RULE)
        assert sure == pytest.approx(share, abs=0.06)


@pytest.mark.parametrize(
    ("left", "told"), [(0.0002, "coulomb_friction"), (0.0010, "directed_friction")]
)
def test_a_wider_law_is_not_told_for_a_shade(left, told):
    # An offset of a hundredth of dry friction is there, far above the noise.
    plain = judged(left + 0.0024 if left < 0.001 else 0.0060, noise=0.0)
    plain = replace(plain, candidate=candidate("coulomb_friction"))
    wide = judged(left, noise=0.0)
    kind = {"complexity": 2, "extends": ("coulomb_friction",)}
    wide = replace(wide, candidate=candidate("directed_friction", **kind))
    assert best_supported([wide, plain], RULE).physics == told
    elsewhere = replace(wide, candidate=candidate("directed_friction", "rim", **kind))
    assert best_supported([elsewhere, plain], RULE) is elsewhere
