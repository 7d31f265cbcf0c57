"""A curve that begins as a law with a name: as much as that explains, and then more.

From nothing a curve may not find its form where the model without it is far from the
machine, and a law with a name does: an air spring is nearly a hardening one. Where a
chosen law leaves much that is no noise, a curve at its place is fitted as well, from
where the best law of the curve's own variable has ended, so that one can see whether
that is all there is. So is one of a variable that goes through another range than the
first model had it, over that range: a wheel that spins slips as no wheel that grips.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.drawn_laws import law_curve
from bondgraph.diagnosis.evidence.judged import Judged, Rule, judge
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.base.beyond_noise import explainable
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.judging import Verdicts, errors_of
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.junction import JunctionPlace, OneJunctionPlace
from bondgraph.physics.unknown import UnknownRelation, knots_at
from bondgraph.structure.domains import Quantity
from bondgraph.structure.edits import InsertElement

Array = NDArray[np.float64]
MUCH = 0.5
"""A chosen law that leaves more than this share beyond the noise is looked at again."""

ANOTHER = 1.5
"""A range so many times as wide as another, or as narrow, is another range."""

Range = tuple[float, float]


def with_curve_drawn(
    bench: Bench, verdicts: Verdicts, tried: float, rule: Rule, noise: Array
) -> tuple[Judged, ...]:
    """Return what was judged, with a curve that the chosen law may only come near to.

    Parameters
    ----------
    tried
        How many independent hypotheses were tried.
    noise
        Residual per output that noise excuses, 0 where it is not known.
    """
    chosen, before = verdicts.chosen, verdicts.before
    if chosen is None or before is None or chosen.physics == CURVE:
        return verdicts.judged
    if explainable(chosen.candidate.fitted, noise) <= MUCH:
        return verdicts.judged
    trial = _trial(bench, chosen.place, verdicts.judged)
    if trial is None:
        return verdicts.judged
    results = bench.run(fit_fully, [trial], "a curve from the law")
    drawn = bench.candidates([trial], results)
    errors = errors_of(bench, drawn, before.chunks.size, noise)
    return (
        *verdicts.judged,
        *(
            judge(one, before, left, tried, rule)
            for one, left in zip(drawn, errors, strict=True)
        ),
    )


def _trial(bench: Bench, there: str, judged: Sequence[Judged]) -> Trial | None:
    """Return a fit of a curve that was not judged yet, or not over its range.

    It begins as the best law that depends on the curve's own variable and nothing else.
    One that was judged, but leaves more than that law, did not get so far from where it
    began.
    """
    laws = [
        one.candidate
        for one in sorted(judged, key=lambda one: -one.gain.value)
        if one.place == there
        and one.physics != CURVE
        and isinstance(one.candidate.hypothesis.edit, InsertElement)
    ]
    trials = (
        _begun_as(law, curve, place, _as_far(law, judged))
        for place in all_places(bench.base.graph, measure_scales(bench.base))
        if place.name == there and isinstance(place, JunctionPlace)
        for law in laws
        for curve in UnknownRelation().propose(place)
        if curve.factor == 1 and law.hypothesis.depends_on == curve.depends_on
    )
    return next((one for one in trials if one is not None), None)


def _as_far(law: Candidate, judged: Sequence[Judged]) -> set[tuple[str, ...]]:
    """Return what was judged and explains the training data as well as a law."""
    return {
        one.candidate.hypothesis.told_by
        for one in judged
        if one.candidate.cost <= law.cost
    }


def _begun_as(
    law: Candidate, curve: Hypothesis, place: JunctionPlace, known: set[tuple[str, ...]]
) -> Trial | None:
    """Return a fit of the curve that begins as the law; None where it came as far."""
    x, y = law_curve(law.fitted, law, variable_of(curve, place).value)
    visited = _another(curve.visited, (float(x.min()), float(x.max())))
    if visited is not None:
        curve = over(place, curve, visited)
    elif curve.told_by in known:
        return None
    return Trial(curve, (along_line(law, curve, place, (x, y)),))


def _another(visited: Range | None, told: Range) -> Range | None:
    """Return the range that a law's fit goes through where it is another one."""
    if visited is None:
        return None
    before, now = visited[1] - visited[0], told[1] - told[0]
    return told if not 1.0 / ANOTHER < now / before < ANOTHER else None


def over(place: JunctionPlace, curve: Hypothesis, visited: Range) -> Hypothesis:
    """Return the same curve over another range."""
    proposed = UnknownRelation(visited=visited).propose(place)
    return next(one for one in proposed if one.words == curve.words)


def variable_of(curve: Hypothesis, place: JunctionPlace) -> Quantity:
    """Return what a curve is drawn over."""
    if any(Quantity.DISPLACEMENT.value in one for one in curve.depends_on):
        return Quantity.DISPLACEMENT
    is_one = isinstance(place, OneJunctionPlace)
    return Quantity.FLOW if is_one else Quantity.EFFORT


def along_line(
    law: Candidate, curve: Hypothesis, place: JunctionPlace, line: tuple[Array, Array]
) -> Start:
    """Return where a law has ended, with the heights of the curve on a line."""
    assert curve.visited is not None
    knots = knots_at(place, variable_of(curve, place), curve.visited)
    heights = np.interp(knots, *line)
    on_it = dict(zip(curve.strengths, map(float, heights), strict=True))
    return Start({**law.fitted.values, **on_it})
