"""A model as one MATLAB function file, which Octave runs too.

The file's function returns a struct: names, units, parameter values, the linear model
where there is one, and handles to the rates and outputs, ready for ``ode15s``.
"""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import sympy

from bondgraph.errors import BondGraphError
from bondgraph.reporting.export.calculation import Block
from bondgraph.reporting.export.printing import MatlabPrinter
from bondgraph.reporting.export.program import (
    Named,
    Program,
    make_program,
    one_line,
    wrapped,
)
from bondgraph.structure.graph import FinishedGraph

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

RESERVED = tuple(
    (
        # keywords of MATLAB, and those that Octave adds
        "break case catch classdef continue else elseif end for function global if "
        "otherwise parfor persistent return spmd switch try while arguments methods "
        "properties events enumeration do until unwind_protect unwind_protect_cleanup "
        "end_try_catch end_unwind_protect endfor endfunction endif endwhile endswitch "
        "endclassdef endenumeration endevents endmethods endproperties endparfor "
        # what the file calls
        "sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt abs sign max min "
        "zeros ones eye all any isfinite isempty nargin error struct numel norm eps pi "
        "Inf NaN nan inf ans true false ode45 ode15s "
        "t x u p z res jac dx y model step trial weight size last damping iteration "
        "next rates outputs residuals unknowns choose size_of"
    ).split()
)


def to_matlab(graph: FinishedGraph, *, name: str | None = None) -> str:
    """Return the text of a function file for MATLAB and Octave.

    Parameters
    ----------
    name
        Name of the function, which must be that of the file; the model's otherwise.

    Raises
    ------
    EquationError
        If a law has no number form.
    """
    program = make_program(graph, name=name, reserved=RESERVED)
    planned = program.calculation
    lines = [
        f"function model = {program.name}()",
        *_help(program),
        f"  model.name = {_quoted(program.title)};",
        *_names("state", program.states),
        *_names("input", program.inputs),
        *_names("output", program.outputs),
        *_parameters(program.parameters),
        f"  model.x0 = zeros({len(program.states)}, 1);",
        "  model.rates = @rates;",
        "  model.outputs = @outputs;",
        *_linear(graph, program),
        "end",
        "",
        *_function(program, "rates", "dx", planned.rates),
        "",
        *_function(program, "outputs", "y", planned.outputs),
    ]
    if planned.equations.unknowns:
        lines += ["", *_residuals(program)]
        lines += ["", _LINEAR if planned.jacobian.constant else _NEWTON]
    text = "\n".join(lines).rstrip() + "\n"
    return text + _CHOOSE if "choose(" in text else text


def _help(program: Program) -> Iterable[str]:
    title, name = one_line(program.title), program.name
    yield f"%{name.upper()}  {title}: state equations."
    yield "%  Written by bondgraph from the bond graph of that name; SI units."
    yield "%"
    yield f"%  model = {name}();"
    yield "%  u = @(t) " + f"zeros({len(program.inputs)}, 1);"
    yield "%  f = @(t, x) model.rates(t, x, u(t), model.parameters);"
    yield "%  [t, x] = ode15s(f, [0 10], model.x0);"
    yield "%  y = model.outputs(t(end), x(end, :).', u(t(end)), model.parameters);"
    for vector, named in (
        ("x", program.states), ("u", program.inputs), ("y", program.outputs)
    ):  # fmt: skip
        yield "%"
        for i, v in enumerate(named, 1):
            yield f"%  {vector}({i})  {v.identifier}  {one_line(v.comment)}"
    reasons = program.calculation.equations.reasons
    for i, (z, reason) in enumerate(
        zip(program.calculation.equations.unknowns, reasons, strict=True), 1
    ):
        yield f"%  z({i})  {program.names[z]}, solved for inside: {one_line(reason)}"


def _quoted(text: str) -> str:
    return "'" + one_line(text).replace("'", "''") + "'"


def _cell(texts: Iterable[str]) -> str:
    return "{" + ", ".join(map(_quoted, texts)) + "}"


def _names(word: str, named: Sequence[Named]) -> list[str]:
    return [
        f"  model.{word}_names = {_cell(v.label for v in named)};",
        f"  model.{word}_units = {_cell(v.unit for v in named)};",
    ]


def _number(value: float | None) -> str:
    return "NaN" if value is None else repr(float(value))


def _parameters(parameters: Sequence[Named]) -> Iterable[str]:
    yield "  model.parameters = struct();"
    for v in parameters:
        yield (
            f"  model.parameters.{v.identifier} = {_number(v.value)};"
            f"  % {one_line(v.comment)}"
        )


def _linear(graph: FinishedGraph, program: Program) -> list[str]:
    """Return the matrices of the linear model around zero, or why there are none."""
    from bondgraph.numeric.state_space import from_equations  # noqa: PLC0415  (numpy)

    equations = program.calculation.equations
    try:
        system = from_equations(equations, graph.parameters.values_by_name())
    except BondGraphError as error:
        return ["", f"  % No linear model: {one_line(str(error))}"]
    n = len(equations.inputs)
    some = "" if n == len(program.inputs) else f", of the first {n} inputs"
    about = f"  % Linear model around x = 0, u = 0{some}."
    matrices = [
        f"  model.{letter} = {_matrix(getattr(system, letter))};" for letter in "ABCD"
    ]
    return ["", about, *matrices]


