"""The elements on one node: on which side each hangs, and how much room they take.

A source comes from the left where the row begins; the others go above and below in
turn, the third to the right where the row ends. Where bonds leave a node on every side,
its elements hang in the corners between them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from bondgraph.reporting.layout.boxes import Box, LabelSize, Point, Side

UPRIGHT = 40.0  # shortest bond to an element above or below
ACROSS = 46.0  # and to one beside
SLOT_GAP = 14.0
STACK_GAP = 6.0
TIER = 30.0  # from an element to the sensor on it
CLEARANCE = 4.0  # from a box to the bond that ends at it
PASSING = 12.0  # from the middle of a bond to what it passes

_BASE = {Side.ABOVE: 0.0, Side.BELOW: 0.05, Side.RIGHT: 0.9, Side.LEFT: 1.2}
_IN_A_CORNER = 1.5
_OUTWARD = 0.6
_STACKED = 3.0  # a second one beside a node is in the way of those above and below


@dataclass(slots=True)
class Fan:
    """The elements around one node, relative to its centre.

    Attributes
    ----------
    boxes, sides, paths
        By element: its box, the side it hangs on, its bond from the node outwards.
    above, middle, below
        How far the three levels of a node reach to the left and right.
    up, down
        How far everything reaches upwards and downwards.
    """

    boxes: dict[str, Box] = field(default_factory=dict)
    sides: dict[str, Side] = field(default_factory=dict)
    paths: dict[str, tuple[Point, Point]] = field(default_factory=dict)
    above: tuple[float, float] | None = None
    middle: tuple[float, float] = (0.0, 0.0)
    below: tuple[float, float] | None = None
    up: float = 0.0
    down: float = 0.0


@dataclass(frozen=True, slots=True)
class Hanging:
    """What hangs on a node: elements in order, and the sensors on each of them."""

    elements: Sequence[str]
    sources: frozenset[str]
    sensors: Mapping[str, Sequence[str]]
    sizes: Mapping[str, LabelSize]
    room: Callable[[str], float]  # length of an element's bond that its label needs
    outward: frozenset[Side] = frozenset()  # sides with nothing of the skeleton beyond
    beside: float = 0.0  # width of what is written beside an upright bond


def fan_of(size: tuple[float, float], taken: frozenset[Side], hanging: Hanging) -> Fan:
    """Return the fan of a node of `size` whose sides in `taken` have other bonds."""
    by_side = _sides(taken, hanging)
    fan = Fan()
    width, height = size
    fan.middle = (width / 2, width / 2)
    fan.up = fan.down = height / 2
    for side in (Side.LEFT, Side.RIGHT):
        _stack(fan, side, by_side[side], size, hanging)
    beside = fan.up - height / 2
    for side in (Side.ABOVE, Side.BELOW):
        _row(fan, side, by_side[side], size, (hanging, side in taken, beside))
    for side in taken & {Side.ABOVE, Side.BELOW}:
        _widen(fan, side, PASSING, PASSING)
    return fan


def _sides(taken: frozenset[Side], hanging: Hanging) -> dict[Side, list[str]]:
    by_side: dict[Side, list[str]] = {side: [] for side in _BASE}
    waiting = list(hanging.elements)
    driving = [name for name in waiting if name in hanging.sources]
    if driving and Side.LEFT not in taken:
        by_side[Side.LEFT].append(driving[0])
        waiting.remove(driving[0])

    def cost(side: Side) -> float:
        corner = _IN_A_CORNER if side in taken else 0.0
        outward = _OUTWARD if side in hanging.outward else 0.0
        each = _STACKED if side in (Side.LEFT, Side.RIGHT) else 1.0
        return _BASE[side] + each * len(by_side[side]) + corner - outward

    open_sides = [s for s in _BASE if s in (Side.ABOVE, Side.BELOW) or s not in taken]
    for name in waiting:
        by_side[min(open_sides, key=cost)].append(name)
    return by_side


def _cluster(name: str, side: Side, hanging: Hanging) -> tuple[float, float]:
    """Return the room of an element with the sensors beyond it."""
    width, height = hanging.sizes[name].on(side)
    sensors = [hanging.sizes[s].on(side) for s in hanging.sensors.get(name, ())]
    if not sensors:
        return width, height
    if side in (Side.LEFT, Side.RIGHT):
        stack = sum(h + STACK_GAP for _, h in sensors) - STACK_GAP
        return width + TIER + max(w for w, _ in sensors), max(height, stack)
    row = sum(w + SLOT_GAP for w, _ in sensors) - SLOT_GAP
    return max(width, row), height + TIER + max(h for _, h in sensors)


def _stack(
    fan: Fan,
    side: Side,
    names: Sequence[str],
    size: tuple[float, float],
    hanging: Hanging,
) -> None:
    """Put elements to the left or right of the node, one under the other."""
    if not names:
        return
    sign = 1 if side is Side.RIGHT else -1
    clusters = [_cluster(name, side, hanging) for name in names]
    total = sum(h + STACK_GAP for _, h in clusters) - STACK_GAP
    reach = size[0] / 2 + max([ACROSS, *(hanging.room(name) for name in names)])
    y = -total / 2
    for name, (_, room) in zip(names, clusters, strict=True):
        width, height = hanging.sizes[name].on(side)
        middle = y + room / 2
        box = Box(sign * (reach + width / 2), middle, width, height)
        _hang(fan, name, side, box)
        leaves = _between(middle * 0.35, size[1] / 2 - 6)
        start = (sign * (size[0] / 2 + CLEARANCE), leaves)
        fan.paths[name] = (start, (sign * (reach - CLEARANCE), middle))
        _sensors_beside(fan, name, side, hanging)
        y += room + STACK_GAP
    outer = reach + max(w for w, _ in clusters)
    left, right = fan.middle
    fan.middle = (max(left, outer), right) if sign < 0 else (left, max(right, outer))
    fan.up, fan.down = max(fan.up, total / 2), max(fan.down, total / 2)


def _sensors_beside(fan: Fan, name: str, side: Side, hanging: Hanging) -> None:
    sensors = hanging.sensors.get(name, ())
    box, sign = fan.boxes[name], 1 if side is Side.RIGHT else -1
    heights = [hanging.sizes[s].on(side)[1] for s in sensors]
    y = box.y - (sum(heights) + STACK_GAP * (len(heights) - 1)) / 2
    for sensor, height in zip(sensors, heights, strict=True):
        width = hanging.sizes[sensor].on(side)[0]
        x = box.x + sign * (box.width / 2 + TIER + width / 2)
        _hang(fan, sensor, side, Box(x, y + height / 2, width, height))
        y += height + STACK_GAP


def _row(
    fan: Fan,
    side: Side,
    names: Sequence[str],
    size: tuple[float, float],
    where: tuple[Hanging, bool, float],
) -> None:
    """Put elements above or below the node, next to each other."""
    hanging, taken, beside = where
    if not names:
        return
    if not taken:
        _row_part(fan, side, names, size, (hanging, None, beside))
        return
    half = (len(names) + 1) // 2
    _row_part(fan, side, names[:half], size, (hanging, 1, beside))
    _row_part(fan, side, names[half:], size, (hanging, -1, beside))


def _row_part(
    fan: Fan,
    side: Side,
    names: Sequence[str],
    size: tuple[float, float],
    where: tuple[Hanging, int | None, float],
) -> None:
    """Put elements in a row: centred, or to the right (1) or left (-1) of a bond."""
    hanging, aside, beside = where
    if not names:
        return
    sign = 1 if side is Side.BELOW else -1
    clusters = [_cluster(name, side, hanging) for name in names]
    widths = [max(width, 2.6 * hanging.beside) for width, _ in clusters]
    total = sum(widths) + SLOT_GAP * (len(widths) - 1)
    passing = PASSING + 0.8 * hanging.beside
    left = -total / 2 if aside is None else passing if aside > 0 else -passing - total
    widest = max(abs(left + widths[0] / 2), abs(left + total - widths[-1] / 2))
    room = max(UPRIGHT, *(hanging.room(name) for name in names))
    gap = max(room + 0.16 * max(0.0, widest - 30), beside + 10)
    reach = size[1] / 2 + gap
    x = left
    for name, slot in zip(names, widths, strict=True):
        width, height = hanging.sizes[name].on(side)
        middle = x + slot / 2
        _hang(fan, name, side, Box(middle, sign * (reach + height / 2), width, height))
        leaves = _between(middle * 0.4, size[0] / 2 - 7)
        start = (leaves, sign * (size[1] / 2 + CLEARANCE))
        fan.paths[name] = (start, (middle, sign * (reach - CLEARANCE)))
        _sensors_beyond(fan, name, side, hanging)
        x += slot + SLOT_GAP
    outer = reach + max(h for _, h in clusters)
    if side is Side.BELOW:
        fan.down = max(fan.down, outer)
    else:
        fan.up = max(fan.up, outer)
    _widen(fan, side, -left, left + total)


def _sensors_beyond(fan: Fan, name: str, side: Side, hanging: Hanging) -> None:
    sensors = hanging.sensors.get(name, ())
    box, sign = fan.boxes[name], 1 if side is Side.BELOW else -1
    widths = [hanging.sizes[s].on(side)[0] for s in sensors]
    x = box.x - (sum(widths) + SLOT_GAP * (len(widths) - 1)) / 2
    for sensor, width in zip(sensors, widths, strict=True):
        height = hanging.sizes[sensor].on(side)[1]
        y = box.y + sign * (box.height / 2 + TIER + height / 2)
        _hang(fan, sensor, side, Box(x + width / 2, y, width, height))
        x += width + SLOT_GAP


def _hang(fan: Fan, name: str, side: Side, box: Box) -> None:
    fan.boxes[name], fan.sides[name] = box, side


def _widen(fan: Fan, side: Side, left: float, right: float) -> None:
    old = fan.above if side is Side.ABOVE else fan.below
    both = (left, right) if old is None else (max(left, old[0]), max(right, old[1]))
    if side is Side.ABOVE:
        fan.above = both
    else:
        fan.below = both


def _between(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
