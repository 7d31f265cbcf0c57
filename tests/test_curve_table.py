"""A curve without a name can be read in a terminal, without a page."""

from types import SimpleNamespace

import numpy as np

from bondgraph.diagnosis.records import RecoveredLaw
from bondgraph.reporting.curve_table import POINTS, WIDTH, curve_tables

SPEED = np.array([0.5, -1.0, 1.0, 0.0])


def told(place, physics, speed=SPEED):
    """Return what the terminal shows of a force of minus twice the speed."""
    law = RecoveredLaw(
        place="cart",
        argument_name="velocity",
        argument_unit="m/s",
        value_name="force",
        value_unit="N",
        argument=np.array([]),
        value=np.array([]),
        curve_argument=speed,
        curve_value=-2.0 * speed,
    )
    finding = SimpleNamespace(place=place, physics=physics)
    diagnosis = SimpleNamespace(findings=(finding,), recovered=(law,))
    return list(curve_tables(diagnosis))


def test_a_curve_is_a_table_and_a_picture_in_the_order_of_its_argument():
    title, table = told("cart", "unknown_relation")
    assert "cart" in title
    heading, _, *lines = table.rstrip().splitlines()
    assert "velocity [m/s]" in heading
    assert "force [N]" in heading
    assert len(lines) == POINTS
    numbers = [line.split()[:2] for line in lines]
    assert numbers[0] == ["−1", "2"]
    assert numbers[-1] == ["1", "−2"]
    dots = [line.index("●") for line in lines]
    assert dots == sorted(dots, reverse=True)
    assert dots[0] - dots[-1] == WIDTH - 1
    assert all("│" in line for line in lines if "●" in line and "0" not in line.split())


def test_laws_with_a_name_and_empty_curves_have_no_table():
    assert told("cart", "coulomb_friction") == []
    assert told("shaft", "unknown_relation") == []
    assert told("cart", "unknown_relation", SPEED[:0]) == []
