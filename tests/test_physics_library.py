"""Every entry of the physics library: it fits in, starts at nothing, units agree."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pint
import pytest
from physics_machines import MACHINES, Array, known, outputs
from proposed import PROPOSED, SCALES

from bondgraph import BondGraph, C, FinishedGraph, R, Sf, derive
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.one_way import OneWayPassage
from bondgraph.physics.orifice import Overflow
from bondgraph.physics.places.channels import ChannelPlace
from bondgraph.physics.places.everywhere import all_places, machine_junctions
from bondgraph.physics.places.junction import ZeroJunctionPlace
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.places.source import ActuatorPlace
from bondgraph.physics.relaxation import StoreBehind
from bondgraph.physics.thermal import TemperatureDependentResistance
from bondgraph.structure.edits import (
    InsertElement,
    ReplaceMeasurement,
    ReplaceRelation,
    SeveralEdits,
    SwapInputs,
    SwapMeasurements,
    WrapInput,
)
from bondgraph.structure.elements import (
    Compliance,
    FlowSource,
    Gyrator,
    Inertance,
    Transformer,
)
from bondgraph.structure.signals import Signal, e, f, p, q, t

VOCABULARY = set(
    "coulomb_friction stribeck_friction load_dependent_friction viscous_friction "
    "quadratic_drag gravity spring hardening_spring end_stop backlash compliance "
    "hysteresis added_inertia added_compliance constant_bias cogging delay lag "
    "saturation dead_zone leak overflow square_root_orifice saturating_inertia "
    "temperature_dependent_resistance voltage_drop sensor_scale sensor_bias "
    "sensor_nonlinearity unknown_relation".split(" ")
)
"""The words a diagnosis is asked for; the library has some more."""


@cache
def base(name: str) -> Array:
    """Return the outputs of a machine to which nothing is added."""
    return outputs(MACHINES[name])


@cache
def edited(number: int) -> FinishedGraph:
    name, _, _, hypothesis = PROPOSED[number]
    return hypothesis.apply(MACHINES[name])


def kinds(
    wanted: Callable[[Hypothesis], bool] = lambda _: True,
) -> pytest.MarkDecorator:
    """Run a test once for every kind of hypothesis: entry, edit, domain and size."""
    chosen = {}
    for i, (name, place, physics, hypothesis) in enumerate(PROPOSED):
        kind = (
            type(physics),
            type(hypothesis.edit),
            place.domain,
            len(hypothesis.parameters),
            hypothesis.depends_on[:1],
        )
        if wanted(hypothesis):
            label = f"{name}-{type(physics).__name__}-{hypothesis.place}-{i}"
            chosen.setdefault(kind, pytest.param(i, id=label))
    return pytest.mark.parametrize("number", list(chosen.values()))


def test_every_entry_proposes_something_and_says_what_it_is():
    for physics in LIBRARY:
        proposed = [h for _, _, origin, h in PROPOSED if origin is physics]
        assert proposed, type(physics).__name__
        assert {h.physics for h in proposed} == {physics.word}
        assert type(physics).__doc__
        for text in (physics.reference, physics.signature):
            assert text.strip() == text != ""


def test_every_word_of_the_vocabulary_is_proposed_somewhere():
    assert {h.physics for _, _, _, h in PROPOSED} >= VOCABULARY


def test_places_are_called_as_the_user_calls_them():
    for name, place, _, hypothesis in PROPOSED:
        graph = MACHINES[name]
        users = {*graph.by_name, *(m.name for m in graph.measurements)}
        assert {hypothesis.place, *hypothesis.also} <= users
        assert hypothesis.place == place.name
        assert hypothesis.place not in hypothesis.also


@pytest.mark.parametrize("number", range(len(PROPOSED)))
def test_it_fits_into_the_graph_and_is_told_in_words(number):
    name, _, _, hypothesis = PROPOSED[number]
    graph, new = MACHINES[name], edited(number)
    known_names = {*new.by_name, *(m.name for m in new.measurements)}
    assert hypothesis.element in known_names
    edits = getattr(hypothesis.edit, "edits", (hypothesis.edit,))
    changes = isinstance(
        edits[0], ReplaceRelation | ReplaceMeasurement | SwapMeasurements | SwapInputs
    )
    before = {*graph.by_name, *(m.name for m in graph.measurements)}
    assert (hypothesis.element in before) is changes
    assert hypothesis.words.strip() == hypothesis.words != ""
    assert hypothesis.edit.describe()
    assert hypothesis.starts
    assert [m.name for m in new.measurements] == [m.name for m in graph.measurements]
    assert [s.name for s in new.inputs] == [s.name for s in graph.inputs]
    for start in hypothesis.starts:
        # Its own parameters; values of the graph's may begin elsewhere too.
        assert set(hypothesis.parameters) <= set(start) <= set(new.parameters)
        for parameter, value in start.items():
            low, high = new.parameters[parameter].bounds
            assert low <= value <= high
    assert set(hypothesis.strengths) <= set(hypothesis.parameters)
    states = getattr(hypothesis.edit, "states", ())
    rates = [state.rate for state in states]
    used = {s.name for x in (hypothesis.law, *rates) for s in x.free_symbols}
    own = {parameter.name for parameter in hypothesis.edit.parameters}
    assert used & own or not own
    assert len(new.parameters) <= len(graph.parameters) + len(
        hypothesis.edit.parameters
    )


@kinds()
def test_it_starts_at_nothing(number):
    name, _, physics, hypothesis = PROPOSED[number]
    # A rigid bond that gives way a little, a delay of a fraction of a sample: nearly.
    rest = hypothesis.silent_starts[0] if hypothesis.silent_starts else {}
    silent = any(rest.get(strength) == 0.0 for strength in hypothesis.strengths)
    nearly = 1e-6 if silent else 2e-2
    size = np.abs(base(name)).max(axis=0)
    for start in hypothesis.silent_starts[:4]:
        # What lags starts from rest, and has caught up after a few samples.
        change = np.abs(outputs(edited(number), start) - base(name))[5:].max(axis=0)
        assert (change <= nearly * size).all(), type(physics).__name__


def test_every_entry_that_is_nested_has_a_silent_start():
    for _, _, physics, hypothesis in PROPOSED:
        assert bool(hypothesis.silent_starts) is hypothesis.edit.nested, physics


@kinds()
def test_it_does_something_at_its_last_start(number):
    name, _, _, hypothesis = PROPOSED[number]
    start = dict(hypothesis.starts[-1])
    for parameter in hypothesis.strengths:
        start[parameter] = start[parameter] or 0.05
    if hypothesis.silent_starts and not hypothesis.strengths:
        for parameter in start:
            start[parameter] *= 1.2
    change = np.abs(outputs(edited(number), start) - base(name)).max()
    assert change > 1e-7


# Metres, kilograms, seconds, amperes and kelvins made smaller by these factors. A law
# keeps its meaning in any units, so its value must change as its own unit says.
FACTORS = {
    "[length]": 3.0,
    "[mass]": 7.0,
    "[time]": 2.0,
    "[current]": 5.0,
    "[temperature]": 11.0,
}
REGISTRY: pint.UnitRegistry = pint.UnitRegistry()


@cache
def _factor(unit: str) -> float:
    """Return how much larger the number of a quantity gets in the smaller units."""
    dimensions = REGISTRY.Quantity(1.0, unit.replace("^", "**")).dimensionality
    return math.prod(
        FACTORS[name] ** float(power) for name, power in dimensions.items()
    )


def _in_other_units(expression, graph, own):
    """Return an expression's value at a point, and at the same point in other units.

    `own` holds the units of port variables and of states.
    """
    random = np.random.default_rng(3)
    here, there = {}, {}
    for symbol in sorted(expression.free_symbols, key=str):
        if symbol in own:
            unit = own[symbol]
        elif isinstance(symbol, Signal):
            unit = graph.domain_at(symbol.place).unit(symbol.quantity)
        elif symbol == t:
            unit = "s"
        else:
            unit = graph.parameters[symbol.name].unit
        value = random.uniform(0.2, 0.9)
        here[symbol], there[symbol] = value, value * _factor(unit)
    return float(expression.xreplace(here)), float(expression.xreplace(there))


def _unit_held(place, state, graph):
    """Return the unit of a reading that a loop sees late; None of anything else."""
    for reading in getattr(place, "readings", ()):
        if f"_of_{reading.place}" in state.name:
            return graph.domain_at(reading.place).unit(reading.quantity)
    return None


@kinds(lambda h: h.physics not in ("cogging", "gravity", "eccentricity", "radiation"))
def test_units_of_new_parameters_fit(number):
    """The law has the unit of what it gives, its states' rates theirs per second.

    Laws with sines have angles in them, radiation a number of kelvins.
    """
    _, place, _, hypothesis = PROPOSED[number]
    new, domain = edited(number), place.domain
    edit = hypothesis.edit
    if isinstance(edit, SeveralEdits):
        edit = edit.edits[0]
    own = {
        e: domain.effort_unit,
        f: domain.flow_unit,
        q: domain.displacement_unit,
        p: domain.momentum_unit,
    }
    states = getattr(edit, "states", ())
    driving = isinstance(place, ChannelPlace | ActuatorPlace)
    channel = place.channel_unit if driving else "1"
    own |= {state.value: _unit_held(place, state, new) or channel for state in states}
    if isinstance(edit, ReplaceMeasurement | SwapMeasurements | SwapInputs | WrapInput):
        expected = channel
    else:
        expected = _unit_of(new.by_name[hypothesis.element], hypothesis, domain)
    changed = isinstance(edit, ReplaceRelation)
    if changed and isinstance(new.by_name[hypothesis.element], Gyrator):
        expected = new.parameters[hypothesis.element].unit  # Its ends are no likes.
    before, after = _in_other_units(hypothesis.law, new, own)
    assert after == pytest.approx(before * _factor(expected), rel=1e-9)
    for state in states:
        before, after = _in_other_units(state.rate, new, own)
        rate = _factor(f"({own[state.value]})/s")
        assert after == pytest.approx(before * rate, rel=1e-9)


def _unit_of(element, hypothesis, domain):
    """Return the unit of what the law gives: of a gear between like domains none."""
    law = hypothesis.law
    if isinstance(element, Transformer):
        return "1"
    if isinstance(element, Gyrator):
        return f"({domain.effort_unit})/({domain.flow_unit})"
    if q in law.free_symbols:
        return domain.effort_unit
    if isinstance(element, Inertance):
        return domain.flow_unit if p in law.free_symbols else domain.momentum_unit
    if isinstance(element, Compliance):
        return domain.displacement_unit
    flowing = isinstance(element, FlowSource) or e in law.free_symbols
    return domain.flow_unit if flowing else domain.effort_unit


@kinds(lambda h: isinstance(h.edit, InsertElement))
def test_a_second_one_at_the_same_place_gets_a_name_of_its_own(number):
    name, _, physics, hypothesis = PROPOSED[number]
    graph = edited(number)
    for place in all_places(graph, SCALES[name]):
        if place.name != hypothesis.place:
            continue
        for other in physics.propose(place):
            if isinstance(other.edit, InsertElement):
                assert not set(other.parameters) & set(graph.parameters)
                assert len(other.apply(graph).nodes) > len(graph.nodes)


def test_what_carries_signals_only_is_no_place():
    """After an edit with memory, the next round looks at the machine's places only."""
    for number, (name, _, _, hypothesis) in enumerate(PROPOSED):
        states = getattr(hypothesis.edit, "states", ())
        if states or isinstance(hypothesis.edit, WrapInput):
            graph = edited(number)
            before = {j.name for j in machine_junctions(MACHINES[name])}
            assert {j.name for j in machine_junctions(graph)} == before
            names = {place.name for place in all_places(graph, Scales())}
            assert not {state.name for state in states} & names


