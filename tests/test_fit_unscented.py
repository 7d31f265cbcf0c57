"""The unscented filter beside the extended one, against a filter of many particles."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    I,
    R,
    Recording,
    Sdirk2,
    Se,
    bind_to,
    displacement,
    f,
    q,
)
from bondgraph.equations.deriving.derivation import derive
from bondgraph.fitting.kalman.filter_setting import Unknowns
from bondgraph.fitting.kalman.filter_start import filter_starts
from bondgraph.fitting.kalman.filtering import filtered
from bondgraph.fitting.kalman.innovations import InnovationStatus, fit_innovations
from bondgraph.fitting.kalman.kalman_choices import Extended, Unscented
from bondgraph.numeric.model import compile_model
from bondgraph.numeric.states_read import with_states_read
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold
from bondgraph.structure.hard_contact import hard_contact

STIFF, STEP, N = 5.0, 0.1, 60
HELD = FitSettings(hold=Hold.ZERO)
START, SPREAD = np.array([0.0, 0.3]), np.array([0.04, 0.04])


def torque(angle, bend):
    return {"none": angle, "sine": np.sin(angle), "distance": angle}[bend] * STIFF


def read(angle, bend):
    return np.sqrt(0.04 + angle**2) if bend == "distance" else angle


def rotor(bend):
    """A shaken rotor on a spring that bends, or seen by its distance only."""
    k, angle = sympy.Symbol("k", real=True), displacement("spring")
    graph = BondGraph("rotor", domain="rotation")
    law = k * (sympy.sin(q) if bend == "sine" else q)
    graph.one("mass", Se("push"), I("J"), R("b"), C("spring", law=law))
    distance = sympy.sqrt(sympy.Rational(1, 25) + angle**2)
    graph.measure("y", distance if bend == "distance" else angle, unit="rad")
    graph.parameter("J", 1.0, "kg*m**2", std=0.0)
    graph.parameter("b", 1.0, "N*m*s/rad", std=0.0)
    graph.parameter("k", 4.0, "N*m")
    return graph.finish()


def shaken(graph, bend, *, shaking, noise, push):
    random, h = np.random.default_rng(0), STEP / 20
    x, y = np.zeros(2), np.zeros(N)
    u = np.repeat(push * random.normal(size=N // 10 + 1), 10)[:N]
    for i in range(N):
        y[i] = read(x[1], bend) + noise * random.normal()
        for _ in range(20):
            rate = np.array([u[i] - x[0] - torque(x[1], bend), x[0]])
            x = x + h * rate + [shaking * np.sqrt(h) * random.normal(), 0.0]
    channels = {"push": (u, "N*m"), "y": (y, "rad")}
    made = Recording.from_arrays("shaken", STEP * np.arange(N), channels)
    return bind_to(graph, made), u, y


def by_particles(bend, u, y, *, shaking, noise, count=20_000):
    """Return minus the log-likelihood, as `Filtered.loss`, by a bootstrap filter."""
    random, h, total = np.random.default_rng(1), STEP / 10, 0.0
    x = START[:, None] + np.sqrt(SPREAD)[:, None] * random.normal(size=(2, count))
    for i in range(N):
        weights = -0.5 * ((y[i] - read(x[1], bend)) / noise) ** 2
        top = weights.max()
        weights = np.exp(weights - top)
        total -= np.log(weights.mean()) + top - np.log(noise)
        places = np.cumsum(weights) / weights.sum()
        kept = np.searchsorted(places, (np.arange(count) + random.random()) / count)
        x = x[:, np.minimum(kept, count - 1)]
        for _ in range(10):
            shock = shaking * np.sqrt(h) * random.normal(size=count)
            turned = h * (u[i] - x[0] - torque(x[1], bend)) + shock
            x = np.stack([x[0] + turned, x[1] + h * (x[0] + 0.5 * turned)])
    return total


def losses(bend, *, shaking, noise, push):
    """Return minus the log-likelihoods: extended, unscented, by particles."""
    graph = rotor(bend)
    noises = {"shaking": shaking, "noise": noise}
    recording, u, y = shaken(graph, bend, push=push, **noises)
    setting, _ = filter_starts(graph, [recording], None, HELD, Extended())
    setting = replace(setting, initial=START[None], spread=SPREAD)
    at = Unknowns(np.array([STIFF]), np.log([shaking]), np.log([noise]))
    found = [filtered(replace(setting, kalman=k), at, None) for k in KALMAN]
    return found[0].loss, found[1].loss, by_particles(bend, u, y, **noises)


KALMAN = (Extended(), Unscented())


def test_where_the_output_bends_only_the_unscented_filter_knows_how_likely_it_is():
    extended, unscented, exact = losses("distance", shaking=0.6, noise=0.05, push=0.5)
    assert abs(unscented - exact) < 3.0
    assert abs(extended - exact) > 30.0


def test_where_laws_bend_little_both_filters_are_right():
    extended, unscented, exact = losses("sine", shaking=1.0, noise=0.3, push=4.0)
    assert abs(extended - exact) < 0.3
    assert abs(unscented - exact) < 0.3


def test_on_a_linear_machine_both_filters_are_one():
    graph = rotor("none")
    recording, _, _ = shaken(graph, "none", shaking=1.0, noise=0.05, push=4.0)
    fits = [
        fit_innovations(graph, [recording], settings=HELD, kalman=k) for k in KALMAN
    ]
    for found in fits:
        assert found.status is InnovationStatus.CONVERGED
    one, other = fits
    assert one.estimate("k").value == pytest.approx(other.estimate("k").value, rel=1e-6)
    assert one.log_likelihood == pytest.approx(other.log_likelihood, abs=1e-6)


@pytest.mark.parametrize("stop", [False, True])
def test_states_are_read_in_every_form_of_a_model(stop):
    tau = sympy.Symbol("tau", real=True)
    graph = BondGraph("rubbing", domain="translation")
    graph.one("mass", I("m"), C("spring"), R("rub", law=tau * sympy.sign(f)))
    if stop:
        law = hard_contact(displacement("spring") - tau, sympy.Rational(1, 2))
        graph.put(R("stop", law=law), on="mass")
    graph.measure("x", displacement("spring"), unit="m")
    model = with_states_read(compile_model(derive(graph.finish())))
    time = 0.01 * np.arange(200)
    shot = shoot(
        model,
        Shots(time, np.zeros((200, 0)), np.zeros((200, 0)), (0, 200)),
        parameters=np.array(
            [{"m": 1.0, "spring": 0.01, "tau": 0.04}[n] for n in model.parameter_names]
        ),
        initial=np.array([[1.0, 0.0]]),
        directions=None,
        solver=Sdirk2(),
        hold=Hold.FIRST,
    )
    assert shot.completed.all()
    assert model.output_names == ("x", "p_m", "q_spring")
    assert shot.outputs[:, 1:] == pytest.approx(shot.states)
    assert shot.outputs[:, 0] == pytest.approx(shot.states[:, 1])
    assert bool(shot.impacts and shot.impacts[0]) == stop
