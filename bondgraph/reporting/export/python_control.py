"""A model as a Python text that makes a python-control system with its names.

A linear model becomes the matrices of ``control.ss``, at the model's parameter values;
any other becomes functions and ``control.nlsys``, with the parameters still free.
"""

from collections.abc import Sequence

import sympy

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.state_equations import StateEquations
from bondgraph.numeric.model import compile_model
from bondgraph.numeric.state_space import from_equations
from bondgraph.numeric.tape import degrees
from bondgraph.reporting.export.program import one_line
from bondgraph.reporting.export.python_functions import to_python_functions
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import t as time_symbol


def to_python_control(graph: FinishedGraph, *, name: str | None = None) -> str:
    """Return Python text whose ``system`` is the model as a python-control system.

    Parameters
    ----------
    name
        Name of the system; the model's otherwise.

    Raises
    ------
    ParameterError
        If a linear model has a parameter without a value.
    EquationError
        If a linear model is improper, or a law has no number form.
    """
    equations = derive(graph)
    # python-control allows no dots in names
    called = (graph.name if name is None else name).replace(".", "_")
    if is_linear(equations):
        return _linear(graph, equations, called)
    head, imports, rest = to_python_functions(graph).partition("import math\n")
    return f"{head}{imports}\nimport control\n{rest[1:]}\n\n{_NONLINEAR}" + (
        f"system = control.nlsys(\n    _rates,\n    _outputs,\n"
        f"    states=STATES,\n    inputs=INPUTS,\n    outputs=OUTPUTS,\n"
        f"    params=PARAMETERS,\n    name={called!r},\n)\n"
    )


def is_linear(equations: StateEquations) -> bool:
    """Return whether rates and outputs are linear in states and inputs.

    They are affine in them, free of time, and vanish where all of them vanish.
    """
    model = compile_model(equations)
    n_parameters = len(equations.parameters)
    n_others = model.dynamics.n_variables - n_parameters - 1
    active = [True] * n_others + [False] * n_parameters + [True]
    if any(
        (degrees(tape, active) > 1).any() for tape in (model.dynamics, model.output)
    ):
        return False
    return not model.needs_time and _vanish_at_zero(equations)


def _vanish_at_zero(equations: StateEquations) -> bool:
    parameters = {*equations.parameters, time_symbol}
    values: dict[sympy.Symbol, sympy.Expr] = {}
    statements = [(a.symbol, a.expression) for a in equations.assignments]
    results = [
        *equations.rates,
        *equations.residuals,
        *(o.expression for o in equations.outputs),
    ]

    def at_zero(expression: sympy.Expr) -> sympy.Expr:
        others = expression.free_symbols - parameters
        return expression.xreplace({s: values.get(s, sympy.S.Zero) for s in others})

    for symbol, expression in statements:
        values[symbol] = at_zero(expression)
    return all(at_zero(result) == 0 for result in results)


def _matrix(rows: Sequence[Sequence[float]]) -> str:
    return repr([[float(x) for x in row] for row in rows])


def _linear(graph: FinishedGraph, equations: StateEquations, name: str) -> str:
    system = from_equations(equations, graph.parameters.values_by_name())
    shapes = {letter: getattr(system, letter) for letter in "ABCD"}
    matrices = "".join(
        f"    np.zeros({m.shape!r}),  # {letter}\n"
        if not m.size
        else f"    {_matrix(m.tolist())},  # {letter}\n"
        for letter, m in shapes.items()
    )
    numpy = "import numpy as np\n" if "np." in matrices else ""
    return (
        f"# {one_line(graph.name)}: linear system.\n"
        "# Written by bondgraph from the bond graph of that name; SI units.\n"
        f"import control\n{numpy}\n"
        f"system = control.ss(\n{matrices}"
        f"    states={list(system.states)!r},\n"
        f"    inputs={list(system.inputs)!r},\n"
        f"    outputs={list(system.outputs)!r},\n"
        f"    name={name!r},\n"
        ")\n"
    )


_NONLINEAR = """\
def _rates(t, x, u, params):
    return rates(t, x, u, {**PARAMETERS, **params})[0]


def _outputs(t, x, u, params):
    return outputs(t, x, u, {**PARAMETERS, **params})[0]


"""
