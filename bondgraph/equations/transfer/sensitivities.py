"""How gain, dc gain and poles of a transfer function depend on each parameter.

Gain and dc gain are differentiated in symbols. A simple pole moves by the implicit
function theorem on the characteristic polynomial, ds/dp = -(∂P/∂p)/(∂P/∂s). A multiple
pole has no such derivative (it splits like a root of the change), and is said to be one
instead of being given a number. Standard deviations are first order: independent
parameters, each with its own std.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import sympy

from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import ParameterError
from bondgraph.structure.parameters import ParameterSet
from bondgraph.structure.signals import parameter_symbol

CLOSE = 1e-6
"""Relative distance below which two computed poles count as one multiple pole."""


class PoleStatus(StrEnum):
    """What can be said of a pole's movement; the value is the sentence."""

    SIMPLE = "a simple pole: it moves in proportion to a small change"
    MULTIPLE = "a multiple pole: it splits, by a root of the change"
    FIXED = "at zero whatever the parameters are"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """One quantity and what each parameter does to it, at the parameter values.

    Parameters
    ----------
    value
        The quantity: gain or dc gain (units of output per input), or a pole (1/s).
    slopes
        d(value)/d(parameter); empty for a multiple pole.
    elasticities
        Relative change per relative change: +1 means + 1 % per + 1 %. None where the
        value is zero.
    std
        First-order standard deviation from those of the parameters; of the largest
        direction for a complex pole; None where a parameter has no std, or the
        quantity has no slope.
    unknown
        The parameters whose missing std makes `std` None.
    """

    name: str
    value: complex
    slopes: Mapping[str, complex]
    elasticities: Mapping[str, complex | None]
    std: float | None
    unknown: tuple[str, ...] = ()
    status: PoleStatus | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivities:
    """Sensitivities of one transfer function; prints as a table.

    ``gain_slopes`` and ``dc_gain_slopes`` are the same derivatives as formulas, by
    parameter; empty for a dc gain that is infinite.
    """

    name: str
    gain: Sensitivity
    dc_gain: Sensitivity | None
    poles: tuple[Sensitivity, ...]
    gain_formula: sympy.Expr
    gain_slopes: Mapping[str, sympy.Expr]
    dc_gain_slopes: Mapping[str, sympy.Expr]

    def elasticity(self, parameter: str) -> sympy.Expr:
        """Return d(ln gain)/d(ln parameter) as a formula of the parameters."""
        try:
            slope = self.gain_slopes[parameter]
        except KeyError:
            raise ParameterError(
                f"{self.name} does not depend on a parameter {parameter!r}.",
                (parameter,),
                f"It depends on {', '.join(self.gain_slopes) or 'none'}.",
            ) from None
        return sympy.cancel(slope * parameter_symbol(parameter) / self.gain_formula)

    def __str__(self) -> str:
        rows = [self.gain, *([self.dc_gain] if self.dc_gain else []), *self.poles]
        return "\n".join([self.name, *(line for row in rows for line in _lines(row))])


def _lines(row: Sensitivity) -> list[str]:
    spread = "" if row.std is None else f" ± {row.std:.3g}"
    lines = [f"  {row.name} = {_number(row.value)}{spread}"]
    if row.status in (PoleStatus.MULTIPLE, PoleStatus.FIXED):
        return [f"{lines[0]}: {row.status.value}"]
    ranked = sorted(row.elasticities.items(), key=lambda item: -abs(item[1] or 0.0))
    for parameter, elasticity in ranked:
        if elasticity is None:
            slope = _number(row.slopes[parameter])
            lines.append(f"    {row.name}: {slope} per unit of {parameter}")
        else:
            percent = _number(elasticity, "+.2f")
            lines.append(f"    {row.name}: {percent} % per % of {parameter}")
    return lines


def _number(value: complex, style: str = ".6g") -> str:
    value = complex(value)
    if value.imag == 0:
        return f"{value.real:{style}}"
    sign = "-" if value.imag < 0 else "+"
    size = format(abs(value.imag), style.replace("+", ""))
    return f"({value.real:{style}} {sign} {size}i)"


def sensitivities(
    transfer: TransferFunction, parameters: ParameterSet | Mapping[str, float]
) -> Sensitivities:
    """Return what each parameter does to gain, dc gain and poles of `transfer`.

    Parameters
    ----------
    parameters
        The values, with their standard deviations where a `ParameterSet` is given.

    Raises
    ------
    ParameterError
        If a parameter in it has no value.
    """
    known = _Known(transfer, parameters)
    gain, dc_gain = transfer.gain, transfer.dc_gain
    gain_slopes = known.differentiated(gain)
    finite = dc_gain != sympy.oo
    dc_slopes = known.differentiated(dc_gain) if finite else {}
    return Sensitivities(
        name=transfer.name,
        gain=known.of_expression("gain", gain, gain_slopes),
        dc_gain=(
            known.of_expression("dc gain", dc_gain, dc_slopes) if finite else None
        ),
        poles=known.of_poles(transfer.denominator_coefficients),
        gain_formula=gain,
        gain_slopes=gain_slopes,
        dc_gain_slopes=dc_slopes,
    )


