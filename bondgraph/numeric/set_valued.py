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


def set_valued_form(equations: StateEquations) -> SetValuedForm | None:
    """Return the form of equations with set-valued friction, or None without any."""
    origin = {a.symbol: a.origin for a in equations.assignments}
    causes = dict(zip(equations.unknowns, equations.causes, strict=True))
    dry = {
        symbol: signs
        for symbol, signs in equations.dry_friction.items()
        if symbol in origin or symbol in causes
    }
    if not dry:
        return None
    force: dict[sympy.Expr, sympy.Symbol] = {}
    places: dict[sympy.Expr, list[str]] = {}
    for symbol, signs in dry.items():
        for sign in signs:
            force.setdefault(sign, sympy.Dummy("friction", real=True))
            named = [origin[symbol]] if symbol in origin else causes[symbol]
            places.setdefault(sign, []).extend(named)

    def freed(symbol: sympy.Symbol, expression: sympy.Expr) -> sympy.Expr:
        return expression.xreplace({s: force[s] for s in dry.get(symbol, ())})

    modes = [(sympy.Dummy("stick"), sympy.Dummy("slip")) for _ in force]
    states = [s.symbol for s in equations.states]
    rates = [s.rate for s in equations.states]
    unknowns = [*equations.unknowns, *force.values()]
    variables = [
        *states,
        *rates,
        *unknowns,
        *equations.inputs,
        *equations.input_rates,
        *equations.parameters,
        *(symbol for pair in modes for symbol in pair),
        time_symbol,
    ]
    residuals = zip(equations.unknowns, equations.residuals, strict=True)
    whole = record_tape(
        variables,
        [(a.symbol, freed(a.symbol, a.expression)) for a in equations.assignments],
        [
            *equations.rates,
            *(freed(symbol, residual) for symbol, residual in residuals),
            *(sign.args[0] for sign in force),
            *(
                stick * sign.args[0] + (1 - stick) * (value - slip)
                for (sign, value), (stick, slip) in zip(
                    force.items(), modes, strict=True
                )
            ),
            *(output.expression for output in equations.outputs),
        ],
        lambda _: False,
    )
    n, nd = len(states) + len(unknowns), len(force)
    solved, instant = {*states, *rates, *unknowns}, {*rates, *unknowns}

    def some(results: Sequence[int], active: set[sympy.Symbol]) -> Tape:
        chosen = replace(whole, outputs=whole.outputs[list(results)])
        return part(chosen, 0, len(results), [v in active for v in variables])

    dynamics = some(range(n), solved)
    output = some(range(n + nd, len(whole.outputs)), instant)
    return SetValuedForm(
        places=tuple(" and ".join(dict.fromkeys(places[s])) for s in force),
        dynamics=dynamics,
        held=some([*range(n - nd), *range(n, n + nd)], solved),
        arguments=some(range(n - nd, n), solved),
        output=output,
        linear=bool(np.all(dynamics.degree < 2)),
        instantaneous=bool(np.any(output.degree > 0)),
    )
