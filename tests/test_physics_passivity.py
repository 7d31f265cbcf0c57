"""What may only take power takes power only, and what stores gives it all back.

The element's port is driven along random closed motions, for parameters anywhere within
their bounds: by numpy, from the law alone.
"""

import numpy as np
import pytest
import sympy
from physics_machines import MACHINES
from proposed import PROPOSED

from bondgraph.physics.hypothesis import Passivity
from bondgraph.physics.library import LIBRARY
from bondgraph.structure.domains import THERMAL
from bondgraph.structure.edits import InsertElement, LoosenBond, SeveralEdits
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    Inertance,
    Resistance,
)
from bondgraph.structure.signals import Signal, displacement, e, f, flow, q

SAMPLES, FINE = 4000, 160_000
"""Of a motion; finer for what goes up and down hundreds of times on its way."""


def cases(*passivities):
    """Return inserted elements with these passivities, one per entry and law."""
    found = {}
    for name, place, physics, hypothesis in PROPOSED:
        # A thermal graph is a pseudo bond graph: e f is no power.
        if physics.passivity in passivities and place.domain is not THERMAL:
            key = type(physics), len(hypothesis.parameters), place.domain
            size = getattr(place, "displacement", 1.0)
            found.setdefault(key, (name, hypothesis, size))
    return [
        pytest.param(*case, id=f"{case[0]}-{case[1].element}")
        for case in found.values()
        if isinstance(case[1].edit, InsertElement | LoosenBond | SeveralEdits)
    ]


def drawn(hypothesis, edited, random):
    """Return parameter values within their bounds, of the size of their starts."""
    values = {}
    for name, parameter in edited.parameters.items():
        value = parameter.value or 0.0
        if name in hypothesis.parameters:
            start = hypothesis.starts[-1][name] or 1.0
            low, high = parameter.bounds
            value = np.clip(start * random.uniform(0.3, 3.0), low, high)
        values[sympy.Symbol(name, real=True)] = float(value)
    return values


def motion(random, size, samples=SAMPLES):
    """Return one period of a smooth motion and its rate, over time 2 pi."""
    time = np.linspace(0.0, 2.0 * np.pi, samples + 1)
    waves = np.arange(1, 5)[:, None]
    height, phase = random.normal(size=(4, 1)), random.uniform(0, 2 * np.pi, (4, 1))
    way = (height * np.sin(waves * time + phase)).sum(axis=0)
    rate = (height * waves * np.cos(waves * time + phase)).sum(axis=0)
    scale = size / np.abs(way).max()
    return time, scale * way, scale * rate


def work(element, values, way, rate, time, states, place):
    """Return the energy that goes into the element along the motion (its flow, q)."""
    random = np.random.default_rng(9)
    inner = integrated(states, values, rate, time, place)
    if isinstance(element, EffortSource):
        law, sign = element.value, -1.0
    else:
        law, sign = element.law, 1.0
    names = {f: rate, q: way, flow(place): rate, displacement(place): way, **inner}
    for symbol in law.xreplace(values).free_symbols - names.keys():
        names[symbol] = random.normal() * np.ones_like(time)
        if isinstance(symbol, Signal) and symbol.quantity == "displacement":
            names[symbol] = way
        if symbol == e:  # a law of effort: the motion is that of the effort
            names[symbol] = way
    run = sympy.lambdify(list(names), law.xreplace(values), "numpy")
    answer = sign * run(*names.values()) + 0.0 * time
    other = way if e in law.free_symbols else rate
    return np.trapezoid(answer * other, time), answer * other


def integrated(states, values, rate, time, place):
    """Return the states of signals along the motion, by small explicit steps."""
    found = {}
    for state in states:
        law = state.rate.xreplace(values)
        step = sympy.lambdify([flow(place), state.value], law, "math")
        z, along = 0.0, np.empty_like(time)
        for _ in range(2):  # the second time round the loop is closed
            for i, flowing in enumerate(rate):
                along[i] = z
                z += step(flowing, z) * (time[1] - time[0])
        found[state.value] = along
    return found


def elements_of(hypothesis):
    """Return the one-ports that the edit adds, with the junction they see."""
    edit = hypothesis.edit
    if isinstance(edit, SeveralEdits):
        edit = edit.edits[0]
    if isinstance(edit, InsertElement):
        return [(edit.element, edit.junction)], edit.states
    return [(element, edit.name) for element in edit.elements], ()


@pytest.mark.parametrize(("name", "hypothesis", "reach"), cases(Passivity.DISSIPATIVE))
def test_what_dissipates_never_gives_more_than_it_got(name, hypothesis, reach):
    edited = hypothesis.apply(MACHINES[name])
    random = np.random.default_rng(4)
    parts, states = elements_of(hypothesis)
    for _ in range(5):
        values = drawn(hypothesis, edited, random)
        time, way, rate = motion(random, 2.0 * reach * random.uniform(0.2, 2.0))
        for element, place in parts:
            total, power = work(element, values, way, rate, time, states, place)
            scale = np.trapezoid(np.abs(power), time)
            if isinstance(element, Resistance):
                assert (power >= -1e-12 * np.abs(power).max()).all()
            assert total >= -2e-3 * scale
            assert np.isfinite(power).all()


@pytest.mark.parametrize(("name", "hypothesis", "reach"), cases(Passivity.STORING))
def test_what_stores_gives_it_all_back(name, hypothesis, reach):
    edited = hypothesis.apply(MACHINES[name])
    random = np.random.default_rng(6)
    ((element, place),), _ = elements_of(hypothesis)
    if isinstance(element, Inertance | Compliance):
        # Linear and positive: an energy p²/2I or q²/2C.
        assert element.law is None
        assert edited.parameters[element.name].bounds[0] >= 0.0
        return
    for _ in range(5):
        values = drawn(hypothesis, edited, random)
        time, way, rate = motion(random, reach * random.uniform(0.2, 2.0), FINE)
        total, power = work(element, values, way, rate, time, (), place)
        assert abs(total) <= 2e-3 * np.trapezoid(np.abs(power), time)


def test_entries_that_carry_no_power_say_so():
    signals = {x.word for x in LIBRARY if x.passivity is Passivity.SIGNAL}
    assert signals == {
        "backlash",  # of an input
        "sensor_scale",
        "sensor_bias",
        "sensor_nonlinearity",
        "sensor_swap",
        "input_scale",
        "input_swap",
        "lag",
        "delay",
        "saturation",
        "dead_zone",
        "input_nonlinearity",
    }
