"""The tape machine: one compiled loop that runs any tape, with tangents.

`run` evaluates a tape and, in the same sweep, the derivative of every slot along ``n``
directions (forward mode), exact to rounding. It compiles once and is cached on disk;
models never compile. The numbers are those of `bondgraph.numeric.tape.Op`.
"""

import math

from bondgraph.numeric.compiled.loops import Array, Integers, compiled


@compiled
def unary(op: int, x: float, exponent: int) -> tuple[float, float]:
    """Return value and slope of a function of one argument."""
    if op == 3:
        slope = exponent * x ** (exponent - 1) if exponent != 0 else 0.0
        return x**exponent, slope
    if op == 5:
        root = math.sqrt(x) if x >= 0.0 else math.nan
        return root, 0.5 / max(root, 1e-150)
    if op == 6:
        return math.sin(x), math.cos(x)
    if op == 7:
        return math.cos(x), -math.sin(x)
    if op == 8:
        tangent = math.tan(x)
        return tangent, 1.0 + tangent * tangent
    if op == 9:
        power = math.exp(x) if x < 700.0 else math.inf
        return power, power
    if op == 10:
        return (math.log(x), 1.0 / x) if x > 0.0 else (math.nan, math.nan)
    if op == 11:
        bend = math.tanh(x)
        return bend, 1.0 - bend * bend
    if op == 12:
        return abs(x), 1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)
    if op == 13:
        return (1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)), 0.0
    if op == 16:
        return math.atan(x), 1.0 / (1.0 + x * x)
    if op == 17:
        return math.sinh(x), math.cosh(x)
    if op == 18:
        return math.cosh(x), math.sinh(x)
    if op == 19:
        return math.asin(x), 1.0 / math.sqrt(1.0 - x * x)
    return math.acos(x), -1.0 / math.sqrt(1.0 - x * x)


@compiled
def truth(op: int, x: float, y: float) -> bool:
    """Return the value of a comparison or connective."""
    if op == 21:
        return x < y
    if op == 22:
        return x <= y
    if op == 23:
        return x != 0.0 and y != 0.0
    if op == 24:
        return x != 0.0 or y != 0.0
    return x == 0.0


@compiled
def _branch(op: int, a: int, b: int, c: int, x: float, y: float) -> int:
    """Return the slot that a selection, maximum or minimum passes on."""
    if op == 26:
        return b if x != 0.0 else c
    if op == 14:
        return a if x >= y else b
    return a if x <= y else b


@compiled
def run(code: Integers, first: int, v: Array, d: Array, n: int) -> None:
    """Run the tape on values `v` and tangents ``d[slot, :n]``, in place.

    Operation i writes slot ``first + i``.
    """
    for i in range(code.shape[0]):
        op, a, b, c = code[i, 0], code[i, 1], code[i, 2], code[i, 3]
        s = first + i
        x = v[a]
        y = 0.0 if op == 3 else v[b]
        if op == 1:
            v[s] = x * y
            for k in range(n):
                d[s, k] = y * d[a, k] + x * d[b, k]
        elif op == 0:
            v[s] = x + y
            for k in range(n):
                d[s, k] = d[a, k] + d[b, k]
        elif op == 28:
            v[s] = x - y
            for k in range(n):
                d[s, k] = d[a, k] - d[b, k]
        elif op == 2:
            v[s] = x / y
            for k in range(n):
                d[s, k] = (d[a, k] - v[s] * d[b, k]) / y
        elif op == 4:
            v[s] = x**y
            by_base = y * x ** (y - 1.0) if y != 0.0 else 0.0
            by_exponent = v[s] * math.log(x) if x > 0.0 else 0.0
            for k in range(n):
                d[s, k] = by_base * d[a, k] + by_exponent * d[b, k]
        elif op == 27:
            v[s] = math.atan2(x, y)
            norm = x * x + y * y
            for k in range(n):
                d[s, k] = (y * d[a, k] - x * d[b, k]) / norm
        elif op == 26 or op == 14 or op == 15:  # noqa: PLR1714  (numba: no sets)
            chosen = _branch(op, a, b, c, x, y)
            v[s] = v[chosen]
            for k in range(n):
                d[s, k] = d[chosen, k]
        elif 21 <= op <= 25:
            v[s] = 1.0 if truth(op, x, y) else 0.0
            for k in range(n):
                d[s, k] = 0.0
        else:
            v[s], slope = unary(op, x, b)
            for k in range(n):
                d[s, k] = slope * d[a, k]
