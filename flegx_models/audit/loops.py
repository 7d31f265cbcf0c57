"""The printed loops of chapter 5: crossovers and margins with their rounding.

The loops are those of `flegx_models.controllers`, read as printed and as corrected. The
rounding of every printed number of a loop, the controller's included, gives an interval
for each figure.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product

from flegx_models.audit.records import Remark, Row, Verdict
from flegx_models.controllers import (
    MODELS,
    VERSIONS,
    PrintedLoop,
    Reading,
    controller,
    corrected_reading,
    evaluated,
    printed_loop,
    printed_reading,
)
from flegx_models.parameters_control import CONTROL
from flegx_models.published import PUBLISHED


def figures(loop: PrintedLoop) -> tuple[float, float, float]:
    """Return gain crossover, phase crossover (rad/s), phase margin (degrees)."""
    found = loop.figures
    return found.crossover, found.turnover, math.degrees(found.phase_margin)


def _intervals(model: str) -> list[tuple[float, float]]:
    """Return the ranges of the figures over the rounding of the loop's numbers.

    The figures are monotone in each number over so small a box: its corners do.
    """
    loop = printed_loop(model)
    (entry,) = (e for e in PUBLISHED if e.model == model)
    half = 10.0**-entry.pole_decimals / 2
    ends = [_ends(f"{name}_{model}") for name in ("K", "z", "p", "numerator")]
    ends.append((loop.friction_pole - half, loop.friction_pole + half))
    found = [
        figures(
            replace(
                loop,
                lead=replace(loop.lead, gain=gain, zero=zero, pole=pole),
                numerator=numerator,
                friction_pole=friction,
            )
        )
        for gain, zero, pole, numerator, friction in product(*ends)
    ]
    return [(min(f), max(f)) for f in zip(*found, strict=True)]


def _ends(name: str) -> tuple[float, float]:
    parameter = CONTROL[name]
    assert parameter.value is not None
    half = parameter.rounding or 0.0
    return parameter.value - half, parameter.value + half


_FIGURES = (
    ("crossover", "gain crossover", "rad/s", 1.0),
    ("turnover", "phase crossover", "rad/s", 1.0),
    ("margin", "phase margin", "°", math.pi / 180),
)
_CORRECTION = (
    "fast pole 1.61e6 of eq. 4.36 (1.16e6 in eq. 5.10 ff. has two digits swapped) and "
    "filter at 25 Hz as in section 3.4 (the formula divides by 25 rad/s)"
)


def rows() -> Iterator[Row]:
    """Yield the rows of the loops of section 5.2."""
    for entry in PUBLISHED:
        printed = figures(printed_loop(entry.model, reading=printed_reading()))
        corrected = figures(printed_loop(entry.model))
        ranges = _intervals(entry.model)
        for k, (key, quantity, unit, size) in enumerate(_FIGURES):
            parameter = CONTROL[f"{key}_{entry.model}"]
            value = (parameter.value or 0.0) / size
            half = (parameter.rounding or 0.0) / size
            low, high = ranges[k]
            meets = low <= value + half and high >= value - half
            yield Row(
                chapter=5,
                where="section 5.2",
                quantity=f"{quantity}, {entry.model.replace('_', ', ')}",
                printed=value,
                unit=unit,
                derived=printed[k],
                corrected=corrected[k],
                verdict=Verdict.CORRECTED if meets else Verdict.NOT_REPRODUCIBLE,
                cause=_CORRECTION
                if meets
                else f"with the fast pole 1.61e6 and the filter at 25 Hz the rounding "
                f"of the loop's numbers leaves {low:.2f} to {high:.2f}",
            )


def remarks() -> Iterator[Remark]:
    """Yield what the loops say beside their figures."""
    printed, right = printed_reading(), corrected_reading()
    readings = (
        ("exactly as printed", printed),
        (
            "as printed but the fast pole, 1.61e6,",
            replace(printed, fast_pole=right.fast_pole),
        ),
        (
            "as printed but the filter, at 25 Hz,",
            replace(printed, filter_cutoff=right.filter_cutoff),
        ),
    )
    for words, reading in readings:
        yield Remark(
            where="eq. 5.10 to 5.24",
            statement=f"With the equations {words} the phase margins are "
            + ", ".join(f"{_margin(model, reading):.1f}°" for model in MODELS)
            + ".",
        )
    yield _highest_turnover()
    yield _kept_margins()


def _kept_margins() -> Remark:
    """Say how well the modified zeros keep the loops, as section 5.2 wants it."""
    margins = {(m, v): math.degrees(x.figures.phase_margin) for m, v, x in evaluated()}
    changes = ", ".join(
        f"{margins[m, 'modified'] - margins[m, 'printed']:+.1f}° "
        f"({m.replace('_', ', ')})"
        for m in MODELS
    )
    return Remark(
        where="section 5.2",
        statement=f"Ten times the friction with ten times the zero changes the phase "
        f"margins by {changes}: the loop stays what it is where the zero lies on the "
        f"friction pole, and 0.12 does not lie on 0.28.",
    )


def _margin(model: str, reading: Reading) -> float:
    return figures(printed_loop(model, reading=reading))[2]


def _highest_turnover() -> Remark:
    """Say what the best of all printed controllers does for the upper leg."""
    leads = [controller(model, version) for model in MODELS for version in VERSIONS]
    best = max(
        figures(replace(printed_loop(model), lead=lead))[1]
        for model in ("upperleg_flight", "upperleg_stance")
        for lead in leads
    )
    return Remark(
        where="figures 5.6, 5.10",
        statement=f"Of all {len(leads)} printed controllers none brings the upper "
        f"leg's phase crossover above {best:.1f} rad/s; 67.25 and 65.75 are printed.",
    )
