"""What recordings cannot show, or what no machine has, is not proposed."""

import pytest
from physics_machines import MACHINES, known, scales_of

from bondgraph import BondGraph, C, I, R, Se, Sf, displacement, flow
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales


def proposed(graph, scales=None):
    return [
        hypothesis
        for place in all_places(graph, scales or Scales())
        for physics in LIBRARY
        for hypothesis in physics.propose(place)
    ]


def pendulum(*, driven):
    g = BondGraph("pendulum", domain="rotation")
    torque = (Se("torque"),) if driven else ()
    g.one("pivot", *torque, I("inertia"), C("weight"), R("bearing"))
    g.measure("angle", displacement="pivot")
    return known(
        g,
        inertia=(1.0, "kg*m^2"),
        weight=(1.0, "rad/(N*m)"),
        bearing=(0.1, "N*m*s/rad"),
    )


@pytest.mark.parametrize("driven", [True, False])
def test_what_moves_by_itself_shows_no_delay(driven):
    late = {
        one.place for one in proposed(pendulum(driven=driven)) if one.physics == "delay"
    }
    assert late == ({"torque", "angle"} if driven else set())


def test_a_delay_needs_an_input_that_changes():
    still = Scales(ranges={"effort(torque)": (2.0, 2.0)})
    found = proposed(pendulum(driven=True), still)
    assert "delay" not in {one.physics for one in found}


def sharing(graph):
    return [one for one in proposed(graph) if "share a supply" in one.words]


def test_inputs_of_one_kind_may_share_a_supply_but_not_signals():
    places = {(one.place, one.parameters) for one in sharing(MACHINES["heaters"])}
    assert places == {
        ("heater1", ("share_lost_to_heater2_heater1",)),
        ("heater2", ("share_lost_to_heater1_heater2",)),
    }
    assert not sharing(MACHINES["dc_drive"])  # a voltage and a current
    g = BondGraph("signals", domain="translation")
    for name in ("goal", "gain"):
        g.one(f"on_{name}", Sf(name), domain="analogue")
    force = flow("gain") * (flow("goal") - displacement("cart"))
    g.one("cart", Se("push", value=force), I("mass"))
    g.measure("position", displacement="cart")
    assert not sharing(known(g, mass=(1.0, "kg")))


def test_slow_friction_is_of_steady_tables():
    graph = MACHINES["wheel"]
    moving = scales_of(graph)
    rows = Scales(moving.sizes, moving.ranges, least={"flow(shaft)": 0.02})
    for scales, there in ((moving, False), (rows, True)):
        words = [one.words for one in proposed(graph, scales)]
        assert any("where it is slow" in told for told in words) is there


@pytest.mark.parametrize(
    ("least", "most", "may_be_folded"),
    [
        (-1.0, 1.0, True),
        (0.0, 1.0, True),
        (0.05, 1.0, True),
        (0.5, 1.0, False),
        (-1.0, -0.1, False),
    ],
)
def test_a_reading_without_a_sign_comes_near_to_zero(least, most, may_be_folded):
    read = Scales(ranges={"angle": (least, most)})
    words = [one.words for one in proposed(pendulum(driven=True), read)]
    assert any("the size and not the sign" in one for one in words) == may_be_folded
