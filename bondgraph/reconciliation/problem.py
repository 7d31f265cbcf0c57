"""The printed numbers as intervals, and the formulas as equations between them.

Parameters and results are treated alike: a `Quantity` is a printed number with a
rounding interval and a far wider one for when it is taken for a misprint. Positive and
negative numbers count by the logarithm of their size, so that products are linear, a
slip of a power of ten is as far up as down, and change is relative. Every formula is an
equation between linear forms (see `forms`), in logarithms where it cannot vanish.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.errors import ParameterError, did_you_mean
from bondgraph.reconciliation.forms import Definition, Forms, Linear
from bondgraph.reconciliation.published import PublishedResult
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import as_expression

FloatArray = NDArray[np.float64]

_NEVER_PRINTED = 1e6
"""A value that nobody prints lies within this factor of 1, or within its bounds."""

_EXACT = 1e-9
"""Relative half-width in which a formula must meet an exact number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A printed number, or one to infer, in the coordinate that the search uses.

    ``inside`` is the range of its rounding, ``outside`` that of a misprint, ``printed``
    None where it is to be inferred. ``sign`` is 0 for a plain coordinate.
    """

    name: str
    printed: float | None
    inside: tuple[float, float]
    outside: tuple[float, float]
    sign: int

    def value(self, coordinate: float) -> float:
        """Return the number at `coordinate`."""
        return self.sign * math.exp(coordinate) if self.sign else coordinate


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Quantities (results last), then variables defined by them, and equations.

    Parameters
    ----------
    definitions
        Variable and what it is, each in terms of those before it.
    equations
        One per result: a linear form that is zero, with -1 times the result in it;
        or the result's plain value where the result counts by its logarithm.
    ranges
        Of all variables, as wide as any search.
    """

    quantities: tuple[Quantity, ...]
    results: int
    definitions: tuple[tuple[int, Definition], ...]
    equations: tuple[Linear, ...]
    ranges: tuple[tuple[float, float], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the quantities, in their order."""
        return tuple(quantity.name for quantity in self.quantities)

    @property
    def first_result(self) -> int:
        """The index of the first result among the quantities."""
        return len(self.quantities) - self.results

    def box(self, free: frozenset[int]) -> tuple[FloatArray, FloatArray]:
        """Return the ends of all variables, the quantities in `free` as misprints."""
        ends = [
            q.outside if k in free else q.inside for k, q in enumerate(self.quantities)
        ]
        ends += self.ranges[len(ends) :]
        return np.array([a for a, _ in ends]), np.array([b for _, b in ends])


def quantity_of(parameter: Parameter, largest_factor: float) -> Quantity:
    """Return the quantity of a parameter; its rounding is taken for certain.

    Raises
    ------
    ParameterError
        If it has no value and no bounds that say its sign.
    """
    low, high = parameter.bounds
    if parameter.value is not None:
        return _printed(
            parameter.name,
            (parameter.value, parameter.rounding or 0.0),
            (low, high),
            largest_factor,
        )
    if low < 0 < high:
        raise ParameterError(
            f"Parameter {parameter.name!r} has no value, and its bounds leave its "
            f"sign open.",
            (parameter.name,),
            "Give bounds such as (0, inf), or a value with its rounding.",
        )
    sign = 1 if low >= 0 else -1
    near, far = sorted((abs(low), abs(high)))
    near, far = max(near, 1 / _NEVER_PRINTED), min(far, _NEVER_PRINTED)
    ends = (math.log(near), math.log(far))
    return Quantity(
        name=parameter.name, printed=None, inside=ends, outside=ends, sign=sign
    )


def _printed(
    name: str,
    number: tuple[float, float],
    bounds: tuple[float, float],
    largest_factor: float,
) -> Quantity:
    """Return the quantity of a printed value and its rounding."""
    value, rounding = number
    if abs(value) <= rounding or value == 0:
        ends = (value - rounding, value + rounding)
        return Quantity(name=name, printed=value, inside=ends, outside=ends, sign=0)
    sign = 1 if value > 0 else -1
    size = math.log(abs(value))
    inside = (math.log(abs(value) - rounding), math.log(abs(value) + rounding))
    reach = math.log(largest_factor)
    nearest, farthest = sorted(map(abs, bounds))
    if bounds[0] < 0 < bounds[1]:
        nearest = 0.0
        farthest = bounds[1] if sign > 0 else -bounds[0]
    lower, upper = size - reach, size + reach
    if nearest > 0:
        lower = max(lower, math.log(nearest))
    if math.isfinite(farthest):
        upper = min(upper, math.log(farthest))
    return Quantity(
        name=name,
        printed=size,
        inside=inside,
        outside=(min(lower, inside[0]), max(upper, inside[1])),
        sign=sign,
    )


def build(
    results: Sequence[PublishedResult],
    parameters: Mapping[str, Parameter],
    *,
    suspects: Collection[str],
    largest_factor: float,
) -> Problem:
    """Return the problem of `results` and the parameters in their formulas.

    Only the `suspects` get the wider range of a misprint.

    Raises
    ------
    ParameterError
        If a formula has a symbol that is no parameter, or names clash.
    EquationError
        If a formula cannot be bounded.
    """
    used = sorted({str(s) for r in results for s in _formula(r).free_symbols})
    _check_names(results, used, parameters)
    quantities = [quantity_of(parameters[name], largest_factor) for name in used]
    quantities += [
        _printed(
            r.name,
            (r.value, max(r.rounding, _EXACT * abs(r.value))),
            (-math.inf, math.inf),
            largest_factor,
        )
        for r in results
    ]
    quantities = [
        q if q.name in suspects else replace(q, outside=q.inside) for q in quantities
    ]
    # A quantity of known sign stands for its size, so that √x² is x.
    symbols = [
        sympy.Dummy(q.name, positive=True) if q.sign else sympy.Dummy(q.name, real=True)
        for q in quantities
    ]
    forms = Forms(
        {s: (k, bool(quantities[k].sign)) for k, s in enumerate(symbols)},
        [q.outside for q in quantities],
    )
    put = {
        name: -s if q.sign < 0 else s
        for name, s, q in zip(used, symbols, quantities, strict=False)
    }
    equations = []
    for result, symbol, quantity in zip(
        results, symbols[len(used) :], quantities[len(used) :], strict=True
    ):
        formula = _formula(result)
        formula = formula.xreplace({s: put[str(s)] for s in formula.free_symbols})
        equations.append(_equation(forms, formula, symbol, quantity))
    return Problem(
        quantities=tuple(quantities),
        results=len(results),
        definitions=tuple(forms.definitions),
        equations=tuple(equations),
        ranges=tuple(forms.ranges),
    )


def _formula(result: PublishedResult) -> sympy.Expr:
    return as_expression(result.formula)


def _equation(
    forms: Forms, formula: sympy.Expr, symbol: sympy.Symbol, result: Quantity
) -> Linear:
    """Return formula - result, as logarithms where both are of one sign."""
    top, bottom = sympy.fraction(sympy.together(formula))
    if result.sign:
        parts = [forms.logarithm(_polynomial(part)) for part in (top, bottom)]
        if parts[0] is not None and parts[1] is not None:
            if parts[0][0] * parts[1][0] != result.sign:
                raise ParameterError(
                    f"The formula of {result.name!r} has the other sign than the "
                    f"published value, whatever the parameters.",
                    (result.name,),
                    "Check the formula's sign, or the parameters' bounds.",
                )
            whole = parts[0][1].plus(parts[1][1], -1.0)
            return whole.plus(_logarithm_of(forms, symbol), -1.0)
    # top = result · bottom needs no division by what may vanish
    sign = result.sign or 1
    return forms.plain(_polynomial(top)).plus(
        forms.plain(_polynomial(sign * symbol * bottom)), -1.0
    )


def _logarithm_of(forms: Forms, symbol: sympy.Symbol) -> Linear:
    found = forms.logarithm(symbol)
    assert found is not None  # a quantity with a sign counts by its logarithm
    return found[1]


def _polynomial(formula: sympy.Expr) -> sympy.Expr:
    """Return products of sums multiplied out where they are not all positive."""
    return sympy.factor_terms(sympy.expand(formula))


def _check_names(
    results: Sequence[PublishedResult],
    used: Iterable[str],
    parameters: Mapping[str, Parameter],
) -> None:
    for name in used:
        if name not in parameters:
            raise ParameterError(
                f"The formulas use {name!r}, which is no parameter.",
                (name,),
                did_you_mean(name, parameters),
            )
    names = [r.name for r in results]
    for name in names:
        if names.count(name) > 1 or name in parameters:
            raise ParameterError(
                f"{name!r} names two things.", (name,), "Give the result another name."
            )
