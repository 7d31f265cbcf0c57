"""Kinks: what a law's derivative is just beside a point where the law switches.

At its switching point a ``sign``, a step or a comparison has no value of its own. It is
replaced by a symbol that stands for the side, +1 or -1, and carried along; a quantity
that is the same for every choice of sides has a value there (``x |x|`` has slope 0),
and one that is not has none (``|x|``).
"""

from collections.abc import Callable, Iterable
from itertools import product

import sympy
from sympy.core.relational import Relational

from bondgraph.equations.algebra.rational import in_lowest_terms

_SWITCHES = (sympy.sign, sympy.Heaviside, Relational)
MOST_SIDES = 6


class Sides:
    """Symbols for the sides of the switching points that were met."""

    def __init__(self) -> None:
        self._symbols: dict[sympy.Expr, sympy.Symbol] = {}

    def opened(
        self,
        expression: sympy.Expr,
        at_point: Callable[[sympy.Expr], sympy.Expr],
        moves: Callable[[sympy.Expr], bool],
    ) -> sympy.Expr:
        """Return `expression` with switches at their switching point replaced.

        Parameters
        ----------
        at_point
            Gives the value of a subexpression at the point.
        moves
            Whether a subexpression can change at all (parameters do not).
        """
        if not expression.has(*_SWITCHES):
            return expression
        put = {}
        for switch in expression.atoms(*_SWITCHES):
            switching = _switching(switch)
            if moves(switching) and at_point(switching) == 0:
                put[switch] = self._replacement(switch, switching)
        return expression.xreplace(put)

    def _replacement(self, switch: sympy.Basic, switching: sympy.Expr) -> sympy.Basic:
        side = self._side(switching)
        match switch:
            case sympy.sign():
                return side
            case sympy.Heaviside():
                return (1 + side) / 2
            case sympy.StrictLessThan() | sympy.LessThan():
                return side < 0
            case sympy.StrictGreaterThan() | sympy.GreaterThan():
                return side > 0
            case _:  # equal or not: beside the point they are not
                return sympy.false if isinstance(switch, sympy.Eq) else sympy.true

    def _side(self, switching: sympy.Expr) -> sympy.Expr:
        if -switching in self._symbols:
            return -self._symbols[-switching]
        if switching not in self._symbols:
            self._symbols[switching] = sympy.Dummy("side", real=True)
        return self._symbols[switching]

    def in_(self, expression: sympy.Expr) -> list[sympy.Symbol]:
        """Return the sides that `expression` depends on."""
        if not self._symbols:
            return []
        found = expression.free_symbols
        return [side for side in self._symbols.values() if side in found]

    def settled(self, expression: sympy.Expr) -> sympy.Expr | None:
        """Return what `expression` is on every side, or None if they differ."""
        sides = self.in_(expression)
        if not sides:
            return expression
        if len(sides) > MOST_SIDES:
            return None
        first, *others = (
            expression.xreplace(
                dict(zip(sides, map(sympy.Integer, signs), strict=True))
            )
            for signs in product((1, -1), repeat=len(sides))
        )
        return first if all(_equal(first, other) for other in others) else None

    def switching_points(self, sides: Iterable[sympy.Symbol]) -> list[sympy.Expr]:
        """Return the expressions that vanish at the switches of `sides`."""
        wanted = set(sides)
        return [g for g, side in self._symbols.items() if side in wanted]


def _switching(switch: sympy.Basic) -> sympy.Expr:
    """Return the expression whose zero is the switching point."""
    if isinstance(switch, Relational):
        return switch.lhs - switch.rhs
    return switch.args[0]


def _equal(one: sympy.Expr, other: sympy.Expr) -> bool:
    return bool(one == other or in_lowest_terms([one, -other]) == 0)
