"""Sheets of a loop or of several: what a designer looks at, on one page.

Needs matplotlib, which only these functions import (``pip install
'bondgraph-workbench[plots]'``). Figures are made without pyplot, so that nothing global
changes and nothing pops up.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bondgraph.errors import BondGraphError, MissingExtraError
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import LoopMeasures, measure
from bondgraph.loopshaping.prototype import SecondOrderPrototype
from bondgraph.reporting.loop_charts import (
    draw_bode,
    draw_nichols,
    draw_noise,
    draw_nyquist,
    draw_sensitivities,
    draw_step,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_LOOPS = 6


def loop_sheet(
    loops: Loop | Mapping[str, Loop],
    *,
    prototype: SecondOrderPrototype | None = None,
    title: str = "",
) -> "Figure":
    """Return Bode, Nichols and Nyquist charts, sensitivities, step and noise response.

    Parameters
    ----------
    loops
        One loop, or several by name to compare: up to six.
    prototype
        Drawn on the Nichols chart with the two curves that bound a loop like it.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    named = {"L": loops} if isinstance(loops, Loop) else dict(loops)
    measured = _measured(named)
    figure = _figure(15, 9)
    places = figure.add_gridspec(4, 3)
    gain = figure.add_subplot(places[0, 0])
    phase = figure.add_subplot(places[1, 0], sharex=gain)
    draw_bode(gain, phase, named, measured)
    nichols = figure.add_subplot(places[:2, 1])
    draw_nichols(nichols, named, measured, prototype)
    draw_nyquist(figure.add_subplot(places[:2, 2]), named, measured)
    sensitivities = figure.add_subplot(places[2:, 0])
    draw_sensitivities(sensitivities, named, measured, prototype)
    draw_step(figure.add_subplot(places[2:, 1]), named, measured)
    draw_noise(figure.add_subplot(places[2:, 2]), named, measured)
    nichols.legend(fontsize=7, loc="lower left")
    if title:
        figure.suptitle(title)
    return figure


@dataclass(frozen=True, slots=True, kw_only=True)
class SheetRow:
    """One machine on a comparison sheet: as designed, and after something grew.

    Parameters
    ----------
    designed
        Loops by name for the left half.
    changed
        Loops by name for the right half, such as grown friction with the old and with
        the moved controller.
    """

    title: str
    designed: Mapping[str, Loop]
    changed: Mapping[str, Loop]


def comparison_sheet(
    rows: Sequence[SheetRow],
    *,
    prototype: SecondOrderPrototype | None = None,
    title: str = "",
) -> "Figure":
    """Return, per row, Bode and Nichols charts before and after a change.

    With the four FlegX loops as rows this is the sheet of the thesis's figures 5.4 to
    5.11.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    figure = _figure(19, 4.6 * len(rows))
    places = figure.add_gridspec(2 * len(rows), 4)
    for k, row in enumerate(rows):
        for side, loops in ((0, row.designed), (2, row.changed)):
            measured = _measured(loops)
            gain = figure.add_subplot(places[2 * k, side])
            phase = figure.add_subplot(places[2 * k + 1, side], sharex=gain)
            nichols = figure.add_subplot(places[2 * k : 2 * k + 2, side + 1])
            draw_bode(gain, phase, loops, measured)
            draw_nichols(nichols, loops, measured, prototype)
            nichols.legend(fontsize=7, loc="lower left")
            gain.set_title(row.title if side == 0 else f"{row.title}, changed")
            nichols.set_title(_figures(measured), fontsize=8)
    if title:
        figure.suptitle(title)
    return figure


def _figures(measured: Mapping[str, LoopMeasures]) -> str:
    return "\n".join(
        f"{name}: ω_c {m.crossover:.2f} rad/s, φ_m {m.phase_margin:.1f}°, "
        f"M_s {m.sensitivity.value:.3f}"
        for name, m in measured.items()
    )


def write_picture(figure: "Figure", path: Path | str) -> None:
    """Write a figure as PNG, SVG or PDF, by the suffix of `path`.

    Raises
    ------
    BondGraphError
        If the file cannot be written, or its suffix is no picture format.
    """
    try:
        figure.savefig(path, dpi=110)
    except (OSError, ValueError) as error:
        raise BondGraphError(
            f"{str(path)!r} cannot be written ({error}).",
            (str(path),),
            "Name a .png, .svg or .pdf in a directory that may be written to.",
        ) from error


def _measured(loops: Mapping[str, Loop]) -> dict[str, LoopMeasures]:
    if not 1 <= len(loops) <= MOST_LOOPS:
        raise BondGraphError(
            f"A chart of {len(loops)} loops cannot be read.",
            tuple(loops),
            f"Give one to {MOST_LOOPS}.",
        )
    return {name: measure(loop) for name, loop in loops.items()}


def _figure(width: float, height: float) -> "Figure":
    try:
        from matplotlib.figure import Figure  # noqa: PLC0415  (an extra, 0.4 s)
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            "Pictures of loops need matplotlib.",
            ("matplotlib",),
            "Install bondgraph-workbench[plots].",
        ) from error
    return Figure(figsize=(width, height), layout="constrained")
