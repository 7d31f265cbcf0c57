"""Any formula as linear equations between variables, some a function of another.

A product of positive numbers is a sum of their logarithms, so a formula of sums and
products becomes linear forms plus links ``plain = exp(logarithm)``; a sine is one more
link. All curvature sits in links of one variable, which can be bounded tightly. A
subexpression that occurs twice is one variable: formulas that need different values of
the same inertia contradict each other in linear equations, whatever else may vary.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import sympy

from bondgraph.errors import EquationError
from bondgraph.reconciliation.functions import (
    ATAN,
    COS,
    EXP,
    LOG,
    SIN,
    SQRT,
    SQUARE,
    TAN,
    Function,
    Range,
)

_FUNCTIONS = {sympy.sin: SIN, sympy.cos: COS, sympy.tan: TAN, sympy.atan: ATAN}


@dataclass(frozen=True, slots=True)
class Linear:
    """``constant + Σ coefficient · variable``, variables by index."""

    terms: tuple[tuple[int, float], ...]
    constant: float

    def plus(self, other: "Linear", factor: float = 1.0) -> "Linear":
        """Return this plus `factor` times `other`."""
        terms = dict(self.terms)
        for index, coefficient in other.terms:
            terms[index] = terms.get(index, 0.0) + factor * coefficient
        kept = tuple((k, c) for k, c in terms.items() if c)
        return Linear(kept, self.constant + factor * other.constant)

    def times(self, factor: float) -> "Linear":
        """Return this times a number."""
        return Linear((), 0.0).plus(self, factor)


@dataclass(frozen=True, slots=True)
class Linked:
    """A variable that is a function of another one."""

    function: Function
    argument: int


Definition = Linear | Linked


class Forms:
    """Variables with their definitions, growing as formulas are taken in.

    Parameters
    ----------
    symbols
        For each symbol its variable, and whether that is its logarithm.
    ranges
        Of the variables given so far, wide enough for every search; they decide which
        subexpressions have a logarithm.
    """

    def __init__(
        self, symbols: Mapping[sympy.Symbol, tuple[int, bool]], ranges: list[Range]
    ) -> None:
        self._symbols = symbols
        self.ranges = list(ranges)
        self.definitions: list[tuple[int, Definition]] = []
        self._known: dict[Definition, int] = {}
        self._plain: dict[sympy.Expr, Linear] = {}

    def plain(self, formula: sympy.Expr) -> Linear:
        """Return `formula` as a linear form.

        Raises
        ------
        EquationError
            If it has a function that is not known here, or may be undefined.
        """
        if formula not in self._plain:
            self._plain[formula] = self._new_plain(formula)
        return self._plain[formula]

    def logarithm(self, formula: sympy.Expr) -> tuple[int, Linear] | None:
        """Return the sign of `formula` and ln of its size, None if it may vanish."""
        if formula.is_number:
            value = float(formula)
            if value == 0:
                return None
            return (1 if value > 0 else -1), Linear((), math.log(abs(value)))
        if formula.is_Symbol and self._symbols[formula][1]:
            return 1, _variable(self._symbols[formula][0])
        if formula.is_Mul:
            return self._logarithm_of_product(formula)
        if formula.is_Pow and formula.exp.is_number:
            return self._logarithm_of_power(formula)
        if formula.func is sympy.exp:
            return 1, self.plain(formula.args[0])
        return self._logarithm_of_sum(self.plain(formula))

    def range_of(self, form: Linear) -> Range:
        """Return the range of a linear form."""
        low = high = form.constant
        for index, coefficient in form.terms:
            ends = [coefficient * end for end in self.ranges[index]]
            low, high = low + min(ends), high + max(ends)
        return low, high

    def _logarithm_of_product(self, formula: sympy.Expr) -> tuple[int, Linear] | None:
        sign, total = 1, Linear((), 0.0)
        for factor in formula.args:
            part = self.logarithm(factor)
            if part is None:
                return None
            sign, total = sign * part[0], total.plus(part[1])
        return sign, total

    def _logarithm_of_power(self, formula: sympy.Expr) -> tuple[int, Linear] | None:
        part = self.logarithm(formula.base)
        power = float(formula.exp)
        if part is None or (part[0] < 0 and not power.is_integer()):
            return None
        return (part[0] if power % 2 else 1), part[1].times(power)

    def _logarithm_of_sum(self, form: Linear) -> tuple[int, Linear] | None:
        low, high = self.range_of(form)
        if low <= 0 <= high:
            return None
        sign = 1 if low > 0 else -1
        size = self._named(form.times(sign))
        return sign, _variable(self._linked(LOG, size))

    def _new_plain(self, formula: sympy.Expr) -> Linear:
        if formula.is_number:
            return Linear((), float(formula))
        if formula.is_Symbol and not self._symbols[formula][1]:
            return _variable(self._symbols[formula][0])
        if formula.is_Add:
            total = Linear((), 0.0)
            for term in formula.args:
                total = total.plus(self.plain(term))
            return total
        if formula.func in _FUNCTIONS:
            inner = self._named(self.plain(formula.args[0]))
            return _variable(self._linked(_FUNCTIONS[formula.func], inner))
        if formula.func is sympy.log:
            found = self.logarithm(formula.args[0])
            if found is not None and found[0] > 0:
                return found[1]
            raise _undefined(formula)
        if formula.is_Mul or formula.is_Pow or formula.func is sympy.exp:
            return self._plain_product(formula)
        if formula.is_Symbol:  # one that counts by its logarithm
            return _variable(self._linked(EXP, self._symbols[formula][0]))
        raise _undefined(formula)

    def _plain_product(self, formula: sympy.Expr) -> Linear:
        """Return a product, power or exponential, by logarithms where there are."""
        number, rest = formula.as_coeff_Mul()
        found = self.logarithm(rest)
        if found is not None:
            sign, form = found
            power = self._linked(EXP, self._named(form))
            return _variable(power).times(sign * float(number))
        if number != 1:
            return self.plain(rest).times(float(number))
        if rest.is_Mul:
            first, *others = rest.args
            return self._product(
                self.plain(first), self.plain(sympy.Mul(*others))
            ).times(float(number))
        if rest.is_Pow and rest.exp.is_Integer and rest.exp > 1:
            half = rest.base ** (rest.exp // 2)
            square = self._square(self.plain(half))
            odd = self.plain(rest.base) if rest.exp % 2 else Linear((), 1.0)
            whole = self._product(square, odd) if rest.exp % 2 else square
            return whole.times(float(number))
        if rest.is_Pow and rest.exp == sympy.Rational(1, 2):
            # Values for which it is not real are no solutions.
            inner = self._named(self.plain(sympy.expand(rest.base)))
            return _variable(self._linked(SQRT, inner)).times(float(number))
        raise _undefined(formula)

    def _product(self, a: Linear, b: Linear) -> Linear:
        """Return a·b of any signs, as ((a + b)² - (a - b)²) / 4."""
        together, apart = self._square(a.plus(b)), self._square(a.plus(b, -1.0))
        return together.plus(apart, -1.0).times(0.25)

    def _square(self, form: Linear) -> Linear:
        return _variable(self._linked(SQUARE, self._named(form)))

    def _named(self, form: Linear) -> int:
        """Return the variable that equals `form`, a new one if there is none."""
        if form.constant == 0 and len(form.terms) == 1 and form.terms[0][1] == 1:
            return form.terms[0][0]
        ordered = Linear(tuple(sorted(form.terms)), form.constant)
        return self._defined(ordered, self.range_of(form))

    def _linked(self, function: Function, argument: int) -> int:
        for index, known in self.definitions:
            undone = isinstance(known, Linked) and {known.function, function} == {
                EXP,
                LOG,
            }
            if undone and index == argument:
                return known.argument  # type: ignore[union-attr]
        values = function.values(self.ranges[argument])
        return self._defined(Linked(function, argument), values)

    def _defined(self, definition: Definition, limits: Range) -> int:
        if definition not in self._known:
            self._known[definition] = len(self.ranges)
            self.definitions.append((len(self.ranges), definition))
            self.ranges.append(limits)
        return self._known[definition]


def _variable(index: int) -> Linear:
    return Linear(((index, 1.0),), 0.0)


def _undefined(formula: sympy.Expr) -> EquationError:
    return EquationError(
        f"{formula} cannot be bounded: it may be undefined for some of the values, or "
        f"has a function that is not known here.",
        (str(formula),),
        "Use sums, products, powers, exp, log, sin, cos, tan and atan, and say the "
        "signs of values by bounds.",
    )
