"""A curve is told to be a line carried on where held-out recordings go beyond it."""

import numpy as np
import pytest
from rubbing_slider import proposed, slider

from bondgraph import Recording, bind_to
from bondgraph.diagnosis.answer.beyond import beyond_training
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.unknown import UnknownRelation


def run(name, low, high):
    """Return a recording of the slider pulled at speeds between two."""
    time = np.arange(400) * 0.01
    speed = low + (high - low) * (0.5 + 0.5 * np.sin(3.0 * time))
    noise = 0.01 * np.random.default_rng(1).normal(size=time.size)
    force = speed + 0.4 * np.tanh(speed / 0.1) + noise
    channels = {"speed": (speed, "m/s"), "force": (force, "N")}
    return bind_to(slider(), Recording.from_arrays(name, time, channels))


def notes(physics, *held_out):
    """Return what is told of a slider with one law, drawn between -0.5 and 0.5 m/s."""
    training = [run("training", -0.5, 0.5)]
    base = fit_model(slider(), training, FitSettings())
    law = proposed(base, physics)
    values = {one.name: one.value for one in law.edit.parameters}
    final = fitted_with(base, base, (law,), values)
    candidate = Candidate(law, final, len(law.edit.parameters))
    return beyond_training([candidate], final, held_out)


@pytest.mark.parametrize(
    ("low", "high", "told"),
    [
        (-0.5, 0.52, ()),
        (-0.5, 0.9, ("up to 0.9 m/s, where those that train end at 0.5 m/s:",)),
        (-0.7, 0.4, ("down to -0.7 m/s, where those that train end at -0.5 m/s:",)),
        (-0.7, 0.9, ("up to 0.9 m/s", " and down to -0.7 m/s")),
    ],
)
def test_what_goes_beyond_the_knots_is_told_with_both_numbers(low, high, told):
    found = notes(UnknownRelation(), run("faster", low, high))
    assert len(found) == bool(told)
    for words in told:
        assert words in found[0]
    if told:
        assert found[0].startswith("faster takes the velocity at cart ")


def test_each_recording_that_goes_beyond_is_told_of():
    runs = run("inside", -0.3, 0.3), run("faster", 0.0, 0.9), run("back", -0.9, 0.0)
    assert [one.split()[0] for one in notes(UnknownRelation(), *runs)] == [
        "faster",
        "back",
    ]


def test_a_law_with_a_name_holds_beyond_what_trains():
    assert notes(CoulombFriction(), run("faster", -0.9, 0.9)) == ()
