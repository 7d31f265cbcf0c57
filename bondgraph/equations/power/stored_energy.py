"""The energy in a storage, as a function of what it stores.

A storage's law is the gradient of its energy: H = ∫ f dp in an I, ∫ e dq in a C, taken
along a straight line from the empty storage, so that one rule serves one port and many.
A law written the other way round (p of f, q of e) gives the co-energy, and H is its
Legendre transform. Integration is tried only by rules that end: what they do not
know stays an integral, which is as true and can be differentiated and evaluated.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import sympy
from sympy.integrals.manualintegrate import manualintegrate

from bondgraph.equations.algebra.rational import RationalField
from bondgraph.equations.deriving.inversion import Laws
from bondgraph.structure import signals
from bondgraph.structure.elements import Inertance, Storage
from bondgraph.structure.fields import StorageField
from bondgraph.structure.relations import Relation
from bondgraph.structure.signals import parameter_symbol, signals_in

LONGEST = 40  # operations in a term up to which a closed form is looked for
GOLDEN = 0.6180339887498949
TINY = 1e-9

_INFINITE = (sympy.nan, sympy.zoo, sympy.oo, -sympy.oo)
_KINKED = (sympy.Abs, sympy.sign, sympy.Max, sympy.Min, sympy.Piecewise)
_along = sympy.Dummy("s", positive=True)


class EnergyForm(StrEnum):
    """How the energy of a storage is known."""

    CLOSED = "closed form"
    INTEGRAL = "an integral without a closed form"


@dataclass(frozen=True, slots=True)
class EnergyFunction:
    """The energy of one storage.

    Parameters
    ----------
    variables
        What `expression` is a function of, one per port: p or q, or f or e where the
        law has no formula for those.
    reads_stored
        Whether the variables are what is stored (p, q) and not its co-variables.
    empty
        The value of the variables at which the energy is zero; 1 where the law is
        infinite at 0.
    """

    variables: tuple[sympy.Symbol, ...]
    expression: sympy.Expr
    form: EnergyForm
    reads_stored: bool
    empty: sympy.Expr = sympy.S.Zero

    @property
    def is_modulated(self) -> bool:
        """Whether the energy also depends on something outside the storage."""
        return bool(
            signals_in(self.expression) or signals.t in self.expression.free_symbols
        )


def energy_function(element: Storage | StorageField, laws: Laws) -> EnergyFunction:
    """Return the energy stored in `element` as a function of its own port variables.

    Parameters
    ----------
    laws
        The laws of the graph, which know when a law can be turned round.
    """
    if isinstance(element, StorageField):
        relations = element.relations
        gives_co = relations[0].output != element.stored[0]
        return energy_of_laws(relations, gives_co=gives_co)
    inertance = isinstance(element, Inertance)
    stored, co = (signals.p, signals.f) if inertance else (signals.q, signals.e)
    if element.law is None:  # the common case, without integrating anything
        linear = stored**2 / (2 * parameter_symbol(element.name))
        return EnergyFunction((stored,), linear, EnergyForm.CLOSED, True)
    relation = element.relation
    if relation.output == co:
        return energy_of_laws([relation], gives_co=True)
    function = energy_of_laws([relation], gives_co=False)
    turned = laws.smooth(element, co)
    if turned is None or relation.expression.subs(co, 0) != 0:
        return function
    expression = sympy.expand_mul(function.expression.xreplace({co: turned}))
    return EnergyFunction((stored,), expression, function.form, True)


def energy_of_laws(relations: Sequence[Relation], *, gives_co: bool) -> EnergyFunction:
    """Return the energy whose gradient the relations are, one relation per port.

    Parameters
    ----------
    gives_co
        True if they give flows (efforts) of what is stored: the energy itself is
        integrated. False if they give what is stored: H = Σ co · stored - ∫ stored dco.
    """
    variables = tuple(relation.argument for relation in relations)
    laws = [relation.expression for relation in relations]
    empty = _empty(laws, variables)
    integral, form = _line_integral(laws, variables, empty)
    if not gives_co:
        products = (x * law for x, law in zip(variables, laws, strict=True))
        integral = sympy.Add(*map(sympy.expand_mul, products)) - integral
    return EnergyFunction(variables, integral, form, gives_co, empty)


def _empty(laws: list[sympy.Expr], variables: tuple[sympy.Symbol, ...]) -> sympy.Expr:
    at_zero = dict.fromkeys(variables, sympy.S.Zero)
    values = [law.subs(at_zero) for law in laws]
    return sympy.S.One if any(v.has(*_INFINITE) for v in values) else sympy.S.Zero


def _line_integral(
    laws: list[sympy.Expr], variables: tuple[sympy.Symbol, ...], empty: sympy.Expr
) -> tuple[sympy.Expr, EnergyForm]:
    """Return ∫ Σ law_i dx_i from x = empty, along a straight line."""
    if len(laws) == 1:
        terms = list(sympy.Add.make_args(laws[0]))
        found = _closed(terms, variables[0], empty, variables[0])
        if _is_gradient(laws, found, variables):
            return found, EnergyForm.CLOSED
    point = {x: empty + _along * (x - empty) for x in variables}
    terms = [
        term * (x - empty)
        for x, law in zip(variables, laws, strict=True)
        for term in sympy.Add.make_args(law.xreplace(point))
    ]
    if len(laws) > 1 or laws[0].has(*_KINKED):  # along the line a kink is none
        found = _closed(terms, _along, sympy.S.Zero, sympy.S.One)
        if _is_gradient(laws, found, variables):
            return found, EnergyForm.CLOSED
    return sympy.Integral(sympy.Add(*terms), (_along, 0, 1)), EnergyForm.INTEGRAL


def _closed(
    terms: list[sympy.Expr], variable: sympy.Symbol, low: sympy.Expr, high: sympy.Expr
) -> sympy.Expr | None:
    """Return the integral of the sum of `terms`, or None if no rule knows it."""
    parts = []
    for term in terms:
        factor, rest = term.as_independent(variable, as_Add=False)
        found = _antiderivative(rest, variable)
        if found is None:
            return None
        part = found.subs(variable, high) - found.subs(variable, low)
        if part.has(*_INFINITE):
            return None
        parts.append(sympy.expand_mul(factor * part))
    return sympy.Add(*parts)


def _antiderivative(core: sympy.Expr, x: sympy.Symbol) -> sympy.Expr | None:
    base, power = core.as_base_exp()
    if base == x and power.is_Integer and power != -1:
        return x ** (power + 1) / (power + 1)
    kinked = _of_a_kink(base, power, x)
    if kinked is not None:
        return kinked
    if core.count_ops() > LONGEST:
        return None
    found = _generic(manualintegrate(core, x))
    return None if found.has(sympy.Integral) else found


def _of_a_kink(
    base: sympy.Expr, power: sympy.Expr, x: sympy.Symbol
) -> sympy.Expr | None:
    """Return ∫ of end stops max(0, g)ⁿ, of |g| and of sign(g), g linear in x."""
    if not isinstance(base, sympy.Max | sympy.Abs | sympy.sign):
        return None
    inside = [arg for arg in base.args if arg.has(x)]
    if len(inside) != 1 or power.has(x) or inside[0].diff(x).has(x):
        return None
    g, slope = inside[0], inside[0].diff(x)
    if base == sympy.Max(0, g):
        return base ** (power + 1) / (power + 1) / slope
    if power != 1:
        return None
    if isinstance(base, sympy.sign):
        return sympy.Abs(g) / slope
    return g * sympy.Abs(g) / 2 / slope if isinstance(base, sympy.Abs) else None


def _is_gradient(
    laws: list[sympy.Expr],
    energy: sympy.Expr | None,
    variables: tuple[sympy.Symbol, ...],
) -> bool:
    return energy is not None and all(
        _vanishes(energy.diff(x) - law, variables)
        for x, law in zip(variables, laws, strict=True)
    )


def _generic(expression: sympy.Expr) -> sympy.Expr:
    """Return the branch of each case distinction that holds for almost all numbers."""

    def branch(cases: sympy.Piecewise) -> sympy.Expr:
        for value, condition in cases.args:
            if isinstance(condition, sympy.Ne) or condition == sympy.true:
                return value
        return cases

    return expression.replace(lambda x: isinstance(x, sympy.Piecewise), branch)


def _vanishes(difference: sympy.Expr, variables: tuple[sympy.Symbol, ...]) -> bool:
    """Return whether an expression is zero, as a rational function or at numbers.

    The numbers are parameters between 0.5 and 1.5, and variables of either sign.
    """
    if difference == 0 or not RationalField([difference]).element(difference):
        return True
    symbols = sorted(difference.free_symbols, key=str)
    for turn, sign in enumerate((1, 1, -1)):
        put = {
            x: sympy.Float(
                (sign if x in variables else 1)
                * (0.5 + ((1 + 50 * turn + i) * GOLDEN) % 1.0)
            )
            for i, x in enumerate(symbols)
        }
        terms = [complex(x.subs(put)) for x in sympy.Add.make_args(difference)]
        if not abs(sum(terms)) <= TINY * max(1.0, *map(abs, terms)):
            return False
    return True
