"""Polynomials in s as products, and their roots where a person can read them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy

s = sympy.Symbol("s")
"""The Laplace variable; a parameter called s is another symbol, which is real."""

_P = sympy.Symbol("p")  # no parameter can be called so

MOST_TERMS = 150
"""Factoring more terms takes seconds and rarely finds a factor; only s is taken out."""
READABLE = 60
"""Operations in a root that still read as a formula."""


@dataclass(frozen=True, slots=True)
class Factor:
    """A polynomial in s with leading coefficient 1, raised to `power`.

    ``coefficients`` are those of the polynomial, highest power of s first.
    """

    coefficients: tuple[sympy.Expr, ...]
    power: int

    @property
    def degree(self) -> int:
        """The degree of the polynomial, not counting `power`."""
        return len(self.coefficients) - 1

    @property
    def expression(self) -> sympy.Expr:
        """The factor with its power."""
        return polynomial(self.coefficients) ** self.power

    @property
    def roots(self) -> tuple[sympy.Expr, ...]:
        """The roots as formulas, each once; empty where they would be unreadable."""
        if self.degree == 1:
            return (-self.coefficients[1],)
        if self.degree != 2:
            return ()
        half, last = self.coefficients[1] / 2, self.coefficients[2]
        root = sympy.sqrt(sympy.factor(half**2 - last))
        pair = (-half + root, -half - root)
        return pair if all(r.count_ops() <= READABLE for r in pair) else ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PoleZeroGain:
    """``gain · ∏ zeros / ∏ poles``, each factor with leading coefficient 1 in s."""

    name: str
    gain: sympy.Expr
    zeros: tuple[Factor, ...]
    poles: tuple[Factor, ...]

    @property
    def expression(self) -> sympy.Expr:
        """The whole as one expression, the gain in front as it is."""
        return sympy.Mul(self.gain, self._shape, evaluate=False)

    @property
    def _shape(self) -> sympy.Expr:
        top = sympy.Mul(*(factor.expression for factor in self.zeros))
        shape = top / sympy.Mul(*(factor.expression for factor in self.poles))
        factors = (*self.zeros, *self.poles)
        inside = [c for factor in factors for c in factor.coefficients]
        return for_reading(shape, [self.gain, *inside])

    def __str__(self) -> str:
        shape = self._shape
        return f"{self.name} = gain*{shape}" + f", gain = {self.gain}"

    def _repr_latex_(self) -> str:
        gain = sympy.latex(self.gain)
        shape = sympy.latex(self._shape)
        return f"$\\displaystyle {gain} \\cdot {shape}$"


def is_ambiguous(coefficients: Iterable[sympy.Expr]) -> bool:
    """Return whether a parameter is called s, and would be read as Laplace's."""
    return any(x.name == "s" for c in coefficients for x in c.free_symbols)


def for_reading(
    expression: sympy.Expr, coefficients: Iterable[sympy.Expr]
) -> sympy.Expr:
    """Return what is printed: with p for the Laplace variable beside a parameter s."""
    return expression.xreplace({s: _P}) if is_ambiguous(coefficients) else expression


def polynomial(coefficients: Sequence[sympy.Expr]) -> sympy.Expr:
    """Return the polynomial in s with these coefficients, highest power first."""
    degree = len(coefficients) - 1
    return sympy.Add(*(c * s ** (degree - i) for i, c in enumerate(coefficients)))


def factored(
    coefficients: Sequence[sympy.Expr],
) -> tuple[sympy.Expr, list[tuple[tuple[sympy.Expr, ...], int]]]:
    """Return the constant and the factors (coefficients, power) of a polynomial in s.

    A factor without s belongs to the constant.
    """
    left = list(coefficients)
    at_zero = 0
    while len(left) > 1 and left[-1] == 0:
        left.pop()
        at_zero += 1
    found: list[tuple[tuple[sympy.Expr, ...], int]] = []
    if at_zero:
        found.append(((sympy.S.One, sympy.S.Zero), at_zero))
    if len(left) == 1:
        return left[0], found
    terms = sum(len(sympy.Add.make_args(c)) for c in left)
    if terms > MOST_TERMS:
        return sympy.S.One, [*found, (tuple(left), 1)]
    constant, factors = sympy.factor_list(polynomial(left))
    for factor, power in factors:
        inside = tuple(sympy.Poly(factor, s).all_coeffs())
        if len(inside) == 1:
            constant *= factor**power
        else:
            found.append((inside, int(power)))
    return constant, found


def product(coefficients: Sequence[sympy.Expr]) -> sympy.Expr:
    """Return the polynomial as a product, each factor collected in powers of s."""
    constant, factors = factored(coefficients)
    return sympy.Mul(constant, *(polynomial(inside) ** n for inside, n in factors))


def monic(coefficients: Sequence[sympy.Expr]) -> tuple[Factor, ...]:
    """Return the factors, each over its leading coefficient."""
    _, factors = factored(coefficients)
    return tuple(
        Factor(tuple(sympy.cancel(c / inside[0]) for c in inside), power)
        for inside, power in factors
    )
