"""Operating points: the values at which partial derivatives are taken.

Values are worked out when a derivative first needs them. Where a law has a kink at the
point, its derivatives carry a symbol for the side (see `kinks`); `smooth` decides at
the end whether what was made of them has a value.
"""

from collections.abc import Mapping

import sympy

from bondgraph.equations.algebra.kinks import Sides
from bondgraph.equations.deriving.sorting import replaced
from bondgraph.equations.reduction import ReducedEquations, reduce
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.steady_state import SteadyState, point_values
from bondgraph.errors import EquationError, did_you_mean
from bondgraph.structure.signals import as_expression, t

AWAY = (
    "Give an operating point away from the kink, such as a velocity that is not zero."
)
_UNDEFINED = (sympy.DiracDelta, sympy.nan, sympy.zoo, sympy.oo, -sympy.oo)


class OperatingPoint:
    """Evaluates partial derivatives; values are worked out only when one needs them.

    Parameters
    ----------
    at
        Values of states, inputs, unknowns and ``t`` by name; others are zero.
    """

    def __init__(
        self,
        equations: StateEquations,
        at: Mapping[str, object] | SteadyState | None,
    ) -> None:
        self._sides = Sides()
        self._equations = equations
        self._free = set(equations.parameters)
        self._values = {
            **dict.fromkeys((s.symbol for s in equations.states), sympy.S.Zero),
            **dict.fromkeys(equations.inputs, sympy.S.Zero),
            **dict.fromkeys(equations.input_rates, sympy.S.Zero),
        }
        self._assigned = {a.symbol: a.expression for a in equations.assignments}
        self._assigned.update(
            (state.rate, rate)
            for state, rate in zip(equations.states, equations.rates, strict=True)
        )
        self._reduced: ReducedEquations | None = None
        settable = {x.name: x for x in (*self._values, *equations.unknowns, t)}
        rates = {x.name for x in equations.input_rates}
        for name, value in point_values(at).items():
            if name not in settable:
                raise EquationError(
                    f"{equations.name!r} has no state or input {name!r}.",
                    (name,),
                    did_you_mean(name, [n for n in settable if n not in rates]),
                )
            self._values[settable[name]] = as_expression(value)

    def __call__(self, partial: sympy.Expr) -> sympy.Expr:
        """Return `partial` at the operating point, in terms of parameters."""
        if partial.is_Number or partial.free_symbols <= self._free:
            return partial
        value = self._evaluated(partial).replace(sympy.DiracDelta, _spike)
        if value.has(*_UNDEFINED):
            if jumps := self._jumps(partial):
                raise self._refusal(
                    f"a law jumps at {jumps}, it has no slope there", partial
                )
            what = f"the derivative {partial} is not defined there"
            below = self._zeros_below(partial)
            if not below:
                raise self._refusal(what, partial)
            names = " and ".join(below)
            raise self._refusal(
                f"{what}: it divides by {names}, which is 0",
                partial,
                way_out=f"Give an operating point at which {names} is not zero.",
            )
        return value

    def _jumps(self, partial: sympy.Expr) -> str:
        """Return where a sign in what was differentiated turns at this point."""
        turning = {
            spike.args[0]
            for spike in partial.atoms(sympy.DiracDelta)
            if self._evaluated(spike.args[0]) == 0
        }
        return " and ".join(sorted(f"{one} = 0" for one in turning))

    def _zeros_below(self, partial: sympy.Expr) -> list[str]:
        """Return, as they are written, the divisors that are zero."""
        below = {p.base for p in partial.atoms(sympy.Pow) if p.exp.is_negative}
        return sorted(str(base) for base in below if self._evaluated(base) == 0)

    def smooth(self, value: sympy.Expr, of: str) -> sympy.Expr:
        """Return `value`, the same on every side of the kinks it depends on.

        Raises
        ------
        EquationError
            If it is not; `of` says in words what it is a slope of.
        """
        settled = self._sides.settled(value)
        if settled is None:
            points = self._sides.switching_points(self._sides.in_(value))
            where = " and ".join(f"{g} = 0" for g in points)
            raise self._refusal(f"{of} has a kink at {where}", *points)
        return settled

    def refuse_jump(self, expression: sympy.Expr, of: str) -> None:
        """Raise EquationError where a Piecewise jumps at the operating point."""
        if not expression.has(sympy.Piecewise):
            return
        value = self._evaluated(expression)
        if self._sides.settled(value) is None:
            points = self._sides.switching_points(self._sides.in_(value))
            where = " and ".join(f"{g} = 0" for g in points)
            raise self._refusal(f"{of} jumps at {where}", *points)

    def _refusal(
        self, what: str, *about: sympy.Expr, way_out: str = AWAY
    ) -> EquationError:
        return EquationError(
            f"{self._equations.name!r} has no linear form at this operating point: "
            f"{what}.",
            tuple(sorted({str(x) for e in about for x in e.free_symbols})),
            way_out,
        )

    def _evaluated(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with every symbol but parameters replaced."""
        pending = [expression]
        while pending:
            here = pending[-1]
            missing = sorted(
                (
                    x
                    for x in here.free_symbols
                    if x not in self._values and x not in self._free
                ),
                key=str,
            )
            missing = [x for x in missing if not self._try_unknown(x)]
            assigned = [self._assigned[x] for x in missing if x in self._assigned]
            ready = [
                x
                for x in missing
                if x in self._assigned and self._is_ready(self._assigned[x])
            ]
            for x in ready:
                self._values[x] = self._at_point(self._assigned[x])
            if not missing or len(ready) == len(missing):
                pending.pop()
            else:
                pending.extend(x for x in assigned if not self._is_ready(x))
        return self._at_point(expression)

    def _at_point(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with known values put in, its switches beside a kink."""
        opened = self._sides.opened(
            expression,
            lambda inside: replaced(inside, self._values),
            lambda inside: not inside.free_symbols <= self._free,
        )
        return replaced(opened, self._values)

    def _is_ready(self, expression: sympy.Expr) -> bool:
        return all(
            x in self._values or x in self._free for x in expression.free_symbols
        )

    def _try_unknown(self, symbol: sympy.Symbol) -> bool:
        """Find the value of an unknown (or refuse t); return False for others."""
        if symbol in self._assigned:
            return False
        if symbol == t:
            raise EquationError(
                f"{self._equations.name!r} depends on time.",
                ("t",),
                'Give the time of the operating point: at={"t": 0}.',
            )
        if self._reduced is None:
            self._reduced = reduce(self._equations)
        if symbol not in self._reduced.solutions:
            raise EquationError(
                f"The value of {symbol} at the operating point is needed, and its "
                f"equation is nonlinear.",
                (str(symbol),),
                f'Give it: at={{"{symbol}": …}}.',
            )
        self._values[symbol] = sympy.Dummy()  # replaced below; guards against cycles
        rates = dict(
            zip(
                (s.rate for s in self._equations.states),
                self._reduced.explicit(),
                strict=True,
            )
        )
        solution = replaced(self._reduced.solutions[symbol], rates)
        self._values[symbol] = replaced(solution, self._values)
        return True


def _spike(argument: sympy.Expr) -> sympy.Expr:
    """Return the slope of a step away from it (zero), or the step's own."""
    return sympy.DiracDelta(argument) if argument == 0 else sympy.S.Zero
