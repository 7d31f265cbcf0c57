"""Fits of two laws: the second one on the model with the first, further and further.

Short fits tell which pairs are worth going on with; of those that lead longer ones; and
full ones of the few that are to be judged.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import TypeVar

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.search.laws.fits import ShortFit
from bondgraph.diagnosis.search.pairs.alone import one_law
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import (
    Start,
    Trial,
    fit_briefly,
    fit_fully,
)
from bondgraph.diagnosis.work.journal import Plain
from bondgraph.diagnosis.work.workers import Work


@dataclass(frozen=True, slots=True)
class Pair:
    """Two laws: each fitted alone, and the second fitted beside the first.

    Parameters
    ----------
    first, second
        As fitted alone, to the base model.
    both
        The second on the model with the first.
    """

    first: Candidate
    second: Candidate
    both: Candidate

    @property
    def cost(self) -> float:
        """What both together leave of the training data."""
        return self.both.cost

    @property
    def complexity(self) -> int:
        """How many fitted parameters the two add together."""
        return self.first.complexity + self.both.complexity

    def has(self, one: Candidate) -> bool:
        """Return whether one of the two is this very candidate."""
        return one is self.first or one is self.second

    def without(self, one: Candidate) -> Candidate:
        """Return the other of the two, as fitted alone."""
        return self.second if one is self.first else self.first


@dataclass(frozen=True, slots=True)
class Begun:
    """A fit of the second law on the model with the first, as far as it has come."""

    first: Candidate
    second: Candidate
    trial: Trial
    result: Plain

    @property
    def cost(self) -> float:
        """What it leaves of the data that it was fitted to."""
        return float(self.result["cost"])


@dataclass(frozen=True, slots=True)
class PairFits:
    """What pairs are fitted with.

    Parameters
    ----------
    bench
        With neither law.
    beside
        For the id of each law the bench whose base model has it.
    """

    bench: Bench
    beside: Mapping[int, Bench]

    def begun(
        self, one: Candidate, other: Candidate, starts: Sequence[tuple[Start, ...]]
    ) -> list[Begun]:
        """Return short fits of the other beside the one."""
        if one_law(one.hypothesis, other.hypothesis):
            return []
        trials = [Trial(other.hypothesis, some) for some in starts]
        results = self.beside[id(one)].run(fit_briefly, trials, "short fits", few=True)
        return _kept(one, other, trials, results)

    def gone_on(self, start: Begun, work: Work, *, few: bool) -> list[Begun]:
        """Return a fit further on; nothing where it is refused."""
        bench = self.beside[id(start.first)]
        same = few or bench.few.problem.shots is bench.base.problem.shots
        finer = bench.base.problem.solver.substeps // bench.few.problem.solver.substeps
        reached = ShortFit(0.0, start.second.hypothesis, start.result)
        trials = [reached.as_start(with_states=same, finer=1 if few else finer)]
        results = bench.run(work, trials, "longer fits" if few else "fits", few=few)
        return _kept(start.first, start.second, trials, results)

    def ended(self, begun: Sequence[Begun]) -> list[Pair]:
        """Return the pairs, fitted to the end on all data, the best first."""
        found = [
            Pair(done.first, done.second, both)
            for start in begun
            for done in self.gone_on(start, fit_fully, few=False)
            for both in self.beside[id(done.first)].candidates(
                [done.trial], [done.result]
            )
        ]
        return sorted(found, key=attrgetter("cost"))


def from_either(one: Candidate, other: Candidate) -> list[tuple[Start, ...]]:
    """Return starts where one has ended, with the other's own, and the reverse."""
    return [
        tuple(Start({**own, **known.fitted.values}) for own in law.hypothesis.starts)
        for known, law in ((one, other), (other, one))
    ]


def in_place(reached: Candidate, other: Candidate) -> tuple[Start, ...]:
    """Return starts of another law in place of one, where the pair of that has ended.

    With its own strength, or with that which it has alone.
    """
    own = set(other.hypothesis.parameters)
    ended = {n: v for n, v in reached.fitted.values.items() if n not in own}
    begun = (*other.hypothesis.starts, other.fitted.values)
    return tuple(Start({**some, **ended}) for some in begun)


def _kept(
    first: Candidate,
    second: Candidate,
    trials: Sequence[Trial],
    results: Sequence[Plain],
) -> list[Begun]:
    """Return what fits of a second law beside a first have come to."""
    return [
        Begun(first, second, trial, result)
        for trial, result in zip(trials, results, strict=True)
        if "refused" not in result
    ]


_Fit = TypeVar("_Fit", Pair, Begun)


def best_of_each(fits: Iterable[_Fit]) -> list[_Fit]:
    """Return the best fit of every two laws, whichever came first, the best first."""
    best: dict[frozenset[int], _Fit] = {}
    for fit in sorted(fits, key=attrgetter("cost")):
        best.setdefault(frozenset((id(fit.first), id(fit.second))), fit)
    return list(best.values())


def leading(begun: Sequence[Begun], cost: float, share: float) -> list[Begun]:
    """Return the best fit of every pair, the best first, as far as they lead.

    Parameters
    ----------
    cost
        Of the model with neither law, on the same data.
    share
        Of the best reduction of this cost, that a pair must reach.
    """
    ranked = best_of_each(begun)
    if not ranked:
        return []
    lead = cost - ranked[0].cost
    return [one for one in ranked if cost - one.cost >= share * lead]
