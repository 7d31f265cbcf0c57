"""Stand-ins: what may stand for one law of a pair, as recordings do not tell it.

Of two laws either may have a twin. A pair of both twins has no law of the chosen pair;
the pairs that do as well lead from one to the other.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.evidence.leads import clearly_better
from bondgraph.diagnosis.search.pairs.two import JudgedPair


def instead_of(
    own: Candidate, chosen: JudgedPair, supported: Sequence[JudgedPair], rule: Rule
) -> list[tuple[JudgedPair, Candidate]]:
    """Return the pairs with another law instead of one of the chosen pair.

    Each with the law that is kept beside it: the chosen pair's own, or one that does as
    well in its place. What does as well beside such a one does so beside the other too.
    """
    partner = chosen.pair.without(own)
    direct = [(one, partner) for one in supported if one.pair.has(partner)]
    as_good = [
        one for one in supported if not clearly_better(chosen.whole, one.whole, rule)
    ]
    sides = _sides(own, partner, as_good)
    around = [(one, p) for one in as_good for p in sides[1] if one.pair.has(p)]
    known, found = {id(own), id(partner)}, []
    for one, beside in (*direct, *around):
        law = one.pair.without(beside)
        if id(law) not in known:
            known.add(id(law))
            found.append((one, beside))
    return found


def _sides(
    own: Candidate, partner: Candidate, as_good: Sequence[JudgedPair]
) -> tuple[list[Candidate], list[Candidate]]:
    """Return what may stand for one law of a pair, and what for the other."""
    sides = [own], [partner]
    grown = True
    while grown:
        grown = False
        for one in as_good:
            for mine, other in (sides, sides[::-1]):
                for there in (law for law in mine if one.pair.has(law)):
                    law = one.pair.without(there)
                    if not any(law is known for known in other):
                        other.append(law)
                        grown = True
    return sides
