"""Partners: what promises most beside a law that helps alone, though alone it may not.

A limit that a drive reaches in a few samples leaves nothing to see where dry friction
bends every number of the model. So the whole library is screened once more beside each
of the laws that help most, and what promises most there is paired with that law.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter

from bondgraph.diagnosis.candidates import Candidate, Promised, is_named
from bondgraph.diagnosis.search.pairs.alone import fitted_alone, one_law
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.screening import screen
from bondgraph.physics.hypothesis import Hypothesis

MOST = 10
"""So many couples are fitted: those that promise to leave least."""

PROMISES = 0.25
"""A partner that promises less of what the law leaves is none."""

ALIKE = 1.1
"""A law is not screened beside if a narrower one leaves at most so many times as much:
what promises much beside the one does beside the other.
"""


@dataclass(frozen=True, slots=True)
class Couple:
    """A law that helps alone, and one that promises most beside it, fitted alone."""

    single: Candidate
    partner: Candidate


def couples(
    bench: Bench,
    beside: Mapping[int, Bench],
    singles: Sequence[Candidate],
    everything: Sequence[Hypothesis],
) -> list[Couple]:
    """Return the laws that help most, each with what promises most beside it.

    Parameters
    ----------
    beside
        For the id of each single law the bench whose base model has it.
    singles
        Laws that help alone, the best first: two of these are paired anyway.
    everything
        What the library proposes for the model without them.
    """
    known = {id(one.hypothesis) for one in singles}
    screened = [one for one in singles if not _is_wider(one, singles)]
    others = [law for law in everything if id(law) not in known]
    wanted = [
        ((1.0 - promised.reduction) * single.cost, single, promised.hypothesis)
        for single in screened
        for promised in promising_beside(beside[id(single)], single, others)
    ]
    best = sorted(wanted, key=itemgetter(0))[:MOST]
    alone = fitted_alone(bench, [law for _, _, law in best])
    return [
        Couple(single, alone[id(law)]) for _, single, law in best if id(law) in alone
    ]


def _is_wider(law: Candidate, others: Sequence[Candidate]) -> bool:
    """Return whether one of the others is a part of the law and does about as much."""
    return any(
        law.hypothesis.contains(other.hypothesis) and other.cost <= ALIKE * law.cost
        for other in others
        if other is not law
    )


def promising_beside(
    bench: Bench, law: Candidate, others: Sequence[Hypothesis]
) -> list[Promised]:
    """Return what promises enough beside a law, each physics at a place once.

    Parameters
    ----------
    bench
        Whose base model has the law.
    """
    named = [
        one for one in others if is_named(one) and not one_law(law.hypothesis, one)
    ]
    found: dict[tuple[str, str], Promised] = {}
    for one in screen(bench, named).promised:
        if one.reduction >= PROMISES:
            found.setdefault((one.hypothesis.physics, one.hypothesis.place), one)
    return list(found.values())
