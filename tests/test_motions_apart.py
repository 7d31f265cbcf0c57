"""Two motions that nothing joins in the model may act on each other all the same."""

import numpy as np
import pytest
from physics_machines import MACHINES
from scipy.linalg import expm

from bondgraph import GY, TF, BondGraph, C, I, R, Recording, Se, bind_to, diagnose
from bondgraph.physics.coupling import Drag, GyroscopicCoupling, SharedInertia, Tie
from bondgraph.physics.places.apart import (
    inputs_apart_from,
    motions_apart,
    motions_beside,
    moving_apart_from,
)
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.pair import ApartPair, MotionPair
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.unknown import UnknownRelation
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict
from bondgraph.structure.signals import Signal

STEP, COUNT, NOISE, SPIN = 0.01, 1200, 2e-4, 0.03
MASS, STIFF, LOSS = (0.08, 0.05), (2.0, 2.6), (0.06, 0.04)


def head(gears=()):
    """Return two axes with a motor each; of those in `gears` behind a gear."""
    g = BondGraph("head", domain="rotation")
    for axis in ("pan", "tilt"):
        parts = (I(f"{axis}_mass"), C(f"{axis}_cable"), R(f"{axis}_bearing"))
        if axis in gears:
            g.one(f"{axis}_motor", Se(f"{axis}_torque"), I(f"{axis}_rotor"))
            g.one(axis, *parts)
            g.join(f"{axis}_motor", TF(f"{axis}_gear"), axis)
        else:
            g.one(axis, Se(f"{axis}_torque"), *parts)
        g.measure(f"{axis}_angle", displacement=axis)
    return g


def fitted_head():
    g = head()
    for axis, mass, cable, loss in (
        ("pan", 0.07, 0.55, 0.07),
        ("tilt", 0.06, 0.35, 0.05),
    ):
        g.parameter(f"{axis}_mass", mass, "kg*m^2", bounds=(1e-3, 1.0))
        g.parameter(f"{axis}_cable", cable, "rad/(N*m)", bounds=(1e-2, 10.0))
        g.parameter(f"{axis}_bearing", loss, "N*m*s/rad", bounds=(1e-4, 1.0))
    return g.finish()


def names(graph):
    return list(motions_apart(graph, [j.name for j in graph.junctions]))


def test_two_axes_are_apart_and_two_ends_of_a_spring_are_not():
    assert names(MACHINES["two_axes"]) == [("pan", "tilt")]
    assert names(MACHINES["two_masses"]) == []
    assert names(MACHINES["geared_arm"]) == []


def test_a_winding_and_the_shaft_that_it_turns_are_no_pair():
    assert names(MACHINES["dc_drive"]) == []


def test_two_motors_on_one_supply_turn_apart():
    g = BondGraph("two motors", domain="electrical")
    g.zero("supply", Se("voltage"))
    for side in ("left", "right"):
        g.one(f"{side}_winding", R(f"{side}_resistance"))
        g.one(side, I(f"{side}_rotor"), domain="rotation")
        g.join("supply", f"{side}_winding")
        g.join(f"{side}_winding", GY(f"{side}_constant"), side)
        g.measure(f"{side}_speed", flow=side)
    graph = g.finish()
    assert names(graph) == [("left", "right")]
    assert inputs_apart_from(graph, "left") == ()  # one voltage drives both


def test_of_motions_that_a_gear_ties_together_one_stands_for_all():
    graph = head(gears=("pan",)).finish()
    assert names(graph) == [("pan", "tilt")]
    assert moving_apart_from(graph, "tilt") == ("pan",)
    assert moving_apart_from(graph, "pan_motor") == ()
    assert inputs_apart_from(graph, "tilt") == ("pan_torque",)


def frame(wheels):
    """Return a frame with so many wheels on springs."""
    g = BondGraph("frame", domain="translation")
    g.one("frame", Se("push"), I("frame_mass"))
    for n in range(wheels):
        g.one(f"wheel{n}", I(f"mass{n}"))
        g.zero(f"joint{n}")
        g.one(f"strut{n}", C(f"spring{n}"), R(f"loss{n}"))
        for bond in (("frame", f"joint{n}"), (f"joint{n}", f"wheel{n}")):
            g.join(*bond)
        g.join(f"joint{n}", f"strut{n}")
    g.measure("travel", displacement="frame")
    return g.finish()


def beside(graph):
    return motions_beside(graph, [j.name for j in graph.junctions])


def test_two_wheels_on_one_frame_are_beside_each_other():
    assert beside(frame(2)) == (("wheel0", "wheel1"),)
    assert len(beside(frame(4))) == 6
    assert beside(frame(9)) == ()  # 36 pairs of ten motions: no two likelier
    assert names(frame(2)) == []


