"""Evidence to the last digit: what small mistakes in it would change (see the page on
mutation testing), each against a number worked out another way.
"""

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

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.alternatives import alternatives_to
from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.evidence.decision import (
    NAMED_SHARE,
    best_supported,
)
from bondgraph.diagnosis.evidence.gain import Gain, beside_earlier, compare
from bondgraph.diagnosis.evidence.judged import Judged, Rule, judge
from bondgraph.diagnosis.evidence.leads import ALIKE, alike, clearly_better
from bondgraph.diagnosis.evidence.left_out import (
    FOLDS,
    LeftOutErrors,
    chunk_count,
    chunk_labels,
    left_out_errors,
)
from bondgraph.diagnosis.evidence.surprise import surprise
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.trials import judging
from bondgraph.fitting.certainty.colour import MOST_ORDER, colour_of
from bondgraph.fitting.horizon import SHORTEST, Windows


@pytest.mark.parametrize(
    ("value", "std", "said"),
    [
        (0.5, 0.0123, "50.0 ± 1.2 %"),
        (0.5, 0.00123, "50.00 ± 0.12 %"),
        (0.5, 0.0001, "50.000 ± 0.010 %"),
        (-0.25, 0.5, "-25.0 ± 50.0 %"),
        (0.123, 0.0, "12.3 ± 0.0 %"),
    ],
)
def test_a_gain_is_told_in_percent_to_two_digits_of_its_error(value, std, said):
    assert str(Gain(value, std, 0.0)) == said


def test_a_gain_does_not_depend_on_the_scale_of_the_errors():
    before, after = np.array([4.0, 5, 6, 5, 7, 3]), np.array([2.0, 4, 3, 3, 5, 1])
    told = compare(errors(*before), errors(*after))
    for scale in (1e-30, 1e30):
        same = compare(errors(*scale * before), errors(*scale * after))
        assert same.value == pytest.approx(told.value, rel=1e-12)
        assert same.std == pytest.approx(told.std, rel=1e-9)
        assert same.p_value == pytest.approx(told.p_value, rel=1e-9)


def test_a_chunk_without_error_counts_as_a_large_ratio_not_an_infinite_one():
    before, after = np.array([4.0, 9, 5, 8, 4, 7]), np.array([2.0, 4, 3, 3, 2, 0])
    tiny = 1e-12 * 9.0
    ratios = np.log((before + tiny) / (after + tiny))
    of_ratios = stats.ttest_1samp(ratios, 0, alternative="greater").pvalue
    gain = compare(errors(*before), errors(*after))
    of_sum = stats.t.sf(gain.value / gain.std, 5)
    assert gain.p_value == pytest.approx(2 * min(of_sum, of_ratios), rel=1e-9)
    # The smallest step is that of the larger errors, on whichever side they are.
    turned = compare(errors(*after), errors(*before))
    worse = stats.ttest_1samp(-ratios, 0, alternative="greater").pvalue
    sums = stats.t.sf(turned.value / turned.std, 5)
    assert turned.p_value == pytest.approx(min(2 * min(sums, worse), 1.0), rel=1e-9)


def test_many_chunks_without_error_decide_by_the_smallest_error_that_counts():
    before = np.array([1.0, 1.1, 0.9, 1.0, 300.0, 1.2])
    after = before * np.array([0.0, 0.0, 0.0, 0.0, 0.9, 0.0])
    tiny = 1e-12 * 300.0
    ratios = np.log((before + tiny) / (after + tiny))
    of_ratios = stats.ttest_1samp(ratios, 0, alternative="greater").pvalue
    gain = compare(errors(*before), errors(*after))
    assert of_ratios < stats.t.sf(gain.value / gain.std, 5)
    assert gain.p_value == pytest.approx(2 * of_ratios, rel=1e-9)


