"""Kindred laws: the same law left out at two places that are built alike.

Machines repeat their parts: two drives, two gauges, two outlets. What is left out at
one is often left out at the other, and alone neither may help, for the other's lack
bends all numbers. So the same law at two like places is also tried as one.
"""

import re
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import sympy

from bondgraph.diagnosis.candidates import Candidate, is_named
from bondgraph.diagnosis.search.pairs.alone import fitted_alone
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_briefly
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.structure.edits import SeveralEdits, SingleEdit
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.signals import signals_in

Kin = tuple[Hypothesis, Hypothesis]
MOST = 64
"""So many are tried at most, evenly spread over the laws."""

LEADING = 3
"""So many go on: those that help most as one."""

HELPS = 0.25
"""What takes away less of the cost does not go on."""


@dataclass(frozen=True, slots=True)
class Kindred:
    """One law at two like places: each as fitted alone, and where both have ended."""

    first: Candidate
    second: Candidate
    start: Start


@dataclass(frozen=True, slots=True)
class Kindreds:
    """The kindred laws that help most as one, of how many were tried."""

    leading: tuple[Kindred, ...]
    tried: int

    @classmethod
    def of(cls, bench: Bench, hypotheses: Sequence[Hypothesis]) -> "Kindreds":
        """Return them, of `hypotheses`, each with its two laws fitted alone as well."""
        pairs = kindred(bench.base.graph, hypotheses)
        trials = [Trial(as_one(kin)) for kin in pairs]
        results = bench.run(fit_briefly, trials, "kindred laws", few=True)
        most = (1.0 - HELPS) * bench.few.optimum.cost
        ended = (
            (kin, result)
            for kin, result in zip(pairs, results, strict=True)
            if "refused" not in result and result["cost"] <= most
        )
        best = sorted(ended, key=lambda one: float(one[1]["cost"]))[:LEADING]
        alone = fitted_alone(bench, [law for kin, _ in best for law in kin])
        leading = (
            Kindred(alone[id(one)], alone[id(other)], Start(result["values"]))
            for (one, other), result in best
            if {id(one), id(other)} <= alone.keys()
        )
        return cls(tuple(leading), len(pairs))

    def have(self, first: Candidate, second: Candidate) -> bool:
        """Return whether these very two are one of the pairs."""
        return any(one.first is first and one.second is second for one in self.leading)


def kindred(graph: FinishedGraph, hypotheses: Sequence[Hypothesis]) -> list[Kin]:
    """Return the pairs of one law at two places of `graph` that are built alike."""
    like: dict[object, list[Hypothesis]] = {}
    for one in hypotheses:
        if is_named(one):
            like.setdefault(_kind(graph, one), []).append(one)
    found = [
        (one, other)
        for family in like.values()
        for one, other in combinations(family, 2)
        if one.place != other.place
    ]
    spread = np.linspace(0, len(found) - 1, min(len(found), MOST)).round().astype(int)
    return [found[i] for i in spread]


def as_one(kin: Kin) -> Hypothesis:
    """Return both laws as one hypothesis, which begins where both begin."""
    one, other = kin
    starts = zip(one.starts, other.starts, strict=True)
    return replace(
        one,
        edit=SeveralEdits((*_edits(one), *_edits(other))),
        law=sympy.Add(one.law, other.law, evaluate=False),
        words=f"{one.words}; {other.words}",
        starts=tuple({**mine, **its} for mine, its in starts),
        strengths=(*one.strengths, *other.strengths),
    )


def _edits(one: Hypothesis) -> tuple[SingleEdit, ...]:
    return one.edit.edits if isinstance(one.edit, SeveralEdits) else (one.edit,)


def _kind(graph: FinishedGraph, one: Hypothesis) -> Hashable:
    """Return what two hypotheses have in common whose laws and places are alike."""
    own = tuple((_stem(graph, one, p.name), p.unit) for p in one.edit.parameters)
    return one.physics, own, len(one.starts), _built(graph, one.place)


def _stem(graph: FinishedGraph, one: Hypothesis, name: str) -> str:
    """Return what is left of a parameter's name without what it is named after."""
    after = sorted({*graph.by_name, one.place}, key=len, reverse=True)
    return re.sub("|".join(map(re.escape, after)), "", name)


def _built(graph: FinishedGraph, place: str) -> Hashable:
    """Return how a place is built: its kind, and what is around or read there."""
    for reading in graph.measurements:
        if reading.name == place:
            signals = signals_in(reading.expression)
            kinds = sorted((s.quantity, _type(graph, s.place)) for s in signals)
            return reading.unit, *kinds
    around = sorted(_type(graph, bond.other(place)) for bond in graph.bonds_at(place))
    return _type(graph, place), *around


def _type(graph: FinishedGraph, name: str) -> str:
    """Return what a node is; of a bond or port that is read, that it is one."""
    node = graph.by_name.get(name)
    return Bond.__name__ if node is None else type(node).__name__
