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
    assert left_of([replace(run, inputs=run.inputs + 30.0 * wave)]) is None


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
