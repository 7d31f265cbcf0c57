"""The pictures of the documentation: ``python examples/pictures.py`` draws them again.

Each is a machine written here or in `flegx_models`, with its causality, drawn by
`draw_svg`; nothing is placed by hand.
"""

from pathlib import Path
from typing import Any

import sympy

from bondgraph import (
    TF,
    BondGraph,
    C,
    FinishedGraph,
    I,
    R,
    Se,
    Sf,
    assign_causality,
    displacement,
    draw_svg,
)
from flegx_models import demo, models

DOCS = Path(__file__).resolve().parent.parent / "docs"


def cylinder() -> BondGraph:
    """Return a valve-controlled hydraulic cylinder that leaks past its piston."""
    graph = BondGraph("valve, cylinder and load", domain="hydraulic")
    area_a, area_b = sympy.symbols("A_a A_b")
    graph.zero("supply", Sf("pump"), C("c_line"), R("relief"))
    graph.one("inlet", R("valve_in"))
    graph.zero("chamber_a", C("oil_a"))
    graph.one("rod", I("mass"), R("friction"), Se("load"), domain="translation")
    graph.zero("chamber_b", C("oil_b"))
    graph.one("outlet", R("valve_out"), Se("tank"))
    graph.one("leak", R("seal"))
    graph.join("supply", "inlet")
    graph.join("inlet", "chamber_a")
    graph.join("chamber_a", TF("piston_a", area_a), "rod")
    graph.join("rod", TF("piston_b", 1 / area_b), "chamber_b")
    graph.join("chamber_b", "outlet")
    graph.join("chamber_a", "leak")
    graph.join("leak", "chamber_b")
    graph.measure("position", displacement="rod")
    graph.measure("p_a", effort="chamber_a")
    return graph


def double_pendulum() -> BondGraph:
    """Return a planar double pendulum: two angles, four velocities, four MTFs."""
    graph = BondGraph("double pendulum", domain="rotation")
    graph.one("theta1", Se("torque"), R("b1"), I("J1"))
    graph.one("theta2", R("b2"), I("J2"))
    for axis, way in (("x", sympy.cos), ("y", sympy.sin)):
        first, second, between = f"v{axis}1", f"v{axis}2", f"sum_{axis}"
        graph.one(first, I(f"m1{axis}"), domain="translation")
        graph.one(second, I(f"m2{axis}"), domain="translation")
        graph.zero(between, domain="translation")
        for k, end in ((1, first), (2, between)):
            lever = sympy.Symbol(f"l{k}") * way(displacement(f"theta{k}"))
            graph.join(end, TF(f"T{k}{axis}", lever), f"theta{k}")
        graph.join(first, between)
        graph.join(between, second)
    graph.measure("angle", displacement="theta1")
    return graph


def pictures() -> dict[str, str]:
    """Return the pictures by their path below the documentation."""

    def drawn(graph: FinishedGraph, **look: Any) -> str:
        return draw_svg(graph, assignment=assign_causality(graph), **look)

    stance = models.lowerleg_stance().finish()
    return {
        "lowerleg_drive.svg": drawn(demo.drive().finish()),
        "images/lowerleg_stance.svg": drawn(stance, labels="numbers"),
        "images/cylinder.svg": drawn(cylinder().finish(), signals=True),
        "images/double_pendulum.svg": drawn(double_pendulum().finish(), signals=True),
    }


def main() -> None:
    for path, svg in pictures().items():
        (DOCS / path).write_text(svg, encoding="utf-8")


if __name__ == "__main__":
    main()
