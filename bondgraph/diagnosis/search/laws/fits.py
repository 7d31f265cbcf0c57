"""Fits: the hypotheses that promise most, briefly on few data, then fully on all.

What seems a worse law may be a fit that ended too early: what was stopped on its way
goes on, past edges it is `eased`, every candidate is refitted from its `relatives`, and
what has run away with the base model is `brought_back`.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from bondgraph.diagnosis.candidates import CURVE, Candidate, Promised
from bondgraph.diagnosis.search.base.steps import solver_named
from bondgraph.diagnosis.search.laws.brought_back import brought_back
from bondgraph.diagnosis.search.laws.eased import eased
from bondgraph.diagnosis.search.laws.relatives import related
from bondgraph.diagnosis.search.laws.sharper import sharpened
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import (
    Start,
    Trial,
    fit_briefly,
    fit_fully,
    fit_on,
    fit_what_forgets,
    fit_what_remembers,
)
from bondgraph.diagnosis.search.trials.vanished import is_nothing
from bondgraph.diagnosis.work.journal import Plain
from bondgraph.diagnosis.work.workers import Work
from bondgraph.physics.hypothesis import Hypothesis

KEPT_PROMISE = 0.8
"""A short fit that keeps this share of what was promised needs no other start."""

ON_THE_WAY = 0.4
"""A law that has come so far towards the leading one and has not ended may pass it."""

TWINS = 1e-4
"""Reductions that differ by less are the same."""

BEGUN_AGAIN = 2
"""Laws that a fit has let go of are begun again with an effect, at most so many."""


def fit_remembering(
    bench: Bench, others: Sequence[Promised], keep: float, most: int
) -> list[Candidate]:
    """Fit hypotheses with states of their own, whatever they promise, as `fit_best`."""
    everything = [Promised(one.hypothesis, 1.0) for one in others]
    return fit_best(bench, everything, keep, most, work=fit_what_remembers)


def fit_whatever(
    bench: Bench, others: Sequence[Promised], keep: float, most: int
) -> list[Candidate]:
    """Fit hypotheses without states of their own, whatever they promise."""
    everything = [Promised(one.hypothesis, 1.0) for one in others]
    return fit_best(bench, everything, keep, most, work=fit_what_forgets)


def fit_best(
    bench: Bench,
    promised: Sequence[Promised],
    keep: float,
    most: int,
    work: Work = fit_briefly,
) -> list[Candidate]:
    """Fit hypotheses briefly, and those that lead to the end, on all data.

    Parameters
    ----------
    keep
        Share of the leading reduction that a hypothesis must reach to be kept. Free
        curves lead by their freedom: named laws are compared with named ones.
    most
        How many are kept, beside the narrower laws that these contain.
    work
        The short fit.
    """
    hypotheses = [one.hypothesis for one in promised]
    trials = [
        Trial(one.hypothesis, enough=KEPT_PROMISE * one.reduction) for one in promised
    ]
    brief = bench.run(work, trials, "short fits", few=True)
    reached = _reached(bench, zip(hypotheses, brief, strict=True))
    if not reached:
        return []
    reached = _gone_on(bench, _at_other_places(bench, reached), most)
    kept = _kept(reached, keep, most)
    same = bench.few.problem.shots is bench.base.problem.shots
    finer = bench.base.problem.solver.substeps // bench.few.problem.solver.substeps
    starts = [one.as_start(with_states=same, finer=finer) for one in kept]
    fitted = bench.run(fit_fully, starts, "fits")
    ended = eased(bench, bench.candidates(starts, fitted))
    ended = related(bench, ended, hypotheses)
    return sharpened(bench, brought_back(bench, ended))


@dataclass(frozen=True, slots=True)
class ShortFit:
    """What a short fit has come to: the share of the base's cost that it takes away."""

    reduction: float
    hypothesis: Hypothesis
    result: Plain

    @property
    def is_there(self) -> bool:
        """Whether anything is left of the law, and not only new states explain."""
        return not is_nothing(self.hypothesis, self.result["values"])

    @property
    def is_named(self) -> bool:
        """Whether it is a law with a name, of which something is left."""
        return self.hypothesis.physics != CURVE and self.is_there

    def as_start(self, *, with_states: bool, finer: int = 1) -> Trial:
        """Return the trial that goes on from here, with so many times the substeps."""
        states = np.array(self.result["initial"]) if with_states else None
        kind, substeps = self.result["solver"]
        solver = solver_named(kind, finer * substeps)
        return Trial(self.hypothesis, (Start(self.result["values"], states, solver),))


