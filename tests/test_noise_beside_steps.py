"""What jumps with a command is no noise, and noise that is fed back stays noise."""

from dataclasses import replace

import numpy as np
import pytest
from carts import recorded

from bondgraph.diagnosis.virtual.noise import channel_noise

STD = 4e-3


def noise_of(command, values):
    """Return the noise of a channel beside a command, through a recording."""
    bound = recorded(1)
    samples = len(values)
    stood_in = replace(
        bound,
        time=0.01 * np.arange(samples),
        inputs=np.asarray(command)[:, None],
        outputs=np.asarray(values)[:, None],
    )
    (found,) = channel_noise([stood_in], 0)
    return found


def test_steps_across_a_resistance_are_not_noise():
    random = np.random.default_rng(3)
    current = np.repeat(random.normal(size=500), random.integers(2, 6, 500))
    white = STD * random.normal(size=len(current))
    found = noise_of(current, 0.02 * current + white)
    assert found.std == pytest.approx(STD, rel=0.1)
    # Without the command they look like noise.
    alone = noise_of(np.zeros_like(current), 0.02 * current + white)
    assert alone.std > 1.5 * STD


def test_noise_that_a_loop_feeds_back_stays_noise():
    random = np.random.default_rng(4)
    white = STD * random.normal(size=2000)
    found = noise_of(-50.0 * white, white)
    assert found.std == pytest.approx(STD, rel=0.1)
