"""Twins of either law of a pair are told, also where only pairs of twins were made."""

from types import SimpleNamespace

import numpy as np

from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.search.pairs.pair_fits import Pair
from bondgraph.diagnosis.search.pairs.stand_ins import instead_of
from bondgraph.diagnosis.search.pairs.two import JudgedPair

LAG, DELAY, LOSS, GLOW, BENT = (
    SimpleNamespace(name=name) for name in ("lag", "delay", "loss", "glow", "bent")
)
RNG = np.random.default_rng(2)


def judged(first, second, share):
    """Return a pair that leaves a share of some error; it has no other fit."""
    errors = LeftOutErrors(share * (1.0 + 0.1 * RNG.random((1, 24))))
    law = SimpleNamespace(hypothesis=SimpleNamespace(extends=()), complexity=2)
    told = {"place": second.name, "physics": second.name, "candidate": law}
    whole = SimpleNamespace(errors=errors, **told)
    return JudgedPair(Pair(first, second, None), whole)


def named(found):
    return {one.pair.without(beside).name: beside.name for one, beside in found}


def test_a_twin_beside_a_twin_is_told_for_each():
    chosen = judged(LAG, LOSS, 1.0)
    twins = [judged(LAG, GLOW, 1.0), judged(GLOW, DELAY, 1.0)]
    supported = [chosen, *twins]
    assert named(instead_of(LAG, chosen, supported, Rule())) == {"delay": "glow"}
    assert named(instead_of(LOSS, chosen, supported, Rule())) == {"glow": "lag"}


def test_what_does_worse_beside_the_very_partner_stays_on_record():
    chosen = judged(LAG, LOSS, 1.0)
    supported = [chosen, judged(LAG, BENT, 9.0), judged(BENT, DELAY, 9.0)]
    assert named(instead_of(LOSS, chosen, supported, Rule())) == {"bent": "lag"}
    assert named(instead_of(LAG, chosen, supported, Rule())) == {}


def test_of_three_alike_each_may_stand_for_either():
    chosen = judged(LAG, LOSS, 1.0)
    supported = [chosen, judged(LOSS, GLOW, 1.0), judged(LAG, GLOW, 1.0)]
    assert named(instead_of(LAG, chosen, supported, Rule())) == {"glow": "loss"}
    assert named(instead_of(LOSS, chosen, supported, Rule())) == {"glow": "lag"}
