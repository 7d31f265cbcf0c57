"""Sparse slopes of a tape, compiled: every result along every variable, one sweep.

First each operation is evaluated with its two partial derivatives, then the chain rule
combines rows: the row of an operation is the sum of its arguments' rows times the
partials, kept as sorted (column, value) pairs. The cost is the number of pairs, so a
chain of any length costs as much per element as a short one, and a dense row makes
nothing else dense (as it would if columns had to share tangents).

A kink is answered from one side: where an argument of ``Abs``, ``sign``, ``Max``,
``Min`` or a comparison sits exactly at its switching point, a tangent along `ray` says
on which side the law is when the variables move that way. What differs between rays
has no slope.
"""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled
from bondgraph.numeric.kernel.machine import truth, unary

# The numbers are those of `bondgraph.numeric.tape.Op`.


@compiled
def _one_sided(op: int, x: float, dx: float) -> tuple[float, float, bool]:
    """Return value, slope and whether there is a kink, of Abs (12) or sign (13)."""
    kink = x == 0.0
    side = dx if kink else x
    sign = 1.0 if side > 0.0 else (-1.0 if side < 0.0 else 0.0)
    return (abs(x), sign, kink) if op == 12 else (sign, 0.0, kink)


@compiled
def _below(x: float, y: float, dx: float, dy: float, strict: bool) -> bool:
    """Return whether x < y (or x <= y), just beyond the point where they are equal."""
    if x == y and dx != dy:
        return dx < dy
    return x < y if strict else x <= y


@compiled
def partials(
    code: Integers, first: int, v: Array, ray: Array, reads: Integers, slopes: Array
) -> bool:
    """Run the tape on values `v` and tangents `ray`, one per slot, in place.

    Writes for operation i the slots ``reads[i]`` that it depends on (the first slot
    twice where there is one) and the partial derivatives ``slopes[i]``. Returns whether
    a kink was met.
    """
    kinked = False
    for i in range(code.shape[0]):
        op, a, b, c = code[i, 0], code[i, 1], code[i, 2], code[i, 3]
        s = first + i
        x, dx = v[a], ray[a]
        other = a if op == 3 else b
        y, dy = v[other], ray[other]
        by_a, by_b = 0.0, 0.0
        if op == 1:
            v[s], by_a, by_b = x * y, y, x
        elif op == 0:
            v[s], by_a, by_b = x + y, 1.0, 1.0
        elif op == 28:
            v[s], by_a, by_b = x - y, 1.0, -1.0
        elif op == 2:
            v[s] = x / y
            by_a, by_b = 1.0 / y, -v[s] / y
        elif op == 4:
            v[s] = x**y
            by_a = y * x ** (y - 1.0) if y != 0.0 else 0.0
            by_b = v[s] * math.log(x) if x > 0.0 else 0.0
        elif op == 27:
            v[s] = math.atan2(x, y)
            norm = x * x + y * y
            by_a, by_b = y / norm, -x / norm
        elif op == 14 or op == 15:  # noqa: PLR1714  (numba: no sets)
            kinked = kinked or x == y
            low = a if _below(x, y, dx, dy, False) else other
            a = low if op == 15 else (other if low == a else a)
            v[s], by_a, other = v[a], 1.0, a
        elif op == 26:
            a = b if x != 0.0 else c
            v[s], by_a, other = v[a], 1.0, a
        elif op == 21 or op == 22:  # noqa: PLR1714
            kinked = kinked or x == y
            v[s] = 1.0 if _below(x, y, dx, dy, op == 21) else 0.0
        elif 23 <= op <= 25:
            v[s] = 1.0 if truth(op, x, y) else 0.0
        elif op == 12 or op == 13:  # noqa: PLR1714
            v[s], by_a, kink = _one_sided(op, x, dx)
            kinked = kinked or kink
            other = a
        else:
            v[s], by_a = unary(op, x, b)
            other = a
        reads[i, 0], reads[i, 1] = a, other
        slopes[i, 0], slopes[i, 1] = by_a, by_b
        tangent = 0.0
        if ray[a] != 0.0:
            tangent += by_a * ray[a]
        if ray[other] != 0.0:
            tangent += by_b * ray[other]
        ray[s] = tangent
    return kinked


@compiled
def rows(
    reads: Integers, slopes: Array, first: int, column: Integers
) -> tuple[Integers, Integers, Array]:
    """Return ``start, columns, values``: the row of slot s lies at ``start[s]`` on.

    ``column[slot]`` is the column of a variable, -1 for what does not count. Rows are
    sorted by column; zeros stay, so that the pattern is that of the law.
    """
    n = first + reads.shape[0]
    start = np.zeros(n + 1, dtype=np.int64)
    columns = np.zeros(4 * n + 16, dtype=np.int64)
    values = np.zeros(4 * n + 16)
    end = 0
    for s in range(first):
        if column[s] >= 0:
            columns[end], values[end] = column[s], 1.0
            end += 1
        start[s + 1] = end
    for i in range(reads.shape[0]):
        a, b = reads[i, 0], reads[i, 1]
        ja, jb = start[a], start[b]
        ea = start[a + 1]
        eb = jb if a == b and slopes[i, 1] == 0.0 else start[b + 1]
        room = end + (ea - ja) + (eb - jb)
        if room > len(columns):
            columns = np.append(columns, np.zeros(room, dtype=np.int64))
            values = np.append(values, np.zeros(room))
        while ja < ea or jb < eb:
            at_a = columns[ja] if ja < ea else np.int64(2**62)
            at_b = columns[jb] if jb < eb else np.int64(2**62)
            value = 0.0
            if at_a <= at_b:
                value += slopes[i, 0] * values[ja]
                ja += 1
            if at_b <= at_a:
                value += slopes[i, 1] * values[jb]
                jb += 1
            columns[end], values[end] = min(at_a, at_b), value
            end += 1
        start[first + i + 1] = end
    return start, columns, values


@compiled
def gathered(
    start: Integers, columns: Integers, values: Array, results: Integers
) -> tuple[Integers, Integers, Array]:
    """Return the rows of `results` alone, as the three arrays of a CSR matrix."""
    bounds = np.zeros(len(results) + 1, dtype=np.int64)
    for i in range(len(results)):
        slot = results[i]
        bounds[i + 1] = bounds[i] + start[slot + 1] - start[slot]
    picked = np.zeros(bounds[-1], dtype=np.int64)
    numbers = np.zeros(bounds[-1])
    for i in range(len(results)):
        here, slot = bounds[i], results[i]
        for k in range(start[slot + 1] - start[slot]):
            picked[here + k] = columns[start[slot] + k]
            numbers[here + k] = values[start[slot] + k]
    return bounds, picked, numbers