class _Known:
    """Parameter values and standard deviations, and derivatives at them."""

    def __init__(
        self,
        transfer: TransferFunction,
        parameters: ParameterSet | Mapping[str, float],
    ) -> None:
        self._transfer = transfer
        free = set().union(
            *(c.free_symbols for c in transfer.numerator_coefficients),
            *(c.free_symbols for c in transfer.denominator_coefficients),
        )
        self.names = sorted(str(symbol) for symbol in free)
        if isinstance(parameters, ParameterSet):
            used = parameters.restricted(self.names)
            self.values = used.values_by_name()
            self.std = {p.name: p.std for p in used.members}
        else:
            self.values = {
                n: float(v) for n, v in parameters.items() if n in self.names
            }
            self.std = dict.fromkeys(self.values)
        transfer.coefficients(self.values)  # refuses a missing value by name
        self._put = {
            parameter_symbol(n): sympy.Float(v, 30) for n, v in self.values.items()
        }

    def number(self, expression: sympy.Expr) -> float:
        return float(expression.xreplace(self._put))

    def differentiated(self, expression: sympy.Expr) -> dict[str, sympy.Expr]:
        return {
            name: expression.diff(parameter_symbol(name))
            for name in self.names
            if parameter_symbol(name) in expression.free_symbols
        }

    def of_expression(
        self, name: str, expression: sympy.Expr, slopes: Mapping[str, sympy.Expr]
    ) -> Sensitivity:
        numbers = {n: self.number(slope) for n, slope in slopes.items()}
        return self._made(name, self.number(expression), numbers, None)

    def of_poles(self, coefficients: Sequence[sympy.Expr]) -> tuple[Sensitivity, ...]:
        poles = self._transfer.poles(self.values)
        numbers = [self.number(c) for c in coefficients]
        slopes = {
            name: [self.number(c.diff(parameter_symbol(name))) for c in coefficients]
            for name in self.names
            if any(parameter_symbol(name) in c.free_symbols for c in coefficients)
        }
        fixed = 0
        while coefficients[-1 - fixed] == 0:
            fixed += 1
        return tuple(
            self._of_pole(i, poles, numbers, slopes, fixed) for i in range(len(poles))
        )

    def _of_pole(
        self,
        i: int,
        poles: Sequence[complex],
        numbers: Sequence[float],
        slopes: Mapping[str, Sequence[float]],
        fixed: int,
    ) -> Sensitivity:
        name, pole = f"pole {i + 1}", poles[i]
        if i < fixed:  # sorted by size, those at zero first
            return self._made(name, 0.0, {}, PoleStatus.FIXED)
        apart = [abs(pole - other) for j, other in enumerate(poles) if j != i]
        if apart and min(apart) <= CLOSE * abs(pole):
            return self._made(name, pole, {}, PoleStatus.MULTIPLE)
        degree = len(numbers) - 1
        steepness = sum(
            (degree - k) * c * pole ** (degree - k - 1)
            for k, c in enumerate(numbers[:-1])
        )
        moved = {
            parameter: -_value(change, pole) / steepness
            for parameter, change in slopes.items()
        }
        return self._made(name, pole, moved, PoleStatus.SIMPLE)

    def _made(
        self,
        name: str,
        value: complex,
        slopes: Mapping[str, complex],
        status: PoleStatus | None,
    ) -> Sensitivity:
        unknown = tuple(n for n in slopes if self.std[n] is None)
        known = not unknown and status not in (PoleStatus.MULTIPLE, PoleStatus.FIXED)
        return Sensitivity(
            name=name,
            value=value,
            slopes=dict(slopes),
            elasticities={
                n: slope * self.values[n] / value if value else None
                for n, slope in slopes.items()
            },
            std=_spread([s * (self.std[n] or 0.0) for n, s in slopes.items()])
            if known
            else None,
            unknown=unknown,
            status=status,
        )


def _value(coefficients: Sequence[float], at: complex) -> complex:
    total = 0j
    for coefficient in coefficients:
        total = total * at + coefficient
    return total


def _spread(moves: Sequence[complex]) -> float:
    """Return the standard deviation along the direction in which it is largest."""
    real = sum(complex(m).real ** 2 for m in moves)
    imaginary = sum(complex(m).imag ** 2 for m in moves)
    mixed = sum(complex(m).real * complex(m).imag for m in moves)
    mean, half = (real + imaginary) / 2, (real - imaginary) / 2
    return math.sqrt(mean + math.hypot(half, mixed))
