"""A curve that begins as a law with a name: as much as that explains, and then more.

From nothing a curve may not find its form where the model without it is far from the
machine, and a law with a name does: an air spring is nearly a hardening one. Where a
chosen law leaves much that is no noise, the curve is fitted from there as well, so that
one can see whether the law is all there is.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.answer.drawn_laws import law_curve
from bondgraph.diagnosis.evidence.decision import Judged, Rule, judge
from bondgraph.diagnosis.evidence.judging import Verdicts, errors_of
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.beyond_noise import explainable
from bondgraph.diagnosis.search.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.trying import Start, Trial, fit_fully
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.junction import JunctionPlace, OneJunctionPlace
from bondgraph.physics.unknown import UnknownRelation, knots_at
from bondgraph.structure.domains import Quantity
from bondgraph.structure.edits import InsertElement

Array = NDArray[np.float64]
MUCH = 0.5
"""A chosen law that leaves more than this share beyond the noise is looked at again."""


def with_curve_drawn(
    bench: Bench, verdicts: Verdicts, tried: float, rule: Rule, noise: Array
) -> tuple[Judged, ...]:
    """Return what was judged, with the curve that the chosen law may be part of.

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
    trial = _trial(bench, chosen.candidate, verdicts.judged)
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


def _trial(bench: Bench, chosen: Candidate, judged: Sequence[Judged]) -> Trial | None:
    """Return a fit of the curve of the law's own variable, begun as the law is.

    None where that curve was judged already.
    """
    law = chosen.hypothesis
    if not isinstance(law.edit, InsertElement) or not law.depends_on:
        return None
    places = all_places(bench.base.graph, measure_scales(bench.base))
    for place in places:
        if place.name != law.place or not isinstance(place, JunctionPlace):
            continue
        for curve in UnknownRelation().propose(place):
            if _displaced(curve) == _displaced(law) and not _known(curve, judged):
                return Trial(curve, (_as_the_law(chosen, curve, place),))
    return None


def _as_the_law(chosen: Candidate, curve: Hypothesis, place: JunctionPlace) -> Start:
    """Return where the law has ended, with the heights of the curve on the law."""
    is_one = isinstance(place, OneJunctionPlace)
    local = Quantity.FLOW if is_one else Quantity.EFFORT
    quantity = Quantity.DISPLACEMENT if _displaced(curve) else local
    x, y = law_curve(chosen.fitted, chosen, quantity.value)
    heights = np.interp(knots_at(place, quantity), x, y)
    on_it = dict(zip(curve.strengths, map(float, heights), strict=True))
    return Start({**chosen.fitted.values, **on_it})


def _displaced(law: Hypothesis) -> bool:
    return any(Quantity.DISPLACEMENT.value in name for name in law.depends_on)


def _known(curve: Hypothesis, judged: Sequence[Judged]) -> bool:
    return any(one.candidate.hypothesis.told_by == curve.told_by for one in judged)