def test_a_0_junction_has_no_displacement_even_where_a_c_sits():
    for name, place, _, _ in PROPOSED:
        if isinstance(place, ZeroJunctionPlace):
            assert not place.displacement_known, (name, place.name)


def test_typical_sizes_that_are_unknown_or_zero_do_not_divide_by_zero():
    for name in ("slider", "geared_arm", "two_tanks", "heaters"):
        graph = MACHINES[name]
        zero = Scales({f"flow({j.name})": 0.0 for j in graph.junctions})
        for place in all_places(graph, zero):
            for physics in LIBRARY:
                for hypothesis in physics.propose(place):
                    numbers = [x for s in hypothesis.starts for x in s.values()]
                    exact = [p.value for p in hypothesis.edit.parameters if p.exact]
                    assert np.isfinite([*numbers, *exact]).all()


def test_words_suit_the_domain():
    electrical = {
        h.physics
        for name, place, _, h in PROPOSED
        if name == "dc_drive" and place.domain.name == "electrical"
    }
    assert "voltage_drop" in electrical
    assert not electrical & {"coulomb_friction", "stribeck_friction", "overflow"}
    thermal = {h.physics for name, _, _, h in PROPOSED if name == "heaters"}
    assert {"radiation", "leak", "lag"} <= thermal
    assert not thermal & {"coulomb_friction", "square_root_orifice", "voltage_drop"}


