"""Gains and friction poles: printed, derived, and what to make of the difference.

``python -m flegx_models.gains`` prints the table. Everything in the column "derived"
comes from the graphs of `flegx_models.models`; nothing is computed by a formula here.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum

from bondgraph import BondGraph, ParameterSet, derive, linearise
from flegx_models import models
from flegx_models.parameters import PRINTED, RECONCILED
from flegx_models.published import PUBLISHED, PublishedTransferFunction

PARAMETER_SETS = {"PRINTED": PRINTED, "RECONCILED": RECONCILED}


class Agreement(StrEnum):
    """How a derived value compares with the printed one; the value is the word."""

    REPRODUCED = "reproduced"
    DIFFERS = "differs"
    NOT_COMPUTABLE = "not computable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One printed result beside the derived one.

    Parameters
    ----------
    quantity
        "gain" (rad/s² per N·m) or "friction pole" (magnitude, rad/s).
    parameters
        Name of the parameter set.
    derived, relative_difference
        None where a parameter has no value.
    reason
        Why the two differ, or what is missing; empty when reproduced.
    """

    model: str
    quantity: str
    equation: str
    parameters: str
    printed: float
    derived: float | None
    agreement: Agreement
    reason: str = ""

    @property
    def relative_difference(self) -> float | None:
        """(derived - printed) / printed."""
        if self.derived is None:
            return None
        return (self.derived - self.printed) / self.printed


def table() -> tuple[Row, ...]:
    """Return the rows for every model, quantity and parameter set."""
    return tuple(
        row
        for published in PUBLISHED
        for row in _rows(published, getattr(models, published.model))
    )


Factory = Callable[[ParameterSet], BondGraph]

_POLE_REASON = "printed as c / I_load, the train's inertia left out; derived c / J"
_GAIN_REASON = "the printed parameters do not give it; see flegx_models.parameters"


def derived(graph: BondGraph) -> tuple[float, float]:
    """Return the gain (rad/s² per N·m) and friction pole (magnitude, rad/s)."""
    finished = graph.finish()
    values = finished.parameters.values_by_name()
    system = linearise(derive(finished))
    transfer_function = system.transfer_function("theta", "T_motor")
    gain = transfer_function.gain_at(values)
    # The other pole is the integration from speed to angle, at zero.
    pole = max(abs(pole) for pole in transfer_function.poles(values))
    return gain, pole


def _rows(published: PublishedTransferFunction, factory: Factory) -> Iterator[Row]:
    for name, parameters in PARAMETER_SETS.items():
        graph = factory(parameters)
        unknown = [p.name for p in graph.finish().parameters.members if p.value is None]
        gain, pole = (None, None) if unknown else derived(graph)
        missing = f"{', '.join(unknown)} is not printed"
        yield _row(
            published.model,
            "gain",
            published.gain_equation,
            name,
            (published.gain, published.gain_decimals, gain),
            missing if unknown else _GAIN_REASON,
        )
        yield _row(
            published.model,
            "friction pole",
            published.pole_equation,
            name,
            (published.friction_pole, published.pole_decimals, pole),
            missing if unknown else _POLE_REASON,
        )


def _row(
    model: str,
    quantity: str,
    equation: str,
    parameters: str,
    numbers: tuple[float, int, float | None],
    reason: str,
) -> Row:
    printed, decimals, value = numbers
    if value is None:
        agreement = Agreement.NOT_COMPUTABLE
    elif round(value, decimals) == printed:
        agreement, reason = Agreement.REPRODUCED, ""
    else:
        agreement = Agreement.DIFFERS
    return Row(
        model=model,
        quantity=quantity,
        equation=equation,
        parameters=parameters,
        printed=printed,
        derived=value,
        agreement=agreement,
        reason=reason,
    )


def as_text(rows: tuple[Row, ...]) -> str:
    """Return the rows as an aligned table."""
    head = ("model", "quantity", "set", "where", "printed", "derived", "off", "verdict")
    cells = [head, *map(_cells, rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    lines = []
    for row in cells:
        padded = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        lines.append("  ".join(padded).rstrip())
    return "\n".join(lines)


def _cells(row: Row) -> tuple[str, ...]:
    off = row.relative_difference
    return (
        row.model,
        row.quantity,
        row.parameters,
        row.equation,
        f"{row.printed:.2f}",
        "" if row.derived is None else _digits(row.derived),
        "" if off is None else f"{100 * off:+.2f} %",
        f"{row.agreement}: {row.reason}" if row.reason else str(row.agreement),
    )


def _digits(value: float) -> str:
    return f"{value:.2f}" if value >= 1 else f"{value:.3g}"


if __name__ == "__main__":
    print(as_text(table()))
