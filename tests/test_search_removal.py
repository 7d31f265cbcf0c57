"""What a later finding makes needless is taken out again."""

import numpy as np
import pytest
from rubbing_slider import proposed, slider

from bondgraph import Recording, bind_to
from bondgraph.diagnosis.candidates import propose_all
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.search.revising.removal import fitted_with, pruned
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.dynamics import Delay, Lag
from bondgraph.physics.friction import CoulombFriction, StribeckFriction


def recorded(graph, law):
    time = np.arange(1500) * 0.01
    speed = 0.5 * np.sin(1.3 * time) * np.sin(0.2 * time + 1)
    noise = 0.01 * np.random.default_rng(3).standard_normal(time.size)
    channels = {
        "speed": (speed, "m/s"),
        "force": (1.5 * speed + law(speed) + noise, "N"),
    }
    return bind_to(graph, Recording.from_arrays("run", time, channels))


def one_after_the_other(law, first, second):
    """Return the model without, with one and with both, and both hypotheses."""
    graph = slider()
    base = fit_model(graph, [recorded(graph, law)], FitSettings())
    one = proposed(base, first)
    narrow = fitted_with(base, base, [one], one.starts[0])
    other = proposed(narrow, second)
    start = {**one.starts[0], **other.starts[-1]}
    return base, narrow, fitted_with(base, narrow, [one, other], start), one, other


def stribeck(speed):
    return (0.8 + 0.6 * np.exp(-((speed / 0.1) ** 2))) * np.tanh(speed / 0.002)


def both(speed):
    return 0.8 * np.tanh(speed / 0.002) + 3.0 * speed * np.abs(speed)


def test_a_law_within_a_later_one_is_taken_out_though_that_has_more_parameters():
    base, before, after, coulomb, wide = one_after_the_other(
        stribeck, CoulombFriction(), StribeckFriction()
    )
    found = pruned(base, before, after, [coulomb, wide], Rule())
    assert found.kept == (wide,)
    assert found.removed == (coulomb,)
    rise, speed = (found.fitted.values[name] for name in wide.parameters[1:])
    assert rise == pytest.approx(0.6, rel=0.05)
    assert speed == pytest.approx(0.1, rel=0.1)


def test_two_laws_that_are_both_there_stay():
    base, before, after, coulomb, drag = one_after_the_other(
        both, CoulombFriction(), QuadraticDrag()
    )
    found = pruned(base, before, after, [coulomb, drag], Rule())
    assert found.kept == (coulomb, drag)
    assert found.removed == ()


def test_a_delay_found_behind_a_lag_takes_its_place():
    graph, late = slider(), 8
    time = np.arange(1500) * 0.01
    speed = 0.5 * np.sin(1.3 * time) * np.sin(4.2 * time + 1)
    force = 1.5 * np.roll(speed, late)[late:]
    force += 0.001 * np.random.default_rng(3).standard_normal(force.size)
    channels = {"speed": (speed[late:], "m/s"), "force": (force, "N")}
    recording = bind_to(graph, Recording.from_arrays("run", time[late:], channels))
    base = fit_model(graph, [recording], FitSettings())
    lag, _ = (h for h in propose_all(base, (Lag(),)) if h.place == "force")
    before = fitted_with(base, base, [lag], lag.starts[0])
    (delay,) = (h for h in propose_all(before, (Delay(),)) if h.place == "force")
    after = fitted_with(base, before, [lag, delay], delay.starts[1])
    found = pruned(base, before, after, [lag, delay], Rule())
    assert found.removed == (lag,)
    assert found.fitted.values["delay_force"] == pytest.approx(0.08, rel=0.02)