def test_the_ratios_decide_where_a_few_chunks_hide_what_all_of_them_show():
    before = np.array([1.0, 1.1, 0.9, 1.0, 300.0, 1.2])
    after = before * np.array([0.30, 0.31, 0.29, 0.30, 0.99, 0.30])
    gain = compare(errors(*before), errors(*after))
    of_ratios = stats.ttest_1samp(
        np.log(before / after), 0, alternative="greater"
    ).pvalue
    assert of_ratios < stats.t.sf(gain.value / gain.std, 5)
    assert gain.p_value == pytest.approx(2 * of_ratios, rel=1e-6)


def with_surprise(before, after):
    """Return a gain of doubtful sums, with surprise before and after."""
    one, other = errors(4, 5, 6, 5), errors(5, 4, 5, 6)
    return compare(
        replace(one, surprise=np.array(before)),
        replace(other, surprise=np.array(after)),
    )


def test_the_surprise_decides_where_it_alone_is_sure():
    before, after = [3.0, 2.5, 2.9, 3.3], [1.0, 0.4, 1.0, 1.2]
    of_steps = stats.ttest_1samp(
        np.array(before) - after, 0, alternative="greater"
    ).pvalue
    assert with_surprise(before, after).p_value == pytest.approx(3 * of_steps, rel=1e-9)
    # The same in every block leaves no doubt, either way.
    assert with_surprise([3.0] * 4, [1.0] * 4).p_value == 0.0
    assert with_surprise([1.5] * 4, [1.0] * 4).p_value == 0.0
    assert with_surprise([1.0] * 4, [3.0] * 4).p_value > 0.5
    assert with_surprise([2.0] * 4, [2.0] * 4).p_value > 0.5


def test_a_finding_that_explains_nothing_is_shape_and_nothing_else():
    assert beside_earlier([]) == []
    _, second = beside_earlier([0.5, 0.0])
    assert second == pytest.approx(1e-12 / (1e-12 + 0.01 * 0.5), rel=1e-9)


def least_squares(speed, force, out):
    """Return the residuals of a fit to what is not left out."""
    rub = speed[~out] @ force[~out] / (speed[~out] @ speed[~out])
    return force - rub * speed


def test_samples_and_surprise_are_those_of_what_was_left_out():
    fitted, speed, force = slider(horizon=Windows(50))
    sigma = fitted.problem.sigma[0]
    labels = np.arange(600) // 100
    found = left_out_errors(fitted, 6)
    assert found.samples == 300
    blocks = np.arange(600) * 24 // 600
    nats = np.zeros(24)
    windows = [slice(50 * i, 50 * i + 50) for i in range(12)]
    for fold in range(FOLDS):
        out = labels % FOLDS == fold
        scored = out & (np.arange(600) % 50 >= 25)
        residuals = least_squares(speed, force, out)[:, None] / sigma
        told = surprise(residuals, windows, 1)
        nats += np.bincount(blocks, weights=told * scored, minlength=24)
    np.testing.assert_allclose(found.surprise, nats, rtol=1e-4, atol=1e-9)
    assert found.noise == 0.0


def test_errors_of_which_nothing_else_is_known_count_no_samples_and_no_noise():
    bare = LeftOutErrors(np.array([1.0, 2.0]))
    assert (bare.samples, bare.noise, bare.beyond_noise) == (0, 0.0, 3.0)
    assert replace(bare, noise=1.0).beyond_noise == 2.0
    assert replace(bare, noise=4.0).beyond_noise == 0.0


def test_as_many_windows_as_chunks_are_enough():
    slow = np.convolve(np.random.default_rng(3).standard_normal(4000), np.ones(2000))
    assert chunk_count(with_residuals(slow[:, None], windows=24)) == 24
    assert chunk_count(with_residuals(slow[:, None], windows=23)) == 6


def test_rows_of_a_table_are_dealt_in_turn():
    slow = np.linspace(-1.0, 1.0, 15)[:, None] ** 2
    assert chunk_count(with_residuals(slow, windows=15)) == 15
    assert chunk_count(with_residuals(slow[:4], windows=4)) == 6
    shots = SimpleNamespace(n_windows=30, timeless=True, time=np.zeros(30))
    labels = chunk_labels(SimpleNamespace(shots=shots), 24)
    np.testing.assert_array_equal(labels, np.arange(30) % 24)


