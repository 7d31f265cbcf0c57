"""A law is not tried where something that is fitted already does the same."""

import pytest
import sympy
from physics_machines import known

from bondgraph import BondGraph, C, FinishedGraph, I, R, Se, Sf
from bondgraph.physics.coupling import Drag, SharedInertia, Tie
from bondgraph.physics.induction import InducedCurrent
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.one_way import DirectionDependentDamping
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.places.source import actuators
from bondgraph.physics.relaxation import StoreAmid, StoreBehind
from bondgraph.physics.thermal import TemperatureDependentResistance
from bondgraph.physics.viscoelastic import RelaxingSpring
from bondgraph.structure.domains import DOMAINS
from bondgraph.structure.elements import Compliance, Inertance, Resistance
from bondgraph.structure.signals import (
    Signal,
    displacement,
    effort,
    f,
    flow,
    parameters_in,
)

NO_TWINS = (
    StoreBehind,
    StoreAmid,
    RelaxingSpring,
    InducedCurrent,
    DirectionDependentDamping,
    Drag,
    Tie,
    SharedInertia,
)


def words_at(graph: FinishedGraph) -> set[str]:
    """Return what the library proposes for a graph, at any place.

    A store behind a resistance, amid one or beside one has a store's word, damping
    that of dry friction, and what is between two motions that of what is at one; they
    are no twins.
    """
    plain = [physics for physics in LIBRARY if not isinstance(physics, NO_TWINS)]
    return {
        hypothesis.physics
        for place in all_places(graph, Scales())
        for physics in plain
        for hypothesis in physics.propose(place)
    }


LINEAR = {
    "viscous_friction": (Resistance, R, "one"),
    "leak": (Resistance, R, "zero"),
    "spring": (Compliance, C, "one"),
    "added_inertia": (Inertance, I, "one"),
    "added_compliance": (Compliance, C, "zero"),
}


@pytest.mark.parametrize("word", LINEAR)
def test_a_linear_element_with_a_free_value_is_not_proposed_again(word):
    kind, element, junction = LINEAR[word]
    domain = "rotation" if junction == "one" else "hydraulic"

    def words(std):
        g = BondGraph("axle", domain=domain)
        source = Se("torque") if junction == "one" else Sf("flow_in")
        other = R if kind is not Resistance else I if junction == "one" else C
        add = g.one if junction == "one" else g.zero
        add("axle", source, other("J"), element("own"))
        reads = "displacement" if junction == "one" else "effort"
        g.measure("theta", **{reads: "axle"})
        g.parameter("own", 1.0, _linear_unit(kind, domain), std=std)
        return words_at(known(g, J=(1.0, _linear_unit(KINDS[other], domain))))

    assert word not in words(std=None)
    assert word in words(std=0.0)
    assert word in words(std=0.1)


KINDS = {R: Resistance, I: Inertance, C: Compliance}


def _linear_unit(kind, domain_name):
    domain = DOMAINS[domain_name]
    above, below = {
        Resistance: (domain.effort_unit, domain.flow_unit),
        Inertance: (domain.momentum_unit, domain.flow_unit),
        Compliance: (domain.displacement_unit, domain.effort_unit),
    }[kind]
    return f"({above})/({below})"


def biased(expression, std=None):
    g = BondGraph("biased", domain="translation")
    names = [s.name for s in sympy.sympify(expression).free_symbols]
    g.one("cart", Se("force"), I("m"), Se("offset", value=expression))
    g.measure("x", displacement="cart")
    for name in names:
        g.parameter(name, 0.5, "N", std=std)
    return known(g, m=(1.0, "kg"))


def test_a_fitted_constant_source_is_a_bias_already():
    bias = sympy.Symbol("bias")
    twice = {"constant_bias", "direction_dependent_friction"}
    assert not words_at(biased(bias)) & twice
    assert not words_at(biased(bias, std=0.1)) & twice
    assert twice <= words_at(biased(bias, std=0.0))
    assert twice <= words_at(biased(sympy.Integer(3)))


