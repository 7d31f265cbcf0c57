"""Dry friction: which ``sign(…)`` in the equations is set-valued.

Coulomb's law says ``e = τ sign(f)`` while the surfaces slip and ``|e| ≤ τ`` while they
stick (Coulomb 1785; as a set-valued law: Moreau 1977). So a ``sign`` in the law of an R
that makes the law jump where the R's own variable passes zero stands for any number
between -1 and 1 there. A ``sign`` in a source, in a modulus or in a law that does not
jump (``f² sign(f)``) is what it says.
"""

from collections.abc import Mapping

import sympy

from bondgraph.equations.deriving.definitions import Definition, Definitions
from bondgraph.equations.deriving.sorting import replaced
from bondgraph.structure.elements import Resistance
from bondgraph.structure.fields import ResistanceField


def set_valued_signs(
    definitions: Definitions,
    kept: Mapping[sympy.Symbol, Definition],
    aliases: Mapping[sympy.Symbol, sympy.Expr],
) -> dict[sympy.Symbol, tuple[sympy.Expr, ...]]:
    """Return for each wire that the law of an R gives its set-valued ``sign(…)``.

    Parameters
    ----------
    kept, aliases
        The definitions with equal wires replaced, and what they were replaced by.
    """
    wires = definitions.wires
    found: dict[sympy.Symbol, tuple[sympy.Expr, ...]] = {}
    for symbol, definition in kept.items():
        signs = definition.expression.atoms(sympy.sign)
        node = wires.nodes[definition.origin]
        if not signs or not isinstance(node, Resistance | ResistanceField):
            continue
        own = {
            x
            for port in wires.ports(node.name)
            for wire in (port.effort, port.flow)
            for x in replaced(wire, aliases).free_symbols
            if x != symbol
        }
        jumping = [s for s in signs if _jumps(definition.expression, s, own)]
        if jumping:
            found[symbol] = tuple(sorted(jumping, key=sympy.default_sort_key))
    return found


def _jumps(law: sympy.Expr, sign: sympy.Expr, own: set[sympy.Basic]) -> bool:
    """Return whether `law` jumps where the argument of `sign` passes zero."""
    (argument,) = sign.args
    variables = argument.free_symbols & own
    if len(variables) != 1:
        return False
    (x,) = variables
    slope = argument.diff(x)
    if slope == 0 or slope.has(x):
        return False
    zero = -argument.xreplace({x: sympy.S.Zero}) / slope
    above, below = (
        law.xreplace({sign: sympy.Integer(side)}).xreplace({x: zero})
        for side in (1, -1)
    )
    return bool(above != below)