def test_a_chunk_is_three_correlation_times_long(monkeypatch):
    from bondgraph.diagnosis.evidence import left_out  # noqa: PLC0415

    monkeypatch.setattr(left_out, "correlation_time", lambda _: 10)
    assert chunk_count(with_residuals(np.zeros((450, 1)))) == 15
    assert chunk_count(with_residuals(np.zeros((479, 2)))) == 15


def test_the_first_samples_of_a_window_that_trains_are_never_hidden(monkeypatch):
    from bondgraph.diagnosis.evidence import left_out  # noqa: PLC0415

    fitted, _, _ = slider()
    seen, original = [], left_out.minimise

    def watched(problem, *args, **options):
        seen.append(np.isnan(problem.shots.outputs[:, 0]))
        return original(problem, *args, **options)

    monkeypatch.setattr(left_out, "minimise", watched)
    left_out_errors(fitted, 12)
    labels = chunk_labels(fitted.problem, 12)
    for fold, hidden in enumerate(seen):
        expected = labels % FOLDS == fold
        expected[:SHORTEST] = False
        np.testing.assert_array_equal(hidden, expected)


def test_the_surprise_is_that_of_the_colour_window_by_window():
    random = np.random.default_rng(8)
    steps = random.standard_normal((900, 1)).cumsum(axis=0) * 0.1
    edges = (0, 400, 700, 900)
    windows = [slice(a, b) for a, b in pairwise(edges)]
    colour = colour_of(steps[:, 0], edges, 3)
    assert len(colour.coefficients)
    for window in windows:
        innovations = colour.innovations(steps[window, 0])
        nats = 0.5 * (innovations**2 / colour.innovation + np.log(colour.innovation))
        nats[:MOST_ORDER] = 0.0
        found = surprise(steps, windows, 3)[window]
        np.testing.assert_allclose(found, nats, rtol=1e-12)


def exactly(*after, before=(4.0,) * 4):
    """Return a gain that is a round number."""
    return errors(*before), errors(*after)


def test_the_bounds_of_a_decision_belong_to_what_they_bound():
    base, after = exactly(3, 3, 3, 3)
    rule = Rule(materiality=0.25)
    assert judge(candidate(), base, after, 1, rule).support is Support.SUPPORTED
    uneven = LeftOutErrors(BASE.chunks * (0.8 + 0.3 * np.cos(np.arange(24) * 5)))
    p_value = compare(BASE, uneven).p_value
    level = Rule(false_alarm_probability=p_value)
    for tried in (1, 0.3):
        assert judge(candidate(), BASE, uneven, tried, level).support is (
            Support.SUPPORTED
        )
    tighter = Rule(false_alarm_probability=0.99 * p_value)
    assert judge(candidate(), BASE, uneven, 1, tighter).support is Support.UNDECIDED


def test_what_could_still_matter_within_two_errors_is_not_refuted():
    after = LeftOutErrors(BASE.chunks * (0.97 + 0.1 * np.cos(np.arange(24) * 5)))
    gain = compare(BASE, after)
    assert gain.value > 0.0
    reach = gain.value + 2 * gain.std
    at = judge(candidate(), BASE, after, 1, Rule(materiality=reach))
    beyond = judge(candidate(), BASE, after, 1, Rule(materiality=reach * (1 + 1e-9)))
    assert (at.support, beyond.support) == (Support.UNDECIDED, Support.REFUTED)
    # A gain of nothing is refuted, however little is known of it.
    base = errors(1, 2, 3, 4, 5, 6)
    nothing = judge(candidate(), base, errors(6, 5, 4, 3, 2, 1), 1, RULE)
    assert (nothing.gain.value, nothing.support) == (0.0, Support.REFUTED)
    assert nothing.gain.value + 2 * nothing.gain.std > RULE.materiality


def leaving(share, **kinds):
    """Return a judged candidate that leaves exactly a share of every chunk."""
    after = LeftOutErrors(16.0 * share * np.ones(24))
    gain = compare(LeftOutErrors(16.0 * np.ones(24)), after)
    return Judged(candidate(**kinds), after, gain, Support.SUPPORTED, "")