@pytest.mark.parametrize(
    ("reached", "seen", "ways"),
    [
        ((-3.0, 5.0), ("lower", "upper"), [True, False]),
        ((1.0, 5.0), ("lower", "upper"), []),
        ((-3.0, 5.0), ("lower",), []),
    ],
    ids=["both ways", "one way", "as far as the model says"],
)
def test_heat_passes_more_easily_one_way_where_it_is_seen_to_turn(reached, seen, ways):
    g = BondGraph("two rooms, one above the other", domain="thermal")
    for room in ("lower", "upper"):
        g.zero(room, C(f"{room}_air"), Sf(f"{room}_heater"))
    for room in seen:
        g.measure(f"{room}_temperature", effort=room)
    g.one("stairs", R("opening"))
    g.join("lower", "stairs")
    g.join("stairs", "upper")
    rooms = known(
        g, lower_air=(9.0, "J/K"), upper_air=(8.0, "J/K"), opening=(2.0, "K/W")
    )
    scales = Scales({"flow(stairs)": 4.0}, {"flow(stairs)": reached})
    (opening,) = (p for p in all_places(rooms, scales) if p.name == "opening")
    proposed = list(OneWayPassage().propose(opening))
    assert ["passes less back" in one.words for one in proposed] == ways
    assert all(len(one.strengths) == 1 for one in proposed)  # nothing opens it


