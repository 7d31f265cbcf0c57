"""Laws in the direction that causality asks for, which may not be the one written.

Tried in this order: the law as written; a formula that holds whatever the parameters
are; a formula that holds for their signs (dry friction beside a viscous one, pieces
that rise); and last a proof that the law rises or falls everywhere, so that a number
can be found where no formula exists. What passes none of them is refused.
"""

import math
from collections.abc import Mapping, Sequence

import sympy

from bondgraph.equations.algebra.pieces import has_no_jump, joints_of
from bondgraph.errors import EquationError
from bondgraph.structure import signals
from bondgraph.structure.elements import (
    Compliance,
    Inertance,
    Resistance,
    letter,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.relations import Relation, inverse
from bondgraph.structure.signals import is_port_variable, parameter_symbol

OnePortWithLaw = Inertance | Compliance | Resistance

_LINEAR: dict[type, tuple[sympy.Symbol, sympy.Symbol]] = {
    Resistance: (signals.e, signals.f),
    Inertance: (signals.p, signals.f),
    Compliance: (signals.q, signals.e),
}
_JUMPING = (sympy.sign, sympy.Max, sympy.Min, sympy.Piecewise)


class Laws:
    """The one-port laws of a graph, in either direction."""

    def __init__(self, graph: FinishedGraph) -> None:
        self._parameters = graph.parameters

    def explicit(
        self,
        element: OnePortWithLaw,
        wanted: sympy.Symbol,
        own: Mapping[sympy.Symbol, sympy.Expr] | None = None,
    ) -> sympy.Expr | None:
        """Return `wanted` in the element's other variable, or None without formula.

        `own` says what to put for that variable.
        """
        put = dict(own or {})
        if element.law is None:  # the common case, without differentiating anything
            constant = parameter_symbol(element.name)
            big, small = _LINEAR[type(element)]
            if wanted == big:
                return constant * put.get(small, small)
            return put.get(big, big) / constant
        law = self._solved(element, wanted)
        return law if law is None or not put else law.xreplace(put)

    def _solved(
        self, element: OnePortWithLaw, wanted: sympy.Symbol
    ) -> sympy.Expr | None:
        relation = element.relation
        if wanted == relation.output:
            return relation.expression
        found = inverse(relation.expression, relation.argument, relation.output)
        if found is None:
            twins = self._twins(relation.expression)
            law = relation.expression.xreplace(twins)
            found = inverse(law, relation.argument, relation.output)
            if found is not None:
                found = found.xreplace({twin: x for x, twin in twins.items()})
        return self._inverse_for_signs(relation) if found is None else found

    def smooth(
        self,
        element: OnePortWithLaw,
        wanted: sympy.Symbol,
        own: Mapping[sympy.Symbol, sympy.Expr] | None = None,
    ) -> sympy.Expr | None:
        """Return what `explicit` does if one can differentiate it, else None."""
        found = self.explicit(element, wanted, own)
        if found is None or element.law is None or wanted == element.relation.output:
            return found
        return None if found.has(*_JUMPING) else found

    def _inverse_for_signs(self, relation: Relation) -> sympy.Expr | None:
        for method in (self._dry_friction, self._rising_pieces):
            found = method(relation)
            if found is not None:
                return found
        return None

    def _dry_friction(self, relation: Relation) -> sympy.Expr | None:
        """Invert ``a x + b sign(x) + c`` with a, b > 0: a dead zone in the value."""
        x = relation.argument
        rest, terms = relation.expression.as_independent(x, as_Add=True)
        step = terms.coeff(sympy.sign(x))
        line = (terms - step * sympy.sign(x)).expand()
        slope = line.coeff(x)
        if step == 0 or line != slope * x or slope.has(x) or step.has(x):
            return None
        if not (self._positive(slope) and self._positive(step)):
            return None
        value = relation.output - rest
        return (
            sympy.sign(value) * sympy.Max(sympy.Abs(value) - step, sympy.S.Zero) / slope
        )

    def _rising_pieces(self, relation: Relation) -> sympy.Expr | None:
        """Invert a continuous Piecewise in order of its argument, each piece rising."""
        x, law = relation.argument, relation.expression
        if not isinstance(law, sympy.Piecewise):
            return None
        joints = joints_of(law, x)
        if joints is None or joints.upward < 0:
            return None
        found = []
        for (piece, _), edge in zip(law.args, (*joints.edges, None), strict=True):
            back = inverse(piece, x, relation.output)
            if back is None or not self._positive(piece.diff(x)):
                return None
            condition = (
                sympy.true
                if edge is None
                else relation.output < piece.xreplace({x: edge})
            )
            found.append((back, condition))
        return sympy.Piecewise(*found)

    def monotone(self, element: OnePortWithLaw, because: str) -> Relation:
        """Return the relation if each value of its output has one argument.

        Raises
        ------
        EquationError
            If that cannot be shown; the message names the element.
        """
        relation = element.relation
        x, law = relation.argument, relation.expression
        if has_no_jump(law, x) and self.rises_or_falls(law.diff(x), x):
            return relation
        remedy = f"Write the law as an expression in {relation.output}"
        if isinstance(element, Resistance):
            given = "flow" if relation.output == signals.e else "effort"
            remedy += f", or put a storage beside it that gives it its {given}"
        raise EquationError(
            f"The law {relation.output} = {relation.expression} of {letter(element)} "
            f"{element.name!r} gives {relation.output}, but here {relation.argument} "
            f"is wanted ({because}), and the law has no unique inverse.",
            (element.name,),
            f"{remedy}.",
        )

    def rises_or_falls(self, slope: sympy.Expr, argument: sympy.Symbol) -> bool:
        """Return whether `slope` has one sign, zero at most at single points.

        Of a law that jumps the slope says nothing.
        """
        # x sign(x) is |x|, which sympy does not see by itself
        modulus = {sympy.sign(argument): sympy.Abs(argument) / argument}
        signed = self._with_signs(slope.xreplace(modulus).expand())
        signed = signed.replace(_is_squared_tanh, _by_cosh)
        if not any(step.has(argument) for step in signed.atoms(sympy.Heaviside)):
            return self._has_one_sign(signed, argument)
        # A step is 0 or 1: the slope must have one sign on both sides of it.
        return self._has_one_sign(signed.replace(sympy.Heaviside, _some_step), argument)

    def _has_one_sign(self, signed: sympy.Expr, argument: sympy.Symbol) -> bool:
        for form in (signed, sympy.expand(signed)):
            if form.is_positive or form.is_negative:
                return True
            one_sign = form.is_nonnegative or form.is_nonpositive
            # An analytic function of x (or |x|) vanishes at single points only.
            flat = form.has(
                sympy.Heaviside, sympy.Piecewise, sympy.Max, sympy.Min, sympy.sign
            )
            if one_sign and not flat and argument in form.free_symbols:
                return True
        return False

    def check_field(
        self, field: MultiPort, unknown: Sequence[int], because: str
    ) -> None:
        """Refuse a field whose laws need not determine the `unknown` ports' arguments.

        Linear ones do where their matrix is regular, which is checked later; nonlinear
        ones if the matrix of their slopes is positive definite everywhere.
        """
        relations = field.relations
        arguments = [relations[i].argument for i in unknown]
        slopes = sympy.Matrix(
            [[relations[i].expression.diff(x) for x in arguments] for i in unknown]
        )
        laws = [relations[i].expression for i in unknown]
        jumps = not all(has_no_jump(law, x) for law in laws for x in arguments)
        if not (jumps or slopes.free_symbols & set(arguments)):
            return
        for size in range(1, len(unknown) + 1):
            minor = slopes[:size, :size].det()
            if jumps or not self._positive(sympy.expand(minor)):
                ports = ", ".join(field.port(i + 1) for i in unknown)
                raise EquationError(
                    f"The laws of {field.name!r} give {relations[unknown[0]].output}, "
                    f"but here {', '.join(map(str, arguments))} are wanted "
                    f"({because}), and they need not be unique.",
                    (field.name, *ports.split(", ")),
                    f"Write the laws in the other variables, or prefer another "
                    f"causality for {ports}.",
                )

    def _positive(self, expression: sympy.Expr) -> bool:
        return bool(self._with_signs(expression).is_positive)

    def _with_signs(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with parameters that know their sign."""
        return expression.xreplace(self._twins(expression))

    def _twins(self, expression: sympy.Expr) -> dict[sympy.Symbol, sympy.Symbol]:
        return {
            symbol: self._twin(symbol)
            for symbol in expression.free_symbols
            if not is_port_variable(symbol)
        }

    def _twin(self, symbol: sympy.Symbol) -> sympy.Symbol:
        """Return a twin of a parameter that knows the sign its value and bounds give.

        A parameter of which nothing is known is taken to be positive, as constants of
        elements are.
        """
        known = self._parameters.get(symbol.name)
        if known is None or isinstance(symbol, signals.Signal) or symbol == signals.t:
            return symbol
        low, high = known.bounds
        value = known.value
        if value is None:
            value = 1.0 if low >= 0 or math.isinf(low) else 0.0
        if value > 0 and (low >= 0 or math.isinf(low)):
            return sympy.Dummy(positive=True)
        if value < 0 and (high <= 0 or math.isinf(high)):
            return sympy.Dummy(negative=True)
        return symbol


def _some_step(*_: sympy.Expr) -> sympy.Symbol:
    return sympy.Dummy(nonnegative=True)


def _is_squared_tanh(expression: sympy.Expr) -> bool:
    return bool(expression.is_Pow and expression.exp == 2) and isinstance(
        expression.base, sympy.tanh
    )


def _by_cosh(square: sympy.Expr) -> sympy.Expr:
    """Return tanh² as 1 - 1/cosh², whose sign sympy knows."""
    return 1 - 1 / sympy.cosh(square.base.args[0]) ** 2