def test_a_name_that_gives_just_the_share_of_a_curve_is_told():
    curve = leaving(0.375, physics=CURVE, complexity=8)
    just = leaving(0.5, physics="drag")
    assert just.gain.value == NAMED_SHARE * curve.gain.value
    assert best_supported([curve, just], RULE) is just
    short = leaving(0.5 + 2.0**-20, physics="drag")
    assert best_supported([curve, short], RULE) is curve


def test_of_alike_laws_as_simple_the_leading_one_decides_which_are_alike():
    order = tuple(dict.fromkeys(RULE.order))  # a word may stand for several laws
    leading = judged(0.300, noise=0.0, physics=order[5])
    near = judged(0.304, noise=0.0, physics=order[4])
    far = judged(0.3085, noise=0.0, physics=order[3])
    assert alike(leading, near)
    assert alike(near, far)
    assert not alike(leading, far)
    assert best_supported([far, near, leading], RULE) is near


def test_a_lead_of_exactly_what_is_asked_is_not_clear():
    # Half the materiality of the worse one's error, without a spread.
    rule = Rule(materiality=0.25)
    worse, better = leaving(0.5), leaving(0.4375)
    known = replace(better, errors=replace(better.errors, noise=1e9))
    assert compare(worse.errors, known.errors).value == 0.125
    assert not clearly_better(known, worse, rule)
    more = leaving(0.4375 - 2.0**-20)
    more = replace(more, errors=replace(more.errors, noise=1e9))
    assert clearly_better(more, worse, rule)


def test_a_lead_is_clear_beyond_two_standard_errors():
    base, shape = LeftOutErrors(np.ones(24)), np.cos(np.arange(24) * 5)
    worse = LeftOutErrors(0.5 * np.ones(24))
    for factor, clear in ((2.5, True), (1.9, False)):
        # The standard error of the mean is the spread over the root of their number.
        spread = 0.1 / factor * np.sqrt(23.0) / np.sqrt((shape**2).mean())
        rough = 0.5 * (0.9 + spread * (shape - shape.mean()))
        after = LeftOutErrors(rough, noise=1e9)
        difference = compare(worse, after)
        assert difference.value == pytest.approx(0.1, rel=1e-9)
        assert difference.value / difference.std == pytest.approx(factor, rel=0.02)
        one = Judged(candidate(), after, compare(base, after), Support.SUPPORTED, "")
        other = Judged(candidate(), worse, compare(base, worse), Support.SUPPORTED, "")
        assert clearly_better(one, other, RULE) is clear


def test_predictions_two_per_cent_apart_are_not_alike():
    one = leaving(0.5)
    assert not alike(one, leaving(0.5 / (1 - 1.001 * ALIKE)))
    assert alike(one, leaving(0.5 / (1 - 0.999 * ALIKE)))
    assert not alike(leaving(0.5 / (1 - 1.03 * ALIKE)), one)


def test_the_same_law_as_wide_elsewhere_or_here_is_an_alternative():
    chosen = judged(0.30, physics="coulomb_friction")
    here = judged(0.301, physics="coulomb_friction")
    assert alternatives_to(chosen, [chosen, here], RULE) == (here,)
    wider = judged(0.301, physics="coulomb_friction", complexity=2, place="motor")
    assert alternatives_to(chosen, [chosen, wider], RULE) == (wider,)


def test_a_curve_competes_with_what_a_name_has_to_give():
    chosen = leaving(0.5, physics="drag")
    for share, wins in ((0.30, False), (0.45, True)):
        curve = leaving(share, physics=CURVE, complexity=8)
        base = LeftOutErrors(16.0 * np.ones(24))
        kept = NAMED_SHARE * share + 1.0 - NAMED_SHARE
        assert (kept > 0.5) is wins
        sure = probability(chosen, [chosen, curve], base, RULE)
        assert sure == pytest.approx(float(wins))
    # Where the curve itself was chosen it competes as it is.
    curve = leaving(0.45, physics=CURVE, complexity=8)
    assert probability(curve, [curve, leaving(0.5)], base, RULE) == pytest.approx(1.0)


