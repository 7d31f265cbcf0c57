"""Sharper edges: a smoothed law is fitted again with less smoothing where that tells.

A fit finds its way over smooth edges only. Where it has ended they cost: below the flow
that smooths it dry friction creeps instead of sticking, and the laws that drop to a
steep slope there (hysteresis, Stribeck) would win by it.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_on

SHARPER = (10.0, 100.0)
"""How many times sharper than proposed, one after the other as long as it tells."""

TELLS = 0.99
"""A sharper edge is kept where it leaves at most this share of the cost."""


def sharpened(bench: Bench, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates, their smooth edges sharpened as far as that tells.

    The leading law goes first, and the leading one of those with the fewest numbers:
    a wider one may make up for an edge. Where a sharper edge tells nothing of these, it
    is not tried of the others. A curve without a name leads by its freedom, and goes
    last.
    """
    told = list(candidates)
    smooth = [i for i, own in enumerate(told) if own.hypothesis.smoothing]
    for times in SHARPER:
        smooth.sort(key=lambda i: (told[i].hypothesis.physics == CURVE, told[i].cost))
        plain = sorted(smooth, key=lambda i: told[i].complexity)[:1]
        first = list(dict.fromkeys([*smooth[:1], *plain]))
        better = _tried(bench, candidates, told, first, times)
        if better:
            others = [i for i in smooth if i not in first]
            better += _tried(bench, candidates, told, others, times)
        smooth = better
    return told


def _tried(
    bench: Bench,
    proposed: Sequence[Candidate],
    told: list[Candidate],
    which: Sequence[int],
    times: float,
) -> list[int]:
    """Sharpen some of those told, in place; return of which it tells."""
    trials = [
        Trial(
            proposed[i].hypothesis.sharper(times), (Start.where_ended(told[i].fitted),)
        )
        for i in which
    ]
    results = bench.run(fit_on, trials, f"edges {times:.0f} times sharper")
    better = []
    for i, trial, result in zip(which, trials, results, strict=True):
        if "refused" not in result and result["cost"] < TELLS * told[i].cost:
            (told[i],) = bench.candidates([trial], [result])
            better.append(i)
    return better
