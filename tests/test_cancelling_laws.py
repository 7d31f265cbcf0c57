"""Two laws at one place that are the terms of a series between them are not there."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.revising.cancelling import cancelled
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.position import Gravity, HardeningSpring


def coupling():
    """Return a rubber coupling that is twisted at known speeds; its torque is read."""
    g = BondGraph("coupling", domain="rotation")
    g.one("rubber", Sf("speed"), C("give"), R("damper"))
    g.measure("torque", effort="speed")
    g.parameter("give", 0.85, "rad/(N*m)", bounds=(0.01, 10.0))
    g.parameter("damper", 0.1, "N*m*s/rad", bounds=(0, 100))
    return g.finish()


def twisted(torque_of):
    """Return a recording of a coupling whose spring gives ``torque_of`` a twist."""
    time = np.arange(1200) * 0.01
    twist = 0.17 * np.sin(3.0 * time)
    speed = 0.17 * 3.0 * np.cos(3.0 * time)
    noise = 1e-3 * np.random.default_rng(1).normal(size=time.size)
    torque = torque_of(twist, speed) + 0.1 * speed + noise
    channels = {"speed": (speed, "rad/s"), "torque": (torque, "N*m")}
    return bind_to(coupling(), Recording.from_arrays("run", time, channels))


def with_laws(recording, *laws, begun=1.0):
    """Return the model with laws at its coupling, fitted, and their hypotheses."""
    base = fit_model(coupling(), [recording], FitSettings())
    places = all_places(base.graph, measure_scales(base))
    (place,) = (one for one in places if one.name == "rubber")
    found = [
        next(
            h
            for h in physics.propose(place)
            if words in h.words and h.place == "rubber"
        )
        for physics, words in laws
    ]
    values = {name: begun * v for one in found for name, v in one.starts[-1].items()}
    return fitted_with(base, base, found, values), found


CUBE = (HardeningSpring(), "grows with the cube")
WEIGHT = (Gravity(), "hangs from the shaft")


def softer_then_harder(twist, _):
    return twist / 0.85 * (1.0 - (twist / 0.11) ** 2 + (twist / 0.11) ** 4)


@pytest.mark.parametrize("laws", [(CUBE, WEIGHT), (WEIGHT, CUBE)])
def test_two_terms_of_a_series_cancel(laws):
    fitted, found = with_laws(twisted(softer_then_harder), *laws, begun=100.0)
    assert cancelled(fitted, found) is found[0]
    assert cancelled(fitted, found[:1]) is None


def test_two_laws_that_are_there_do_not():
    def torque(twist, speed):
        return twist / 0.85 + 60.0 * twist**3 + 0.4 * speed * np.abs(speed)

    laws = CUBE, (QuadraticDrag(), "")
    fitted, found = with_laws(twisted(torque), *laws)
    assert cancelled(fitted, found) is None


def test_a_spring_against_which_a_weight_works_somewhere_is_kept():
    def torque(twist, _):
        return twist / 0.85 + 60.0 * twist**3 + 90.0 * (np.sin(twist) - twist)

    fitted, found = with_laws(twisted(torque), CUBE, WEIGHT)
    assert cancelled(fitted, found) is None
