"""From names and values to a point of a numeric model."""

from collections.abc import Mapping

import numpy as np
import sympy

from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.steady_state import SteadyState, point_values
from bondgraph.errors import EquationError, ParameterError, did_you_mean
from bondgraph.numeric.jacobian import Point
from bondgraph.numeric.model import NumericModel
from bondgraph.structure.signals import as_expression, parameter_symbol


def placed(
    model: NumericModel,
    equations: StateEquations,
    values: Mapping[str, float],
    at: Mapping[str, object] | SteadyState | None,
) -> Point:
    """Return the point that `values` (parameters) and `at` (all else) describe.

    What `at` does not name is zero; it may give numbers or expressions of parameters.

    Raises
    ------
    EquationError
        If a name is unknown.
    ParameterError
        If a parameter has no value.
    """
    numbers = parameter_values(equations, values)
    given = point_values(at)
    groups = {
        "x": [state.symbol.name for state in equations.states],
        "rates": [state.rate.name for state in equations.states],
        "unknowns": [z.name for z in equations.unknowns],
        "u": [u.name for u in equations.inputs],
        "input_rates": [u.name for u in equations.input_rates],
    }
    known = {name for names in groups.values() for name in names} | {"t"}
    for name in given:
        if name not in known:
            raise EquationError(
                f"{equations.name!r} has no state or input {name!r}.",
                (name,),
                did_you_mean(name, known),
            )
    arrays = {
        group: np.array([_number(given.get(name, 0.0), values) for name in names])
        for group, names in groups.items()
    }
    return Point(p=numbers, t=_number(given.get("t", 0.0), values), **arrays)


def parameter_values(
    equations: StateEquations, values: Mapping[str, float]
) -> np.ndarray:
    """Return the parameter values in the order of the equations."""
    missing = tuple(p.name for p in equations.parameters if p.name not in values)
    if missing:
        raise ParameterError(
            f"{equations.name!r} needs a value of {', '.join(missing)}.",
            missing,
            "Give one for every parameter in it.",
        )
    return np.array([float(values[p.name]) for p in equations.parameters])


def _number(value: object, parameters: Mapping[str, float]) -> float:
    if isinstance(value, int | float):
        return float(value)
    expression = as_expression(value)
    names = sorted(map(str, expression.free_symbols))
    missing = tuple(name for name in names if name not in parameters)
    if missing:
        raise ParameterError(
            f"The operating point {value} needs a value of {', '.join(missing)}.",
            missing,
            "Give one for every parameter in it.",
        )
    put = {parameter_symbol(name): sympy.Float(parameters[name]) for name in names}
    return float(expression.xreplace(put))
