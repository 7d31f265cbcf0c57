"""Running checks: every value is derived afresh from the graph and compared.

Margins and crossovers are those of the loop that the check declares around the model.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, assert_never

from bondgraph.checking.declaration import read_checks
from bondgraph.checking.loops import loop_figures
from bondgraph.checking.records import (
    Check,
    CheckedQuantity,
    Index,
    Nearest,
    Selection,
)
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.transfer.linear import LinearSystem, linearise
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import BondGraphError, CheckError, did_you_mean
from bondgraph.loading import load_model, load_object
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import ParameterSet


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckResult:
    """One check and what was derived for it, in SI units."""

    check: Check
    derived: complex

    @property
    def difference(self) -> float:
        """Distance of the derived value from the declared one."""
        return abs(self.derived - self.check.value)

    @property
    def allowed(self) -> float:
        """The largest difference that passes."""
        return self.check.tolerance.allowed(self.check.value)

    @property
    def ok(self) -> bool:
        """Whether the derived value is within the tolerance."""
        return self.difference <= self.allowed

    @property
    def statement(self) -> str:
        """The result as one sentence."""
        check = self.check
        relation = "as declared" if self.ok else "not as declared"
        return (
            f"{check.name}: the {check.quantity.value.replace('_', ' ')} is "
            f"{shown(self.derived)}, {relation} ({shown(check.value)} "
            f"{check.tolerance}; off by {self.difference:.3g})."
        )


@dataclass(frozen=True, slots=True)
class CheckReport:
    """The results of one check file, in its order."""

    source: str
    results: tuple[CheckResult, ...]

    @property
    def ok(self) -> bool:
        """Whether every check passes."""
        return all(result.ok for result in self.results)

    @property
    def failed(self) -> tuple[CheckResult, ...]:
        """The results outside their tolerance."""
        return tuple(result for result in self.results if not result.ok)

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain values for JSON; complex ones as pairs."""
        return {
            "schema": 1,
            "source": self.source,
            "ok": self.ok,
            "checks": [_plain(result) for result in self.results],
        }


def run_checks(path: Path | str) -> CheckReport:
    """Return the report of the checks that the file at `path` declares.

    Parameters
    ----------
    path
        A check file, or a ``pyproject.toml`` with ``[[tool.bondgraph.checks.check]]``.
        Models in it are named relative to its directory.

    Raises
    ------
    CheckError
        If the file, a model, a place or a parameter in it cannot be understood.
    """
    path = Path(path)
    checks = read_checks(path)
    cache: dict[str, tuple[FinishedGraph, LinearSystem]] = {}
    results = []
    for check in checks:
        try:
            results.append(_run(check, path.parent, cache))
        except BondGraphError as error:
            raise CheckError(
                f"{path.name}, check {check.name!r}: {error.problem}",
                error.about,
                error.remedy,
            ) from error
    return CheckReport(str(path), tuple(results))


def _run(
    check: Check, directory: Path, cache: dict[str, tuple[FinishedGraph, LinearSystem]]
) -> CheckResult:
    # Symbols do not depend on parameter values: one derivation per model and run.
    if check.model not in cache:
        graph = load_model(check.model, directory=directory)
        cache[check.model] = graph, linearise(derive(graph))
    graph, system = cache[check.model]
    _known("input", check.input, [source.name for source in graph.inputs])
    _known("output", check.output, [m.name for m in graph.measurements])
    values = _values(check, graph, directory)
    transfer_function = system.transfer_function(check.output, check.input)
    return CheckResult(check=check, derived=_derived(check, transfer_function, values))


def _known(kind: str, name: str, names: list[str]) -> None:
    if name not in names:
        raise CheckError(
            f"the model has no {kind} {name!r}.", (name,), did_you_mean(name, names)
        )


def _values(check: Check, graph: FinishedGraph, directory: Path) -> dict[str, float]:
    """Return the model's parameter values with those that the check gives instead.

    A parameter without a value is left out; it matters only where it is needed.
    """
    given = check.parameters
    if isinstance(given, str):
        found = load_object(given, directory=directory)
        if not isinstance(found, ParameterSet):
            raise CheckError(
                f"{given!r} is not a ParameterSet.", (given,), "Name a ParameterSet."
            )
        graph = graph.with_parameters(found.restricted(graph.parameters).members)
    else:
        graph = graph.with_parameters(given)
    members = graph.parameters.members
    return {m.name: m.value for m in members if m.value is not None}


def _derived(
    check: Check, transfer_function: TransferFunction, values: Mapping[str, float]
) -> complex:
    match check.quantity:
        case CheckedQuantity.GAIN:
            return complex(transfer_function.gain_at(values))
        case CheckedQuantity.DC_GAIN:
            return _dc_gain(transfer_function, values)
        case CheckedQuantity.POLE:
            return _selected(check.selection, transfer_function.poles(values), "pole")
        case CheckedQuantity.ZERO:
            return _selected(check.selection, transfer_function.zeros(values), "zero")
        case _:
            figures = loop_figures(check, transfer_function, values)
            kind = check.quantity.value.replace("_", " ")
            return _selected(check.selection, figures, kind)


def _dc_gain(
    transfer_function: TransferFunction, values: Mapping[str, float]
) -> complex:
    numerator, denominator = transfer_function.coefficients(values)
    if denominator[-1] == 0:
        raise CheckError(
            "the dc gain is infinite: there is a pole at s = 0.",
            (),
            "Check the gain or a pole instead.",
        )
    return complex(numerator[-1] / denominator[-1])


def _selected(selection: Selection, points: tuple[complex, ...], kind: str) -> complex:
    """Return the pole or zero that is meant."""
    ordered = sorted(points, key=lambda point: (abs(point), point.imag))
    if not ordered:
        raise CheckError(
            f"the transfer function has no {kind}.", (), "Check its gain instead."
        )
    match selection:
        case Nearest(point):
            return min(ordered, key=lambda candidate: abs(candidate - point))
        case Index(place):
            if place < len(ordered):
                return ordered[place]
            raise CheckError(
                f"there is no {kind} {place}: the transfer function has "
                f"{len(ordered)}, {', '.join(map(shown, ordered))}.",
                (str(place),),
                "Count from 0 by growing magnitude.",
            )
        case _:
            assert_never(selection)


def shown(value: complex) -> str:
    """Return `value` with six digits, as a real number where it is one."""
    if value.imag == 0:
        return f"{value.real:.6g}"
    return f"{value.real:.6g} {'-' if value.imag < 0 else '+'} {abs(value.imag):.6g}i"


def _plain(result: CheckResult) -> dict[str, Any]:
    check = result.check
    return {
        "name": check.name,
        "model": check.model,
        "input": check.input,
        "output": check.output,
        "quantity": check.quantity.value,
        "value": _number(check.value),
        "derived": _number(result.derived),
        "difference": result.difference,
        "allowed": result.allowed,
        "tolerance": str(check.tolerance),
        "ok": result.ok,
    }


def _number(value: complex) -> float | list[float]:
    return [value.real, value.imag] if value.imag else value.real
