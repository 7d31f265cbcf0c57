"""A model as a Python module that needs NumPy and no bondgraph.

Functions of scalars and short arrays, for what accepts ``rates(t, x, u)``: SciPy's
``solve_ivp``, python-control's ``nlsys``, a controller's test bench.
"""

import keyword
from collections.abc import Iterable, Sequence

import sympy

from bondgraph.reporting.export.calculation import Block
from bondgraph.reporting.export.printing import PythonPrinter
from bondgraph.reporting.export.program import (
    Named,
    Program,
    make_program,
    one_line,
)
from bondgraph.structure.graph import FinishedGraph

RESERVED = (
    *keyword.kwlist, *keyword.softkwlist,
    *"math np control abs max min range len zip dict float int print".split(),
    *"t x u p z y dx res jac start PARAMETERS STATES INPUTS OUTPUTS N_UNKNOWNS".split(),
    *"rates outputs residuals unknowns sign_of size_of system".split(),
)  # fmt: skip


def to_python_functions(graph: FinishedGraph, *, name: str | None = None) -> str:
    """Return the text of a Python module with the rates and outputs of a model.

    Parameters
    ----------
    name
        What the model is called there; its own name otherwise.

    Raises
    ------
    EquationError
        If a law has no number form.
    """
    return python_module(make_program(graph, name=name, reserved=RESERVED))


def python_module(program: Program) -> str:
    """Return the module of a program whose names Python allows."""
    planned = program.calculation
    unknowns = planned.equations.unknowns
    parts = [
        _docstring(program),
        "import math\n\nimport numpy as np\n",
        _tables(program),
        _function(program, "rates", "dx", planned.rates),
        _function(program, "outputs", "y", planned.outputs),
    ]
    if unknowns:
        parts.append(_residuals(program))
        parts.append(_LINEAR if planned.jacobian.constant else _NEWTON)
    if any("sign_of(" in part for part in parts):
        parts.append(_SIGN)
    return "\n".join(parts[:3]) + "\n\n" + "\n\n".join(parts[3:])


def _docstring(program: Program) -> str:
    title = one_line(program.title).replace("\\", "\\\\").replace('"', "'")
    lines = [
        f'"""{title}: state equations.',
        "",
        "Written by bondgraph from the bond graph of that name; SI units.",
        "",
        "    x' = rates(t, x, u, p)[0],    y = outputs(t, x, u, p)[0]",
        "",
    ]
    equations = program.calculation.equations
    reasons = zip(equations.unknowns, equations.reasons, strict=True)
    for i, (z, reason) in enumerate(reasons):
        why = one_line(reason).replace("\\", "\\\\").replace('"', "'")
        lines.append(f"z[{i}] is {program.names[z]}, solved for inside: {why}.")
    return "\n".join(lines).rstrip() + '\n"""\n'


def _table(title: str, named: Sequence[Named]) -> list[str]:
    rows = (
        f"    {v.label!r},  # {one_line(v.unit)}" if v.unit else f"    {v.label!r},"
        for v in named
    )
    return [f"{title} = [", *rows, "]"] if named else [f"{title} = []"]


def _tables(program: Program) -> str:
    values = [
        f"    {v.label!r}: {_number(v.value)},  # {one_line(v.unit)}"
        for v in program.parameters
    ]
    lines = [
        *_table("STATES", program.states),
        *_table("INPUTS", program.inputs),
        *_table("OUTPUTS", program.outputs),
        f"N_UNKNOWNS = {len(program.calculation.equations.unknowns)}",
        *(["PARAMETERS = {", *values, "}"] if values else ["PARAMETERS = {}"]),
    ]
    return "\n".join(lines) + "\n"


def _number(value: float | None) -> str:
    return "math.nan" if value is None else repr(float(value))


def _locals(program: Program, block: Block) -> list[str]:
    """Return a local variable for each part of x, u, p and z that a block reads."""
    labels = [v.label for v in program.parameters]
    read = block.read()
    lines = []
    for symbol, (vector, i) in program.leaves().items():
        if symbol in read:
            index = repr(labels[i]) if vector == "p" else str(i)
            lines.append(f"    {program.names[symbol]} = {vector}[{index}]")
    return lines


