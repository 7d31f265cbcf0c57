"""Proof that a junction or a two-port conserves power, from few assignments.

The net power at a node is a sum of products of assigned symbols. Putting in what the
node itself defines makes it vanish; where a loop was cut, putting in definitions, last
one first, does. That is exact, and costs the same in a graph of any size.
"""

import sympy

from bondgraph.equations.deriving.sorting import replaced
from bondgraph.equations.state_equations import Assignment, StateEquations

LONGEST_PROOF = 40  # assignments inserted before the proof of one node is given up


class PowerProof:
    """Shows that a sum of products vanishes, by inserting few assignments.

    They are inserted from the last backwards; the one that a junction or two-port gives
    comes after those it reads, so a true balance cancels after a step or two.
    """

    def __init__(self, equations: StateEquations) -> None:
        listed: tuple[Assignment, ...] = (*equations.assignments, *equations.further)
        self._given_by: dict[str, dict[sympy.Symbol, sympy.Expr]] = {}
        for a in listed:
            self._given_by.setdefault(a.origin, {})[a.symbol] = a.expression
        self._place = {a.symbol: i for i, a in enumerate(listed)}
        self._expression = {a.symbol: a.expression for a in listed}
        residuals = dict(zip(equations.unknowns, equations.residuals, strict=True))
        values = {z: z - residual for z, residual in residuals.items()}
        self._cut = {z: x for z, x in values.items() if z not in x.free_symbols}
        self._rings = [(z, residuals[z]) for z in values if z not in self._cut]

    def __call__(self, power: sympy.Expr, node: str) -> bool:
        """Return whether `power`, that into `node`, vanishes whatever the states are.

        What the node itself defines is put in first, which nearly always suffices.
        """
        if sympy.expand(replaced(power, self._given_by.get(node, {}))) == 0:
            return True
        cut = sorted((x for x in power.free_symbols if x in self._cut), key=str)
        choices = [[], *([x] for x in cut), cut]
        return any(
            self._vanishes(power.xreplace({x: self._cut[x] for x in choice}))
            for choice in choices
        )

    def _vanishes(self, power: sympy.Expr) -> bool:
        here = sympy.expand(power)
        for _ in range(LONGEST_PROOF):
            if here == 0 or any(self._contains(here, *ring) for ring in self._rings):
                return True
            last = max(
                (s for s in here.free_symbols if s in self._place),
                key=self._place.__getitem__,
                default=None,
            )
            if last is None:
                return False
            here = sympy.expand(here.xreplace({last: self._expression[last]}))
        return False

    def _contains(
        self, power: sympy.Expr, unknown: sympy.Symbol, residual: sympy.Expr
    ) -> bool:
        """Return whether `residual`, which vanishes, is a factor of `power`."""
        if unknown not in power.free_symbols:
            return False
        tops = [sympy.fraction(sympy.together(x))[0] for x in (power, residual)]
        if not all(top.is_polynomial(unknown) for top in tops):
            return False
        whole, divisor = (sympy.Poly(x, unknown) for x in tops)
        return bool(divisor.degree() > 0 and whole.prem(divisor).is_zero)
