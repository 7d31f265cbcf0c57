"""The model handed on is fitted from where it has been found, not from far away."""

import pytest
from carts import free_cart, recorded

from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.physics.friction import CoulombFriction


def test_what_is_handed_on_knows_no_less_than_what_was_found():
    training, held_out = recorded(1, coulomb=1.0), recorded(2, coulomb=1.0)
    found = diagnose(
        free_cart(),
        [training],
        held_out=[held_out],
        options=Options(library=(CoulombFriction(),)),
    )
    handed = {one.name: one.value for one in found.fit_all.estimates}
    truth = {"mass": 1.3, "viscous": 2.0, "coulomb_wheel": 1.0}
    assert handed == pytest.approx(truth, rel=0.01)