def test_in_a_chain_only_next_but_one_is_beside():
    g = BondGraph("chain", domain="rotation")
    for n in range(4):
        g.one(f"disc{n}", I(f"mass{n}"))
    for n in range(3):
        g.zero(f"shaft{n}", C(f"spring{n}"))
        g.join(f"disc{n}", f"shaft{n}")
        g.join(f"shaft{n}", f"disc{n + 1}")
    g.measure("angle", displacement="disc0")
    assert beside(g.finish()) == (("disc0", "disc2"), ("disc1", "disc3"))


def test_beside_each_other_there_is_drag_and_a_spring_where_both_are_known():
    graph = frame(2)
    (place,) = (x for x in all_places(graph, Scales()) if isinstance(x, MotionPair))
    assert not isinstance(place, ApartPair)
    for physics, count in ((Drag(), 1), (Tie(), 1), (GyroscopicCoupling(), 0)):
        laws = list(physics.propose(place))
        assert len(laws) == count
        assert all(law.apply(graph).nodes != graph.nodes for law in laws)
    (tie,) = Tie().propose(place)
    struts = {signal.name for signal in tie.law.atoms(Signal)}
    assert struts == {"displacement(strut0)", "displacement(strut1)"}


def test_laws_of_a_pair_say_both_ends():
    (place,) = (
        place
        for place in all_places(MACHINES["two_axes"], Scales())
        if isinstance(place, MotionPair)
    )
    for physics in (GyroscopicCoupling(), SharedInertia()):
        for law in physics.propose(place):
            assert (law.place, law.other_end) == ("pan", "tilt")
            assert {"pan", "tilt"} <= set(law.words.replace(",", "").split())


def test_what_another_axis_or_its_input_does_is_a_curve_of_its_own():
    for place in all_places(MACHINES["two_axes"], Scales()):
        if place.name == "pan" and not isinstance(place, MotionPair):
            told = [law.words for law in UnknownRelation().propose(place)]
            for what in ("the angular velocity of tilt", "the angle of tilt"):
                assert f"a torque that is an unnamed function of {what}" in told
            assert "a torque that is an unnamed function of tilt_torque" in told


def spun():
    """Return both angles of axes that a spinning wheel couples, under held torques."""
    random = np.random.default_rng(12)
    torques = np.repeat(random.uniform(-0.3, 0.3, (COUNT // 40, 2)), 40, axis=0)
    mass, stiff, loss = map(np.diag, (MASS, STIFF, LOSS))
    spin = SPIN * np.array([[0.0, 1.0], [-1.0, 0.0]])
    inverse = np.linalg.inv(mass)
    rates = np.zeros((6, 6))
    rates[:2, 2:4] = np.eye(2)
    rates[2:4] = np.hstack([-inverse @ stiff, -inverse @ (loss + spin), inverse])
    step = expm(STEP * rates)
    state, told = np.zeros(4), []
    for torque in torques:
        told.append(state[:2])
        state = step[:4] @ np.concatenate([state, torque])
    return torques, np.array(told) + NOISE * random.standard_normal((COUNT, 2))


@pytest.fixture(scope="module")
def diagnosis():
    torques, angles = spun()
    graph, time = fitted_head(), STEP * np.arange(COUNT)

    def run(name, rows):
        channels = {
            "pan_torque": (torques[rows, 0], "N*m"),
            "tilt_torque": (torques[rows, 1], "N*m"),
            "pan_angle": (angles[rows, 0], "rad"),
            "tilt_angle": (angles[rows, 1], "rad"),
        }
        return bind_to(graph, Recording.from_arrays(name, time[rows], channels))

    train, held = run("train", slice(720)), run("held", slice(720, COUNT))
    return diagnose(graph, [train], held_out=[held])


@pytest.mark.long
def test_a_spinning_wheel_between_two_axes_is_found_between_them(diagnosis):
    (finding,) = diagnosis.findings
    assert finding.physics == "gyroscopic_coupling"
    assert {finding.place, finding.other_end} == {"pan", "tilt"}
    assert "between pan and tilt was left out" in finding.statement
    assert "do not tell" not in finding.statement
    (estimate,) = finding.estimates
    assert abs(estimate.value) == pytest.approx(SPIN, rel=0.01)
    assert "apart" not in diagnosis.next_experiment


@pytest.mark.long
def test_the_other_end_is_told_to_programs(diagnosis):
    (finding,) = diagnosis_to_dict(diagnosis)["findings"]
    assert finding["other_end"] == "tilt"
    assert finding["indistinguishable_places"] == ["tilt"]
