"""What is left at one frequency that no input has is no noise."""

from dataclasses import replace

import numpy as np
import pytest
from test_in_time import COUNT, SETTINGS, STEP, cart, pushed

from bondgraph import Recording, bind_to, diagnose
from bondgraph.diagnosis.answer.humming import swinging
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.estimate import fit_model
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.moments import DisturbanceStep

HERTZ = 2.7


def hummed(seed, size, shape=np.sin, **happens):
    """Return a recording of a cart with a hum of its sensor."""
    quiet = pushed(seed, **happens)
    time = STEP * np.arange(COUNT)
    read = quiet.outputs[:, 0] + size * shape(2.0 * np.pi * HERTZ * time + seed)
    channels = {"push": (quiet.inputs[:, 0], "N"), "position": (read, "m")}
    return bind_to(cart(), Recording.from_arrays(f"run {seed}", time, channels))


def left_of(recordings):
    return swinging(fit_model(cart(), recordings, SETTINGS))


def test_a_hum_is_told_with_its_frequency_and_size():
    hum = left_of([hummed(1, 0.004), hummed(2, 0.004)])
    assert hum is not None
    assert hum.output == "position"
    assert hum.frequency == pytest.approx(HERTZ, abs=0.5 / (STEP * COUNT))
    assert hum.amplitude == pytest.approx(0.004, rel=0.1)


def test_noise_and_drift_have_no_frequency():
    assert left_of([pushed(1), pushed(2)]) is None
    assert left_of([hummed(1, 0.02, lambda angle: angle / 500.0)]) is None
    assert left_of([hummed(1, 0.0005)]) is None


def test_what_swings_as_an_input_does_is_no_hum():
    wave = np.sin(2.0 * np.pi * HERTZ * STEP * np.arange(COUNT))[:, None]
    run = hummed(1, 0.004)
    driven = replace(run, inputs=run.inputs + 30.0 * wave)
    assert left_of([driven]) is None
    # Nor where that is one of two recordings, whose other one is driven by more.
    wild = replace(pushed(2), inputs=100.0 * pushed(2).inputs)
    assert left_of([driven, wild]) is None


def test_a_machine_that_swings_by_itself_does_not_hum():
    mass = cart().with_parameters({"mass": 2.0, "drag": 0.01})
    time = STEP * np.arange(COUNT)
    swing = 0.2 * np.cos(5.0 * time) * np.exp(-0.002 * time)
    read = swing + 0.004 * np.cos(5.0 * time + 1.0)
    channels = {"push": (np.zeros(COUNT), "N"), "position": (read, "m")}
    free = bind_to(mass, Recording.from_arrays("free", time, channels))
    fixed = mass.with_parameters(
        [replace(p, std=0.0) for p in mass.parameters.values()]
    )
    assert swinging(fit_model(fixed, [free], SETTINGS)) is None


def test_a_model_that_leaves_a_hum_is_not_called_adequate():
    options = Options(library=(CoulombFriction(),), settings=SETTINGS)
    runs = [hummed(seed, 0.004) for seed in (1, 2)]
    answer = diagnose(cart(), runs, held_out=[hummed(3, 0.004)], options=options)
    assert answer.verdict is Verdict.CANNOT_TELL
    assert "swings at 2.7 Hz" in answer.statement


def test_a_hum_beside_what_was_found_is_told_as_well():
    runs = [hummed(seed, 0.004, held=4.0) for seed in (1, 2, 3)]
    options = Options(library=(DisturbanceStep(),), settings=SETTINGS)
    answer = diagnose(cart(), runs[:2], held_out=runs[2:], options=options)
    (found,) = answer.findings
    assert found.physics == "disturbance_step"
    assert "swings at 2.7 Hz" in answer.statement
