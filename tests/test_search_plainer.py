"""The plainer law is told where the final fit finds a wider one to add nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import BondGraph, R, Recording, Sf, bind_to
from bondgraph.diagnosis.answer.found import is_untold
from bondgraph.diagnosis.answer.notes import notes_on
from bondgraph.diagnosis.evidence.decision import Judged
from bondgraph.diagnosis.evidence.gain import Gain
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search import plainer
from bondgraph.diagnosis.search.candidates import Candidate
from bondgraph.diagnosis.search.one_round import Round
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.plainer import REASON, UNTOLD, without_needless_parts
from bondgraph.diagnosis.search.removal import fitted_with
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.friction import CoulombFriction, StribeckFriction
from bondgraph.physics.places.everywhere import all_places

DRY = 0.8


def slider():
    g = BondGraph("slider", domain="translation")
    g.one("cart", Sf("speed"), R("damper"))
    g.measure("force", effort="speed")
    g.parameter("damper", 1.0, "N*s/m", bounds=(0, 100))
    return g.finish()


def recorded(rise):
    time = np.arange(1500) * 0.01
    speed = 0.5 * np.sin(1.3 * time) * np.sin(0.2 * time + 1)
    dry = (DRY + rise * np.exp(-((speed / 0.1) ** 2))) * np.tanh(speed / 0.002)
    noise = 0.01 * np.random.default_rng(3).standard_normal(time.size)
    channels = {"speed": (speed, "m/s"), "force": (1.5 * speed + dry + noise, "N")}
    return bind_to(slider(), Recording.from_arrays("run", time, channels))


def added_to(base, physics, support, gain):
    """Return the physics fitted at the cart, as judged with this support and gain."""
    places = all_places(base.graph, measure_scales(base))
    (place,) = (place for place in places if place.name == "cart")
    (law,) = physics.propose(place)
    fitted = fitted_with(base, base, [law], law.starts[-1])
    candidate = Candidate(law, fitted, len(law.parameters))
    errors = LeftOutErrors(np.full(12, 1.0 - gain))
    return Judged(candidate, errors, Gain(gain, 0.01, 1e-9), support, f"takes {gain}")


def search_that_chose_the_wider(rise, narrow_support):
    recording = recorded(rise)
    base = fit_model(slider(), [recording], FitSettings())
    wide = added_to(base, StribeckFriction(), Support.SUPPORTED, 0.9)
    narrow = added_to(base, CoulombFriction(), narrow_support, 0.3)
    found = Round(base, judged=(wide, narrow), chosen=wide, probability=0.8)
    final = wide.candidate.fitted
    rounds = [found, Round(final)]
    return wide, narrow, without_needless_parts(rounds, final, [recording], Options())


@pytest.mark.parametrize("support", [Support.SUPPORTED, Support.UNDECIDED])
def test_what_adds_nothing_is_left_out_of_the_law(support):
    wide, narrow, (rounds, final) = search_that_chose_the_wider(0.0, support)
    chosen = rounds[0].chosen
    assert chosen.physics == "coulomb_friction"
    assert chosen.support is Support.SUPPORTED
    assert chosen in rounds[0].judged
    assert final.values["coulomb_cart"] == pytest.approx(DRY, rel=0.02)
    assert "stribeck_rise_cart" not in final.values
    refuted = replace(wide, support=Support.REFUTED, reason=REASON)
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


def test_a_refuted_narrower_law_takes_no_place():
    wide, _, (rounds, _) = search_that_chose_the_wider(0.0, Support.REFUTED)
    assert rounds[0].chosen is wide


def estimated(**numbers):
    """Return what reports numbers, each with its standard error."""
    estimates = [
        SimpleNamespace(name=n, value=v, std=e) for n, (v, e) in numbers.items()
    ]
    return lambda *_: SimpleNamespace(estimates=estimates)


@pytest.mark.parametrize(
    ("rise", "coulomb", "said"),
    [
        ((0.30, 0.1), (0.8, 0.01), ""),
        ((0.02, 0.02), (0.8, 0.01), REASON),
        ((0.00, None), (0.8, 0.01), REASON),
        ((0.20, 0.21), (0.6, 0.2), f"{UNTOLD}: rise 0.2 ± 0.21"),
    ],
)
def test_nothing_is_told_from_what_recordings_do_not_tell(
    monkeypatch, rise, coulomb, said
):
    def law(**strengths):
        hypothesis = SimpleNamespace(
            strengths=tuple(strengths), parameters=tuple(strengths)
        )
        return SimpleNamespace(candidate=SimpleNamespace(hypothesis=hypothesis))

    monkeypatch.setattr(plainer, "report", estimated(rise=rise, coulomb=coulomb))
    final = SimpleNamespace(graph=None)
    wide, narrow = law(coulomb=1, rise=1), law(coulomb=1)
    assert plainer._needless(wide, narrow, final, []) == said


def test_what_is_not_told_stays_undecided_beside_the_plainer_law():
    wide, narrow, _ = search_that_chose_the_wider(0.0, Support.SUPPORTED)
    found = Round(wide.candidate.fitted, judged=(wide, narrow), chosen=wide)
    without = plainer._refuted(found, narrow, {id(wide): f"{UNTOLD}: rise 0.2 ± 0.21"})
    assert without.chosen is narrow
    assert is_untold(without.judged[0])
    assert not is_untold(replace(wide, support=Support.REFUTED, reason=REASON))
    (note,) = notes_on([without], SimpleNamespace(unidentifiable=()), Options())
    assert note == f"Stribeck friction at cart: {UNTOLD}: rise 0.2 ± 0.21."
