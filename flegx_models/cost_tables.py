"""What chapter 4's assumptions cost and what it neglects, as aligned tables.

``python -m flegx_models.cost_tables`` prints them; docs/flegx_models.md shows them.
"""

from collections.abc import Iterator, Sequence

from bondgraph import ParameterSet
from flegx_models.decoupling import Assumption, assumptions
from flegx_models.neglected import bending, neglected, weighted_poles
from flegx_models.parameters import RECONCILED


def as_text(parameters: ParameterSet = RECONCILED) -> str:
    """Return the assumptions, and what is neglected, as aligned tables."""
    costs: list[tuple[str, ...]] = [
        ("model", "assumed", "gain", "without", "change", "pole", "over the range"),
        *map(_cost_cells, assumptions(parameters)),
    ]
    left_out = [
        ("leg", "joint", "term", "rad/s²", "of the nominal torque's"),
        *(
            (n.leg, n.joint, n.term, f"{n.acceleration:.3f}", f"{100 * n.share:.2f} %")
            for n in neglected(parameters)
        ),
    ]
    poles = [
        ("leg", "fastest pole under its weight, 1/s"),
        *((leg, _rounded(pole)) for leg, pole in weighted_poles(parameters).items()),
    ]
    bent = [
        ("joint", "link bends at", "crossover", "gain there, alone", "opposed"),
        *(
            (
                b.joint,
                f"{b.resonance:.2f} rad/s",
                f"{b.crossover:.2f} rad/s",
                _percent(b.alone),
                _percent(b.opposed),
            )
            for b in bending(parameters)
        ),
    ]
    tables = ("\n".join(_aligned(table)) for table in (costs, left_out, poles, bent))
    return "\n\n".join(tables)


def _cost_cells(cost: Assumption) -> tuple[str, ...]:
    return (
        cost.model,
        cost.statement,
        f"{cost.gain:.2f}",
        f"{cost.gain_without:.2f}",
        _percent(cost.gain_change),
        _percent(cost.pole_change),
        f"{_percent(cost.lowest)} to {_percent(cost.highest)}",
    )


def _rounded(pole: complex) -> str:
    """Return a pole that is real or imaginary; one of them is rounding."""
    if round(abs(pole), 2) == 0:
        return "0"
    if abs(pole.imag) > abs(pole.real):
        return f"±{abs(pole.imag):.2f}i"
    return f"{pole.real:.2f}"


def _percent(share: float) -> str:
    # Adding zero turns a rounded -0.0 into 0.0.
    return f"{round(100 * share, 2) + 0.0:+.2f} %"


def _aligned(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield "  ".join(cells).rstrip()


if __name__ == "__main__":
    print(as_text())
