"""An expression at many values of one symbol, as a function of its parameters."""

from collections.abc import Callable, Sequence

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.numeric.model import evaluate
from bondgraph.numeric.tape import record_tape

Array = NDArray[np.float64]


def along(
    expression: sympy.Expr,
    symbol: sympy.Symbol,
    points: Array,
    parameters: Sequence[sympy.Symbol],
) -> Callable[[Array], tuple[Array, Array]]:
    """Return what gives the expression at all points, and its slopes.

    The function takes the values of the parameters (k,) and returns the values (n,) and
    the partials along the parameters (n, k).

    Raises
    ------
    EquationError
        If the expression has any other symbol, or an unknown function.
    """
    there = [expression.xreplace({symbol: sympy.Float(float(x))}) for x in points]
    tape = record_tape(parameters, (), there, lambda _: True)
    directions = np.eye(len(parameters))
    return lambda values: evaluate(tape, values, directions)