def test_an_offset_or_factor_that_is_fitted_already_is_not_proposed_of_a_sensor():
    def words(expression):
        g = BondGraph("cart", domain="translation")
        g.one("cart", Se("force"), I("m"), C("k"))
        g.measure("x", expression, unit="m")
        g.parameter("own", 0.5, "m" if expression.is_Add else "1")
        return words_at(known(g, m=(1.0, "kg"), k=(1.0, "m/N")))

    own, x = sympy.Symbol("own", real=True), Signal("displacement", "cart")
    assert "sensor_bias" not in words(x + own)
    assert "sensor_scale" in words(x + own)
    assert "sensor_bias" in words(x * own)
    assert "sensor_scale" not in words(x * own)


def test_laws_of_position_need_a_position_that_is_known():
    def words(*, measured):
        g = BondGraph("free cart", domain="rotation")
        g.one("shaft", Se("torque"), I("J"))
        g.measure("w", flow="shaft")
        if measured:
            g.measure("angle", displacement="shaft")
        return words_at(known(g, J=(1.0, "kg*m^2")))

    gained = words(measured=True) - words(measured=False)
    laws = {"gravity", "spring", "hardening_spring", "end_stop", "cogging"}
    assert gained == laws | {"backlash"}  # That of a sensor that reads a position.
    # An angle that nothing else reads has a free origin, which is its sensor's offset.
    assert words(measured=False) - words(measured=True) == set()


def test_beside_an_offset_and_dry_friction_no_second_slope_is_tried():
    def tried(**more):
        g = BondGraph("door", domain="rotation")
        g.one("hinge", Se("hand"), I("leaf"), R("oil"), *more.values())
        g.measure("angle", displacement="hinge")
        for name in more:
            g.parameter(name, 0.5, "N*m")
        graph = known(g, leaf=(1.0, "kg*m^2"), oil=(1.0, "N*m*s/rad"))
        (hinge,) = (p for p in all_places(graph, Scales()) if p.name == "hinge")
        return bool(list(DirectionDependentDamping().propose(hinge)))

    offset = Se("pretension", value=sympy.Symbol("offset"))
    dry = R("seal", law=sympy.Symbol("dry") * sympy.tanh(f))
    assert tried(offset=offset)
    assert tried(dry=dry)
    assert not tried(offset=offset, dry=dry)


@pytest.mark.parametrize(("domain", "least"), [("rotation", 2.0), ("electrical", 0.01)])
def test_a_body_warms_slower_than_a_wire(domain, least):
    g = BondGraph("worn", domain=domain)
    g.one("part", Se("push"), I("own"), R("loss"))
    g.measure("rate", flow="part")
    units = _linear_unit(Inertance, domain), _linear_unit(Resistance, domain)
    graph = known(g, own=(1.0, units[0]), loss=(1.0, units[1]))
    for place in all_places(graph, Scales(interval=1e-3, duration=0.5)):
        for law in TemperatureDependentResistance().propose(place):
            (time,) = (p for p in law.edit.parameters if p.unit == "s")
            assert time.bounds[0] == least
            assert all(start[time.name] >= least for start in law.starts)


def test_an_actuator_is_steered_by_a_command_and_by_the_machine():
    def steered(value):
        g = BondGraph("arm", domain="rotation")
        g.zero("command", Se("goal"), domain="analogue")
        g.one("arm", Se("hand"), I("own"), Se("drive", value=value))
        g.measure("angle", displacement="arm")
        return list(actuators(known(g, own=(1.0, "kg*m^2"))))

    assert steered(effort("command") - displacement("arm")) == ["drive"]
    assert steered(effort("goal") - flow("arm")) == ["drive"]
    assert not steered(2 * effort("command"))
    # What the hand moves is no command, though it moves what the hand is on.
    assert not steered(-flow("arm") - displacement("arm"))


def test_a_constant_set_point_steers_where_signals_count_against_it_in_proportion():
    def steered(value):
        g = BondGraph("wheel", domain="rotation")
        g.one("wheel", I("own"), R("loss"), Se("drive", value=value))
        g.measure("rate", flow="wheel")
        numbers = dict.fromkeys(parameters_in(value), (3.0, "1"))
        own = {"own": (1.0, "kg*m^2"), "loss": (0.1, "N*m*s/rad")}
        return list(actuators(known(g, **own, **numbers)))

    gain, goal = sympy.symbols("gain goal")
    assert steered(gain * (goal - flow("wheel"))) == ["drive"]
    assert not steered(gain * goal)
    assert not steered(-gain * flow("wheel"))
    assert not steered(gain * sympy.cos(flow("wheel")) + goal)
    assert not steered(gain * (goal - flow("wheel") ** 2))
