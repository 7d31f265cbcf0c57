"""The leading law at other places, from where it has ended and with its numbers there.

A base model that has run away promises little of a law at all places but one, where it
happens to mend most; beside that law its numbers come back. What it does next to there
only shows from these, and may be as good, or better.
"""

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.diagnosis.search.trials.vanished import has_vanished
from bondgraph.physics.hypothesis import Hypothesis

MOST = 4
"""Places that are tried."""


def at_other_places(
    bench: Bench,
    candidates: Sequence[Candidate],
    hypotheses: Sequence[Hypothesis],
    keep: float,
) -> list[Candidate]:
    """Return the candidates, and the leading law where it was not kept.

    Parameters
    ----------
    hypotheses
        All that was proposed.
    keep
        Share of the leading reduction that one must reach to be kept.
    """
    leading = min(candidates, key=attrgetter("cost"), default=None)
    if leading is None or leading.hypothesis.physics == CURVE:
        return list(candidates)
    kept = {id(one.hypothesis) for one in candidates}
    trials = _trials(leading, [h for h in hypotheses if id(h) not in kept])
    if not trials:
        return list(candidates)
    results = bench.run(fit_fully, trials, "the same elsewhere")
    least = keep * leading.reduction(bench.base)
    found = [
        one
        for one in bench.candidates(trials, results)
        if one.reduction(bench.base) >= least and not has_vanished(one)
    ]
    return [*candidates, *found]


def _trials(leading: Candidate, others: Sequence[Hypothesis]) -> list[Trial]:
    """Return the fits of the law in the same form elsewhere."""
    law, there = leading.hypothesis, Start.where_ended(leading.fitted)
    known = leading.fitted.graph.parameters
    trials = []
    for one in others:
        own = {parameter.name: parameter.unit for parameter in one.edit.parameters}
        twins = list(zip(one.parameters, law.parameters, strict=False))
        same = one.words.replace(one.place, law.place) == law.words
        alike = all(own[name] == known[twin].unit for name, twin in twins)
        if one.is_elsewhere(law) and same and alike:
            values = {**there.values, **{n: there.values[twin] for n, twin in twins}}
            trials.append(Trial(one, (replace(there, values=values),)))
    return trials[:MOST]