def test_a_wider_rival_has_to_win_clearly_and_one_as_wide_does_not():
    base, chosen = LeftOutErrors(16.0 * np.ones(24)), leaving(0.5)
    known = replace(chosen, errors=replace(chosen.errors, noise=1e9))
    rival = leaving(0.48, physics="spring")
    assert probability(known, [known, rival], base, RULE) == pytest.approx(0.0)
    wider = leaving(0.48, physics="spring", complexity=2)
    wider = replace(wider, errors=replace(wider.errors, noise=1e9))
    assert probability(known, [known, wider], base, RULE) == pytest.approx(1.0)
    # Half the materiality of 10 %: a lead of a tenth wins, whatever the width.
    much = leaving(0.45, physics="spring", complexity=2)
    much = replace(much, errors=replace(much.errors, noise=1e9))
    assert probability(known, [known, much], base, RULE) == pytest.approx(0.0)


def test_nothing_missing_competes_with_the_materiality_as_its_lead():
    base = LeftOutErrors(16.0 * np.ones(24))
    for left, wins in ((0.89, True), (0.91, False)):
        one = leaving(left)
        assert probability(one, [one], base, RULE) == pytest.approx(float(wins))


def test_the_same_law_where_the_chosen_one_clearly_wins_does_not_count():
    base = LeftOutErrors(16.0 * np.ones(24))
    chosen, far = leaving(0.5), leaving(0.8, place="motor")
    tied = Judged(far.candidate, chosen.errors, far.gain, far.support, "")
    assert clearly_better(chosen, far, RULE)
    assert probability(chosen, [chosen, tied], base, RULE) == pytest.approx(1.0)
    assert probability(far, [far, chosen], base, RULE) == pytest.approx(1.0)
    spring = replace(tied, candidate=candidate(physics="spring"))
    assert probability(chosen, [chosen, spring], base, RULE) == pytest.approx(0.5)


def test_the_same_law_elsewhere_counts_only_where_it_could_be_the_one():
    base = LeftOutErrors(16.0 * np.ones(24))
    chosen = leaving(0.5)
    chosen = replace(chosen, errors=replace(chosen.errors, noise=1e9))
    # Worse by a tenth of the error and by 2.2 standard errors: some resamples are won.
    shape = np.cos(np.arange(24) * 5)
    shape = (shape - shape.mean()) / shape.std()
    chunks = 8.0 * (1.11 + 0.11 / 2.2 * np.sqrt(23.0) * shape)
    rival = leaving(0.5, place="motor")
    rival = replace(rival, errors=LeftOutErrors(chunks))
    here = replace(rival, candidate=chosen.candidate)
    assert clearly_better(chosen, rival, RULE)
    assert 0.9 < probability(chosen, [chosen, rival], base, RULE) < 0.999
    assert probability(chosen, [chosen, here], base, RULE) == pytest.approx(1.0)


def test_the_simplest_of_a_chain_is_as_sure_as_it_is_chosen_again():
    """A wide law beats the simplest one, and not the one between, which does not."""
    base, ones = LeftOutErrors(16.0 * np.ones(24)), np.ones(24)
    rough = 1.0 + 0.9 * np.cos(np.arange(24) * 5)  # of which little is sure
    simplest = leaving(0.14, physics="orifice", complexity=0)
    between = leaving(0.137, physics="spring")
    between = replace(
        between, errors=LeftOutErrors(16.0 * 0.137 * rough**2 / np.mean(rough**2))
    )
    wide = leaving(0.10, physics="bent sensor", complexity=2)
    wide = replace(wide, errors=LeftOutErrors(16.0 * 0.10 * ones))
    all_of_them = [wide, between, simplest]
    assert clearly_better(wide, simplest, RULE)
    assert not clearly_better(wide, between, RULE)
    assert not clearly_better(between, simplest, RULE)
    assert best_supported(all_of_them, RULE) is simplest
    sure = probability(simplest, all_of_them, base, RULE)
    assert 0.3 < sure < 1.0
    alone = probability(simplest, [wide, simplest], base, RULE)
    assert alone == pytest.approx(0.0)


