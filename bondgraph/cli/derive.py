"""``bondgraph derive``: what follows from the graph alone."""

from collections.abc import Mapping, Sequence
from typing import Any

import click
import sympy

from bondgraph.causality.assignment import assign_causality
from bondgraph.causality.records import CausalAssignment
from bondgraph.cli.inputs import model_argument, read_model
from bondgraph.cli.session import Session, json_option
from bondgraph.equations.derivation import derive
from bondgraph.equations.linear import LinearSystem, linearise
from bondgraph.equations.rendering import as_latex, as_text
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.transfer_function import TransferFunction
from bondgraph.errors import BondGraphError, EquationError, ParameterError
from bondgraph.structure.graph import FinishedGraph


@click.command("derive")
@model_argument
@click.option(
    "--at",
    multiple=True,
    metavar="NAME=VALUE",
    help="State or input at the operating point of a nonlinear model; 0 otherwise.",
)
@click.option("--latex", is_flag=True, help="Print the equations as LaTeX.")
@click.option("--reasons", is_flag=True, help="Say why each causal stroke is there.")
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    at: tuple[str, ...],
    latex: bool,
    reasons: bool,
    json_file: str | None,
) -> None:
    """Derive causality, state equations and transfer functions of MODEL."""
    session.answers_in(json_file)
    graph = read_model(model, values)
    causality = assign_causality(graph)
    equations = derive(graph)
    linear = _linear(equations, _point(at))
    transfers = _transfer_functions(linear)
    numbers = _numbers(graph)
    if latex:
        session.say(_latex(equations, transfers))
    else:
        session.say("\n".join(_causality_lines(causality, reasons=reasons)))
        session.say(as_text(equations))
        session.say()
        session.say("transfer functions")
        for transfer in transfers:
            session.say("\n".join(_transfer_lines(transfer, numbers)))
    session.deliver(json_file, _plain(graph, causality, equations, transfers))


def _point(words: Sequence[str]) -> dict[str, float]:
    point = {}
    for word in words:
        name, _, value = (part.strip() for part in word.partition("="))
        try:
            point[name] = float(value)
        except ValueError:
            raise ParameterError(
                f"--at {word} does not give a state or input a number.",
                (name,),
                "Write --at name=value.",
            ) from None
    return point


def _linear(
    equations: StateEquations, point: Mapping[str, float]
) -> LinearSystem | BondGraphError:
    """Return the linear system, or why there is none: that is an answer too."""
    try:
        return linearise(equations, point)
    except EquationError as error:
        return error


def _transfer_functions(
    linear: LinearSystem | BondGraphError,
) -> list[TransferFunction | BondGraphError]:
    if isinstance(linear, BondGraphError):
        return [linear]
    found: list[TransferFunction | BondGraphError] = []
    for output in linear.outputs:
        for source in linear.inputs:
            try:
                found.append(linear.transfer_function(output, source))
            except EquationError as error:
                found.append(error)
    return found


def _numbers(graph: FinishedGraph) -> dict[str, float]:
    members = graph.parameters.members
    return {m.name: m.value for m in members if m.value is not None}


def _causality_lines(causality: CausalAssignment, *, reasons: bool) -> list[str]:
    lines = ["causality", f"  integral: {', '.join(causality.integral) or 'none'}"]
    if causality.derivative:
        lines.append(f"  derivative (dependent): {', '.join(causality.derivative)}")
    if causality.arbitrary:
        lines.append(f"  chosen freely: {', '.join(causality.arbitrary)}")
    if reasons:
        lines += [
            f"  {step.stroke.bond.name}: effort into {step.stroke.at} ({step.reason})"
            for step in causality.steps
        ]
    return [*lines, ""]


def _transfer_lines(
    transfer: TransferFunction | BondGraphError, numbers: Mapping[str, float]
) -> list[str]:
    if isinstance(transfer, BondGraphError):
        return [f"  {transfer}"]
    lines = [f"  {transfer}"]
    if _has_numbers(transfer, numbers):
        lines.append(f"    gain  {transfer.gain_at(numbers):.6g}")
        lines += [
            f"    {kind} {', '.join(map(_complex, points))}"
            for kind, points in (
                ("poles", transfer.poles(numbers)),
                ("zeros", transfer.zeros(numbers)),
            )
            if points
        ]
    return lines


def _has_numbers(transfer: TransferFunction, numbers: Mapping[str, float]) -> bool:
    """Return whether gain, poles and zeros can be given as numbers."""
    needed = (transfer.expression.free_symbols) - {sympy.Symbol("s")}
    known = {str(symbol) for symbol in needed} <= set(numbers)
    return known and any(c != 0 for c in transfer.numerator_coefficients)


def _complex(point: complex) -> str:
    if point.imag == 0:
        return f"{point.real:.6g}"
    sign = "-" if point.imag < 0 else "+"
    return f"{point.real:.6g} {sign} {abs(point.imag):.6g}i"


def _latex(
    equations: StateEquations, transfers: Sequence[TransferFunction | BondGraphError]
) -> str:
    blocks = [f"\\[\n{as_latex(equations)}\n\\]"]
    for transfer in transfers:
        if isinstance(transfer, BondGraphError):
            blocks.append(f"% {transfer}")
        else:
            over = sympy.Symbol(transfer.output) / sympy.Symbol(transfer.input)
            formula = sympy.Eq(over, transfer.textbook, evaluate=False)
            blocks.append(f"\\[\n{sympy.latex(formula)}\n\\]")
    return "\n".join(blocks)


def _plain(
    graph: FinishedGraph,
    causality: CausalAssignment,
    equations: StateEquations,
    transfers: Sequence[TransferFunction | BondGraphError],
) -> dict[str, Any]:
    """Return everything derived, expressions as text."""
    numbers = _numbers(graph)
    return {
        "schema": 1,
        "model": graph.name,
        "causality": {
            "strokes": {s.bond.name: s.at for s in causality.strokes},
            "integral": list(causality.integral),
            "derivative": list(causality.derivative),
            "arbitrary": list(causality.arbitrary),
            "reasons": {s.stroke.bond.name: s.reason for s in causality.steps},
        },
        "states": [
            {"name": str(s.symbol), "place": s.place, "unit": s.unit}
            for s in equations.states
        ],
        "inputs": [str(u) for u in equations.inputs],
        "parameters": numbers,
        "assignments": [
            [str(a.symbol), str(a.expression)] for a in equations.assignments
        ],
        "rates": [str(rate) for rate in equations.rates],
        "unknowns": [str(z) for z in equations.unknowns],
        "residuals": [str(residual) for residual in equations.residuals],
        "outputs": {o.name: str(o.expression) for o in equations.outputs},
        "transfer_functions": [_plain_transfer(t, numbers) for t in transfers],
    }


def _plain_transfer(
    transfer: TransferFunction | BondGraphError, numbers: Mapping[str, float]
) -> dict[str, Any]:
    if isinstance(transfer, BondGraphError):
        return {"refused": str(transfer)}
    plain: dict[str, Any] = {
        "input": transfer.input,
        "output": transfer.output,
        "numerator": [str(c) for c in transfer.numerator_coefficients],
        "denominator": [str(c) for c in transfer.denominator_coefficients],
        "gain": None,
        "poles": None,
        "zeros": None,
    }
    if _has_numbers(transfer, numbers):
        plain["gain"] = transfer.gain_at(numbers)
        plain["poles"] = [[p.real, p.imag] for p in transfer.poles(numbers)]
        plain["zeros"] = [[z.real, z.imag] for z in transfer.zeros(numbers)]
    return plain
