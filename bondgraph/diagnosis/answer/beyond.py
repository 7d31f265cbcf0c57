"""Where held-out recordings go beyond what a curve without a name was drawn over.

A named law says what happens there. A curve does not: beyond its last knots it is a
line carried on, and what held-out recordings say of that line is nothing of the curve.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.drawn_laws import argument_of
from bondgraph.diagnosis.probing import probe
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.fitting.long_runs import posed_over, settled_over
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.domains import Quantity

Array = NDArray[np.float64]

BEYOND = 0.1
"""Of the range that trains, what reaches no farther beyond it is hardly beyond."""


def beyond_training(
    chosen: Sequence[Candidate],
    final: FittedModel,
    held_out: Sequence[BoundRecording],
) -> tuple[str, ...]:
    """Return a note for each curve that held-out recordings take beyond its knots."""
    curves = [
        (argument, *_along(candidate))
        for candidate in chosen
        if candidate.hypothesis.physics == CURVE
        and (argument := argument_of(candidate)) is not None
    ]
    if not curves or not held_out:
        return ()
    arguments = tuple(dict.fromkeys(argument for argument, *_ in curves))
    trained = probe(final, arguments)
    kept = [(r.name, probe(_over(final, r), arguments)) for r in held_out]
    return tuple(
        f"{name} takes the {word} {ends}: beyond, the curve is a line "
        "carried on, and what it misses there says nothing against the curve. Train "
        "on that recording, too, to have it drawn there."
        for argument, word, unit in curves
        for name, read in kept
        if (ends := _ends(trained[argument], read[argument], unit))
    )


def _over(final: FittedModel, recording: BoundRecording) -> FittedModel:
    """Return the fitted model as it goes through another recording, whole."""
    problem = posed_over(final, [recording], WholeRecordings())
    initial, _ = settled_over(problem, final)
    return replace(
        final, problem=problem, optimum=replace(final.optimum, initial=initial)
    )


def _along(candidate: Candidate) -> tuple[str, str]:
    """Return what a curve goes along, and where, and its unit."""
    law = candidate.hypothesis
    if law.shape is not None:
        return law.shape.argument_name, law.shape.argument_unit
    domain, own = candidate.fitted.graph.domain_at(law.place), law.depends_on[0]
    return f"{domain.word(Quantity(own))} at {law.place}", domain.unit(Quantity(own))


def _ends(trained: Array, kept: Array, unit: str) -> str:
    """Return how far a recording goes beyond others; nothing where it stays inside."""
    if not (np.isfinite(trained).any() and np.isfinite(kept).any()):
        return ""
    low, high = np.nanmin(trained), np.nanmax(trained)
    margin = BEYOND * (high - low)
    return " and ".join(
        f"{way} to {reached:.3g} {unit}, where those that train end at {end:.3g} {unit}"
        for way, sign, end, reached in (
            ("up", 1, high, np.nanmax(kept)),
            ("down", -1, low, np.nanmin(kept)),
        )
        if sign * (reached - end) > margin
    )
