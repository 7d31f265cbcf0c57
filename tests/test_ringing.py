"""A part that rings is begun where what is left rings, with the mass that is there."""

from functools import cache

import numpy as np
import pytest
from scipy.linalg import expm

from bondgraph import BondGraph, C, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.diagnose import diagnose
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.ringing import ringing
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Windows
from bondgraph.physics.modes import FlexibleMode
from bondgraph.physics.places.everywhere import all_places
from bondgraph.simulation.solvers import Hold

STEP, SAMPLES = 2e-4, 2400
MASS, STIFFNESS, DAMPING = 0.72, 2.2e6, 75.0
PART, RATE, RATIO = 0.095, 2860.0, 0.012
NOISE = 5e-9


def stage():
    g = BondGraph("stage", domain="translation")
    g.one("stage", Se("force"), I("mass"), C("flexure"), R("damping"))
    g.measure("position", displacement="stage")
    g.parameter("mass", 0.8, "kg", std=0.04)
    g.parameter("flexure", 1 / 2.0e6, "m/N", std=0.05e-6)
    g.parameter("damping", 60.0, "N*s/m")
    return g.finish()


def dynamics(part):
    """Return the rates' matrix of stage and part: positions, then speeds."""
    k, d = part * RATE**2, 2 * RATIO * part * RATE
    stiffness = np.array([[STIFFNESS + k, -k], [-k, k]])
    damping = np.array([[DAMPING + d, -d], [-d, d]])
    inverse = np.diag([1 / MASS, 1 / (part or 1.0)])
    upper = np.hstack([np.zeros((2, 2)), np.eye(2)])
    return np.vstack([upper, np.hstack([-inverse @ stiffness, -inverse @ damping])])


@cache
def recorded(seed, part):
    """Return a run under held steps of force, exactly stepped."""
    random = np.random.default_rng(seed)
    force = np.repeat(random.normal(size=SAMPLES // 8) * 10.0, 8)
    whole = np.zeros((5, 5))
    whole[:4, :4] = dynamics(part)
    whole[2, 4] = 1 / MASS
    over = expm(whole * STEP)
    x, position = np.zeros(4), np.empty(SAMPLES)
    for i, pushed in enumerate(force):
        position[i] = x[0]
        x = over[:4, :4] @ x + over[:4, 4] * pushed
    position += NOISE * random.normal(size=SAMPLES)
    time = STEP * np.arange(SAMPLES)
    channels = {"force": (force, "N"), "position": (position, "m")}
    return bind_to(stage(), Recording.from_arrays(f"run {seed}", time, channels))


@cache
def base(part):
    settings = FitSettings(hold=Hold.ZERO, horizon=Windows(SAMPLES))
    return fit_model(stage(), [recorded(1, part)], settings)


def resonance():
    """Return the frequency at which stage and part swing against each other."""
    return max(abs(np.linalg.eigvals(dynamics(PART)).imag))


def test_what_is_left_rings_where_the_missing_part_does():
    first = ringing(base(PART))[0]
    assert first == pytest.approx(resonance(), rel=0.06)


def test_a_model_that_leaves_noise_leaves_nothing_that_rings():
    assert ringing(base(0.0)) == ()


def test_short_windows_show_no_resonance():
    settings = FitSettings(hold=Hold.ZERO, horizon=Windows(20))
    assert ringing(fit_model(stage(), [recorded(1, PART)], settings)) == ()


def test_a_part_is_begun_there_with_a_tenth_of_the_inertia_at_most():
    fitted = base(PART)
    (place,) = (
        place
        for place in all_places(fitted.graph, measure_scales(fitted))
        if place.name == "stage" and list(FlexibleMode().propose(place))
    )
    (mode,) = FlexibleMode().propose(place)
    begun = [start["mode_frequency_stage"] for start in mode.starts]
    assert min(abs(rate - resonance()) for rate in begun) < 0.06 * resonance()
    masses = [start["mode_inertia_stage"] for start in mode.starts]
    assert max(masses) == pytest.approx(0.1 * fitted.values["mass"])


@pytest.mark.long
def test_a_light_part_that_rings_fast_is_found_and_measured():
    answer = diagnose(
        stage(),
        [recorded(1, PART)],
        held_out=[recorded(2, PART)],
        options=Options(library=(FlexibleMode(),)),
    )
    (finding,) = answer.findings
    assert (finding.physics, finding.place) == ("compliance", "stage")
    found = {one.name: one.value for one in finding.estimates}
    assert found["mode_inertia_stage"] == pytest.approx(PART, rel=0.1)
    assert found["mode_frequency_stage"] == pytest.approx(RATE, rel=0.01)
    assert found["mode_damping_stage"] == pytest.approx(RATIO, rel=0.1)
