"""Everything that follows from a graph alone, as plain data for JSON."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import sympy

from bondgraph.causality.records import CausalAssignment
from bondgraph.equations.power.energy import EnergyBalance
from bondgraph.equations.power.invariants import Invariants
from bondgraph.equations.power.port_hamiltonian import PortHamiltonian
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import BondGraphError


def plain_causality(causality: CausalAssignment) -> dict[str, Any]:
    """Return the strokes by bond, the kinds of storage, and the reasons."""
    return {
        "strokes": {s.bond.name: s.at for s in causality.strokes},
        "integral": list(causality.integral),
        "derivative": list(causality.derivative),
        "arbitrary": list(causality.arbitrary),
        "unmet": list(causality.unmet),
        "reasons": {s.stroke.bond.name: s.reason for s in causality.steps},
    }


def plain_equations(equations: StateEquations) -> dict[str, Any]:
    """Return the sorted equations, expressions as text."""
    return {
        "states": [
            {"name": str(s.symbol), "place": s.place, "unit": s.unit}
            for s in equations.states
        ],
        "inputs": [str(u) for u in equations.inputs],
        "assignments": [
            [str(a.symbol), str(a.expression)] for a in equations.assignments
        ],
        "rates": [str(rate) for rate in equations.rates],
        "unknowns": [str(z) for z in equations.unknowns],
        "residuals": [str(residual) for residual in equations.residuals],
        "loops": [
            {"unknown": str(z), "reason": reason, "elements": list(elements)}
            for z, reason, elements in zip(
                equations.unknowns, equations.reasons, equations.causes, strict=True
            )
        ],
        "outputs": {o.name: str(o.expression) for o in equations.outputs},
    }


def plain_energy(balance: EnergyBalance) -> dict[str, Any]:
    """Return what is stored, supplied and dissipated where."""
    return {
        "status": balance.status.value,
        "total": str(balance.total),
        "stored": {s.element: str(s.energy) for s in balance.stored},
        "supplied": {p.element: str(p.power) for p in balance.supplied},
        "dissipated": {p.element: str(p.power) for p in balance.dissipated},
        "exchanged": {p.element: str(p.power) for p in balance.exchanged},
    }


def plain_invariants(found: Invariants) -> dict[str, Any]:
    """Return what stays constant, and the states that are redundant."""
    return {
        "first_integrals": [str(i.expression) for i in found.first_integrals],
        "redundant": [r.state for r in found.redundant],
        "measured_only": list(found.measured_only),
        "unread": list(found.unread),
    }


def plain_hamiltonian(form: PortHamiltonian) -> dict[str, Any]:
    """Return the port-Hamiltonian form, or why there is none."""
    plain: dict[str, Any] = {
        "status": form.status.value,
        "reasons": list(form.reasons),
        "states": list(form.states),
        "inputs": list(form.inputs),
        "left_out": list(form.left_out),
    }
    if form.exists:
        plain["H"] = str(form.H)
        for name in ("J", "R", "G", "P", "D"):
            matrix: sympy.Matrix = getattr(form, name)
            plain[name] = [[str(x) for x in row] for row in matrix.tolist()]
    return plain


def plain_transfer(
    transfer: TransferFunction | BondGraphError, numbers: Mapping[str, float]
) -> dict[str, Any]:
    """Return one transfer function, with numbers where the parameters have values."""
    if isinstance(transfer, BondGraphError):
        return {"refused": str(transfer)}
    plain: dict[str, Any] = {
        "input": transfer.input,
        "output": transfer.output,
        "numerator": [str(c) for c in transfer.numerator_coefficients],
        "denominator": [str(c) for c in transfer.denominator_coefficients],
        "gain": None,
        "dc_gain": None,
        "poles": None,
        "zeros": None,
    }
    if has_numbers(transfer, numbers):
        plain["gain"] = transfer.gain_at(numbers)
        plain["dc_gain"] = _finite(transfer.dc_gain_at(numbers))
        plain["poles"] = _pairs(transfer.poles(numbers))
        plain["zeros"] = _pairs(transfer.zeros(numbers))
    return plain


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None


def _pairs(points: Sequence[complex]) -> list[list[float]]:
    return [[point.real, point.imag] for point in points]


def has_numbers(transfer: TransferFunction, numbers: Mapping[str, float]) -> bool:
    """Return whether gain, poles and zeros can be given as numbers."""
    needed = (transfer.expression.free_symbols) - {sympy.Symbol("s")}
    known = {str(symbol) for symbol in needed} <= set(numbers)
    return known and any(c != 0 for c in transfer.numerator_coefficients)
