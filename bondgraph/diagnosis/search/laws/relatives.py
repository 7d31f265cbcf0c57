"""Relatives: laws of which one contains the other, or the same law at another place.

What seems a worse law may be a fit that ended too early. A wider law's values without
its additions, a narrower one's with them, and the same law's at another place are
better starts; every candidate is refitted from relatives that fit better. So is a
plainer one that comes close to the best law at its place: a weight and a spring that
bends leave nearly the same, and the one whose fit took the model's own numbers into
another valley would lose by that alone. And a law with a name where a free curve leads:
a curve finds its way from anywhere, and takes the model's own numbers along. And where
a signal that comes late leads, the other ways in which it may be as late.
"""

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

from bondgraph.diagnosis.candidates import CURVE, Candidate, best_of_each
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.diagnosis.search.trials.vanished import begun_again
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.dynamics import LATE, STAGES
from bondgraph.physics.hypothesis import Hypothesis

RELATIVE_BETTER = 0.99
"""A relative that costs less than this share is a better start."""

CLOSE = 0.9
"""One that takes away this share of what the best at its place does comes close."""

WIDER = 4
"""Laws that contain the leading one are tried from its optimum, at most so many."""


def related(
    bench: Bench, candidates: list[Candidate], hypotheses: Sequence[Hypothesis]
) -> list[Candidate]:
    """Return the candidates, each refitted from relatives that fit better.

    Laws that contain the leading one are tried from its optimum, even where they were
    not kept; a law that its fit has let go of begins again with an effect.
    """
    if not candidates:
        return []
    leading = min(candidates, key=attrgetter("cost"))
    trials = [
        Trial(own.hypothesis, from_relative(own, other))
        for own in candidates
        for other in candidates
        if other.cost < RELATIVE_BETTER * own.cost
        and (
            _akin(own, other)
            or _close(own, other, candidates, bench.base)
            or (other is leading and _is_named_beside(own, other))
        )
    ]
    kept = {id(candidate.hypothesis) for candidate in candidates}
    wider = [
        h for h in hypotheses if id(h) not in kept and h.contains(leading.hypothesis)
    ][:WIDER]
    there = Start.where_ended(leading.fitted)
    trials += [Trial(hypothesis, (there,)) for hypothesis in wider]
    trials += _as_late(leading, hypotheses)
    trials += begun_again(candidates)
    if not trials:
        return candidates
    refitted = bench.candidates(trials, bench.run(fit_fully, trials, "relatives"))
    return best_of_each([*candidates, *refitted])


def _akin(own: Candidate, other: Candidate) -> bool:
    """Return whether one law contains the other here, or is the same elsewhere."""
    a, b = own.hypothesis, other.hypothesis
    if a.place == b.place:
        return a.contains(b) or b.contains(a)
    return a.physics == b.physics and own.complexity == other.complexity


def _as_late(leading: Candidate, hypotheses: Sequence[Hypothesis]) -> list[Trial]:
    """Return the other forms of a lag or a delay that leads, begun as late as it is."""
    law, values = leading.hypothesis, leading.fitted.values
    if law.physics not in LATE:
        return []
    late = _stages(law) * values[_time_of(law)]
    return [
        Trial(other, (Start({**values, _time_of(other): late / _stages(other)}),))
        for other in hypotheses
        if other.physics in LATE and other.place == law.place and other is not law
    ]


def _time_of(law: Hypothesis) -> str:
    """Return the name of the one number of a lag or a delay."""
    (time,) = law.starts[0]
    return time


def _stages(law: Hypothesis) -> int:
    """Return in how many stages a signal comes late."""
    return 2 if law.words.endswith(STAGES) else 1


def _is_named_beside(own: Candidate, curve: Candidate) -> bool:
    """Return whether the other is a free curve, and this a law with a name there."""
    a, b = own.hypothesis, curve.hypothesis
    return b.physics == CURVE and a.physics != CURVE and a.place == b.place


def _close(
    own: Candidate, other: Candidate, candidates: Sequence[Candidate], base: FittedModel
) -> bool:
    """Return whether the other is the best law there and this one, plainer, close."""
    place = own.hypothesis.place
    there = [
        one
        for one in candidates
        if one.hypothesis.place == place and one.hypothesis.physics != CURVE
    ]
    if not any(one is own for one in there) or other is not min(
        there, key=attrgetter("cost")
    ):
        return False
    near = own.reduction(base) >= CLOSE * other.reduction(base)
    return near and own.complexity < other.complexity


def _shared(other: Candidate) -> dict[str, float]:
    """Return the values that a fit found, to start another from."""
    problem = other.fitted.problem
    names = problem.free_names
    return dict(zip(names, map(float, other.fitted.optimum.theta), strict=True))


def from_relative(own: Candidate, other: Candidate) -> tuple[Start, ...]:
    """Return starts at the other's values, with the own ones where they differ.

    And where the other is contained in it, with its additions at none: what it has
    become on its own way need not suit, and from there it cannot end worse.
    """
    shared = {**_shared(own), **_shared(other)}
    twins = zip(own.hypothesis.parameters, other.hypothesis.parameters, strict=False)
    for name, twin in twins:
        # A coefficient without a unit is the same seen from either side of a gear.
        if name != twin and own.fitted.graph.parameters[name].unit == "1":
            shared[name] = shared[twin]
    problem = other.fitted.problem
    starts = [Start(shared, other.fitted.optimum.initial, problem.solver)]
    if own.hypothesis.contains(other.hypothesis):
        added = set(own.hypothesis.strengths) - set(other.hypothesis.parameters)
        starts += [
            replace(starts[0], values={**shared, **{n: silent[n] for n in added}})
            for silent in own.hypothesis.silent_starts[:1]
        ]
    return tuple(starts)
