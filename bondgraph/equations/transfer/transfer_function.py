"""Transfer functions with symbolic parameters.

Kept as two polynomials in s without a common factor. The gain is that of the
zero-pole-gain form: the ratio of the leading coefficients, 176.76 in
``176.76 / (s (s + pole))``. Three forms print and render: `polynomial` (coefficients by
powers of s), `textbook` (factors without fractions), `pole_zero_gain` (gain times
factors that start with s). Beside a parameter called s the latter two write p instead.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy

from bondgraph.equations.algebra.factors import (
    PoleZeroGain,
    for_reading,
    is_ambiguous,
    monic,
    product,
    s,
)
from bondgraph.equations.algebra.factors import polynomial as _polynomial
from bondgraph.errors import EquationError, ParameterError
from bondgraph.structure.signals import parameter_symbol

__all__ = ["TransferFunction", "s"]

_SHORT = 200  # operations up to which a gain is worth factoring


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
    def name(self) -> str:
        """Output over input."""
        return f"{self.output}/{self.input}"

    @property
    def polynomial(self) -> sympy.Expr:
        """Numerator over denominator, each by powers of s, nothing factored."""
        return sympy.Mul(
            self.numerator,
            sympy.Pow(self.denominator, -1, evaluate=False),
            evaluate=False,
        )

    @property
    def textbook(self) -> sympy.Expr:
        """Numerator over denominator as products of polynomials in s, for reading.

        Where a parameter is called s, they are written in p.
        """
        top, bottom = self.numerator_coefficients, self.denominator_coefficients
        return for_reading(product(top) / product(bottom), (*top, *bottom))

    @property
    def pole_zero_gain(self) -> PoleZeroGain:
        """The gain, and zeros and poles as factors with s in front."""
        return PoleZeroGain(
            name=self.name,
            gain=sympy.factor(self.gain)
            if self.gain.count_ops() < _SHORT
            else self.gain,
            zeros=monic(self.numerator_coefficients),
            poles=monic(self.denominator_coefficients),
        )

    def at(self, frequency: complex, values: Mapping[str, float]) -> complex:
        """Return the complex gain at s = `frequency` (1/s) and parameter values."""
        top, bottom = self.coefficients(values)
        return complex(_horner(top, frequency) / _horner(bottom, frequency))

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

    def dc_gain_at(self, values: Mapping[str, float]) -> float:
        """Return the value at s = 0 at these parameter values; inf with a pole there.

        By the last coefficients as numbers: symbols may cancel only there.
        """
        ends = self.numerator_coefficients[-1], self.denominator_coefficients[-1]
        top, bottom = self._at(ends, values)
        return float(top / bottom) if bottom else float("inf")

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
                f"{self.name} needs a value of {', '.join(missing)}.",
                tuple(missing),
                "Give one for every parameter in it.",
            )
        return numbers

    def __str__(self) -> str:
        text = f"{self.name} = {self.textbook}"
        if is_ambiguous((*self.numerator_coefficients, *self.denominator_coefficients)):
            return f"{text}, p for Laplace's variable, as s is a parameter"
        return text

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {sympy.latex(self.textbook)}$"


def _horner(coefficients: Sequence[float], at: complex) -> complex:
    total = 0j
    for coefficient in coefficients:
        total = total * at + coefficient
    return total


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
    polynomial = sympy.Poly([sympy.N(c, 30) for c in trimmed], s)
    roots += [complex(r) for r in polynomial.nroots(n=15, maxsteps=500)]
    return tuple(sorted(roots, key=lambda r: (abs(r), r.imag)))
