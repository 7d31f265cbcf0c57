"""Fits brought back: what ran away for want of a law is tried where it was stated.

A base model bends its numbers to what it lacks: a rope whose car rubs is fitted as one
of a hundred times the damping. The fit of the right law begins there, where that number
tells next to nothing, and stays. So the leading laws are fitted once more with all that
has run away put back, and what leaves less from there is kept.
"""

from collections.abc import Sequence
from operator import attrgetter

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_on
from bondgraph.diagnosis.search.trials.vanished import has_vanished

LEADING = 6
"""How many laws are tried."""


def brought_back(bench: Bench, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates, the leading ones as fitted from what is stated, if better.

    Only those are tried of whose model a parameter has run away.
    """
    named = (one for one in candidates if one.hypothesis.physics != CURVE)
    leading = sorted(named, key=attrgetter("cost"))[:LEADING]
    trials = [
        Trial(one.hypothesis, (Start({**one.fitted.values, **stated}),))
        for one in leading
        if (stated := run_away(one.fitted))
    ]
    if not trials:
        return list(candidates)
    fitted = bench.candidates(trials, bench.run(fit_on, trials, "brought back"))
    back = {id(one.hypothesis): one for one in fitted if not has_vanished(one)}
    others = (back.get(id(one.hypothesis), one) for one in candidates)
    pairs = zip(candidates, others, strict=True)
    return [min(pair, key=attrgetter("cost")) for pair in pairs]