def test_what_leaves_nothing_wins_whatever_is_drawn():
    nothing = leaving(0.0)
    something = leaving(0.001, physics="spring")
    base = LeftOutErrors(16.0 * np.ones(24))
    assert probability(nothing, [something, nothing], base, RULE) == pytest.approx(1.0)
    twin = leaving(0.0, physics="spring")
    assert probability(nothing, [twin, nothing], base, RULE) == pytest.approx(0.5)


def fitted_with(residuals, cost, noise_unit=1.0):
    """Return what judging reads of a fitted model."""
    at = SimpleNamespace(residuals=np.array(residuals)[:, None])
    optimum = SimpleNamespace(linearisation=at, cost=cost, initial=np.zeros((1, 0)))
    problem = SimpleNamespace(sigma=np.array([noise_unit]), solver=None)
    graph = SimpleNamespace(domains_at=lambda _: [])
    return SimpleNamespace(optimum=optimum, problem=problem, values={}, graph=graph)


def proposal(residuals, cost, complexity=1):
    fitted = fitted_with(residuals, cost)
    hypothesis = SimpleNamespace(
        physics="drag", place="body", extends=(), factor=1, depends_on=("flow",)
    )
    return SimpleNamespace(
        hypothesis=hypothesis,
        told=hypothesis,
        fitted=fitted,
        cost=cost,
        complexity=complexity,
    )


@pytest.fixture
def judged_on(monkeypatch):
    """Judge candidates whose left-out errors are made up; record which were asked."""
    asked = []

    def judged_on(worth, noise=0.0, sigma=1.0):
        def run(_, trials, what, *, whole):
            assert (what, whole) == ("judging", True)
            asked.append([trial.chunks for trial in trials])
            after = 0.5 * BASE.chunks
            return [
                {"chunks": after.tolist(), "surprise": [], "samples": 40}
                for _ in trials
            ]

        bench = SimpleNamespace(base=fitted_with([0.0], 1.0, sigma), run=run)
        monkeypatch.setattr(judging, "left_out_errors", lambda *_: BASE)
        monkeypatch.setattr(judging, "chunk_count", lambda fitted: fitted.optimum.cost)
        found = judging.judge_all(
            bench,
            worth,
            1.0,
            RULE,
            np.array([noise]),
            lambda *_: None,
            judging.Verdicts(),
        )
        return found, asked

    return judged_on


def test_nothing_to_judge_is_no_verdict(judged_on):
    assert judged_on([]) == (judging.Verdicts(), [])


def test_twins_are_judged_once_and_the_chunks_are_those_of_the_best(judged_on):
    far = [1.0, 2.0, 3.0]
    near = [1.0, 2.0, 3.0 + 0.9e-3 * np.sqrt(14.0)]
    other = [1.0, 2.0, 3.0 + 1.2e-3 * np.sqrt(14.0)]
    wide = proposal(far, 8.0, complexity=2)
    worth = [wide, proposal(far, 9.0), proposal(near, 7.0), proposal(other, 10.0)]
    found, asked = judged_on(worth)
    # The third is the twin of the second, beyond one that is wider; the last is none.
    assert asked == [[7.0, 7.0, 7.0]]
    assert len(found.judged) == 4


def test_a_twin_at_the_very_distance_is_one(judged_on, monkeypatch):
    monkeypatch.setattr(judging, "TWINS", 0.25)
    _, asked = judged_on([proposal([5.0, 0.0], 1.0), proposal([4.0, 0.0], 1.0)])
    assert asked == [[1.0]]
    asked.clear()
    _, asked = judged_on([proposal([5.0, 0.0], 1.0), proposal([3.9, 0.0], 1.0)])
    assert asked == [[1.0, 1.0]]


def test_noise_is_that_of_all_samples_in_units_of_the_residuals(judged_on):
    found, _ = judged_on([proposal([1.0], 1.0)], noise=0.3, sigma=0.5)
    assert found.judged[0].errors.noise == pytest.approx(40 * (0.3 / 0.5) ** 2)
