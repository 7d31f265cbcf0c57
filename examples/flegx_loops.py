"""FlegX: the gains of chapter 5 found again from the prototype, and faster controllers.

`chapter5_loops.py` draws the loops as printed.

python examples/flegx_loops.py [folder for the pictures]
"""

import math
import sys
from pathlib import Path

import numpy as np

from bondgraph import (
    Design,
    Free,
    Lead,
    Loop,
    NoiseGain,
    RollOff,
    SecondOrderPrototype,
    Specification,
    ZeroPoleGain,
    loop_sheet,
    measure,
    shape,
    with_friction_pole,
    write_picture,
)
from flegx_models.controllers import MODELS as NAMES
from flegx_models.controllers import controller, printed_loop
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CONTROL

FRICTION_POLE = {
    limb: printed_loop(f"{limb}_flight").friction_pole
    for limb in ("lowerleg", "upperleg")
}
NOISE = 2 * math.pi * CHAPTER_3.values_by_name()["f_sampling"] / 3  # section 3.4
PROTOTYPE = SecondOrderPrototype(CONTROL.values_by_name()["damping_prototype"])


def encoder_filter() -> ZeroPoleGain:
    """Return eq. 5.11 with its cut-off at 25 Hz, as section 3.4 says in words."""
    return printed_loop(NAMES[0]).loop.feedback


def plant(name: str) -> ZeroPoleGain:
    """Return the direct branch of eq. 5.10 to 5.22, with the fast pole of eq. 4.36."""
    return printed_loop(name).loop.plant


def printed_lead(name: str, which: str = "printed") -> Lead:
    """Return the controller of chapter 5; ``modified`` or ``tuned`` for the others."""
    return controller(name, which)


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


if __name__ == "__main__":
    main()
