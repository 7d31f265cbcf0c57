"""Two laws of which neither is supported alone are found together.

Dry friction bends the force against the speed one way, drag bends it the other way. Of
both at once a free viscous damper leaves little, and either alone hardly less.
"""

import numpy as np
import pytest
from rubbing_slider import slider

from bondgraph import Recording, bind_to, diagnose
from bondgraph.diagnosis.evidence.gain import Gain
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.pairs.two import each_needed, half_of
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction

FRICTION, DRAG = 1.0, 14.2
"""In N, and in N s2/m2: so that they bend alike and against each other."""


def recorded(graph, friction, drag, seed, samples=1500):
    rng = np.random.default_rng(seed)
    time = np.arange(samples) * 0.01
    speed = 0.5 * np.sin(1.3 * time + seed)
    force = 1.5 * speed + friction * np.sign(speed) + drag * speed * np.abs(speed)
    channels = {
        "speed": (speed, "m/s"),
        "force": (force + 0.02 * rng.normal(size=samples), "N"),
    }
    return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))


LIBRARY = (CoulombFriction(), QuadraticDrag())


def said(friction, drag, library=LIBRARY):
    graph = slider()
    training, held_out = (recorded(graph, friction, drag, seed) for seed in (1, 2))
    options = Options(library=library)
    return diagnose(graph, [training], held_out=[held_out], options=options)


def test_what_hides_behind_each_other_is_found_together():
    found = said(FRICTION, DRAG)
    assert found.verdict is Verdict.PHYSICS_MISSING
    values = {e.name: e.value for one in found.findings for e in one.estimates}
    assert values["coulomb_cart"] == pytest.approx(FRICTION, rel=0.02)
    assert values["quadratic_cart"] == pytest.approx(DRAG, rel=0.02)
    reasons = [one.reason for one in found.candidates if one.support == "supported"]
    assert len(reasons) == 2
    assert all("together with" in reason for reason in reasons)
    assert all(one.probability > 0.7 for one in found.findings)
    # Half of what both take away is counted for each, and so nothing is left.
    assert "remains" not in found.statement


def test_the_order_of_the_library_decides_nothing():
    values = [
        {e.name: e.value for one in found.findings for e in one.estimates}
        for found in (said(FRICTION, DRAG), said(FRICTION, DRAG, LIBRARY[::-1]))
    ]
    assert values[0] == pytest.approx(values[1], rel=1e-6)
    assert len(values[0]) == 2


def test_two_laws_within_the_noise_are_not_told():
    assert said(0.01 * FRICTION, 0.01 * DRAG).verdict is Verdict.ADEQUATE


def test_each_of_two_has_to_be_needed_beside_the_other():
    rng = np.random.default_rng(5)
    errors = 1.0 + 0.1 * rng.random((3, 24))
    alone, hardly, clearly = errors * np.array([[1.0], [0.99], [0.6]])
    for both, needed in ((hardly, False), (clearly, True)):
        one, other = LeftOutErrors(3.0 * alone), LeftOutErrors(alone)
        assert each_needed((one, other), LeftOutErrors(both), Rule()) is needed


def test_halves_of_a_gain_leave_together_what_the_whole_leaves():
    half = half_of(Gain(0.84, 0.08, 1e-6))
    assert (1.0 - half.value) ** 2 == pytest.approx(0.16)
    # To first order: as the square of what is left, so does its error.
    assert 2.0 * (1.0 - half.value) * half.std == pytest.approx(0.08)
    assert half.p_value == 1e-6
