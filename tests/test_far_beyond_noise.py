"""What is many times the noise of a sensor is not called its noise, however small."""

import numpy as np
import pytest
from scipy.signal import lfilter

from bondgraph import (
    BondGraph,
    FitSettings,
    Hold,
    I,
    R,
    Recording,
    Se,
    bind_to,
    diagnose,
)
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.drag import QuadraticDrag

STEP, COUNT, NOISE = 0.01, 1500, 1e-3


def sled():
    graph = BondGraph("sled", domain="translation")
    graph.one("sled", Se("pull"), I("mass"), R("snow"))
    graph.parameter("mass", 2.2, "kg", std=0.0)
    graph.parameter("snow", 5.0, "N*s/m")
    graph.measure("speed", flow="sled")
    return graph.finish()


def recorded(seed, wandering):
    """Return a run whose reading wanders by so much, whatever the sled does."""
    rng = np.random.default_rng(seed)
    pull = np.repeat(rng.uniform(-20.0, 20.0, COUNT // 50), 50)
    decay = np.exp(-5.5 / 2.2 * STEP)
    speed = lfilter([0.0, 1.0], [1.0, -decay], (1.0 - decay) / 5.5 * pull)
    keeps = 0.998
    slow = lfilter([np.sqrt(1.0 - keeps**2)], [1.0, -keeps], rng.normal(size=COUNT))
    read = speed + NOISE * rng.normal(size=COUNT) + wandering * slow
    channels = {"pull": (pull, "N"), "speed": (read, "m/s")}
    time = STEP * np.arange(COUNT)
    return bind_to(sled(), Recording.from_arrays(f"run {seed}", time, channels))


@pytest.mark.parametrize(
    ("wandering", "verdict"), [(2e-3, Verdict.ADEQUATE), (0.08, Verdict.CANNOT_TELL)]
)
def test_a_reading_that_wanders_far_beyond_its_noise_is_not_told(wandering, verdict):
    runs = [recorded(seed, wandering) for seed in (1, 2)]
    settings = FitSettings(hold=Hold.ZERO)
    options = Options(library=(QuadraticDrag(),), settings=settings)
    answer = diagnose(sled(), runs, held_out=[recorded(3, wandering)], options=options)
    assert answer.verdict is verdict
    assert ("times its noise" in answer.statement) == (verdict is Verdict.CANNOT_TELL)
