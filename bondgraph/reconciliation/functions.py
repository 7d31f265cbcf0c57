"""Functions of one variable, with what a search needs to know about them.

Over a range each gives the range of its values, that of its slope and, where it is
monotone, the range of arguments that a range of values leaves. The exponential links
plain numbers with their logarithms and carries nearly everything.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

Range = tuple[float, float]
EVERYTHING: Range = (-math.inf, math.inf)
_FAR = 700.0  # the exponential of more overflows


@dataclass(frozen=True, slots=True)
class Function:
    """A smooth function of one variable.

    ``bend`` is 1 where it is convex everywhere, -1 where concave, 0 otherwise.
    """

    name: str
    value: Callable[[float], float]
    slope: Callable[[float], float]
    values: Callable[[Range], Range]
    slopes: Callable[[Range], Range]
    arguments: Callable[[Range], Range] | None = None
    bend: int = 0


def _exp(x: float) -> float:
    return math.exp(min(x, _FAR))


def _log_of(limits: Range) -> Range:
    low, high = limits
    if high <= 0:
        return math.inf, -math.inf  # no logarithm: empty
    return (math.log(low) if low > 0 else -math.inf), math.log(high)


def _root_of(limits: Range) -> Range:
    low, high = limits
    if high < 0:
        return math.inf, -math.inf  # no root: empty
    return math.sqrt(max(low, 0.0)), math.sqrt(high)


def _sin_of(limits: Range) -> Range:
    a, b = limits
    if not math.isfinite(a + b):
        return -1.0, 1.0
    ends = math.sin(a), math.sin(b)
    turn, quarter = 2 * math.pi, math.pi / 2
    top = math.floor((b - quarter) / turn) >= math.ceil((a - quarter) / turn)
    bottom = math.floor((b + quarter) / turn) >= math.ceil((a + quarter) / turn)
    return -1.0 if bottom else min(ends), 1.0 if top else max(ends)


def _cos_of(limits: Range) -> Range:
    return _sin_of((limits[0] + math.pi / 2, limits[1] + math.pi / 2))


def _minus_sin_of(limits: Range) -> Range:
    low, high = _sin_of(limits)
    return -high, -low


def _tan_of(limits: Range) -> Range:
    a, b = limits
    if not math.isfinite(a + b) or b - a >= math.pi or math.tan(b) < math.tan(a):
        return EVERYTHING
    return math.tan(a), math.tan(b)


def _square_of(limits: Range) -> Range:
    a, b = limits
    high = max(a * a, b * b)
    return (0.0 if a <= 0 <= b else min(a * a, b * b)), high


def _tan_slopes(limits: Range) -> Range:
    low, high = _square_of(_tan_of(limits))
    return 1 + low, 1 + high


def _atan_slopes(limits: Range) -> Range:
    low, high = _square_of(limits)
    return 1 / (1 + high), 1 / (1 + low)


EXP = Function(
    "exp",
    _exp,
    _exp,
    lambda r: (_exp(r[0]), _exp(r[1])),
    lambda r: (_exp(r[0]), _exp(r[1])),
    arguments=_log_of,
    bend=1,
)
LOG = Function(
    "log",
    math.log,
    lambda x: 1 / x,
    _log_of,
    lambda r: (1 / r[1], 1 / r[0] if r[0] > 0 else math.inf),
    arguments=lambda r: (_exp(r[0]), _exp(r[1])),
    bend=-1,
)
SQRT = Function(
    "sqrt",
    math.sqrt,
    lambda x: 0.5 / math.sqrt(x) if x > 0 else math.inf,
    _root_of,
    lambda r: (0.5 / math.sqrt(r[1]), 0.5 / math.sqrt(r[0]) if r[0] > 0 else math.inf),
    arguments=lambda r: (r[0] ** 2, r[1] ** 2),
    bend=-1,
)
SQUARE = Function(
    "square",
    lambda x: x * x,
    lambda x: 2 * x,
    _square_of,
    lambda r: (2 * r[0], 2 * r[1]),
    bend=1,
)
SIN = Function("sin", math.sin, math.cos, _sin_of, _cos_of)
COS = Function("cos", math.cos, lambda x: -math.sin(x), _cos_of, _minus_sin_of)
TAN = Function("tan", math.tan, lambda x: 1 + math.tan(x) ** 2, _tan_of, _tan_slopes)
ATAN = Function(
    "atan",
    math.atan,
    lambda x: 1 / (1 + x * x),
    lambda r: (math.atan(r[0]), math.atan(r[1])),
    _atan_slopes,
)