def _reached(
    bench: Bench, results: Iterable[tuple[Hypothesis, Plain]]
) -> list[ShortFit]:
    """Return what short fits have come to, the best first, without those refused."""
    cost = bench.few.optimum.cost
    found = [
        ShortFit(1.0 - result["cost"] / cost, hypothesis, result)
        for hypothesis, result in results
        if "refused" not in result
    ]
    return sorted(found, key=lambda one: -one.reduction)


def _kept(reached: Sequence[ShortFit], keep: float, most: int) -> list[ShortFit]:
    """Return those that lead, and what they contain, however far that has come.

    Whether the additions of a wider law are needed is seen beside the narrower one.
    What leads with nothing left of it does not count against others.
    """
    there = [one for one in reached if one.is_there]
    best, lead = _best(there), _best([one for one in there if one.is_named])
    leading = [
        one for one in there if one.reduction >= keep * (lead if one.is_named else best)
    ]
    leading = _first(leading, most)
    leading += [one for one in reached if not one.is_there][:BEGUN_AGAIN]
    narrower = [
        one
        for one in reached
        if one not in leading
        and any(wide.hypothesis.contains(one.hypothesis) for wide in leading)
    ]
    return [*leading, *narrower]


def _first(leading: Sequence[ShortFit], most: int) -> list[ShortFit]:
    """Return the first `most`; those that come equally far count as one.

    They are mostly the same to these sensors, and would keep all others out.
    """
    kept: list[ShortFit] = []
    last = np.inf
    for one in leading:
        other = last - one.reduction > TWINS
        if other and most == 0:
            break
        most -= other
        last = one.reduction
        kept.append(one)
    return kept


def _best(reached: Sequence[ShortFit]) -> float:
    """Return the largest reduction."""
    return max((one.reduction for one in reached), default=-np.inf)


def _gone_on(bench: Bench, reached: list[ShortFit], most: int) -> list[ShortFit]:
    """Return them again, those gone on that were stopped on their way to the lead.

    Of two laws fitted briefly the one that has more to learn is behind, the right one
    too: beside a large effect all other numbers of the model are wrong at first.
    """
    lead = _best([one for one in reached if one.is_named])
    coming = [
        one
        for one in reached
        if one.reduction >= ON_THE_WAY * lead
        and not one.result["converged"]
        and one.hypothesis.physics != CURVE
    ][:most]
    trials = [one.as_start(with_states=True) for one in coming]
    trials += _from_what_they_contain(reached, ON_THE_WAY * lead)
    longer = bench.run(fit_on, trials, "longer fits", few=True)
    there = _reached(bench, zip([t.hypothesis for t in trials], longer, strict=True))
    return _best_of_each((*there, *reached))


def _at_other_places(bench: Bench, reached: list[ShortFit]) -> list[ShortFit]:
    """Return them again, the leading law at other places fitted from all its starts.

    Where it promises little a start that does as little has kept the promise; but what
    helps so much here may help more next to it.
    """
    lead = next((one for one in reached if one.is_named), None)
    if lead is None or lead.reduction <= 0.0:
        return reached
    law, enough = lead.hypothesis, KEPT_PROMISE * lead.reduction
    behind = [
        one
        for one in reached
        if one.reduction < enough and one.hypothesis.is_elsewhere(law)
    ]
    trials = [Trial(one.hypothesis, enough=enough) for one in behind]
    again = bench.run(fit_briefly, trials, "the same elsewhere", few=True)
    found = _reached(bench, zip([t.hypothesis for t in trials], again, strict=True))
    return _best_of_each((*found, *reached))


def _best_of_each(fits: Iterable[ShortFit]) -> list[ShortFit]:
    """Return the best fit of every law, the best law first."""
    best: dict[int, ShortFit] = {}
    for one in fits:
        known = best.setdefault(id(one.hypothesis), one)
        if one.reduction > known.reduction:
            best[id(one.hypothesis)] = one
    return sorted(best.values(), key=lambda one: -one.reduction)


def _from_what_they_contain(reached: Sequence[ShortFit], least: float) -> list[Trial]:
    """Return fits of laws that are behind one that they contain, begun where it ended.

    With nothing added they are as good, and can only gain from there. Each begins at
    the best that it contains, as far as that takes away `least`.
    """
    trials = []
    for wide in reached:
        contained = (
            narrow
            for narrow in reached
            if narrow.reduction > max(wide.reduction, least)
            and wide.hypothesis.contains(narrow.hypothesis)
        )
        best = next(contained, None)  # They are in order.
        if best is not None:
            starts = best.as_start(with_states=True).starts
            trials.append(Trial(wide.hypothesis, starts))
    return trials
