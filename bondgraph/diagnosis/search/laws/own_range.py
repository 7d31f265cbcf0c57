"""A curve over the range that it goes through itself.

Its knots are set over what the model without it goes through. With the curve that may
be another range: a spring that softens is wound farther. Beyond the last knot the curve
stays as it is, and no knots between them bend what lies there; so it is fitted again
over its own range, and over what it goes through then.
"""

import numpy as np

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.drawn_laws import argument_of, law_curve
from bondgraph.diagnosis.probing import measure_scales, probe
from bondgraph.diagnosis.search.laws.curve_from_law import (
    Range,
    along_line,
    over,
    variable_of,
)
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Trial, fit_fully
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.junction import JunctionPlace

BEYOND = 0.1
"""Of the range of its knots, that a curve goes beyond it before it is drawn anew."""

NARROW = 1.5
"""So many times narrower is another range, too."""

MOST = 0.9
"""Of what the curve takes away, that it does over its own range."""

TIMES = 3
"""How often at most: each time it may go farther."""


def over_its_own_range(bench: Bench, candidate: Candidate) -> Candidate | None:
    """Return a curve fitted over what it goes through; None where it was already.

    As few knots over more may leave more, until it is drawn finely. None, too, where
    hardly anything is taken away so: then what it went through was no range.
    """
    found, now, before = None, candidate, bench.base.optimum.cost
    for _ in range(TIMES):
        anew = _drawn_anew(bench, now)
        if anew is None or before - anew.cost < MOST * (before - now.cost):
            break
        found = now = anew
    return found


def _drawn_anew(bench: Bench, candidate: Candidate) -> Candidate | None:
    curve, argument = candidate.hypothesis, argument_of(candidate)
    if curve.visited is None or curve.factor != 1 or argument is None:
        return None
    along = probe(candidate.fitted, (argument,))[argument]
    if not np.isfinite(along).any():
        return None
    goes = float(np.nanmin(along)), float(np.nanmax(along))
    if not _is_another(curve.visited, goes):
        return None
    places = all_places(bench.base.graph, measure_scales(bench.base))
    place = next(one for one in places if one.name == curve.place)
    assert isinstance(place, JunctionPlace)  # What else has a range over its knots?
    wider, variable = over(place, curve, goes), variable_of(curve, place)
    line = law_curve(candidate.fitted, candidate, variable.value)
    trial = Trial(wider, (along_line(candidate, wider, place, line),))
    results = bench.run(fit_fully, [trial], "a curve over its own range")
    return next(iter(bench.candidates([trial], results)), None)


def _is_another(knots: Range, goes: Range) -> bool:
    """Return whether a curve goes beyond its knots, or through few of them."""
    width = knots[1] - knots[0]
    beyond = max(knots[0] - goes[0], goes[1] - knots[1])
    return beyond > BEYOND * width or NARROW * (goes[1] - goes[0]) < width
