"""Total time derivatives through a list of assignments.

Each assigned symbol gets at most one derivative, itself an assignment made from those
of the symbols it reads (the chain rule over the shared graph), so the cost is linear
in what is read. A state's derivative is its rate, an input's its input rate. An
unknown of an algebraic loop has a derivative too: a new unknown, whose residual is the
differentiated residual of the loop.
"""

from collections.abc import Callable, Mapping

import sympy

from bondgraph.equations.chain_rule import derivative
from bondgraph.equations.deriving.wires import SymbolNames
from bondgraph.structure import signals


class TimeDerivative:
    """Differentiates expressions along the trajectory.

    Parameters
    ----------
    assigned
        The expression of every assigned symbol.
    leaves
        Derivatives of states and inputs.
    residual_of
        Residual of an unknown that may be differentiated; raises if it may not.
    """

    def __init__(
        self,
        assigned: Mapping[sympy.Symbol, sympy.Expr],
        leaves: Mapping[sympy.Symbol, sympy.Expr],
        residual_of: Callable[[sympy.Symbol], sympy.Expr | None],
        names: SymbolNames,
    ) -> None:
        self.assignments: dict[sympy.Symbol, tuple[sympy.Symbol, sympy.Expr]] = {}
        self.unknowns: dict[sympy.Symbol, sympy.Symbol] = {}
        self._assigned = assigned
        self._known: dict[sympy.Symbol, sympy.Expr] = dict(leaves)
        self._residual_of = residual_of
        self._names = names

    def of(self, expression: sympy.Expr) -> sympy.Expr:
        """Return d(expression)/dt; new assignments are collected on the way."""
        pending = [iter(self._read(expression))]
        path: list[sympy.Symbol] = []
        while pending:
            symbol = next(pending[-1], None)
            if symbol is None:
                pending.pop()
                if path:
                    self._finish(path.pop())
            elif symbol not in self._known:
                if symbol in self._assigned:
                    path.append(symbol)
                    pending.append(iter(self._read(self._assigned[symbol])))
                else:
                    self._known[symbol] = self._of_leaf(symbol)
        return self._total(expression)

    def source_of(self, rate: sympy.Symbol) -> sympy.Symbol:
        """Return the unknown whose derivative the unknown `rate` is."""
        return next(source for source, r in self.unknowns.items() if r == rate)

    def residuals(self) -> dict[sympy.Symbol, sympy.Expr]:
        """Return the residual of each derivative that is itself an unknown."""
        done: dict[sympy.Symbol, sympy.Expr] = {}
        while len(done) < len(self.unknowns):
            for unknown, rate in list(self.unknowns.items()):
                if rate not in done:
                    residual = self._residual_of(unknown)
                    assert residual is not None
                    done[rate] = self.of(residual)
        return done

    def _read(self, expression: sympy.Expr) -> list[sympy.Symbol]:
        return sorted(expression.free_symbols, key=lambda s: str(s.name))

    def _of_leaf(self, symbol: sympy.Symbol) -> sympy.Expr:
        if self._residual_of(symbol) is None:
            return sympy.S.Zero  # a parameter, or t, whose part is taken in _total
        self.unknowns[symbol] = self._names.symbol(f"d{symbol.name}")
        return self.unknowns[symbol]

    def _finish(self, symbol: sympy.Symbol) -> None:
        total = self._total(self._assigned[symbol])
        if total.is_Atom:
            self._known[symbol] = total
            return
        name = self._names.symbol(f"d{symbol.name}")
        self._known[symbol] = name
        self.assignments[symbol] = (name, total)

    def _total(self, expression: sympy.Expr) -> sympy.Expr:
        terms = [
            derivative(expression, symbol) * self._known[symbol]
            for symbol in self._read(expression)
            if symbol != signals.t and self._known[symbol] != 0
        ]
        if signals.t in expression.free_symbols:
            terms.append(expression.diff(signals.t))
        return sympy.Add(*terms)