def test_every_kind_of_hypothesis_can_be_solved_for():
    """Causality and equations: no conflict, no law that cannot be inverted."""
    for number in range(0, len(PROPOSED), 8):
        equations = derive(edited(number))
        assert len(equations.states) == len(equations.rates)


@pytest.mark.parametrize(
    ("reached", "bottom"), [((2.0, 9.0), 2.0), ((-3.0, 5.0), 0.0), ((-8.0, -2.0), -8.0)]
)
def test_an_edge_is_nowhere_below_all_that_was_there(reached, bottom):
    # It would be a leak or a bias, and bend the law that is really missing.
    scales = Scales({"effort(upper)": 4.0}, {"effort(upper)": reached})
    graph = MACHINES["two_tanks"]
    (upper,) = (p for p in all_places(graph, scales) if p.name == "upper")
    for hypothesis in Overflow().propose(upper):
        edge = next(p for p in hypothesis.edit.parameters if "level" in p.name)
        assert edge.bounds[0] == bottom
        starts = [start["overflow_level_upper"] for start in hypothesis.starts]
        assert all(bottom < level < reached[1] for level in starts)


def test_only_of_a_coil_it_is_said_that_it_warms():
    # A filter that clogs changes alike, and no temperature is seen.
    said = {
        (place.domain.name == "electrical", h.words.endswith("as it warms"))
        for _, place, physics, h in PROPOSED
        if isinstance(physics, TemperatureDependentResistance)
        and place.domain.name != "thermal"
    }
    assert said == {(True, True), (False, False)}


@pytest.mark.parametrize("samples", [20, 5000])
def test_a_second_store_is_slower_than_an_error_of_the_clock(samples):
    scales = Scales(interval=0.1, duration=0.1 * samples)
    for place in all_places(MACHINES["two_tanks"], scales):
        for hypothesis in StoreBehind().propose(place):
            (time,) = (p for p in hypothesis.edit.parameters if p.unit == "s")
            assert time.bounds[0] == pytest.approx(0.5)
            assert all(start[time.name] > 0.5 for start in hypothesis.starts)
