"""A model as C99: one header, one source, no allocation, no library but ``math.h``.

Dependent storages and algebraic loops are solved inside: unknowns that enter linearly
by one LU factorisation, others by a damped Newton iteration with the exact Jacobian.
"""

from collections.abc import Iterable, Sequence

import sympy

from bondgraph.errors import EquationError
from bondgraph.reporting.export.c99_solver import FACTOR, LINEAR, NEWTON
from bondgraph.reporting.export.calculation import Block
from bondgraph.reporting.export.printing import CPrinter
from bondgraph.reporting.export.program import (
    Named,
    Program,
    make_program,
    one_line,
    wrapped,
)
from bondgraph.structure.graph import FinishedGraph

MOST_UNKNOWNS = 100  # the dense Jacobian lies on the stack
_KEYWORDS = (
    "auto break case char const continue default do double else enum extern float for "
    "goto if inline int long register restrict return short signed sizeof static "
    "struct switch typedef union unsigned void volatile while _Bool _Complex "
    "_Imaginary asm fortran alignas alignof bool constexpr false nullptr static_assert "
    "thread_local true typeof "
    # C++, because the header may be read there
    "and and_eq bitand bitor catch class compl const_cast decltype delete "
    "dynamic_cast explicit export friend mutable namespace new noexcept not not_eq "
    "operator or or_eq private protected public reinterpret_cast static_cast template "
    "this throw try typeid typename using virtual wchar_t xor xor_eq main"
).split()
_MATH = (
    "acos asin atan atan2 cos sin tan acosh asinh atanh cosh sinh tanh exp exp2 expm1 "
    "frexp ilogb ldexp log log10 log1p log2 logb modf scalbn scalbln cbrt fabs hypot "
    "pow sqrt erf erfc lgamma tgamma ceil floor nearbyint rint lrint llrint round "
    "lround llround trunc fmod remainder remquo copysign nan nextafter nexttoward fdim "
    "fmax fmin fma j0 j1 jn y0 y1 yn gamma signgam isnan isinf isfinite isnormal "
    "signbit fpclassify isgreater isless isunordered INFINITY NAN HUGE_VAL NULL "
    "float_t double_t linux unix"
).split()
_OWN = (
    "t x u p z res jac dx y start status residuals solve factor substitute sign_of"
).split()
RESERVED = (*_KEYWORDS, *_MATH, *_OWN)


def to_c99(graph: FinishedGraph, *, name: str | None = None) -> tuple[str, str]:
    """Return the header and the source of a model.

    Parameters
    ----------
    name
        Prefix of every public name and stem of the header; the model's name otherwise.

    Raises
    ------
    EquationError
        If a law has no number form, or more than 100 unknowns are coupled.
    """
    program = make_program(graph, name=name, reserved=RESERVED)
    unknowns = program.calculation.equations.unknowns
    if len(unknowns) > MOST_UNKNOWNS:
        raise EquationError(
            f"{graph.name!r} has {len(unknowns)} algebraic unknowns; C99 text is "
            f"written for up to {MOST_UNKNOWNS}.",
            (graph.name,),
            "Export to Modelica, whose compilers solve large sparse systems.",
        )
    return _header(program), _source(program)


def _comment(text: str) -> str:
    return one_line(text).replace("*/", "* /").replace("/*", "/ *")


def _table(vector: str, word: str, named: Sequence[Named]) -> list[str]:
    """Return what a vector holds, as lines of a comment."""
    if not named:
        return [f" * {word}: none"]
    width = max(len(v.identifier) for v in named)
    return [
        f" * {word}",
        *(
            f" *   {vector}[{i}]  {v.identifier:<{width}}  {_comment(v.comment)}"
            for i, v in enumerate(named)
        ),
    ]


