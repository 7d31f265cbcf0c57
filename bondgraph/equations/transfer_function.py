"""Transfer functions with symbolic parameters.

Kept as two polynomials in s without a common factor. The gain is that of the
zero-pole-gain form: the ratio of the leading coefficients, 176.76 in
``176.76 / (s (s + pole))``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy

from bondgraph.errors import EquationError, ParameterError
from bondgraph.structure.signals import parameter_symbol

s = sympy.Symbol("s")


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunction:
    """One input to one output.

    Parameters
    ----------
    numerator_coefficients, denominator_coefficients
        Of the polynomials in s, highest power first, in terms of parameters.
    """

    input: str
    output: str
    numerator_coefficients: tuple[sympy.Expr, ...]
    denominator_coefficients: tuple[sympy.Expr, ...]

    @property
    def numerator(self) -> sympy.Expr:
        """The numerator, a polynomial in s."""
        return _polynomial(self.numerator_coefficients)

    @property
    def denominator(self) -> sympy.Expr:
        """The denominator, a polynomial in s."""
        return _polynomial(self.denominator_coefficients)

    @property
    def expression(self) -> sympy.Expr:
        """Numerator over denominator, not factored."""
        return self.numerator / self.denominator

    @property
    def gain(self) -> sympy.Expr:
        """The ratio of the leading coefficients."""
        return self.numerator_coefficients[0] / self.denominator_coefficients[0]

    @property
    def dc_gain(self) -> sympy.Expr:
        """The value at s = 0; infinite with a pole there."""
        last = self.denominator_coefficients[-1]
        return sympy.oo if last == 0 else self.numerator_coefficients[-1] / last

    @property
    def textbook(self) -> sympy.Expr:
        """Numerator over denominator as products of polynomials in s, for reading."""
        return _factors(self.numerator) / _factors(self.denominator)

    def poles(self, values: Mapping[str, float]) -> tuple[complex, ...]:
        """Return the poles (1/s) at these parameter values, smallest first."""
        return _roots(self._at(self.denominator_coefficients, values))

    def zeros(self, values: Mapping[str, float]) -> tuple[complex, ...]:
        """Return the zeros (1/s) at these parameter values, smallest first."""
        return _roots(self._at(self.numerator_coefficients, values))

    def gain_at(self, values: Mapping[str, float]) -> float:
        """Return the gain at these parameter values."""
        (gain,) = self._at((self.gain,), values)
        return float(gain)

    def coefficients(
        self, values: Mapping[str, float]
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return numerator and denominator coefficients, highest power first."""
        numerator = self._at(self.numerator_coefficients, values)
        denominator = self._at(self.denominator_coefficients, values)
        return tuple(map(float, numerator)), tuple(map(float, denominator))

    def _at(
        self, expressions: Sequence[sympy.Expr], values: Mapping[str, float]
    ) -> list[sympy.Expr]:
        put = {parameter_symbol(n): sympy.Rational(v) for n, v in values.items()}
        numbers = [expression.xreplace(put) for expression in expressions]
        missing = sorted({str(x) for number in numbers for x in number.free_symbols})
        if missing:
            raise ParameterError(
                f"{self.output}/{self.input} needs a value of {', '.join(missing)}.",
                tuple(missing),
                "Give one for every parameter in it.",
            )
        return numbers

    def __str__(self) -> str:
        return f"{self.output}/{self.input} = {self.textbook}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {sympy.latex(self.textbook)}$"


def _polynomial(coefficients: Sequence[sympy.Expr]) -> sympy.Expr:
    degree = len(coefficients) - 1
    return sympy.Add(*(c * s ** (degree - i) for i, c in enumerate(coefficients)))


def _factors(polynomial: sympy.Expr) -> sympy.Expr:
    """Return the factors, each collected in powers of s."""
    constant, factors = sympy.factor_list(polynomial)
    collected = (
        sympy.collect(sympy.expand(factor), s) ** power for factor, power in factors
    )
    return sympy.Mul(constant, *collected)


def _roots(coefficients: list[sympy.Expr]) -> tuple[complex, ...]:
    """Return the roots; those at zero exactly, the others to double precision."""
    trimmed = list(coefficients)
    while trimmed and trimmed[0] == 0:
        trimmed.pop(0)
    if not trimmed:
        raise EquationError("The transfer function is zero: it has no such roots.")
    at_zero = 0
    while trimmed[-1] == 0:
        trimmed.pop()
        at_zero += 1
    roots = [0j] * at_zero
    if len(trimmed) > 1:
        polynomial = sympy.Poly([sympy.N(c, 30) for c in trimmed], s)
        roots += [complex(r) for r in polynomial.nroots(n=15, maxsteps=500)]
    return tuple(sorted(roots, key=lambda r: (abs(r), r.imag)))
