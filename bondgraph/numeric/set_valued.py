"""Set-valued dry friction as arrays: each ``sign(g)`` is an unknown λ in [-1, 1].

λ is 1 where g > 0, -1 where g < 0, and whatever the equations ask for where g = 0. So
each λ comes with one more equation, which the stage solver chooses by its mode::

    slips:   λ = 1 (or -1),  as long as g ≥ 0 (or g ≤ 0)
    sticks:  g = 0,          as long as |λ| ≤ 1

which is the projection ``λ = clip(λ + ρ g, -1, 1)`` solved by an active set (Alart and
Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991). Laws that read the same g share λ.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy

from bondgraph.equations.state_equations import StateEquations
from bondgraph.numeric.tape import Tape, part, record_tape
from bondgraph.structure.signals import t as time_symbol


@dataclass(frozen=True, slots=True, kw_only=True)
class SetValuedForm:
    """A model in the variables x, ẋ, (z, λ), u, u̇, (p, σ, m), t.

    Of each friction, σ is 1 where it sticks and 0 where it slips, m is λ where it
    slips; only `held` reads them.

    Parameters
    ----------
    places
        For each λ the elements whose dry friction it is, in words.
    dynamics
        Tape whose results are the rates, the residuals and the arguments g.
    held
        Tape whose results are the rates, the residuals and ``σ g + (1 - σ) (λ - m)``:
        an ordinary model, as long as the modes last.
    arguments
        Tape whose results are the g.
    output
        Tape whose results are the outputs.
    linear
        Whether the dynamics' results are affine in (x, ẋ, z, λ).
    instantaneous
        Whether an output depends on ẋ, z or λ.
    """

    places: tuple[str, ...]
    dynamics: Tape
    held: Tape
    arguments: Tape
    output: Tape
    linear: bool
    instantaneous: bool


@dataclass(frozen=True, slots=True)
class _Frictions:
    """The frictions of a model: for each argument g its λ, its modes and its places.

    ``within`` holds the signs that each wire's own law gives it.
    """

    force: dict[sympy.Expr, sympy.Symbol]
    modes: dict[sympy.Expr, tuple[sympy.Symbol, sympy.Symbol]]
    places: dict[sympy.Expr, list[str]]
    within: dict[sympy.Symbol, tuple[sympy.Expr, ...]]

    def freed(self, symbol: sympy.Symbol, expression: sympy.Expr) -> sympy.Expr:
        """Return what defines a wire with its own signs replaced by their λ."""
        own = self.within.get(symbol, ())
        return expression.xreplace({sign: self.force[sign] for sign in own})

    @property
    def arguments(self) -> list[sympy.Expr]:
        """The g of every friction."""
        return [sign.args[0] for sign in self.force]

    @property
    def held(self) -> list[sympy.Expr]:
        """What is zero while modes last: ``σ g + (1 - σ) (λ - m)``."""
        return [
            stick * sign.args[0] + (1 - stick) * (value - slip)
            for (sign, value), (stick, slip) in zip(
                self.force.items(), self.modes.values(), strict=True
            )
        ]


def set_valued_form(equations: StateEquations) -> SetValuedForm | None:
    """Return the form of equations with set-valued friction, or None without any."""
    found = _frictions(equations)
    if not found.force:
        return None
    states = [s.symbol for s in equations.states]
    rates = [s.rate for s in equations.states]
    unknowns = [*equations.unknowns, *found.force.values()]
    variables = [
        *states,
        *rates,
        *unknowns,
        *equations.inputs,
        *equations.input_rates,
        *equations.parameters,
        *(symbol for pair in found.modes.values() for symbol in pair),
        time_symbol,
    ]
    whole = _recorded(equations, found, variables)
    n, nd = len(states) + len(unknowns), len(found.force)
    solved, instant = {*states, *rates, *unknowns}, {*rates, *unknowns}

    def some(results: Sequence[int], active: set[sympy.Symbol]) -> Tape:
        chosen = replace(whole, outputs=whole.outputs[list(results)])
        return part(chosen, 0, len(results), [v in active for v in variables])

    dynamics = some(range(n), solved)
    output = some(range(n + nd, len(whole.outputs)), instant)
    return SetValuedForm(
        places=tuple(" and ".join(dict.fromkeys(p)) for p in found.places.values()),
        dynamics=dynamics,
        held=some([*range(n - nd), *range(n, n + nd)], solved),
        arguments=some(range(n - nd, n), solved),
        output=output,
        linear=bool(np.all(dynamics.degree < 2)),
        instantaneous=bool(np.any(output.degree > 0)),
    )


def _frictions(equations: StateEquations) -> _Frictions:
    """Return the frictions of the equations; those that read the same g are one."""
    origin = {a.symbol: a.origin for a in equations.assignments}
    causes = dict(zip(equations.unknowns, equations.causes, strict=True))
    found = _Frictions({}, {}, {}, {})
    for symbol, signs in equations.dry_friction.items():
        if symbol not in origin and symbol not in causes:
            continue
        found.within[symbol] = signs
        named = [origin[symbol]] if symbol in origin else causes[symbol]
        for sign in signs:
            if sign not in found.force:
                found.force[sign] = sympy.Dummy("friction", real=True)
                found.modes[sign] = sympy.Dummy("stick"), sympy.Dummy("slip")
            found.places.setdefault(sign, []).extend(named)
    return found


def _recorded(
    equations: StateEquations, found: _Frictions, variables: Sequence[sympy.Symbol]
) -> Tape:
    """Return the tape of rates, residuals, arguments, held modes and outputs."""
    residuals = zip(equations.unknowns, equations.residuals, strict=True)
    return record_tape(
        variables,
        [
            (a.symbol, found.freed(a.symbol, a.expression))
            for a in equations.assignments
        ],
        [
            *equations.rates,
            *(found.freed(symbol, residual) for symbol, residual in residuals),
            *found.arguments,
            *found.held,
            *(output.expression for output in equations.outputs),
        ],
        lambda _: False,
    )
