"""Places that a model may change over with others: it is the same model then."""

import pytest
import sympy

from bondgraph import BondGraph, C, I, R, Se, Sf, effort, f
from bondgraph.diagnosis.answer.changed_over import with_images
from bondgraph.diagnosis.records import Finding
from bondgraph.fitting.result import Estimate
from bondgraph.structure.mirror import mirror_images

VALUES = {"left_pipe": 2.0, "right_pipe": 3.0, "left_bag": 0.4, "right_bag": 0.9}


def lungs(*, std=None, twisted=False, read="mouth", bags=True):
    """Return two branches behind a tube, with one stated value or one turned bond."""
    g = BondGraph("lungs", domain="hydraulic")
    g.one("tube", Se("blower"), R("tube_loss"), I("tube_mass"))
    g.zero("mouth", C("mouth_volume"))
    g.join("tube", "mouth")
    for side in ("left", "right"):
        g.one(side, R(f"{side}_pipe"))
        if bags or side == "left":
            g.zero(f"{side}_lung", C(f"{side}_bag"))
        else:
            g.zero(f"{side}_lung", R(f"{side}_bag"))
        g.join(*(("mouth", side) if side == "left" or not twisted else (side, "mouth")))
        g.join(side, f"{side}_lung")
    g.measure("flow", flow="tube")
    g.measure("pressure", effort=read)
    for name, value in VALUES.items():
        resists = name.endswith("pipe") or (name == "right_bag" and not bags)
        unit = "Pa*s/m^3" if resists else "m^3/Pa"
        g.parameter(name, value, unit, std=std if name == "left_bag" else None)
    for name, unit in (
        ("tube_loss", "Pa*s/m^3"),
        ("tube_mass", "Pa*s^2/m^3"),
        ("mouth_volume", "m^3/Pa"),
    ):
        g.parameter(name, 1.0, unit)
    return g.finish()


def images(graph, place):
    return {image.of(place) for image in mirror_images(graph)} - {place}


@pytest.mark.parametrize(
    ("place", "image"),
    [
        ("left", "right"),
        ("right_pipe", "left_pipe"),
        ("left_lung", "right_lung"),
        ("mouth>left", "mouth>right"),
    ],
)
def test_equal_branches_change_over(place, image):
    assert images(lungs(), place) == {image}


@pytest.mark.parametrize("place", ["tube", "mouth", "blower", "flow", "tube>mouth"])
def test_what_drives_and_what_is_read_stays(place):
    assert not images(lungs(), place)


@pytest.mark.parametrize(
    "graph",
    [
        lungs(std=0.1),
        lungs(std=0.0),
        lungs(twisted=True),
        lungs(read="left_lung"),
        lungs(bags=False),
    ],
    ids=["known", "held", "turned", "read", "other parts"],
)
def test_what_tells_them_apart_leaves_one(graph):
    assert not images(graph, "left")


def test_the_numbers_change_over_with_their_places():
    (other,) = (i for i in mirror_images(lungs()) if i.of("left") == "right")
    assert other.parameter["left_pipe"] == "right_pipe"
    assert other.parameter["tube_loss"] == "tube_loss"


def test_parts_that_share_a_number_change_over_only_with_each_other():
    law = sympy.Symbol("shared") * f
    g = BondGraph("three", domain="electrical")
    g.zero("node", Sf("source"), R("one", law=law), R("two", law=law), R("own"))
    g.measure("voltage", effort="node")
    g.parameter("shared", 2.0, "ohm")
    g.parameter("own", 2.0, "ohm")
    graph = g.finish()
    assert images(graph, "one") == {"two"}
    assert not images(graph, "own")


def test_a_number_that_a_reading_is_made_with_keeps_its_place():
    g = BondGraph("bridge", domain="electrical")
    g.zero("node", Sf("source"), R("one"), R("two"))
    g.measure("scaled", sympy.Symbol("one") * effort("node"), unit="V")
    for name in ("one", "two"):
        g.parameter(name, 2.0, "ohm")
    assert not images(g.finish(), "two")


def found(place="left"):
    return Finding(
        physics="quadratic_drag", place=place, element="it", statement="It is.", law="x"
    )


def fitted(**values):
    return [
        Estimate(name=name, value=value, std=0.1, unit="1", start=None)
        for name, value in values.items()
    ]


def test_a_finding_names_its_image_and_the_side_that_its_values_speak_for():
    swapped = fitted(left_pipe=3.0, right_pipe=2.0, left_bag=0.9, right_bag=0.4)
    (told,) = with_images([found()], lungs(), swapped)
    assert told.indistinguishable_places == ("right",)
    assert "left and right changed over" in told.statement
    assert "nearer with it at right" in told.statement
    (told,) = with_images([found()], lungs(), fitted(**VALUES))
    assert "nearer" not in told.statement


def test_a_finding_without_an_image_is_left_as_it_is():
    assert with_images([found("tube")], lungs(), fitted(**VALUES)) == [found("tube")]
    assert with_images([], lungs(), []) == []
