"""A pump that pulsates: a ratio that varies several times in a turn is no torque."""

import numpy as np
import pytest

from bondgraph import (
    TF,
    BondGraph,
    C,
    FitSettings,
    Hold,
    I,
    R,
    Recording,
    Se,
    bind_to,
    diagnose,
)
from bondgraph.diagnosis.candidates import propose_all
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.base.horizons import refitted
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.estimate import fit_model
from bondgraph.fitting.horizon import Windows
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.position import Cogging
from bondgraph.physics.ratio import Eccentricity

STEP, COUNT, FINE = 0.005, 2000, 20
INERTIA, BEARING, RATIO, CUSHION, VALVE = 0.4, 0.3, 2.0, 0.02, 4.0
SINE, COSINE, PLUNGERS = 0.06, -0.04, 3


def pump():
    graph = BondGraph("pump", domain="rotation")
    graph.one("shaft", Se("torque"), I("rotor"), R("bearing"))
    graph.zero("head", C("cushion"), R("valve"), domain="hydraulic")
    graph.join("shaft", TF("plungers"), "head")
    graph.measure("angle", displacement="shaft")
    graph.measure("pressure", effort="head")
    graph.parameter("rotor", 1.1 * INERTIA, "kg*m^2")
    graph.parameter("bearing", 0.8 * BEARING, "N*m*s/rad")
    graph.parameter("plungers", RATIO, "1/m^3", std=0.02 * RATIO)
    graph.parameter("cushion", CUSHION, "m^3/Pa")
    graph.parameter("valve", 1.1 * VALVE, "Pa*s/m^3")
    return graph.finish()


def run(seed, mean=6.0, begin=(0.0, 0.0, 0.0)):
    """Return a recording of three plungers: the ratio swings thrice a turn."""
    rng = np.random.default_rng(seed)
    torque = mean + np.repeat(rng.uniform(-4.0, 4.0, COUNT // 100), 100)
    angle, speed, pressure = begin
    told = []
    for drive in torque:
        told.append((angle, pressure))
        for _ in range(FINE):
            phase = PLUNGERS * angle
            swing = 1.0 + SINE * np.sin(phase) + COSINE * np.cos(phase)
            # Of the model: the flow of the shaft over that of the head.
            ratio = RATIO * swing
            lost = BEARING * speed + pressure / ratio
            speed += STEP / FINE * (drive - lost) / INERTIA
            pressure += STEP / FINE * (speed / ratio - pressure / VALVE) / CUSHION
            angle += STEP / FINE * speed
    read = np.array(told) + rng.normal(size=(COUNT, 2)) * (2e-3, 0.02)
    channels = {
        "torque": (torque, "N*m"),
        "angle": (read[:, 0], "rad"),
        "pressure": (read[:, 1], "Pa"),
    }
    time = STEP * np.arange(COUNT)
    return bind_to(pump(), Recording.from_arrays(f"run {seed}", time, channels))


def test_it_is_told_from_a_torque_that_repeats():
    options = Options(
        library=(CoulombFriction(), Cogging(), Eccentricity()),
        settings=FitSettings(hold=Hold.ZERO),
    )
    answer = diagnose(pump(), [run(1), run(2)], held_out=[run(3)], options=options)
    assert answer.verdict is Verdict.PHYSICS_MISSING
    (found,) = answer.findings
    assert (found.physics, found.place) == ("eccentricity", "plungers")
    swings({one.name: one.value for one in found.estimates})


def swings(numbers):
    assert numbers["ripple_wave_shaft_plungers"] == pytest.approx(PLUNGERS, rel=1e-3)
    size = np.hypot(
        numbers["ripple_sine_shaft_plungers"], numbers["ripple_cosine_shaft_plungers"]
    )
    assert size == pytest.approx(np.hypot(SINE, COSINE), rel=0.1)


def test_a_fit_to_more_recordings_keeps_it():
    settings = FitSettings(hold=Hold.ZERO, horizon=Windows(250))
    speed = 30.0 / (BEARING + VALVE / RATIO**2)
    fast = [run(seed, 30.0, (4.6, speed, speed / RATIO * VALVE)) for seed in (1, 2)]
    base = fit_model(pump(), fast[:1], settings)
    law = propose_all(base, (Eccentricity(),))[-1]
    known = {"sine": SINE, "cosine": COSINE, "wave": float(PLUNGERS)}
    true = {f"ripple_{name}_shaft_plungers": x for name, x in known.items()}
    graph = law.apply(base.graph).with_parameters(base.values | true)
    fitted = fit_model(graph, fast[:1], settings, sigma=np.array((2e-3, 0.02)))
    swings(fitted.values)
    swings(refitted(fitted, fast, settings).values)
