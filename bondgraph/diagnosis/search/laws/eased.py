"""Eased: a law with a smoothed edge whose fit was caught there goes by a wider edge.

Where a machine comes to rest at another sample than it did, the error has a kink, and a
fit that meets one stays. Over an edge that is ten times as wide there is no kink; from
where that fit ends, the law as proposed is fitted again. Asked of laws of which another
one at the same place leaves clearly less: that would win by the kink alone.
"""

from collections.abc import Sequence
from operator import attrgetter

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully

WIDER = 0.1
"""How many times sharper the wide edge is than the one proposed."""

CLEARLY = 0.8
"""Another law that leaves less than this share leaves clearly less."""


def eased(bench: Bench, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates, those that were caught at an edge fitted past it."""
    caught = [one for one in candidates if _is_caught(one, candidates)]
    if not caught:
        return list(candidates)
    wide = [Trial(one.hypothesis.sharper(WIDER)) for one in caught]
    found = bench.run(fit_fully, wide, "edges ten times wider")
    back = [
        Trial(one.hypothesis, (Start.where_ended(over.fitted),))
        for one, trial, result in zip(caught, wide, found, strict=True)
        for over in bench.candidates([trial], [result])
    ]
    best = {id(one.hypothesis): one for one in candidates}
    for one in bench.candidates(back, bench.run(fit_fully, back, "edges as they were")):
        known = best[id(one.hypothesis)]
        best[id(one.hypothesis)] = min(known, one, key=attrgetter("cost"))
    return list(best.values())


def _is_caught(own: Candidate, candidates: Sequence[Candidate]) -> bool:
    """Return whether a law has an edge, and a plainer or wider one leaves clearly less.

    A curve without a name does that by its freedom.
    """
    if not own.hypothesis.smoothing or own.hypothesis.physics == CURVE:
        return False
    return any(
        other.hypothesis.place == own.hypothesis.place
        and other.hypothesis.physics != CURVE
        and other.cost < CLEARLY * own.cost
        for other in candidates
    )
