"""Time from one sample to the next, in steps that are split where frictions stop.

A step in which a slipping friction stops or turns round ends there; the friction
decides anew, and the rest follows. So the error stays that of a smooth step, and what
is a kink in a fixed grid of steps has its right slope.
"""

from bondgraph.numeric.compiled.loops import Array, lean
from bondgraph.numeric.compiled.newton import GLANCE, SHORTEST
from bondgraph.numeric.kernel.events import margin_left, step_to_event
from bondgraph.numeric.kernel.method import Drive, Method, Steps
from bondgraph.numeric.kernel.stage_arrays import STICKS, System, Work
from bondgraph.numeric.kernel.steps import copy_start, stopped, take_step

EVENTS = 8  # splits of one step; the rest is taken as it is


@lean
def advance(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int,
) -> bool:  # fmt: skip
    """Take one step of size `h` in place, split where frictions stop.

    Where a step finds no solution, it is taken in halves: sharp corners and steep
    slopes that one step would jump over are met one by one.
    """
    whole, events, part = h, 0, h
    while h > GLANCE * whole or events == 0:
        part = min(part, h)
        start = 0.0
        copy_start(system, work, steps, x, dx, n, work.held[0])
        if system.nd > 0:
            start, _ = margin_left(system, work, steps)
            if events >= EVENTS:  # too many: the rest of the step as it comes
                for k in range(system.nd):
                    steps.mode[k] = STICKS
        share = 1.0
        found = take_step(system, work, method, steps, x, dx, drive, elapsed, part, n)
        if found and stopped(system, work, steps):
            share = step_to_event(
                system, work, method, steps, x, dx, drive, elapsed, part, n, start
            )
            found = share >= 0.0
            events += 1
        if not found:
            if part < SHORTEST * whole:
                return False
            work.held[0] = True
            copy_start(system, work, steps, x, dx, n, work.held[0])
            work.held[0] = False
            part *= 0.5
            continue
        elapsed += share * part
        h -= share * part
        events = max(events, 1)
    return True