def _matrix(matrix: "NDArray[np.float64]") -> str:
    if not matrix.size:
        return f"zeros({matrix.shape[0]}, {matrix.shape[1]})"
    rows = (", ".join(repr(float(x)) for x in row) for row in matrix)
    return "[" + "; ...\n    ".join(rows) + "]"


def _locals(program: Program, block: Block) -> list[str]:
    """Return a local variable for each part of x, u, p and z that a block reads."""
    read = block.read()
    lines = []
    for symbol, (vector, i) in program.leaves().items():
        if symbol in read:
            name = program.names[symbol]
            source = f"p.{name}" if vector == "p" else f"{vector}({i + 1})"
            lines.append(f"  {name} = {source};")
    return lines


def _statements(
    program: Program, statements: Iterable[tuple[sympy.Symbol, sympy.Expr]]
) -> list[str]:
    printer = MatlabPrinter(program.names)
    return [
        _line(f"  {program.names[symbol]} = {printer.doprint(expression)};")
        for symbol, expression in statements
    ]


def _line(text: str) -> str:
    return wrapped(text, continuation=" ...")


def _results(program: Program, name: str, block: Block) -> list[str]:
    printer = MatlabPrinter(program.names)
    return [
        f"  {name} = zeros({len(block.results)}, 1);",
        *(
            _line(f"  {name}({i}) = {printer.doprint(value)};")
            for i, value in enumerate(block.results, 1)
        ),
    ]


def _function(program: Program, name: str, result: str, block: Block) -> list[str]:
    """Return a function that evaluates `block`, solving for the unknowns first."""
    lines = [
        f"function [{result}, z] = {name}(t, x, u, p, z)",
        "  % z: the unknowns, on entry where to start looking (zero if left out).",
        "  if nargin < 5",
        f"    z = zeros({len(program.calculation.equations.unknowns)}, 1);",
        "  end",
    ]
    if not block.read().isdisjoint(program.calculation.equations.unknowns):
        lines.append("  z = unknowns(t, x, u, p, z);")
    lines += _locals(program, block)
    lines += _statements(program, block.statements)
    return [*lines, *_results(program, result, block), "end"]


def _residuals(program: Program) -> list[str]:
    planned = program.calculation
    printer = MatlabPrinter(program.names)
    n, jacobian = len(planned.equations.unknowns), planned.jacobian
    own = planned.residuals
    statements = (*own.statements, *jacobian.statements)
    whole = Block(statements, (*own.results, *jacobian.entries.values()))
    return [
        "function [res, jac] = residuals(t, x, u, p, z)",
        "  % What must vanish, and its derivatives with respect to z.",
        *_locals(program, whole),
        *_statements(program, statements),
        *_results(program, "res", own),
        f"  jac = zeros({n}, {n});",
        *(
            _line(f"  jac({i + 1}, {j + 1}) = {printer.doprint(value)};")
            for (i, j), value in jacobian.entries.items()
        ),
        "end",
    ]


_CHOOSE = """\

function value = choose(condition, one, other)
  if condition
    value = one;
  else
    value = other;
  end
end
"""

_LINEAR = """\
function z = unknowns(t, x, u, p, z)
  % The residuals are linear in z: one step from zero solves them.
  [res, jac] = residuals(t, x, u, p, zeros(numel(z), 1));
  z = -(jac \\ res);
  if ~all(isfinite(z))
    error('bondgraph:singular', 'The unknowns are not determined here.');
  end
end
"""

_NEWTON = """\
function z = unknowns(t, x, u, p, z)
  % Newton's method. A step is halved until the next one, taken with the same Jacobian,
  % is shorter (Deuflhard, Newton Methods for Nonlinear Problems, 2004, section 3.1).
  z = z(:);
  weight = 1e-6 * ones(numel(z), 1);
  last = Inf;
  for iteration = 1:100
    [res, jac] = residuals(t, x, u, p, z);
    if iteration == 1 && any(all(jac == 0, 2))
      z = z + 1e-3 * (1:numel(z)).';  % flat at the start: look a little further
      [res, jac] = residuals(t, x, u, p, z);
    end
    step = jac \\ res;
    weight = max(weight, abs(z));
    size = size_of(step, weight);
    if ~isfinite(size)
      error('bondgraph:singular', 'The unknowns are not determined here.');
    end
    damping = 1;
    while true
      trial = z - damping * step;
      if size <= 1e-12
        break
      end
      next = jac \\ residuals(t, x, u, p, trial);
      if size_of(next, weight) <= (1 - 0.25 * damping) * size || damping < 1e-4
        break
      end
      damping = damping / 2;
    end
    z = trial;
    if size <= 1e-12 || (size <= 1e-6 && size >= 0.5 * last)
      return  % steps that no longer shrink are rounding
    end
    last = size;
  end
  error('bondgraph:not_converged', 'Newton''s method found no solution.');
end

function size = size_of(step, weight)
  % The largest change in a step, relative to the size of its unknown.
  if all(isfinite(step))
    size = max(abs(step) ./ weight);
  else
    size = Inf;
  end
end
"""
