"""A round again, with inputs that do otherwise between samples: as its best law wants.

What a base model leaves hides half a sample of delay. Beside the law that is missing it
shows; beside any other a law with more freedom makes up for it, and wins by that: dry
friction in a loop whose command is held was told as hysteresis.
"""

import math
from collections.abc import Callable
from dataclasses import replace

from bondgraph.diagnosis.search.considered import Setting
from bondgraph.diagnosis.search.revising.exchange import Reached
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.either_hold import held_as_fits
from bondgraph.fitting.fine_steps import simulated_as
from bondgraph.simulation.solvers import Hold

OneRound = Callable[[Setting], Round]

MATTERS = 0.8
"""A way of inputs to behave decides between laws where it leaves less than this share.
"""


def held_as_found(
    setting: Setting, reached: Reached, found: Round, again: OneRound
) -> tuple[Setting, Reached, Round]:
    """Return a round with its setting, made again where its best law wants that.

    Whichever way of inputs to behave leaves less, with the law that leaves least.

    Parameters
    ----------
    again
        Makes a round from another setting.
    """
    hold = _wanted(found)
    if hold is None or hold is setting.base.problem.hold or found.cut_short:
        return setting, reached, found
    held = _held(reached, hold)
    otherwise = replace(setting, base=held.current)
    other = again(otherwise)
    if not _left(other) < _left(found):
        return setting, reached, found
    return otherwise, held, other


def _held(reached: Reached, hold: Hold) -> Reached:
    """Return the first model and the last with inputs that behave so, refitted."""
    first = simulated_as(reached.first, reached.first.problem.solver, hold)
    if reached.current is reached.first:
        return replace(reached, first=first, current=first)
    current = simulated_as(reached.current, reached.current.problem.solver, hold)
    return replace(reached, first=first, current=current)


def _wanted(found: Round) -> Hold | None:
    """Return how inputs behave as fits the law that leaves least; None without need."""
    if not found.judged:
        return None
    best = min((one.candidate for one in found.judged), key=lambda one: one.cost)
    otherwise = held_as_fits(best.fitted)
    matters = otherwise.optimum.cost < MATTERS * best.cost
    return otherwise.problem.hold if matters else None


def _left(found: Round) -> float:
    """Return what the law leaves that leaves least."""
    return min((one.candidate.cost for one in found.judged), default=math.inf)
