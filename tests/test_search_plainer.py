"""The plainer law is told where the final fit finds a wider one to add nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rubbing_slider import proposed, slider

from bondgraph import Recording, bind_to
from bondgraph.diagnosis.answer.notes import notes_on
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence import addition
from bondgraph.diagnosis.evidence.addition import LEFT_OPEN, NOTHING, seen_again
from bondgraph.diagnosis.evidence.gain import Gain
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising import plainer
from bondgraph.diagnosis.search.revising.plainer import without_needless_parts
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.work.limit import Limit
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.bias import ConstantBias
from bondgraph.physics.friction import CoulombFriction, StribeckFriction

DRY = 0.8
OPEN = Support.UNDECIDED
FOR_EVER = Limit()


def recorded(rise):
    time = np.arange(1500) * 0.01
    speed = 0.5 * np.sin(1.3 * time) * np.sin(0.2 * time + 1)
    dry = (DRY + rise * np.exp(-((speed / 0.1) ** 2))) * np.tanh(speed / 0.002)
    noise = 0.01 * np.random.default_rng(3).standard_normal(time.size)
    channels = {"speed": (speed, "m/s"), "force": (1.5 * speed + dry + noise, "N")}
    return bind_to(slider(), Recording.from_arrays("run", time, channels))


def added_to(base, physics, support, gain):
    """Return the physics fitted at the cart, as judged with this support and gain."""
    law = proposed(base, physics)
    fitted = fitted_with(base, base, [law], law.starts[-1])
    candidate = Candidate(law, fitted, len(law.parameters))
    errors = LeftOutErrors(np.full(12, 1.0 - gain))
    return Judged(candidate, errors, Gain(gain, 0.01, 1e-9), support, f"takes {gain}")


def search_that_chose_the_wider(rise, narrow_support, limit=FOR_EVER):
    recording = recorded(rise)
    base = fit_model(slider(), [recording], FitSettings())
    wide = added_to(base, StribeckFriction(), Support.SUPPORTED, 0.9)
    narrow = added_to(base, CoulombFriction(), narrow_support, 0.3)
    found = Round(base, judged=(wide, narrow), chosen=wide, probability=0.8)
    final = wide.candidate.fitted
    rounds = [found, Round(final)]
    return (
        wide,
        narrow,
        without_needless_parts(rounds, final, [recording], Options(), limit),
    )


def test_what_there_is_no_time_to_see_again_stands():
    out = Limit.after(0.0)
    wide, _, (rounds, _) = search_that_chose_the_wider(0.0, Support.SUPPORTED, out)
    assert rounds[0].chosen is wide


@pytest.mark.parametrize("support", [Support.SUPPORTED, Support.UNDECIDED])
def test_what_adds_nothing_is_left_out_of_the_law(support):
    wide, narrow, (rounds, final) = search_that_chose_the_wider(0.0, support)
    chosen = rounds[0].chosen
    assert chosen.physics == "coulomb_friction"
    assert chosen.support is Support.SUPPORTED
    assert chosen in rounds[0].judged
    assert rounds[0].probability == 0.8
    assert final.values["coulomb_cart"] == pytest.approx(DRY, rel=0.02)
    assert "stribeck_rise_cart" not in final.values
    refuted = replace(wide, support=Support.REFUTED, reason=NOTHING)
    assert refuted in rounds[0].judged
    # What windows had not decided is told with what the wider law took away there.
    undecided = support is Support.UNDECIDED
    assert chosen.gain.value == (wide if undecided else narrow).gain.value
    assert ("wider form" in chosen.reason) == undecided


@pytest.mark.parametrize("support", [Support.SUPPORTED, Support.UNDECIDED])
def test_what_adds_something_stays(support):
    wide, _, (rounds, final) = search_that_chose_the_wider(0.6, support)
    assert rounds[0].chosen is wide
    assert "stribeck_rise_cart" in final.values


@pytest.mark.parametrize("as_good", [True, False])
def test_once_the_wider_law_is_gone_what_is_plainest_is_chosen_anew(
    monkeypatch, as_good
):
    # A spring was chosen for how it hardens: without that it is as likely as others.
    monkeypatch.setattr(plainer, "best_supported", lambda judged, _: judged[-1])
    monkeypatch.setattr(plainer, "as_good", lambda *_: as_good)
    recording = recorded(0.0)
    base = fit_model(slider(), [recording], FitSettings())
    wide = added_to(base, StribeckFriction(), Support.SUPPORTED, 0.9)
    narrow = added_to(base, CoulombFriction(), Support.SUPPORTED, 0.9)
    other = added_to(base, ConstantBias(), Support.SUPPORTED, 0.9)
    found = Round(base, judged=(wide, narrow, other), chosen=wide, probability=0.8)
    rounds = [found, Round(wide.candidate.fitted)]
    (first, _), final = without_needless_parts(
        rounds, wide.candidate.fitted, [recording], Options(), FOR_EVER
    )
    assert first.chosen.candidate is (other if as_good else narrow).candidate
    assert set(first.chosen.candidate.hypothesis.parameters) <= final.values.keys()
    assert wide not in first.judged


def test_a_refuted_narrower_law_takes_no_place():
    wide, _, (rounds, _) = search_that_chose_the_wider(0.0, Support.REFUTED)
    assert rounds[0].chosen is wide


def estimated(**numbers):
    """Return what reports numbers, each with its standard error."""
    estimates = [
        SimpleNamespace(name=name, value=value, std=std)
        for name, (value, std) in numbers.items()
    ]
    return lambda *_: SimpleNamespace(estimates=estimates)


def judged(support, **strengths):
    names = tuple(strengths)
    hypothesis = SimpleNamespace(strengths=names, parameters=names)
    candidate = SimpleNamespace(hypothesis=hypothesis)
    return Judged(candidate, None, None, support, "as judged")


@pytest.mark.parametrize(
    ("rise", "coulomb", "support", "reason"),
    [
        ((0.30, 0.1), (0.8, 0.01), Support.SUPPORTED, "as judged"),
        ((0.02, 0.02), (0.8, 0.01), Support.REFUTED, NOTHING),
        ((0.00, None), (0.8, None), Support.REFUTED, NOTHING),
        ((0.20, 0.21), (0.6, 0.2), Support.UNDECIDED, f"{LEFT_OPEN}: rise 0.2 ± 0.21"),
        (
            (0.20, None),
            (0.8, 0.01),
            Support.UNDECIDED,
            f"{LEFT_OPEN}: rise is not determined",
        ),
    ],
)
def test_nothing_is_told_from_what_recordings_leave_open(
    monkeypatch, rise, coulomb, support, reason
):
    monkeypatch.setattr(addition, "report", estimated(rise=rise, coulomb=coulomb))
    wide = judged(Support.SUPPORTED, coulomb=1, rise=1)
    narrow = judged(Support.SUPPORTED, coulomb=1)
    told = seen_again(wide, narrow, SimpleNamespace(graph=None), [])
    assert (told.support, told.reason) == (support, reason)
    assert told.open == (support is OPEN)


@pytest.mark.parametrize("left_open", [True, False])
def test_what_is_left_open_is_noted_as_that(left_open):
    wide, narrow, _ = search_that_chose_the_wider(0.0, Support.SUPPORTED)
    support = OPEN if left_open else Support.REFUTED
    told = replace(wide, support=support, reason="left open", open=left_open)
    found = Round(wide.candidate.fitted, judged=(told, narrow), chosen=narrow)
    (note,) = notes_on([found], SimpleNamespace(unidentifiable=()), Options())
    assert note.startswith("Stribeck friction at cart")
    assert note.endswith(": left open.") == left_open
    assert ("hardly supported" in note) != left_open
