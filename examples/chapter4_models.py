"""Chapter 4: the bond graphs of figures 4.2 to 4.5, their transfer functions and gains.

Run with ``python examples/chapter4_models.py [FOLDER]``: the figures, and those of the
nonlinear stance model and of the whole leg, go to FOLDER (``out/chapter4``).
"""

import sys
from pathlib import Path

from bondgraph import (
    BondGraph,
    assign_causality,
    derive,
    draw_svg,
    linearise,
)
from flegx_models import cost_tables, gains, models, nonlinear_stance, planar_leg

FIGURES = {
    "figure_4_2_lowerleg_flight": models.lowerleg_flight,
    "figure_4_3_upperleg_flight": models.upperleg_flight,
    "figure_4_4_lowerleg_stance": models.lowerleg_stance,
    "figure_4_5_upperleg_stance": models.upperleg_stance,
}
BEYOND = {
    "lowerleg_stance_nonlinear": nonlinear_stance.lowerleg_stance,
    "planar_leg_in_flight": planar_leg.flying_leg,
    "planar_leg_on_the_ground": planar_leg.standing_leg,
}


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, factory in FIGURES.items():
        graph = factory()
        draw(graph, folder / f"{name}.svg", labels="numbers")
        system = linearise(derive(graph.finish()))
        transfer_function = system.transfer_function("theta", "T_motor")
        print(f"{factory.__name__}: gain = {transfer_function.gain}")
    for name, factory in BEYOND.items():
        draw(factory(), folder / f"{name}.svg", signals=True)
    for name in ("lowerleg_stance", "upperleg_stance"):
        print(f"\n{name}: the moving lever linearised is the printed form:", same(name))
    print("\nPrinted and derived:")
    print(gains.as_text(gains.table()))
    print("\nWhat the assumptions of chapter 4 cost:")
    print(cost_tables.as_text())


def same(name: str) -> bool:
    """Return whether 2 L sin θ, linearised at θ0, gives the printed form in symbols."""
    printed = linearise(derive(getattr(models, name)().finish()))
    moving = linearise(
        derive(getattr(nonlinear_stance, name)().finish()),
        nonlinear_stance.printed_point(name),
    )
    return printed.transfer_function() == moving.transfer_function()


def draw(graph: BondGraph, path: Path, **look: object) -> None:
    finished = graph.finish()
    svg = draw_svg(finished, assignment=assign_causality(finished), **look)
    path.write_text(svg, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/chapter4"))
