"""A relation that a named law only comes near to is told as a curve, or said to be."""

import numpy as np
import pytest
from rubbing_slider import slider

from bondgraph import Recording, bind_to, diagnose
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.unknown import UnknownRelation

LIBRARY = (CoulombFriction(), QuadraticDrag(), UnknownRelation())


def said(force_of):
    graph = slider()

    def recorded(seed):
        rng = np.random.default_rng(seed)
        time = np.arange(1500) * 0.01
        speed = 0.5 * np.sin(1.3 * time + seed) * (1.0 + 0.5 * np.sin(0.2 * time))
        force = force_of(speed) + 0.01 * rng.normal(size=time.size)
        channels = {"speed": (speed, "m/s"), "force": (force, "N")}
        return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))

    options = Options(library=LIBRARY)
    return diagnose(graph, [recorded(1)], held_out=[recorded(2)], options=options)


def test_a_relation_far_from_every_law_is_told_as_a_curve():
    # An eddy-current brake: beyond 0.2 m/s the faster the weaker.
    found = said(lambda speed: 8.0 * speed / (1.0 + (speed / 0.2) ** 2))
    assert found.verdict is Verdict.UNEXPLAINED
    (curve,) = found.findings
    assert (curve.physics, curve.place) == ("unknown_relation", "cart")
    assert "comes nearest" in curve.statement


def test_a_law_that_comes_near_is_doubted_beside_a_curve():
    # A damper of a root of the speed, which dry friction comes near to.
    found = said(lambda speed: 3.0 * np.sign(speed) * np.abs(speed) ** 0.2)
    (rub,) = found.findings
    assert rub.physics == "coulomb_friction"
    assert rub.probability < 0.65
    assert "comes near to what is there" in rub.statement
    assert "unknown_relation" in [one.physics for one in rub.alternatives]


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
