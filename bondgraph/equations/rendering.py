"""State equations for reading: as text and as LaTeX.

Both show the sorted form; the reduced form ``M ẋ = f`` follows where it is short.
"""

from collections.abc import Iterable

import sympy

from bondgraph.equations.latex_names import latex
from bondgraph.equations.reduction import ReducedEquations, reduce
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError

SHORT = 12  # states up to which inserted equations are worth reading


def as_text(equations: StateEquations) -> str:
    """Return the equations as plain text, one per line."""
    lines = [equations.name, ""]
    lines += _section("states", (_described(equations, i) for i in _all(equations)))
    lines += _section(
        "inputs",
        (
            f"{symbol} [{unit}]"
            for symbol, unit in zip(
                equations.inputs, equations.input_units, strict=True
            )
        ),
    )
    lines += _section(
        "assignments",
        (f"{a.symbol} = {a.expression}" for a in equations.assignments),
    )
    lines += _section(
        "rates",
        (
            f"d({state.symbol})/dt = {rate}"
            for state, rate in zip(equations.states, equations.rates, strict=True)
        ),
    )
    lines += _section(
        "implicit",
        (
            f"0 = {residual}   ({reason})"
            for residual, reason in zip(
                equations.residuals, equations.reasons, strict=True
            )
        ),
    )
    lines += _section(
        "outputs", (f"{o.name} [{o.unit}] = {o.expression}" for o in equations.outputs)
    )
    if len(equations.states) <= SHORT:
        lines += _section("reduced", _reduced_lines(equations, reduce(equations)))
    return "\n".join(lines).rstrip() + "\n"


def _all(equations: StateEquations) -> range:
    return range(len(equations.states))


def _described(equations: StateEquations, i: int) -> str:
    state = equations.states[i]
    return f"{state.symbol} [{state.unit}] at {state.place}"


def _section(title: str, lines: Iterable[str]) -> list[str]:
    found = [f"  {line}" for line in lines]
    return [title, *found, ""] if found else []


def _reduced_lines(equations: StateEquations, reduced: ReducedEquations) -> list[str]:
    names = {
        state.rate: sympy.Symbol(f"d({state.symbol})/dt") for state in equations.states
    }
    return [
        f"{left.xreplace(names)} = {right.xreplace(names)}"
        for left, right in _reduced_sides(equations, reduced)
    ]


def _reduced_sides(
    equations: StateEquations, reduced: ReducedEquations
) -> list[tuple[sympy.Expr, sympy.Expr]]:
    """Return left and right side of every reduced equation, the implicit ones last."""
    rates = [state.rate for state in equations.states]
    left: list[list[sympy.Expr]] = [[] for _ in rates]
    for (i, j), value in sorted(reduced.mass.todok().items()):
        left[i].append(value * rates[j])
    sides = [
        (sympy.Add(*terms), force)
        for terms, force in zip(left, reduced.forces, strict=True)
    ]
    return sides + [(sympy.S.Zero, residual) for residual in reduced.residuals]


def as_latex(equations: StateEquations) -> str:
    r"""Return the reduced equations as a LaTeX ``aligned`` block.

    Where there are too many states for that, the sorted assignments and rates.

    Raises
    ------
    EquationError
        If there is nothing to write.
    """
    symbols = [state.symbol for state in equations.states]
    rates = dict(zip((s.rate for s in equations.states), symbols, strict=True))
    rates |= dict(zip(equations.input_rates, equations.inputs, strict=True))
    outputs = [(sympy.Symbol(o.name), o.expression) for o in equations.outputs]
    pairs: list[tuple[sympy.Expr, sympy.Expr]] = []
    if len(equations.states) <= SHORT:
        reduced = reduce(equations)
        pairs += _reduced_sides(equations, reduced)
        outputs = [(sympy.Symbol(o.name), o.expression) for o in reduced.outputs]
    else:
        pairs += [(a.symbol, a.expression) for a in equations.assignments]
        pairs += [
            (state.rate, rate)
            for state, rate in zip(equations.states, equations.rates, strict=True)
        ]
        pairs += [(sympy.S.Zero, residual) for residual in equations.residuals]
    pairs += outputs
    if not pairs:
        raise EquationError(
            f"{equations.name!r} has neither states nor outputs to write.",
            (equations.name,),
            "Add a measurement with measure(...).",
        )
    lines = [f"{latex(left, rates)} &= {latex(right, rates)}" for left, right in pairs]
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"