def _header(program: Program) -> str:
    name = program.name
    unknowns = program.calculation.equations.unknowns
    guard = f"{name.upper()}_H"
    reasons = program.calculation.equations.reasons
    solved = [
        f" *   z[{i}]  {program.names[z]}: {_comment(reason)}"
        for i, (z, reason) in enumerate(zip(unknowns, reasons, strict=True))
    ]
    lines = [
        f"/* {_comment(program.title)}: state equations in C99.",
        " * Written by bondgraph from the bond graph of that name; SI units.",
        " *",
        " *     x' = f(t, x, u, p),    y = g(t, x, u, p)",
        " *",
        *_table("x", "states", program.states),
        *_table("u", "inputs", program.inputs),
        *_table("y", "outputs", program.outputs),
        *([" * unknowns, solved for inside", *solved] if solved else []),
        " */",
        f"#ifndef {guard}",
        f"#define {guard}",
        "",
        "#ifdef __cplusplus",
        'extern "C" {',
        "#endif",
        "",
        "enum {",
        f"    {name}_n_states = {len(program.states)},",
        f"    {name}_n_inputs = {len(program.inputs)},",
        f"    {name}_n_outputs = {len(program.outputs)},",
        f"    {name}_n_unknowns = {len(unknowns)}",
        "};",
        "",
        "typedef struct {",
        *(
            f"    double {v.identifier}; /* {_comment(v.comment)} */"
            for v in program.parameters
        ),
        *([] if program.parameters else ["    double unused; /* no parameters */"]),
        f"}} {name}_parameters;",
        "",
        "/* The values of the model; NAN where it gives none. */",
        f"extern const {name}_parameters {name}_defaults;",
        "",
        "/* Both functions return 0, or why there is no answer. */",
        "enum {",
        f"    {name}_ok = 0,",
        f"    {name}_singular = 1, /* the unknowns are not determined here */",
        f"    {name}_not_converged = 2, /* Newton's method found no solution */",
        f"    {name}_not_finite = 3 /* a value is infinite or not a number */",
        "};",
        "",
        "/* z holds the unknowns: where to start looking on entry, the solution on",
        " * return. Keep it between calls, or pass NULL to start at zero. */",
        *_prototypes(program, ";"),
        "",
        "#ifdef __cplusplus",
        "}",
        "#endif",
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def _prototypes(program: Program, end: str) -> list[str]:
    return [
        f"int {program.name}_{what}(double t, const double x[], const double u[],\n"
        f"    const {program.name}_parameters *p, double z[], double {result}[]){end}"
        for what, result in (("rates", "dx"), ("outputs", "y"))
    ]


def _source(program: Program) -> str:
    planned = program.calculation
    rates, outputs = _prototypes(program, "")
    body = [
        *_defaults(program),
        *(_solver(program) if planned.equations.unknowns else []),
        *_function(program, rates, planned.rates, "dx"),
        "",
        *_function(program, outputs, planned.outputs, "y"),
    ]
    text = "\n".join(body)
    sign = _SIGN if "sign_of(" in text else ""
    return (
        f"/* {_comment(program.title)}: see the header {program.name}.h. */\n"
        f'#include "{program.name}.h"\n\n#include <math.h>\n#include <stddef.h>\n\n'
        f"{sign}{text}\n"
    )


def _defaults(program: Program) -> Iterable[str]:
    yield f"const {program.name}_parameters {program.name}_defaults = {{"
    values = [
        f"    {_number(v.value)}, /* {v.identifier} */" for v in program.parameters
    ]
    yield from values or ["    0.0"]
    yield "};"
    yield ""


def _number(value: float | None) -> str:
    return "NAN" if value is None else repr(float(value))


def _locals(program: Program, block: Block) -> list[str]:
    """Return a local constant for each part of x, u, p and z that a block reads."""
    read = block.read()
    lines = []
    for symbol, (vector, i) in program.leaves().items():
        if symbol in read:
            name = program.names[symbol]
            source = f"p->{name}" if vector == "p" else f"{vector}[{i}]"
            lines.append(f"    const double {name} = {source};")
    return lines


def _statements(
    program: Program, statements: Iterable[tuple[sympy.Symbol, sympy.Expr]]
) -> list[str]:
    printer = CPrinter(program.names)
    return [
        wrapped(f"    const double {program.names[s]} = {printer.doprint(x)};")
        for s, x in statements
    ]


def _unused(program: Program, block: Block, given: str) -> list[str]:
    """Return statements that read arguments which nothing else reads."""
    leaves = program.leaves()
    used = {leaves[s][0] if s in leaves else s.name for s in block.read()}
    return [
        f"    (void){argument};" for argument in given.split() if argument not in used
    ]


def _function(program: Program, prototype: str, block: Block, result: str) -> list[str]:
    """Return a public function that evaluates `block`."""
    printer = CPrinter(program.names)
    name = program.name
    unknowns = program.calculation.equations.unknowns
    lines = [prototype, "{"]
    if block.read().isdisjoint(unknowns):
        solve, given = [], "t x u p z"
    else:
        given = ""
        solve = [
            f"    double start[{name}_n_unknowns] = {{0.0}};",
            "    int status;",
            "    if (z == NULL)",
            "        z = start;",
            "    status = solve(t, x, u, p, z);",
            f"    if (status != {name}_ok)",
            "        return status;",
        ]
    inner = [
        *_locals(program, block),
        *_statements(program, block.statements),
        *(
            wrapped(f"    {result}[{i}] = {printer.doprint(value)};")
            for i, value in enumerate(block.results)
        ),
        *_unused(program, block, given),
        *([] if block.results else [f"    (void){result};"]),
    ]
    return [*lines, *solve, *inner, f"    return {name}_ok;", "}"]


def _solver(program: Program) -> list[str]:
    """Return the functions that solve for the unknowns."""
    planned = program.calculation
    printer = CPrinter(program.names)
    n = len(planned.equations.unknowns)
    tangents = planned.jacobian
    entries = tuple(tangents.entries.values())
    whole = Block(
        (*planned.residuals.statements, *tangents.statements),
        (*planned.residuals.results, *entries),
    )
    own = Block(planned.residuals.statements, planned.residuals.results)
    early = _locals(program, own)
    late = [line for line in _locals(program, whole) if line not in early]
    lines = [
        "/* Residuals of the unknowns, and dr/dz row by row where jac is not NULL. */",
        "static void residuals(double t, const double x[], const double u[],",
        f"    const {program.name}_parameters *p, const double z[],",
        "    double res[], double jac[])",
        "{",
        *early,
        *_statements(program, own.statements),
        *(
            wrapped(f"    res[{i}] = {printer.doprint(value)};")
            for i, value in enumerate(own.results)
        ),
        *_unused(program, whole, "t x u p z"),
        "    if (jac != NULL) {",
    ]
    inner = [
        *late,
        *_statements(program, tangents.statements),
        "    int i;",
        f"    for (i = 0; i < {n * n}; ++i)",
        "        jac[i] = 0.0;",
        *(
            wrapped(f"    jac[{i * n + j}] = {printer.doprint(value)};")
            for (i, j), value in tangents.entries.items()
        ),
    ]
    lines += [f"    {line}".replace("\n", "\n    ") for line in inner]
    lines += ["    }", "}", ""]
    method = LINEAR if tangents.constant else NEWTON
    return ["\n".join(lines), (FACTOR + method).replace("MODEL", program.name)]


_SIGN = """\
static double sign_of(double a)
{
    return (double)((a > 0.0) - (a < 0.0));
}

"""
