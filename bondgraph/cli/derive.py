"""``bondgraph derive``: what follows from the graph alone."""

import math
from collections.abc import Mapping, Sequence

import click
import sympy

from bondgraph.causality.assignment import assign_causality
from bondgraph.causality.records import CausalAssignment
from bondgraph.cli.command import Command, json_option
from bondgraph.cli.inputs import model_argument, read_model
from bondgraph.cli.operating_point import operating_point
from bondgraph.cli.session import Session
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.latex_names import latex as as_formula
from bondgraph.equations.power.energy import EnergyBalance, energy
from bondgraph.equations.power.invariants import Invariants, invariants
from bondgraph.equations.power.port_hamiltonian import PortHamiltonian, port_hamiltonian
from bondgraph.equations.rendering import SHORT, as_latex, as_text
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.transfer.descriptor import DescriptorSystem, descriptor
from bondgraph.equations.transfer.linearity import is_linear
from bondgraph.equations.transfer.sensitivities import sensitivities
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import BondGraphError, EquationError
from bondgraph.reporting.derived_json import (
    has_numbers,
    plain_causality,
    plain_energy,
    plain_equations,
    plain_hamiltonian,
    plain_invariants,
    plain_transfer,
)
from bondgraph.structure.graph import FinishedGraph

_NO_TRANSFERS = "transfer functions: none without an input and a measurement"


@click.command(
    "derive",
    cls=Command,
    examples=(
        ("derive leg.py:flight", "Causality, state equations, transfer functions"),
        ("derive leg.py:flight --energy --hamiltonian", "Where the energy goes"),
        ("derive crane.py --at q_cable=0.2 --latex", "Linear elsewhere, as LaTeX"),
    ),
)
@model_argument
@click.option(
    "--at",
    multiple=True,
    metavar="NAME=VALUE",
    help="State or input at the operating point of a nonlinear model, or a junction's "
    "flow (1) or effort (0) that stands for a state; 0 otherwise.",
)
@click.option("--latex", is_flag=True, help="Print the equations as LaTeX.")
@click.option("--reasons", is_flag=True, help="Say why each causal stroke is there.")
@click.option("--energy", "show_energy", is_flag=True, help="Print the energy balance.")
@click.option(
    "--hamiltonian", is_flag=True, help="Print the port-Hamiltonian form, if any."
)
@click.option(
    "--sensitivities",
    "show_sensitivities",
    is_flag=True,
    help="Print how gain and poles change with each parameter.",
)
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
    show_energy: bool,
    hamiltonian: bool,
    show_sensitivities: bool,
    json_file: str | None,
) -> None:
    """Derive causality, state equations and transfer functions of MODEL."""
    session.answers_in(json_file)
    graph = read_model(model, values)
    causality = assign_causality(graph)
    equations = derive(graph)
    numbers = _numbers(graph)
    linear = _linear(equations, operating_point(at, graph, equations, numbers))
    transfers = _transfer_functions(linear)
    balance, held = energy(graph, equations), invariants(graph, equations)
    form = port_hamiltonian(graph)
    parts: list[EnergyBalance | PortHamiltonian | Invariants] = []
    notable = held.first_integrals or held.redundant or held.unread or held.energy
    parts += [held] if notable else []
    parts += [_readable(balance)] if show_energy else []
    parts += [form] if hamiltonian else []
    if latex:
        session.say(_latex(equations, transfers))
        for part in parts:
            session.say(f"\\[\n{part.as_latex()}\n\\]")
    else:
        session.say("\n".join(_causality_lines(causality, reasons=reasons)))
        session.say(as_text(equations))
        session.say()
        session.say(_transfer_title(equations, transfers, at))
        for transfer in transfers:
            session.say("\n".join(_transfer_lines(transfer, numbers)))
            if show_sensitivities and isinstance(transfer, TransferFunction):
                session.say(str(sensitivities(transfer, graph.parameters)))
        for part in parts:
            session.say()
            session.say(part.as_text())
    answer = {
        "schema": 1,
        "model": graph.name,
        "causality": plain_causality(causality),
        "parameters": numbers,
        **plain_equations(equations),
        "energy": plain_energy(balance),
        "invariants": plain_invariants(held),
        "port_hamiltonian": plain_hamiltonian(form),
        "transfer_functions": [plain_transfer(t, numbers) for t in transfers],
    }
    session.deliver(json_file, answer)


def _readable(balance: EnergyBalance) -> EnergyBalance:
    """Return the balance in states and inputs, where that is short."""
    few = len(balance.equations.states) <= SHORT
    return balance.in_states() if few else balance


def _linear(
    equations: StateEquations, point: Mapping[str, float]
) -> DescriptorSystem | BondGraphError:
    """Return the linear system, or why there is none: that is an answer too.

    In descriptor form, where loops and dependent storages do not fill the matrices in.
    """
    try:
        return descriptor(equations, point)
    except EquationError as error:
        return error


def _transfer_functions(
    linear: DescriptorSystem | BondGraphError,
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


def _transfer_title(
    equations: StateEquations,
    transfers: Sequence[TransferFunction | BondGraphError],
    at: Sequence[str],
) -> str:
    """Return what stands above the transfer functions: about which point they hold."""
    if not transfers:
        return _NO_TRANSFERS
    title = "transfer functions (gain: the ratio of the leading coefficients)"
    if is_linear(equations):
        return title
    about = f"{', '.join(at)} and all else 0" if at else "all states and inputs 0"
    return f"{title}\n  linear about {about}; --at NAME=VALUE moves that"


def _transfer_lines(
    transfer: TransferFunction | BondGraphError, numbers: Mapping[str, float]
) -> list[str]:
    if isinstance(transfer, BondGraphError):
        return [f"  {transfer}"]
    lines = [f"  {transfer}"]
    if has_numbers(transfer, numbers):
        at_rest = transfer.dc_gain_at(numbers)
        slowly = f", and {at_rest:.6g} at s = 0" if math.isfinite(at_rest) else ""
        lines.append(f"    gain  {transfer.gain_at(numbers):.6g}{slowly}")
        lines += [
            f"    {kind} {', '.join(map(_complex, points))}"
            for kind, points in (
                ("poles", transfer.poles(numbers)),
                ("zeros", transfer.zeros(numbers)),
            )
            if points
        ]
    return lines


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
            blocks.append(f"\\[\n{as_formula(formula)}\n\\]")
    return "\n".join(blocks)
