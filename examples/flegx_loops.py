"""The thesis's figures 5.4 to 5.11, its gains found again, and faster controllers.

python examples/flegx_loops.py [folder for the pictures]
"""

import math
import sys
from pathlib import Path

import numpy as np

from bondgraph.loopshaping.controllers import Lead, RollOff
from bondgraph.loopshaping.friction import FrictionRule, with_friction_pole
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import measure
from bondgraph.loopshaping.prototype import SecondOrderPrototype
from bondgraph.loopshaping.requirements import NoiseGain, Specification
from bondgraph.loopshaping.shaping import Design, shape
from bondgraph.loopshaping.sizing import Free
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain
from bondgraph.reporting.loop_pictures import (
    SheetRow,
    comparison_sheet,
    loop_sheet,
    write_picture,
)
from flegx_models.parameters_control import CONTROL

NAMES = ("lowerleg_flight", "upperleg_flight", "lowerleg_stance", "upperleg_stance")
FRICTION_POLE = {"lowerleg": 0.17, "upperleg": 0.28}  # rad/s, eq. 5.9 to 5.21
NOISE = 2 * math.pi * 400 / 3  # rad/s: the encoder's noise, section 3.4
PROTOTYPE = SecondOrderPrototype(CONTROL["damping_prototype"].value or 0.6)
VALUES = CONTROL.values_by_name()


def encoder_filter() -> ZeroPoleGain:
    """Return eq. 5.11 with its cut-off at 25 Hz, as section 3.4 says in words."""
    cut_off = 2 * math.pi * 25.0
    poles = np.roots([1 / cut_off**2, 1.414 / cut_off, 1.0])
    return ZeroPoleGain(poles=(*poles, *poles), gain=cut_off**4)


def plant(name: str) -> ZeroPoleGain:
    """Return the direct branch of eq. 5.10 to 5.22, with the fast pole of eq. 4.36."""
    friction = FRICTION_POLE[name.partition("_")[0]]
    fast, slow = VALUES["fast_pole_driver"], VALUES["slow_pole_driver"]
    return ZeroPoleGain(
        zeros=(-VALUES["zero_driver"],),
        poles=(0.0, -friction, -slow, -fast),
        gain=VALUES[f"numerator_{name}"],
    )


def printed_lead(name: str, which: str = "") -> Lead:
    """Return the controller of chapter 5; ``modified`` or ``tuned`` for the others."""
    key = f"{name}_{which}" if which else name
    return Lead(VALUES[f"K_{key}"], VALUES[f"z_{key}"], VALUES[f"p_{key}"])


def closed(name: str, lead: Lead, *, friction: float = 1.0) -> Loop:
    """Return the loop around a plant whose friction pole is `friction` times faster."""
    pole = FRICTION_POLE[name.partition("_")[0]]
    moved = with_friction_pole(plant(name), pole, friction * pole)
    return Loop(plant=moved, controller=lead.transfer, feedback=encoder_filter())


def found_again(name: str) -> Design:
    """Return the design from the thesis's own words: the gain is all that is free."""
    return shape(
        plant(name),
        printed_lead(name),
        Specification(prototype=PROTOTYPE),
        feedback=encoder_filter(),
    )


def faster(name: str) -> Design:
    """Return a lead with a roll-off that passes no more noise than the printed one."""
    printed = closed(name, printed_lead(name))
    noise = float(np.abs(printed.control_of_noise(np.array([NOISE])))[0])
    return shape(
        plant(name),
        Lead(zero=printed_lead(name).zero) * RollOff(300.0, order=3),
        Specification(
            prototype=PROTOTYPE, requirements=(NoiseGain(noise, omega=NOISE),)
        ),
        feedback=encoder_filter(),
        free=(Free("roll_off.omega", 50.0, 2000.0),),
    )


def row(name: str) -> SheetRow:
    """Return one leg's loops as printed, and with ten times the friction."""
    lead = printed_lead(name)
    designed = closed(name, lead)
    rule = FrictionRule(
        lead=lead,
        friction_pole=FRICTION_POLE[name.partition("_")[0]],
        crossover=measure(designed, step=False).crossover,
    )
    moved = rule.at(10 * rule.friction_pole)
    return SheetRow(
        title=name.replace("_", ", "),
        designed={"printed": designed},
        changed={
            "before": designed,
            "friction × 10": closed(name, lead, friction=10),
            "zero as printed": closed(
                name, printed_lead(name, "modified"), friction=10
            ),
            "zero as derived": closed(name, moved, friction=10),
        },
    )


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    print("gain and crossover: printed, from the prototype alone, with a roll-off")
    for name in NAMES:
        printed = closed(name, printed_lead(name))
        ours, quick = found_again(name), faster(name)
        gain = ours.controller.value("gain")
        print(
            f"{name:16}  {printed_lead(name).gain:.1f} {gain:.3f}"
            f"   {measure(printed).crossover:5.2f} {ours.measures.crossover:5.2f}"
            f" {quick.measures.crossover:5.2f} rad/s   ({', '.join(quick.binding)})"
        )
        if folder is not None:
            loops = {"printed": printed, "found again": ours.loop, "faster": quick.loop}
            sheet = loop_sheet(loops, prototype=PROTOTYPE, title=name)
            write_picture(sheet, folder / f"{name}.png")
    if folder is not None:
        sheet = comparison_sheet([row(n) for n in NAMES], prototype=PROTOTYPE)
        write_picture(sheet, folder / "figures_5_4_to_5_11.png")


if __name__ == "__main__":
    main()