def _statements(
    program: Program, statements: Iterable[tuple[sympy.Symbol, sympy.Expr]]
) -> list[str]:
    printer = PythonPrinter(program.names)
    return [f"    {program.names[s]} = {printer.doprint(x)}" for s, x in statements]


def _array(program: Program, name: str, values: Sequence[sympy.Expr]) -> list[str]:
    printer = PythonPrinter(program.names)
    if not values:
        return [f"    {name} = np.zeros(0)"]
    rows = (f"        {printer.doprint(value)}," for value in values)
    return [f"    {name} = np.array([", *rows, "    ], dtype=float)"]


def _function(program: Program, name: str, result: str, block: Block) -> str:
    solves = not block.read().isdisjoint(program.calculation.equations.unknowns)
    lines = [
        f"def {name}(t, x, u, p=PARAMETERS, z=None):",
        f'    """Return {result} and the unknowns z; give z back to start from it."""',
        "    z = np.zeros(N_UNKNOWNS) if z is None else z",
        *(["    z = unknowns(t, x, u, p, z)"] if solves else []),
        *_locals(program, block),
        *_statements(program, block.statements),
        *_array(program, result, block.results),
        f"    return {result}, z",
    ]
    return "\n".join(lines) + "\n"


def _residuals(program: Program) -> str:
    planned = program.calculation
    own, jacobian = planned.residuals, planned.jacobian
    statements = (*own.statements, *jacobian.statements)
    whole = Block(statements, (*own.results, *jacobian.entries.values()))
    printer = PythonPrinter(program.names)
    lines = [
        "def residuals(t, x, u, p, z):",
        '    """Return what must vanish, and its derivatives with respect to z."""',
        *_locals(program, whole),
        *_statements(program, statements),
        *_array(program, "res", own.results),
        "    jac = np.zeros((N_UNKNOWNS, N_UNKNOWNS))",
        *(
            f"    jac[{i}, {j}] = {printer.doprint(value)}"
            for (i, j), value in jacobian.entries.items()
        ),
        "    return res, jac",
    ]
    return "\n".join(lines) + "\n"


_SIGN = '''\
def sign_of(a):
    """Return the sign of a, 0 for 0."""
    return float(a > 0.0) - float(a < 0.0)
'''

_LINEAR = '''\
def unknowns(t, x, u, p, z):
    """Return the unknowns; the residuals are linear in them."""
    res, jac = residuals(t, x, u, p, np.zeros(N_UNKNOWNS))
    return -np.linalg.solve(jac, res)
'''

_NEWTON = '''\
def size_of(step, weight):
    """Return the largest change in a step, relative to the size of its unknown."""
    return np.max(np.abs(step) / weight) if np.all(np.isfinite(step)) else np.inf


def unknowns(t, x, u, p, z):
    """Return the unknowns by Newton's method.

    A step is halved until the next one, taken with the same Jacobian, is shorter
    (Deuflhard, Newton Methods for Nonlinear Problems, 2004, section 3.1).
    """
    weight, last = np.full(N_UNKNOWNS, 1e-6), np.inf
    for iteration in range(100):
        res, jac = residuals(t, x, u, p, z)
        if iteration == 0 and np.any(np.all(jac == 0.0, axis=1)):
            z = z + 1e-3 * np.arange(1, N_UNKNOWNS + 1)  # flat: look a little further
            res, jac = residuals(t, x, u, p, z)
        step = np.linalg.solve(jac, res)
        weight = np.maximum(weight, np.abs(z))
        size, damping = size_of(step, weight), 1.0
        while size > 1e-12:
            try:
                beyond = residuals(t, x, u, p, z - damping * step)[0]
                ahead = size_of(np.linalg.solve(jac, beyond), weight)
            except (OverflowError, ValueError):
                ahead = np.inf  # outside of what a law is defined for
            if ahead <= (1.0 - 0.25 * damping) * size or damping < 1e-4:
                break
            damping *= 0.5
        z = z - damping * step
        # Steps that no longer shrink are rounding.
        if size <= 1e-12 or 0.5 * last <= size <= 1e-6:
            return z
        last = size
    raise ArithmeticError("Newton's method found no solution for the unknowns.")
'''
