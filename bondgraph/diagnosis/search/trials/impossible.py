"""Curves that no store, no loss and no input has, and stops that stop nothing.

A free curve follows what is missing wherever it leads. Where that is no law of the
element the curve bends along with something else, most often with time. And losses that
set in somewhere along the way are no end of it.
"""

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.drawn_laws import curve_of
from bondgraph.diagnosis.probing import probe
from bondgraph.physics.hypothesis import Shape
from bondgraph.physics.places.base import MECHANICAL
from bondgraph.physics.places.junction import junction_place
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.position import EndStop
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Inertance,
    Resistance,
)
from bondgraph.structure.signals import f, flow, q, signals_in

Array = NDArray[np.float64]
TOO_MUCH = 0.25
"""A store whose curve falls by more than this share of what it rises has a negative
capacity somewhere, and a resistance that turns negative by more than this share of its
largest gives back power; less is how few knots follow what is flat.
"""
TOO_FAR = 100.0
"""An input that acts so many times more than was ever asked of it is not driven by it:
the curve makes up for another value of the machine that has run away.
"""
HELD = 0.05
"""Of its largest effort, that a stop has to hold where nothing moves ..."""
BEYOND = 0.1
"""... if motion goes on for more than this share of the whole way once it is reached.
One that is hardly passed may take all that comes in losses.
"""
NEGATIVE_STORE = (
    "somewhere it would give less the more it holds, as no store but a spring does: "
    "what it holds stands for the time there"
)
NEGATIVE_LOSS = (
    "somewhere it would give back power, as no loss does: what it goes along there "
    "stands for something else"
)
STOPS_NOTHING = (
    "motion goes on far beyond it, and it would hold next to nothing there: losses "
    "that set in on the way are no end of it"
)
BEYOND_COMMAND = (
    "somewhere it would act a hundred times more than was ever commanded: it makes up "
    "for a parameter that has run away"
)


def impossible(candidate: Candidate) -> str | None:
    """Return why no element has the law of a candidate; None where one may."""
    hypothesis = candidate.hypothesis
    if hypothesis.physics == EndStop.word:
        return STOPS_NOTHING if _is_passed(candidate) else None
    if hypothesis.physics != CURVE or hypothesis.shape is None:
        return None
    shape = hypothesis.shape
    match candidate.fitted.graph.by_name.get(hypothesis.element):
        case Compliance() | Inertance() if not _is_mechanical(candidate):
            steps = np.diff(_drawn(candidate, shape)[1])
            rises, falls = steps[steps > 0.0].sum(), -steps[steps < 0.0].sum()
            return NEGATIVE_STORE if falls > TOO_MUCH * rises else None
        case Resistance() if shape.multiplies:
            _, factor = _drawn(candidate, shape)
            turned = factor.min() < -TOO_MUCH * np.abs(factor).max()
            return NEGATIVE_LOSS if turned else None
        case EffortSource() | FlowSource() if _is_commanded(shape, hypothesis.place):
            asked, acts = np.abs(_drawn(candidate, shape)).max(axis=1)
            return BEYOND_COMMAND if acts > TOO_FAR * asked else None
    return None


def _is_passed(candidate: Candidate) -> bool:
    """Return whether motion goes on far beyond a stop that holds next to nothing."""
    place, law = candidate.hypothesis.place, candidate.hypothesis.law
    moved = junction_place(candidate.fitted.graph, place, Scales()).displacement_signal
    assert moved is not None  # A stop is proposed where the displacement is known.
    held, taken = (law.xreplace({q: moved, f: x}) for x in (sympy.S.Zero, flow(place)))
    read = probe(candidate.fitted, (moved, held, taken))
    told = np.isfinite(read[taken])
    way, holds, takes = (read[key][told] for key in (moved, held, taken))
    if not takes.any() or np.abs(holds).max() > HELD * np.abs(takes).max():
        return False
    return bool(np.ptp(way[takes != 0.0]) > BEYOND * np.ptp(way))


def _drawn(candidate: Candidate, shape: Shape) -> tuple[Array, Array]:
    """Return what the curve goes along, as far as that has been, and its values."""
    return curve_of(candidate.fitted, shape.argument, shape.value)


def _is_mechanical(candidate: Candidate) -> bool:
    """Return whether a place is one of springs, which may push less the further."""
    domains = candidate.fitted.graph.domains_at(candidate.hypothesis.place)
    return bool({domain.name for domain in domains} & MECHANICAL)


def _is_commanded(shape: Shape, place: str) -> bool:
    """Return whether a curve is one of the input's own command; else it is a factor."""
    return any(signal.place == place for signal in signals_in(shape.argument))
