"""Pairs: the laws that help most alone are fitted two by two, from either side.

What one law explains can be hidden by the lack of another: an overflow behind an outlet
of the wrong form, dry friction at one of two drives. A fit that begins where one of the
two has bent all other numbers may not find the way back; so each pair is begun from
both, and with the numbers of either.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

from bondgraph.diagnosis.candidates import Candidate, Promised
from bondgraph.diagnosis.search.pairs.alone import Singles, fitted_alone
from bondgraph.diagnosis.search.pairs.kindred import Kindreds
from bondgraph.diagnosis.search.pairs.pair_fits import (
    Pair,
    PairFits,
    from_either,
    in_place,
    leading,
)
from bondgraph.diagnosis.search.pairs.partners import Couple, couples, promising_beside
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import fit_on
from bondgraph.physics.hypothesis import Hypothesis

ON_THE_WAY = 0.5
"""Of the best short fit's reduction: pairs that have come so far go on."""

MOST = 16
"""So many pairs go on at most."""

HOPELESS = 0.75
"""A pair with less than this share of the best one's reduction is not fitted fully."""

IN_PLACE = 4
"""So many of those that promise most beside one law are tried in place of the other."""


@dataclass(frozen=True, slots=True)
class Pairing:
    """Laws that help alone or beside another, and what is fitted of them in pairs."""

    fits: PairFits
    singles: Singles
    couples: tuple[Couple, ...]
    kin: Kindreds
    everything: Sequence[Hypothesis]

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
        return cls(PairFits(bench, beside), singles, tuple(found), kin, everything)

    def best(self, most: int) -> list[Pair]:
        """Return the pairs that leave least, `most` at most, fitted to the end."""
        couples = ((one.single, one.partner) for one in self.couples)
        begun = [
            start
            for one, other in (*combinations(self.singles.leading, 2), *couples)
            for start in self.fits.begun(one, other, from_either(one, other))
        ]
        for kin in self.kin.leading:
            begun += self.fits.begun(kin.first, kin.second, [(kin.start,)])
        cost = self.fits.bench.few.optimum.cost
        longer = [
            better
            for start in leading(begun, cost, ON_THE_WAY)[:MOST]
            for better in self.fits.gone_on(start, fit_on, few=True)
        ]
        return self.fits.ended(leading(longer, cost, HOPELESS)[:most])

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
        begun = [
            start
            for kept, given_up in (either, either[::-1])
            for other in self._instead_of(given_up, kept)
            if not pair.has(other)
            for start in self.fits.begun(kept, other, [in_place(pair.both, other)])
        ]
        cost = self.fits.bench.few.optimum.cost
        return self.fits.ended(leading(begun, cost, HOPELESS))

    def _instead_of(self, given_up: Candidate, kept: Candidate) -> list[Candidate]:
        """Return what helps most alone, what says the same, and what is narrower.

        And what promises most beside the law that is kept.
        """
        beside = self.fits.beside[id(kept)]
        promised = promising_beside(beside, kept, self.everything)[:IN_PLACE]
        laws = [law for law in self.everything if given_up.hypothesis.contains(law)]
        laws += [one.hypothesis for one in promised]
        known = {id(one.hypothesis): one for one in self._fitted()}
        missing = [law for law in laws if id(law) not in known]
        known |= fitted_alone(self.fits.bench, missing)
        alone = (known[id(law)] for law in laws if id(law) in known)
        found = (*self.singles.leading, *self.singles.like(given_up), *alone)
        return list({id(one): one for one in found}.values())

    def _fitted(self) -> Iterable[Candidate]:
        """Return all laws that were fitted alone on the way to the pairs."""
        yield from self.singles.fitted
        yield from (one.partner for one in self.couples)
        yield from (law for kin in self.kin.leading for law in (kin.first, kin.second))


def _benches(bench: Bench, laws: Iterable[Candidate]) -> dict[int, Bench]:
    """Return for the id of each law the bench whose base model has it."""
    name = f"{bench.name}, two at once"
    return {id(one): Bench.of(one.fitted, bench.shop, name) for one in laws}
