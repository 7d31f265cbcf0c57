"""Each recording by itself, where all together are not explained: what happens once.

A law that acts from a moment on has one moment on the clock of all recordings. Where
something happens at another moment in each of them, or in one only, it is looked for in
each alone. That is said and not inserted: it is no law of the machine.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.answer.wording import unit_after
from bondgraph.diagnosis.evidence.leftover import ADEQUATE_RATIO
from bondgraph.diagnosis.records import Diagnosis, Verdict
from bondgraph.diagnosis.search.base.beginnings import base_fit
from bondgraph.diagnosis.search.looks import Look, explains, look
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.round_found import chosen_in
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.errors import FitError
from bondgraph.fitting.settings import FitSettings
from bondgraph.physics.hypothesis import AbstractPhysics
from bondgraph.physics.moments import AtOneMoment
from bondgraph.physics.names import name_of
from bondgraph.physics.sensing import SensorBias
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]


def with_each_alone(
    found: Diagnosis,
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    noise: Array,
    settings: FitSettings,
    options: Options,
    shop: Workshop,
) -> Diagnosis:
    """Return the answer with what happens in single recordings, if it is open.

    If nothing can be told, or much is left without an explanation, or by a moment that
    was found: one of all recordings where each has its own.

    Parameters
    ----------
    noise
        Residual per output that noise excuses.
    settings
        Of the fits.
    """
    moving = not any(one.steady for one in recordings)
    library = tuple(_once(options.library))
    if not (_is_open(found) and found.complete and moving and library):
        return found
    once = replace(options, library=library)
    told = []
    for one in recordings:
        if shop.limit.passed:
            break
        shop.progress(f"{one.name} by itself: what happens at one moment")
        seen = _alone(graph, one, noise, settings, once, shop)
        if seen is not None and _has_moment(_numbers_of(seen)):
            told.append(
                f"If something happened once in {one.name}, it is explained by itself "
                f"by {_in_words(seen)}."
            )
    if not told:
        return found
    return replace(found, statement=" ".join((found.statement, *told)))


def _once(library: Sequence[AbstractPhysics]) -> Iterator[AbstractPhysics]:
    """Yield the laws of a library by which something happens at one moment.

    Anywhere: what nobody takes for a law may be told of what does not come back.
    """
    for physics in library:
        if isinstance(physics, AtOneMoment):
            yield replace(physics, anywhere=True)
        elif isinstance(physics, SensorBias):
            yield physics


def _is_open(found: Diagnosis) -> bool:
    """Return whether what happens once may be what an answer lacks."""
    if found.verdict is Verdict.CANNOT_TELL:
        return True
    left, floor = found.train.after.rmse, found.noise_floor
    much = any(left[name] > ADEQUATE_RATIO * floor[name] for name in left)
    numbers = (one.name for finding in found.findings for one in finding.estimates)
    return much and (found.verdict is Verdict.UNEXPLAINED or _has_moment(numbers))


def _has_moment(numbers: Iterable[str]) -> bool:
    """Return whether a law with these numbers acts from a moment on."""
    return any(name.startswith("moment_") for name in numbers)


def _numbers_of(seen: Look) -> Iterator[str]:
    """Yield the names of the numbers of all laws that were found."""
    for candidate in chosen_in(seen.rounds):
        yield from candidate.hypothesis.parameters


def _alone(
    graph: FinishedGraph,
    recording: BoundRecording,
    noise: Array,
    settings: FitSettings,
    options: Options,
    shop: Workshop,
) -> Look | None:
    """Return what explains a recording by what happens once in it; None if nothing."""
    try:
        base = base_fit(graph, [recording], settings, noise, options)
    except FitError:
        return None
    seen = look(base, [recording], noise, options, shop)
    return seen if explains(seen, [recording]) else None


def _in_words(seen: Look) -> str:
    return " and ".join(_laws(seen))


def _laws(seen: Look) -> Iterator[str]:
    """Yield each law that was found with its numbers."""
    parameters = seen.final.graph.parameters
    for candidate in chosen_in(seen.rounds):
        law = candidate.hypothesis
        numbers = ", ".join(
            f"{name} = {seen.final.values[name]:.4g}{unit_after(parameters[name].unit)}"
            for name in law.parameters
        )
        yield f"{name_of(law.physics)} at {law.place} ({law.words}; {numbers})"
