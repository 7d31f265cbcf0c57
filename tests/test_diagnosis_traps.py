"""Known traps of locating missing physics, on a simulated cart that misses nothing.

It is simulated here with numpy alone, by semi-implicit Euler at a fine step, so that no
law of the library makes the data that test it.
"""

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Se
from bondgraph.diagnosis.diagnose import diagnose
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.estimate import FitSettings
from bondgraph.recordings.binding import bind
from bondgraph.recordings.recording import Recording
from bondgraph.simulation.solvers import Hold

STEP, FINE, DURATION = 0.005, 10, 6.0
TIME = np.arange(0.0, DURATION, STEP)


def multisine(seed, size=6.0):
    rng = np.random.default_rng(seed)
    waves = np.outer(TIME, rng.uniform(0.2, 3.0, 8))
    return (
        size * np.sin(2 * np.pi * waves + rng.uniform(0, 2 * np.pi, 8)).sum(axis=1) / 2
    )


def simulated(force, *, mass=1.3, viscous=2.0):
    """Return the position of a mass under a force, less its viscous friction."""
    fine = STEP / FINE
    x, v = 0.0, 0.0
    position = np.empty(TIME.size)
    for i in range(TIME.size):
        position[i] = x
        for _ in range(FINE):
            v += fine * (force[i] - viscous * v) / mass
            x += fine * v
    return position


def recorded(name, applied, position, noise=2e-4, seed=0, coloured=0.0):
    white = np.random.default_rng(seed + 10_000).standard_normal(TIME.size)
    error = np.empty(TIME.size)
    error[0] = white[0]
    for i in range(1, TIME.size):
        error[i] = coloured * error[i - 1] + np.sqrt(1 - coloured**2) * white[i]
    channels = {"force": (applied, "N"), "position": (position + noise * error, "m")}
    recording = Recording.from_arrays(name, TIME, channels)
    return bind(recording, {"force": "N"}, {"position": "m"})


def cart(mass=1.05, friction=2.4):
    graph = BondGraph("cart", domain="translation")
    graph.one("wheel", Se("force"), I("mass"), R("viscous"))
    graph.measure("position", displacement="wheel")
    graph.parameter("mass", mass, "kg", bounds=(0.01, 100))
    graph.parameter("viscous", friction, "N*s/m", bounds=(0, 100))
    return graph.finish()


def pair(seed, *, noise=2e-4, coloured=0.0):
    """Return a training and a held-out recording, with different excitation."""
    made = []
    for one in (seed, seed + 50):
        drive = multisine(one)
        made.append(
            recorded(f"run {one}", drive, simulated(drive), noise, one, coloured)
        )
    return made


def diagnosed(graph, training, held_out):
    settings = FitSettings(hold=Hold.ZERO)
    return diagnose(
        graph, [training], held_out=[held_out], options=Options(settings=settings)
    )


def test_wrong_start_values_are_not_missing_physics():
    # A base fit that ends too early looks like a discovery.
    diagnosis = diagnosed(cart(mass=6.0, friction=20.0), *pair(1))
    assert diagnosis.verdict is Verdict.ADEQUATE, diagnosis.statement
    assert diagnosis.fit_before.estimate("mass").value == pytest.approx(1.3, rel=0.01)


@pytest.mark.long
def test_coloured_noise_of_a_sensor_is_not_physics():
    training, held_out = pair(1, noise=5e-4, coloured=0.95)
    diagnosis = diagnosed(cart(), training, held_out)
    assert diagnosis.findings == (), diagnosis.statement
