"""Transfer functions as ratios of two sparse determinants, without any division.

With P = sE - A, the transfer function from u to y is det [[P, -B], [C, D]] / det P.
Columns are multiplied by their denominators first, so that all entries are polynomials;
then a determinant is a sum over matchings of rows with columns. Rows are taken one by
one, in an order that keeps few columns half used, and sub-determinants that use the
same columns are added up. What is made on the way are the terms of the answer and few
others, so the number of terms is the cost, and the limit.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy
from sympy.polys.domains import QQ
from sympy.polys.galoistools import gf_gcd
from sympy.polys.rings import PolyElement, PolyRing
from sympy.polys.rings import ring as make_ring

from bondgraph.equations.algebra.rational import RationalField
from bondgraph.equations.transfer.transfer_function import s

Entries = Mapping[tuple[int, int], sympy.Expr]
Coefficients = tuple[sympy.Expr, ...]

MOST_TERMS = 20_000
"""Terms of all sub-determinants together: a few seconds, and many pages."""
PRIME = 2**31 - 1


class Pencil:
    """``P(s) ξ = Q(s) u`` and ``y = C ξ + R(s) u`` with symbolic entries.

    Parameters
    ----------
    constant, linear
        P is ``constant + s linear``; entries by (row, column).
    right, right_rate
        Q is ``right + s right_rate``.
    read, direct, direct_rate
        C, and R = ``direct + s direct_rate``.
    """

    def __init__(
        self,
        *,
        constant: Entries,
        linear: Entries,
        right: Entries,
        right_rate: Entries,
        read: Entries,
        direct: Entries,
        direct_rate: Entries,
    ) -> None:
        parts = (constant, linear, right, right_rate, read, direct, direct_rate)
        self._field = RationalField(x for part in parts for x in part.values())
        names = [*self._field.symbols, s]
        self._ring: PolyRing = make_ring(names, QQ)[0]
        self._s = self._ring.gens[-1]
        self._matrix = _Fractions(self._merged(constant, linear, 1))
        self._right = self._merged(right, right_rate, -1)
        self._read = self._merged(read, {}, 1)
        self._direct = self._merged(direct, direct_rate, 1)
        self._denominators: dict[tuple[int, ...], PolyElement | None] = {}

    def _merged(
        self, constant: Entries, linear: Entries, sign: int
    ) -> dict[tuple[int, int], tuple[PolyElement, PolyElement]]:
        """Return numerator and denominator of ``sign (constant + s linear)``."""
        found = {}
        for place in {**constant, **linear}:
            top, bottom = self._fraction(constant.get(place, sympy.S.Zero))
            other, below = self._fraction(linear.get(place, sympy.S.Zero))
            if bottom == below:
                whole = top + self._s * other
            else:
                common = bottom.lcm(below)
                whole = common.exquo(bottom) * top
                whole += self._s * common.exquo(below) * other
                bottom = common
            if whole:
                found[place] = sign * whole, bottom
        return found

    def _fraction(self, expression: sympy.Expr) -> tuple[PolyElement, PolyElement]:
        element = self._field.element(expression)
        if not self._field.symbols:
            return self._ring(element), self._ring.one
        return (
            element.numer.set_ring(self._ring),
            element.denom.set_ring(self._ring),
        )

    def transfer(
        self, output: int, source: int, within: Sequence[int]
    ) -> tuple[Coefficients, Coefficients] | None:
        """Return numerator and denominator coefficients in s, highest power first.

        Parameters
        ----------
        within
            The rows and columns of P that lie between the two.

        Returns
        -------
        The coefficients in lowest terms, or None where there are too many terms. The
        denominator is empty where P is singular.
        """
        place = {i: k for k, i in enumerate(within)}
        scaled = self._matrix.scaled(place)
        if scaled.key not in self._denominators:
            self._denominators[scaled.key] = determinant(scaled.rows, self._ring)
        bottom = self._denominators[scaled.key]
        border, extra = self._border(output, source, place, scaled)
        rows = [{**row} for row in scaled.rows] + [{}]
        for (i, j), value in border.items():
            rows[i][j] = value
        if bottom is None:
            return None
        top = determinant(rows, self._ring)
        if top is None:
            return None
        return self._in_lowest_terms(top, bottom * extra)

    def _border(
        self, output: int, source: int, place: Mapping[int, int], scaled: "_Scaled"
    ) -> tuple[dict[tuple[int, int], PolyElement], PolyElement]:
        """Return the last row and column, and what they were multiplied by."""
        last = len(place)
        entries = {
            (place[i], last): x
            for (i, j), x in self._right.items()
            if j == source and i in place
        }
        entries |= {
            (last, place[j]): self._times(x, scaled.by_column[place[j]])
            for (i, j), x in self._read.items()
            if i == output and j in place
        }
        if (output, source) in self._direct:
            entries[last, last] = self._direct[output, source]
        columns = self._lcm(b for (i, j), (_, b) in entries.items() if j == last)
        made = {
            key: self._times(x, columns) if key[1] == last else x
            for key, x in entries.items()
        }
        rows = self._lcm(b for (i, _), (_, b) in made.items() if i == last)
        made = {
            key: self._times(x, rows) if key[0] == last else x
            for key, x in made.items()
        }
        assert all(b == self._ring.one for _, b in made.values())
        return {key: top for key, (top, _) in made.items()}, columns * rows

    def _times(
        self, fraction: tuple[PolyElement, PolyElement], factor: PolyElement
    ) -> tuple[PolyElement, PolyElement]:
        return _reduced(self._ring, fraction[0] * factor, fraction[1])

    def _lcm(self, polynomials: Any) -> PolyElement:
        return _lcm(self._ring, polynomials)

    def _in_lowest_terms(
        self, top: PolyElement, bottom: PolyElement
    ) -> tuple[Coefficients, Coefficients]:
        if not bottom:
            return (), ()
        if not top:
            return (sympy.S.Zero,), (sympy.S.One,)
        top, bottom = _without_content(self._ring, top, bottom)
        if _share_a_root(self._ring, top, bottom):
            common = top.gcd(bottom)
            top, bottom = (x.exquo(common) for x in (top, bottom))
        if not self._field.symbols:
            lead = bottom.LC
            top, bottom = top.quo_ground(lead), bottom.quo_ground(lead)
        elif _by_power(bottom)[bottom.degree(self._s)].LC < 0:
            top, bottom = -top, -bottom
        return self._coefficients(top), self._coefficients(bottom)

    def _coefficients(self, polynomial: PolyElement) -> Coefficients:
        powers = _by_power(polynomial)
        return tuple(
            self._field.restored(powers[k].as_expr()) if k in powers else sympy.S.Zero
            for k in range(max(powers), -1, -1)
        )


@dataclass(frozen=True, slots=True)
class _Scaled:
    """A matrix of polynomials, and what its columns were multiplied by."""

    rows: list[dict[int, PolyElement]]
    by_column: list[PolyElement]
    key: tuple[int, ...]


class _Fractions:
    """A sparse matrix of fractions of polynomials."""

    def __init__(
        self, entries: dict[tuple[int, int], tuple[PolyElement, PolyElement]]
    ) -> None:
        self._entries = entries
        self._made: dict[tuple[int, ...], _Scaled] = {}
        self._ring: PolyRing | None = next(
            (top.ring for top, _ in entries.values()), None
        )

    def scaled(self, place: Mapping[int, int]) -> _Scaled:
        """Return the part between `place`, its columns without fractions.

        Denominators belong to columns: the state p enters as p/m everywhere.
        """
        key = tuple(place)
        if key not in self._made:
            self._made[key] = self._scaled(place, key)
        return self._made[key]

    def _scaled(self, place: Mapping[int, int], key: tuple[int, ...]) -> _Scaled:
        if self._ring is None:
            return _Scaled([], [], key)
        ring, n = self._ring, len(place)
        inside = {
            (place[i], place[j]): x
            for (i, j), x in self._entries.items()
            if i in place and j in place
        }
        by_column = [
            _lcm(ring, (b for (_, j), (_, b) in inside.items() if j == k))
            for k in range(n)
        ]
        half = {
            (i, j): _reduced(ring, top * by_column[j], bottom)
            for (i, j), (top, bottom) in inside.items()
        }
        rows: list[dict[int, PolyElement]] = [{} for _ in range(n)]
        for (i, j), (top, _) in half.items():
            rows[i][j] = top
        return _Scaled(rows, by_column, key)


def _reduced(
    ring: PolyRing, top: PolyElement, bottom: PolyElement
) -> tuple[PolyElement, PolyElement]:
    if bottom == ring.one:
        return top, bottom
    top, bottom = top.cancel(bottom)
    if bottom.is_ground:
        return top.quo_ground(bottom.LC), ring.one
    return top, bottom


def _lcm(ring: PolyRing, polynomials: Any) -> PolyElement:
    common = ring.one
    for polynomial in polynomials:
        if polynomial not in (ring.one, common):
            common = common.lcm(polynomial)
    return common


def determinant(
    rows: Sequence[Mapping[int, PolyElement]], ring: PolyRing
) -> PolyElement | None:
    """Return the determinant of a sparse square matrix, None beyond `MOST_TERMS`."""
    order, sign = _order(rows)
    last = {column: k for k, i in enumerate(order) for column in rows[i]}
    partial: dict[int, PolyElement] = {0: ring.one}
    for k, i in enumerate(order):
        due = sum(1 << column for column in rows[i] if last[column] == k)
        grown: dict[int, PolyElement] = {}
        for used, value in partial.items():
            for column, entry in rows[i].items():
                bit = 1 << column
                if used & bit or due & ~(used | bit):
                    continue
                term = entry * value
                if (used >> column).bit_count() % 2:
                    term = -term
                key = used | bit
                grown[key] = grown[key] + term if key in grown else term
        partial = {key: value for key, value in grown.items() if value}
        if sum(map(len, partial.values())) > MOST_TERMS:
            return None
    total = partial.get((1 << len(rows)) - 1, ring.zero)
    return total if sign > 0 else -total


def _order(rows: Sequence[Mapping[int, PolyElement]]) -> tuple[list[int], int]:
    """Return an order of the rows that keeps few columns open, and its sign."""
    left = set(range(len(rows)))
    waiting: dict[int, int] = {}
    for row in rows:
        for column in row:
            waiting[column] = waiting.get(column, 0) + 1
    opened: set[int] = set()
    order: list[int] = []
    while left:
        best = min(left, key=lambda i: (_widening(rows[i], opened, waiting), i))
        left.remove(best)
        order.append(best)
        for column in rows[best]:
            opened.add(column)
            waiting[column] -= 1
            if not waiting[column]:
                opened.discard(column)
    return order, _sign(order)


def _widening(
    row: Mapping[int, PolyElement], opened: set[int], waiting: Mapping[int, int]
) -> int:
    """Return by how many columns the front grows when `row` is taken."""
    return sum((c not in opened) - (waiting[c] == 1) for c in row)


def _sign(order: list[int]) -> int:
    sign, seen = 1, [False] * len(order)
    for start in range(len(order)):
        length, here = 0, start
        while not seen[here]:
            seen[here], here, length = True, order[here], length + 1
        if length and length % 2 == 0:
            sign = -sign
    return sign


def _by_power(polynomial: PolyElement) -> dict[int, PolyElement]:
    """Return the coefficient of each power of s, as polynomials without s."""
    powers: dict[int, dict[Any, Any]] = {}
    for monomial, coefficient in polynomial.terms():
        powers.setdefault(monomial[-1], {})[*monomial[:-1], 0] = coefficient
    return {k: polynomial.ring.from_dict(terms) for k, terms in powers.items()}


def _without_content(
    ring: PolyRing, top: PolyElement, bottom: PolyElement
) -> tuple[PolyElement, PolyElement]:
    """Return the two over the greatest common divisor of all their coefficients."""
    content = ring.zero
    parts = [*_by_power(top).values(), *_by_power(bottom).values()]
    for part in sorted(parts, key=len):
        content = content.gcd(part)
        if content.is_ground:
            break
    top, bottom = top.exquo(content), bottom.exquo(content)
    numbers = [
        Fraction(int(c.numerator), int(c.denominator))
        for p in (top, bottom)
        for c in p.coeffs()
    ]
    scale = Fraction(math.lcm(*(c.denominator for c in numbers)))
    scale /= math.gcd(*(int(c * scale) for c in numbers))
    factor = QQ(scale.numerator, scale.denominator)
    return top.mul_ground(factor), bottom.mul_ground(factor)


def _share_a_root(ring: PolyRing, top: PolyElement, bottom: PolyElement) -> bool:
    """Return whether the two have a common factor in s, tried at arbitrary numbers.

    At numbers modulo a prime the greatest common divisor takes microseconds; a common
    factor shows at every choice of numbers, so a "no" is certain.
    """
    primes = list(sympy.primerange(100, 100 + 60 * len(ring.gens) + 100))
    values = [pow(7, prime, PRIME) for prime in primes[: len(ring.gens) - 1]]
    sides = [_modulo(polynomial, values) for polynomial in (top, bottom)]
    return len(gf_gcd(*sides, PRIME, sympy.ZZ)) > 1


def _modulo(polynomial: PolyElement, values: Sequence[int]) -> list[int]:
    sums: dict[int, int] = {}
    for monomial, coefficient in polynomial.terms():
        term = int(coefficient.numerator) * pow(int(coefficient.denominator), -1, PRIME)
        for value, power in zip(values, monomial[:-1], strict=True):
            if power:
                term = term * pow(value, power, PRIME) % PRIME
        sums[monomial[-1]] = (sums.get(monomial[-1], 0) + term) % PRIME
    dense = [sympy.ZZ(sums.get(k, 0)) for k in range(max(sums), -1, -1)]
    while dense and dense[0] == 0:
        dense.pop(0)
    return dense
