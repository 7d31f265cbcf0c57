"""A law with a name laid along a line: how near it can come, and with which numbers."""

from collections.abc import Iterator, Mapping

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy.optimize import least_squares

from bondgraph.numeric.along import along
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.structure.edits import InsertElement, WrapInput
from bondgraph.structure.signals import parameter_symbol

Array = NDArray[np.float64]
Line = tuple[Array, Array]
"""Points along a line: the variable, and what the law gives there."""

NEAR = 0.75
"""Of what a straight line leaves of a line, a law that leaves more is not near.

A line is bent by all that is missing besides: behind a lag that nobody told of, the
line of dry friction falls at both ends, and friction leaves 0.64 of it.
"""

EVALUATIONS = 50
"""Of a law, from each of its starts."""


def laid_along(
    law: Hypothesis, curve: Hypothesis, line: Line
) -> tuple[float, Mapping[str, float]] | None:
    """Return what a law leaves of the line, and its values there; None where much.

    A part in proportion counts as none: the model's own numbers take it.
    """
    whole = _function(law, curve)
    if whole is None:
        return None
    expression, argument = whole
    x, y = line
    straight = y - x * float(x @ y) / max(float(x @ x), 1e-300)
    size = float(np.linalg.norm(straight)) or 1.0
    values = along(
        expression, argument, x, [parameter_symbol(n) for n in law.parameters]
    )

    def residual(theta: Array) -> Array:
        off: Array = (values(theta[:-1])[0] + theta[-1] * x - y) / size
        return off

    def slopes(theta: Array) -> Array:
        # The slope of a root at none is no number.
        own = np.nan_to_num(values(theta[:-1])[1], posinf=0.0, neginf=0.0)
        return np.column_stack([own, x]) / size

    best: tuple[float, Mapping[str, float]] | None = None
    for start, low, high in _starts(law):
        if not np.isfinite(residual(start)).all():
            continue
        found = least_squares(
            residual, start, slopes, (low, high), x_scale="jac", max_nfev=EVALUATIONS
        )
        cost = 2.0 * float(found.cost)
        if np.isfinite(cost) and cost <= NEAR and (best is None or cost < best[0]):
            best = (
                cost,
                dict(zip(law.parameters, map(float, found.x[:-1]), strict=True)),
            )
    return best


def _function(
    law: Hypothesis, curve: Hypothesis
) -> tuple[sympy.Expr, sympy.Symbol] | None:
    """Return a law of the curve's variable alone, and that; None of any other."""
    edit = law.edit
    if isinstance(edit, WrapInput) and not edit.states:
        whole = edit.value
    elif isinstance(edit, InsertElement) and law.factor == 1:
        whole = law.law
    else:
        return None
    exact = {
        parameter_symbol(p.name): p.value
        for p in edit.parameters
        if p.exact and p.value is not None
    }
    fitted = {parameter_symbol(name) for name in law.parameters}
    whole = whole.xreplace(exact)
    others = whole.free_symbols - fitted
    same = type(edit) is type(curve.edit) and law.depends_on == curve.depends_on
    return (whole, *others) if same and len(others) == 1 else None


def _starts(law: Hypothesis) -> Iterator[tuple[Array, Array, Array]]:
    """Yield where to begin, with the bounds; a part in proportion comes last."""
    bounds = {p.name: p.bounds for p in law.edit.parameters}
    low, high = np.array([*(bounds[n] for n in law.parameters), (-np.inf, np.inf)]).T
    for start in law.starts:
        begin = np.array([*(start[n] for n in law.parameters), 0.0])
        yield np.clip(begin, low, high), low, high
