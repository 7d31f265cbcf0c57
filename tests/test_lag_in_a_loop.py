"""A loop whose sensor is filtered: the motor overshoots; nothing is recorded late."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    Hold,
    I,
    MSe,
    MSf,
    R,
    Recording,
    Se,
    bind_to,
    diagnose,
    displacement,
    effort,
    flow,
    q,
)
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.dynamics import Delay, Lag
from bondgraph.physics.friction import CoulombFriction

STEP, COUNT, FINE = 0.01, 1500, 20
INERTIA, LOSS, GAIN, FILTER = 0.02, 0.05, 0.8, 0.06
REPEATED = 0.25


def motor():
    gain = sympy.Symbol("gain")
    graph = BondGraph("motor with a speed controller", domain="rotation")
    graph.zero("command", Se("goal"), domain="analogue")
    error = effort("command") - flow("shaft")
    graph.zero("errors", MSf("rate", value=error), C("sum", law=q), domain="analogue")
    drive = MSe("drive", value=gain * (error + displacement("sum") / REPEATED))
    graph.one("shaft", drive, I("inertia"), R("loss"))
    graph.parameter("inertia", INERTIA, "kg*m^2", std=0.0)
    graph.parameter("gain", 0.9 * GAIN, "N*m*s/rad")
    graph.parameter("loss", 1.2 * LOSS, "N*m*s/rad")
    graph.measure("speed", flow="shaft")
    return graph.finish()


def run(seed):
    """Return a recording of steps of the goal; the loop sees the speed filtered."""
    rng = np.random.default_rng(seed)
    goal = np.repeat(rng.uniform(-5.0, 5.0, COUNT // 75), 75)
    speed = seen = errors = 0.0
    told = []
    for asked in goal:
        told.append(speed)
        for _ in range(FINE):
            torque = GAIN * (asked - seen + errors / REPEATED)
            errors += STEP / FINE * (asked - seen)
            speed, seen = (
                speed + STEP / FINE * (torque - LOSS * speed) / INERTIA,
                seen + STEP / FINE * (speed - seen) / FILTER,
            )
    read = np.array(told) + 0.01 * rng.normal(size=COUNT)
    channels = {"goal": (goal, "1"), "speed": (read, "rad/s")}
    time = STEP * np.arange(COUNT)
    return bind_to(motor(), Recording.from_arrays(f"run {seed}", time, channels))


def test_what_the_loop_reads_is_told_as_late():
    options = Options(
        library=(CoulombFriction(), Lag(), Delay()),
        settings=FitSettings(hold=Hold.ZERO),
    )
    answer = diagnose(motor(), [run(1), run(2)], held_out=[run(3)], options=options)
    assert answer.verdict is Verdict.PHYSICS_MISSING
    found, *_ = answer.findings
    assert (found.physics, found.place) == ("lag", "drive")
    assert "what drive reads of shaft comes with a lag" in answer.statement
    (time,) = (one.value for one in found.estimates)
    assert time == pytest.approx(FILTER, rel=0.1)
