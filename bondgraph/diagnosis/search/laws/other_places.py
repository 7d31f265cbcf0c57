"""The leading law at other places, from where it has ended and with its numbers there.

A base model that has run away promises little of a law at all places but one, where it
happens to mend most; beside that law its numbers come back. What it does next to there
only shows from these, and may be as good, or better. A curve without a name takes its
line along, wider and lower as the motion there is larger.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.candidates import CURVE, Candidate, leading
from bondgraph.diagnosis.drawn_laws import law_curve
from bondgraph.diagnosis.probing import measure_scales, probe
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.laws.curve_from_law import along_line, variable_of
from bondgraph.diagnosis.search.laws.read_off import curve_that_leads
from bondgraph.diagnosis.search.trials.trying import Start, Trial
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.junction import JunctionPlace
from bondgraph.physics.unknown import UnknownRelation
from bondgraph.structure.domains import Quantity
from bondgraph.structure.signals import Signal

MOST = 4
"""Places that are tried."""

SELDOM = 0.01
"""Where half of all samples are below this share of the root mean square nothing moves
but for a moment.
"""


def at_other_places(
    base: FittedModel,
    candidates: Sequence[Candidate],
    hypotheses: Sequence[Hypothesis],
) -> list[Trial]:
    """Return the fits of the leading law where it was not kept.

    Parameters
    ----------
    hypotheses
        All that was proposed.
    """
    best = leading(candidates)
    if best is None:
        return []
    if best.hypothesis.physics != CURVE:
        kept = {id(one.hypothesis) for one in candidates}
        others = [one for one in hypotheses if id(one) not in kept]
        return list(_numbers(best, others))[:MOST]
    if curve_that_leads(candidates) is None:
        return []
    return list(_lines(base, candidates))[:MOST]


def _numbers(best: Candidate, others: Sequence[Hypothesis]) -> Iterator[Trial]:
    """Yield the fits of the law in the same form, its numbers in the same units."""
    law, there = best.hypothesis, Start.where_ended(best.fitted)
    known = best.fitted.graph.parameters
    for one in others:
        own = {parameter.name: parameter.unit for parameter in one.edit.parameters}
        twins = list(zip(one.parameters, law.parameters, strict=False))
        same = one.words.replace(one.place, law.place) == law.words
        alike = all(own[name] == known[twin].unit for name, twin in twins)
        if one.is_elsewhere(law) and same and alike:
            values = {**there.values, **{n: there.values[twin] for n, twin in twins}}
            yield Trial(one, (replace(there, values=values),))


def _lines(base: FittedModel, candidates: Sequence[Candidate]) -> Iterator[Trial]:
    """Yield the fits of the best curve that hangs at a junction, along its line.

    Where the motion is n times as large the effort is an n-th: the power is the same.
    Begun where it has ended, and what has run away there where it is stated.
    """
    local = [one for one in candidates if one.hypothesis.visited]
    best = leading(local)
    if best is None:
        return
    scales = measure_scales(best.fitted)
    places = {
        place.name: place
        for place in all_places(base.graph, scales)
        if isinstance(place, JunctionPlace)
    }
    here = places[best.hypothesis.place]
    variable = variable_of(best.hypothesis, here)
    x, y = law_curve(best.fitted, best, variable.value)
    known = {one.hypothesis.place for one in local}
    others = [
        place
        for place in places.values()
        if place.name not in known and type(place) is type(here)
    ]
    sizes = _sizes(best.fitted, variable, [here, *others])
    stated = run_away(best.fitted)
    for there in others:
        if not sizes[here.name] or not sizes[there.name]:
            continue
        times = sizes[there.name] / sizes[here.name]
        over = (times * float(x[0]), times * float(x[-1]))
        for curve in UnknownRelation(visited=over).propose(there):
            if curve.visited is not None and variable_of(curve, there) is variable:
                start = along_line(best, curve, there, (times * x, y / times))
                yield Trial(curve, (Start({**start.values, **stated}),))


def _sizes(
    fitted: FittedModel, variable: Quantity, places: Sequence[JunctionPlace]
) -> dict[str, float]:
    """Return how large a variable mostly is at each place: a transient counts little.

    0 where it is all that there is.
    """
    signals = {place.name: Signal(variable, place.name) for place in places}
    read = probe(fitted, list(signals.values()))
    sizes = {}
    for name, signal in signals.items():
        size = np.abs(read[signal])
        mostly = float(np.nanmedian(size))
        moves = mostly > SELDOM * float(np.sqrt(np.nanmean(size**2)))
        sizes[name] = mostly if moves else 0.0
    return sizes
