"""A published result: a number as printed, and the formula it should follow from.

The formula is a sympy expression in the parameters, such as the gain of a
`TransferFunction`, one of its poles written out, or any textbook formula. The printed
digits say how far the number may be off: half a unit of the last one.
"""

import math
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation

import sympy

from bondgraph.errors import ParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedResult:
    """One published number and its formula.

    Parameters
    ----------
    value
        As published.
    rounding
        Half-width of the interval that would have been printed as `value`.
    formula
        A sympy expression in the parameters, in the same unit.
    source
        Where it is printed.
    """

    name: str
    value: float
    rounding: float
    formula: sympy.Expr
    source: str = ""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.value) and 0 <= self.rounding < math.inf):
            raise ParameterError(
                f"The result {self.name!r} is {self.value} ± {self.rounding}.",
                (self.name,),
                "Give a finite value and a rounding that is not negative.",
            )


def rounding_of(printed: str) -> float:
    """Return half a unit of the last printed digit: 0.005 for ``"176.76"``.

    Raises
    ------
    ParameterError
        If the text is not a finite decimal number.
    """
    exponent = _decimal(printed).as_tuple().exponent
    return 0.5 * 10.0 ** int(exponent)


def as_printed(
    name: str, printed: str, formula: sympy.Expr, source: str = ""
) -> PublishedResult:
    """Return the result printed as the text `printed`, such as ``"1.14e7"``.

    Raises
    ------
    ParameterError
        If the text is not a finite decimal number.
    """
    return PublishedResult(
        name=name,
        value=float(_decimal(printed)),
        rounding=rounding_of(printed),
        formula=formula,
        source=source,
    )


def _decimal(printed: str) -> Decimal:
    try:
        number = Decimal(printed)
    except InvalidOperation:
        number = Decimal("nan")
    if not number.is_finite():
        raise ParameterError(
            f"{printed!r} is not a printed number.",
            (printed,),
            "Write its digits as printed, such as '176.76' or '1.14e7'.",
        )
    return number
