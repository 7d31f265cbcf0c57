"""State equations, linear systems and transfer functions as formulas in a notebook."""

import sympy

from bondgraph.equations.latex_names import latex
from bondgraph.equations.rendering import as_latex
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.transfer.linear import LinearSystem
from bondgraph.equations.transfer.transfer_function import TransferFunction

LARGEST = 8
"""States up to which matrices are worth reading."""


def equations(found: StateEquations) -> str:
    """Return the reduced equations, or the sorted ones of a large model."""
    return _display(as_latex(found))


def linear_system(found: LinearSystem) -> str | None:
    """Return the matrices of a small system; None for a large one."""
    if len(found.states) > LARGEST:
        return None
    rate = _sum([("A", "x"), ("B", "u")], found.B_rate, "B_{\\dot u}")
    output = _sum([("C", "x"), ("D", "u")], found.D_rate, "D_{\\dot u}")
    named = [("A", found.A), ("B", found.B), ("C", found.C), ("D", found.D)]
    named += [("B_{\\dot u}", found.B_rate)] if found.B_rate.nnz() else []
    named += [("D_{\\dot u}", found.D_rate)] if found.D_rate.nnz() else []
    lines = [f"\\dot x &= {rate}, \\quad y = {output}"]
    vectors = (("x", found.states), ("u", found.inputs), ("y", found.outputs))
    lines += [f"{letter} &= {_vector(names)}" for letter, names in vectors]
    lines += [f"{letter} &= {latex(matrix.as_explicit())}" for letter, matrix in named]
    return _display("\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}")


def transfer(found: TransferFunction) -> str:
    """Return output over input, and what it is."""
    ratio = f"\\frac{{{_name(found.output)}}}{{{_name(found.input)}}}"
    return _display(f"{ratio} = {latex(found.textbook)}")


def _sum(
    terms: list[tuple[str, str]], rate: sympy.ImmutableSparseMatrix, letter: str
) -> str:
    written = [f"{matrix} {vector}" for matrix, vector in terms]
    return " + ".join([*written, *([f"{letter} \\dot u"] if rate.nnz() else [])])


def _vector(names: tuple[str, ...]) -> str:
    rows = " \\\\ ".join(_name(name) for name in names)
    return f"\\begin{{bmatrix}} {rows} \\end{{bmatrix}}"


def _name(name: str) -> str:
    return latex(sympy.Symbol(name))


def _display(formula: str) -> str:
    return f"$$\n{formula}\n$$"
