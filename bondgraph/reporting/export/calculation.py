"""What an exported program calculates, before any language is chosen.

A program has three blocks of assignments, each no longer than its results need: the
residuals of the algebraic unknowns z with their exact Jacobian, the rates ẋ, and the
outputs y. The Jacobian is made in the same shared form as everything else: every
assignment that depends on an unknown carries its tangent along as one assignment more.
Rates of inputs that the equations need (a storage that follows a source) are inputs of
the program.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import sympy

from bondgraph.equations.chain_rule import partial_derivative
from bondgraph.equations.deriving.wires import SymbolNames
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError

Statement = tuple[sympy.Symbol, sympy.Expr]
_UNSMOOTH = (sympy.Abs, sympy.sign, sympy.Max, sympy.Min)


@dataclass(frozen=True, slots=True)
class Block:
    """``symbol = expression`` in evaluation order, and the results read from it."""

    statements: tuple[Statement, ...]
    results: tuple[sympy.Expr, ...]

    def read(self) -> frozenset[sympy.Symbol]:
        """Return the symbols that the block reads and does not assign."""
        read: set[sympy.Symbol] = set()
        for expression in (*(s[1] for s in self.statements), *self.results):
            read |= expression.free_symbols
        return frozenset(read.difference(s[0] for s in self.statements))


@dataclass(frozen=True, slots=True)
class Jacobian:
    """The nonzero entries dr_i/dz_j, by (i, j), and the statements they read.

    The statements read those of the residuals. ``constant`` tells whether no entry
    depends on an unknown: the residuals are then linear and one step solves them.
    """

    statements: tuple[Statement, ...]
    entries: Mapping[tuple[int, int], sympy.Expr]
    constant: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Calculation:
    """The blocks of one model's program.

    Parameters
    ----------
    inputs, input_units
        The inputs of the model, followed by the input rates that the equations need.
    rates, outputs, residuals
        Blocks whose results are ẋ, y and r(z).
    """

    equations: StateEquations
    inputs: tuple[sympy.Symbol, ...]
    input_units: tuple[str, ...]
    rates: Block
    outputs: Block
    residuals: Block
    jacobian: Jacobian

    @property
    def assigned(self) -> tuple[sympy.Symbol, ...]:
        """Every symbol that some block assigns, once, in evaluation order."""
        blocks = (self.rates, self.outputs, self.residuals)
        found = (s for block in blocks for s, _ in block.statements)
        return tuple(dict.fromkeys((*found, *(s for s, _ in self.jacobian.statements))))


def calculation(equations: StateEquations) -> Calculation:
    """Return the program of `equations`, in no language yet."""
    early, late = equations.around_rates()
    states = equations.states
    rates = tuple(
        (state.rate, rate) for state, rate in zip(states, equations.rates, strict=True)
    )
    statements = [
        *((a.symbol, a.expression) for a in early),
        *rates,
        *((a.symbol, a.expression) for a in late),
    ]
    values = _block([(a.symbol, a.expression) for a in early], equations.rates)
    outputs = _block(statements, [o.expression for o in equations.outputs])
    residuals = _block(statements, equations.residuals)
    read = values.read() | outputs.read() | residuals.read()
    followed = [
        (rate, f"({unit})/s" if unit != "1" else "1/s")
        for rate, unit in zip(equations.input_rates, equations.input_units, strict=True)
        if rate in read
    ]
    return Calculation(
        equations=equations,
        inputs=(*equations.inputs, *(rate for rate, _ in followed)),
        input_units=(*equations.input_units, *(unit for _, unit in followed)),
        rates=values,
        outputs=outputs,
        residuals=residuals,
        jacobian=_jacobian(residuals, equations.unknowns),
    )


def _block(statements: Sequence[Statement], results: Iterable[sympy.Expr]) -> Block:
    """Return the statements that `results` need, in order."""
    results = tuple(results)
    needed = {s for result in results for s in result.free_symbols}
    kept = []
    for symbol, expression in reversed(statements):
        if symbol in needed:
            needed |= expression.free_symbols
            kept.append((symbol, expression))
    return Block(tuple(reversed(kept)), results)


def _jacobian(block: Block, unknowns: tuple[sympy.Symbol, ...]) -> Jacobian:
    """Return dr/dz of the residuals in `block`."""
    names = SymbolNames()
    for symbol in (*block.read(), *(s for s, _ in block.statements)):
        names.reserve(symbol.name)
    # What a symbol's derivative to each unknown is: a number or a symbol.
    tangents: dict[sympy.Symbol, dict[int, sympy.Expr]] = {
        z: {j: sympy.S.One} for j, z in enumerate(unknowns)
    }
    statements: list[Statement] = []
    for symbol, expression in block.statements:
        row: dict[int, sympy.Expr] = {}
        for j, value in _tangent(expression, tangents).items():
            row[j] = value
            if not value.is_Atom:
                row[j] = names.symbol(f"d{symbol.name}_d{unknowns[j].name}")
                statements.append((row[j], value))
        if row:
            tangents[symbol] = row
    entries = {
        (i, j): value
        for i, residual in enumerate(block.results)
        for j, value in _tangent(residual, tangents).items()
    }
    needed = _block(statements, entries.values()).statements
    read = Block(needed, tuple(entries.values())).read()
    return Jacobian(needed, entries, constant=read.isdisjoint(tangents))


def _tangent(
    expression: sympy.Expr, tangents: Mapping[sympy.Symbol, Mapping[int, sympy.Expr]]
) -> dict[int, sympy.Expr]:
    """Return the derivatives of `expression` to the unknowns, none that is zero."""
    terms: dict[int, list[sympy.Expr]] = {}
    read = (s for s in expression.free_symbols if s in tangents)
    for symbol in sorted(read, key=lambda s: str(s.name)):
        partial = _almost_everywhere(expression, symbol)
        for j, tangent in tangents[symbol].items():
            terms.setdefault(j, []).append(partial * tangent)
    sums = ((j, sympy.Add(*found)) for j, found in sorted(terms.items()))
    return {j: total for j, total in sums if total != 0}


def _almost_everywhere(expression: sympy.Expr, symbol: sympy.Symbol) -> sympy.Expr:
    """Return a partial derivative, with jumps and kinks left out.

    Sympy differentiates |g| of a g that it cannot prove real into real and imaginary
    parts; here every such function's argument is real, so its own variable stands in.
    """
    inner = {
        call: sympy.Dummy(real=True)
        for call in sorted(expression.atoms(*_UNSMOOTH), key=sympy.count_ops)
        if symbol in call.free_symbols and not all(a.is_Symbol for a in call.args)
    }
    if not inner:
        return _without_impulses(partial_derivative(expression, symbol))
    call, value = inner.popitem()
    outer = expression.xreplace({call: value})
    arguments = [sympy.Dummy(real=True) for _ in call.args]
    shell = call.func(*arguments)
    put = dict(zip(arguments, call.args, strict=True))
    slope = sympy.Add(
        *(
            _without_impulses(shell.diff(a)).xreplace(put)
            * _almost_everywhere(put[a], symbol)
            for a in arguments
        )
    )
    through = _almost_everywhere(outer, value).xreplace({value: call}) * slope
    return _almost_everywhere(outer, symbol).xreplace({value: call}) + through


def _without_impulses(derivative: sympy.Expr) -> sympy.Expr:
    impulses = derivative.atoms(sympy.DiracDelta)
    derivative = derivative.xreplace(dict.fromkeys(impulses, sympy.S.Zero))
    if derivative.has(sympy.Derivative, sympy.Subs):
        raise EquationError(
            f"{derivative} has no formula.",
            (str(derivative),),
            "Write the law with functions whose derivative sympy knows.",
        )
    return derivative
