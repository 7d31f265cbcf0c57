"""Pairs: the laws that help most alone are fitted two by two, from either side.

What one law explains can be hidden by the lack of another: an overflow behind an outlet
of the wrong form, dry friction at one of two drives. A fit that begins where one of the
two has bent all other numbers may not find the way back; so each pair is begun from
both, and with the numbers of either.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from operator import attrgetter
from typing import TypeVar

from bondgraph.diagnosis.search.alone import Singles, one_law
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.candidates import Candidate, Promised
from bondgraph.diagnosis.search.fits import ShortFit
from bondgraph.diagnosis.search.kindred import Kindreds
from bondgraph.diagnosis.search.partners import Couple, couples
from bondgraph.diagnosis.search.trying import (
    Start,
    Trial,
    fit_briefly,
    fit_fully,
    fit_on,
)
from bondgraph.diagnosis.work.journal import Plain
from bondgraph.diagnosis.work.workers import Work
from bondgraph.physics.hypothesis import Hypothesis

ON_THE_WAY = 0.5
"""Of the best short fit's reduction: pairs that have come so far go on."""

MOST = 16
"""So many pairs go on at most."""

HOPELESS = 0.75
"""A pair with less than this share of the best one's reduction is not fitted fully."""


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
class Pairing:
    """Laws that help alone or beside another, and what is fitted of them in pairs."""

    bench: Bench
    singles: Singles
    couples: tuple[Couple, ...]
    kin: Kindreds
    beside: Mapping[int, Bench]

    @classmethod
    def of(
        cls,
        bench: Bench,
        promising: Sequence[Promised],
        everything: Sequence[Hypothesis],
    ) -> "Pairing":
        """Return the pairing of the laws that promise most, and of kindred ones."""
        singles = Singles.of(bench, promising)
        kin = Kindreds.of(bench, everything)
        kindred = (law for one in kin.leading for law in (one.first, one.second))
        beside = _benches(bench, (*singles.leading, *kindred))
        found = couples(bench, beside, singles.leading, everything)
        beside |= _benches(bench, [one.partner for one in found])
        return cls(bench, singles, tuple(found), kin, beside)

    def best(self, most: int) -> list[Pair]:
        """Return the pairs that leave least, `most` at most, fitted to the end."""
        couples = ((one.single, one.partner) for one in self.couples)
        begun = [
            start
            for one, other in (*combinations(self.singles.leading, 2), *couples)
            for start in self._begun(one, other, _from_either(one, other))
        ]
        for kin in self.kin.leading:
            begun += self._begun(kin.first, kin.second, [(kin.start,)])
        cost = self.bench.few.optimum.cost
        longer = [
            better
            for start in _leading(begun, cost, ON_THE_WAY)[:MOST]
            for better in self._gone_on(start, fit_on, few=True)
        ]
        return self._ended(_leading(longer, cost, HOPELESS)[:most])

    def rivals(self, pair: Pair, independent: float) -> float:
        """Return of how many pairs one is the best: of its class, and that twice.

        Half of what may go wrong is for kindred laws, which are few, half for all.
        """
        if self.kin.have(pair.first, pair.second):
            return 2.0 * self.kin.tried
        return independent * (independent - 1.0)

    def exchanged(self, pair: Pair) -> list[Pair]:
        """Return pairs with another law in place of either, from where it ended."""
        either = (pair.first, pair.second)
        others = [
            (kept, other)
            for kept, given_up in (either, either[::-1])
            for other in self._instead_of(given_up)
            if not pair.has(other)
        ]
        begun = [
            start
            for kept, other in others
            for start in self._begun(kept, other, _from_either(pair.both, other)[:1])
        ]
        return self._ended(_leading(begun, self.bench.few.optimum.cost, HOPELESS))

    def _instead_of(self, given_up: Candidate) -> list[Candidate]:
        """Return the laws that help most, what says the same, and what is narrower."""
        leading, like = self.singles.leading, self.singles.like(given_up)
        known = {id(one) for one in leading}
        return [*leading, *(one for one in like if id(one) not in known)]

    def _begun(
        self, one: Candidate, other: Candidate, starts: Sequence[tuple[Start, ...]]
    ) -> list["_Begun"]:
        """Return short fits of the other beside the one."""
        if one_law(one.hypothesis, other.hypothesis):
            return []
        trials = [Trial(other.hypothesis, some) for some in starts]
        results = self.beside[id(one)].run(fit_briefly, trials, "short fits", few=True)
        return _kept(one, other, trials, results)

    def _gone_on(self, start: "_Begun", work: Work, *, few: bool) -> list["_Begun"]:
        """Return a fit further on; nothing where it is refused."""
        bench = self.beside[id(start.first)]
        same = few or bench.few.problem.shots is bench.base.problem.shots
        finer = bench.base.problem.solver.substeps // bench.few.problem.solver.substeps
        reached = ShortFit(0.0, start.second.hypothesis, start.result)
        trials = [reached.as_start(with_states=same, finer=1 if few else finer)]
        results = bench.run(work, trials, "longer fits" if few else "fits", few=few)
        return _kept(start.first, start.second, trials, results)

    def _ended(self, begun: Sequence["_Begun"]) -> list[Pair]:
        """Return the pairs, fitted to the end on all data, the best first."""
        found = [
            Pair(done.first, done.second, both)
            for start in begun
            for done in self._gone_on(start, fit_fully, few=False)
            for both in self.beside[id(done.first)].candidates(
                [done.trial], [done.result]
            )
        ]
        return sorted(found, key=attrgetter("cost"))


def _benches(bench: Bench, laws: Iterable[Candidate]) -> dict[int, Bench]:
    """Return for the id of each law the bench whose base model has it."""
    name = f"{bench.name}, two at once"
    return {id(one): Bench.of(one.fitted, bench.shop, name) for one in laws}


def _from_either(one: Candidate, other: Candidate) -> list[tuple[Start, ...]]:
    """Return starts where one has ended, with the other's own, and the reverse."""
    return [
        tuple(Start({**own, **known.fitted.values}) for own in law.hypothesis.starts)
        for known, law in ((one, other), (other, one))
    ]


@dataclass(frozen=True, slots=True)
class _Begun:
    """A fit of the second law on the model with the first, as far as it has come."""

    first: Candidate
    second: Candidate
    trial: Trial
    result: Plain

    @property
    def cost(self) -> float:
        """What it leaves of the data that it was fitted to."""
        return float(self.result["cost"])


def _kept(
    first: Candidate,
    second: Candidate,
    trials: Sequence[Trial],
    results: Sequence[Plain],
) -> list[_Begun]:
    """Return what fits of a second law beside a first have come to."""
    return [
        _Begun(first, second, trial, result)
        for trial, result in zip(trials, results, strict=True)
        if "refused" not in result
    ]


_Fit = TypeVar("_Fit", Pair, _Begun)


def best_of_each(fits: Iterable[_Fit]) -> list[_Fit]:
    """Return the best fit of every two laws, whichever came first, the best first."""
    best: dict[frozenset[int], _Fit] = {}
    for fit in sorted(fits, key=attrgetter("cost")):
        best.setdefault(frozenset((id(fit.first), id(fit.second))), fit)
    return list(best.values())


def _leading(begun: Sequence[_Begun], cost: float, share: float) -> list[_Begun]:
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
