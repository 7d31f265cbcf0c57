"""Sensors out of the way of bonds: their own lines are drawn last, and can go anywhere.

Where bonds of the skeleton come in beside each other, as at a hip with four modulated
transformers, the corner that a sensor was put in may be crossed by one of them. Such a
sensor is moved to the nearest place beside its node that nothing runs over.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from bondgraph.reporting.layout.boxes import Box, Point, Side

STEP = 12.0
FARTHEST = 20  # steps
DIRECTIONS = 16
AIR = 5.0
ARROW = 16.0  # room for the arrow from the node to its sensor

Line = Sequence[Point]


def clear_sensors(
    boxes: dict[str, Box],
    sides: dict[str, Side],
    lines: Iterable[Line],
    sensors: Mapping[str, str],
) -> None:
    """Move the sensors that a bond runs over; others and everything else stay.

    Parameters
    ----------
    boxes, sides
        Of everything, by name; changed in place.
    lines
        The bonds.
    sensors
        Names of sensors with the node or element that each is put on.
    """
    pieces = [piece for line in lines for piece in pairwise(line)]
    for sensor, host in sensors.items():
        box = boxes[sensor]
        if not any(box.meets(*piece) for piece in pieces):
            continue
        others = [other for name, other in boxes.items() if name != sensor]
        others.append(boxes[host].grown(ARROW))
        for place in _places(box, boxes[host]):
            roomy = place.grown(AIR)
            if not any(map(roomy.overlaps, others)) and not any(
                roomy.meets(*piece) for piece in pieces
            ):
                boxes[sensor] = place
                if sides[sensor] in (Side.ABOVE, Side.BELOW):
                    under = place.y > boxes[host].y
                    sides[sensor] = Side.BELOW if under else Side.ABOVE
                break


def _places(box: Box, host: Box) -> Iterator[Box]:
    """Yield places for a box around its host, those near to both first."""
    turns = [2 * math.pi * k / DIRECTIONS for k in range(DIRECTIONS)]
    around = [
        replace(
            box,
            x=host.x + step * STEP * math.cos(turn),
            y=host.y + step * STEP * math.sin(turn),
        )
        for step in range(1, FARTHEST + 1)
        for turn in turns
    ]
    yield from sorted(
        around,
        key=lambda place: (
            math.dist((place.x, place.y), (host.x, host.y))
            + 0.5 * math.dist((place.x, place.y), (box.x, box.y))
        ),
    )
