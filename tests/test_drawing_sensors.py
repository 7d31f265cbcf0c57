"""Sensors of the planar leg stand where no bond runs, near what they read."""

import math
from itertools import combinations, pairwise

import pytest

from bondgraph.reporting.picture.bond_labels import BondLabels
from bondgraph.reporting.picture.canvas import Content, Picture
from bondgraph.reporting.picture.causal_marks import CausalMarks
from flegx_models import planar_leg


@pytest.mark.parametrize("leg", ["flying_leg", "standing_leg"])
def test_no_bond_runs_over_a_sensor_of_the_planar_leg(leg: str) -> None:
    content = Content(
        causality=CausalMarks(),
        colouring=None,
        inserted=frozenset(),
        labels=BondLabels.NONE,
        signals=True,
    )
    picture = Picture(getattr(planar_leg, leg)().finish(), content)
    boxes, sensors = picture.layout.boxes, picture.sensors
    assert "theta_hip" in {sensor.measurement.name for sensor in sensors}
    pieces = [piece for path in picture.layout.paths for piece in pairwise(path)]
    for sensor in sensors:
        box = boxes[sensor.key]
        assert not any(box.meets(*piece) for piece in pieces), sensor.key
        host = boxes[sensor.on]
        assert math.dist((box.x, box.y), (host.x, host.y)) < 200.0
    overlaps = [
        (one, other)
        for one, other in combinations(boxes, 2)
        if boxes[one].overlaps(boxes[other])
    ]
    assert overlaps == []
