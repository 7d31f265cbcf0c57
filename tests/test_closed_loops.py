"""An axis in a position loop that works on noisy readings.

The loop feeds the noise back into what is commanded, and it reaches the drive's limit
only where friction lets it: what is missing hides behind what else is missing, and
nothing missing looks like structure.
"""

import numpy as np
import pytest

from bondgraph import (
    BondGraph,
    FitSettings,
    Hold,
    I,
    R,
    Recording,
    Se,
    Windows,
    bind_to,
)
from bondgraph.diagnosis.adequacy.adequacy import adequacy
from bondgraph.diagnosis.adequacy.records import AdequacyStatus
from bondgraph.diagnosis.answer.nothing_found import TRACE
from bondgraph.diagnosis.candidates import Promised, propose_all
from bondgraph.diagnosis.search.pairs.pairs import Pairing
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import fit_model
from bondgraph.physics.actuation import Saturation
from bondgraph.physics.friction import CoulombFriction

STEP, SUBSTEPS = 0.01, 20
ROTOR, BEARING, FRICTION, LIMIT = 0.02, 0.05, 0.12, 0.9


def axis():
    graph = BondGraph("axis", domain="rotation")
    graph.one("shaft", Se("torque"), I("rotor"), R("bearing"))
    graph.parameter("rotor", 0.023, "kg*m^2", bounds=(0, 1))
    graph.parameter("bearing", 0.045, "N*m*s/rad", bounds=(0, 1))
    graph.measure("angle", displacement="shaft")
    return graph.finish()


def recorded(seed, *, friction=0.0, limit=np.inf, noise=1e-3, samples=1800):
    """Return what the loop records: steps of its goal, held commands of a PD."""
    rng = np.random.default_rng(seed)
    goal = np.repeat(rng.choice([-0.6, -0.3, 0.0, 0.3, 0.6], samples // 90 + 1), 90)
    read = noise * rng.normal(size=samples)
    angle = speed = filtered = before = 0.0
    torques, angles = np.empty(samples), np.empty(samples)
    for k in range(samples):
        seen = angle + read[k]
        filtered += 0.3 * ((seen - before) / STEP * (k > 0) - filtered)
        before = seen
        torques[k], angles[k] = 4.0 * (goal[k] - seen) - 0.35 * filtered, seen
        acting, h = np.clip(torques[k], -limit, limit), STEP / SUBSTEPS
        for _ in range(SUBSTEPS):
            rubbing = friction * np.tanh(speed / 1e-3)
            # Implicit in the steep friction, that its smooth edge is followed.
            steep = BEARING + friction / 1e-3 * (1.0 - np.tanh(speed / 1e-3) ** 2)
            pushed = acting - BEARING * speed - rubbing
            speed += h * pushed / (ROTOR + h * steep)
            angle += h * speed
    channels = {"torque": (torques, "N*m"), "angle": (angles, "rad")}
    time = STEP * np.arange(samples)
    return bind_to(axis(), Recording.from_arrays(f"run {seed}", time, channels))


def test_a_limit_that_alone_explains_nothing_is_found_beside_friction():
    recording = recorded(38, friction=FRICTION, limit=LIMIT, samples=800)
    settings = FitSettings(horizon=Windows(75), hold=Hold.ZERO)
    base = fit_model(axis(), [recording], settings)
    everything = propose_all(base, (CoulombFriction(), Saturation()))
    friction = [Promised(h, 1.0) for h in everything if h.physics == "coulomb_friction"]
    with workshop(Here(), Journal(), lambda _: None) as shop:
        bench = Bench.of(base, shop, "round 1")
        pairing = Pairing.of(bench, friction, everything)
        pairs = pairing.best(10)
    alone = {c.partner.hypothesis.place: c.partner.cost for c in pairing.couples}
    assert alone["torque"] == pytest.approx(base.optimum.cost, rel=0.01)
    best = pairs[0]
    assert best.second.hypothesis.place == "torque"
    assert best.cost < 0.05 * min(base.optimum.cost, best.first.cost)
    assert best.both.fitted.values["coulomb_shaft"] == pytest.approx(FRICTION, rel=0.1)
    assert best.both.fitted.values["limit_torque"] == pytest.approx(LIMIT, rel=0.1)


def checked(recording, window):
    settings = FitSettings(horizon=Windows(window), hold=Hold.ZERO)
    return adequacy(fit_model(axis(), [recording], settings), [recording])


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_noise_that_the_loop_feeds_back_is_no_structure(seed):
    found = checked(recorded(seed, noise=5e-3), 300)
    assert found.status is AdequacyStatus.ADEQUATE


@pytest.mark.parametrize("seed", [1, 2])
def test_in_short_windows_it_leaves_a_trace_at_most(seed):
    # Their free initial states mix the noise of all their samples into each.
    found = checked(recorded(seed, noise=5e-3), 50)
    assert max(one.share for one in found.dependences) < TRACE


def test_friction_in_a_loop_is_structure():
    found = checked(recorded(5, friction=FRICTION), 300)
    assert found.status is AdequacyStatus.STRUCTURE
    assert max(one.share for one in found.dependences) > 0.5


def test_few_samples_are_checked_as_they_are():
    # Sixty are too few to estimate what a controller answers to.
    found = checked(recorded(5, friction=FRICTION, samples=60), 60)
    assert found.draws > 0
