"""One curve drawn finely, fitted and held against data that are left out.

What is proportional may be another's as well: a damper beside a force that bends over
the speed takes any share of its slope. Then it takes all of it.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors, left_out_errors
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.impossible import impossible
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.fitting.certainty.combinations import (
    Local,
    flat_directions,
    relative,
    taking_part,
)
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.problem import prior_residuals, reduced_hessian
from bondgraph.physics.bends import LINES
from bondgraph.physics.curves import BOTH_WAYS
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.places.base import PROPOSED
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.smooth import Smooth
from bondgraph.physics.unknown import UnknownRelation

Array = NDArray[np.float64]

BEND, ALL_BENDS = re.compile(r"bend_\d+"), re.compile(r"bend_\d*$")
"""What a bend is called, and what is left of that where all names begin so."""

AS_WELL = 1.01
"""A curve without its line does as well as with it where it costs no more than this."""


class Drawing:
    """A curve, and how well it predicts chunks that are left out.

    Every fourth of them, or a quarter of all in one piece.
    """

    def __init__(
        self, candidate: Candidate, chunks: int, smooth: Smooth | None = None
    ) -> None:
        self.candidate, self.chunks, self.smooth = candidate, chunks, smooth
        self.errors = left_out_errors(candidate.fitted, chunks)
        self.typical = float(_logs(self.errors).mean())
        """Mean log of the squared errors on left-out chunks."""
        self.in_one = _logs(left_out_errors(candidate.fitted, chunks, in_one=True))
        """Log of the squared error of each, with its quarter left out."""


def _logs(errors: LeftOutErrors) -> Array:
    """Return the logs of the squared errors on left-out chunks."""
    left = errors.chunks
    return np.asarray(np.log(np.maximum(left, 1e-12 * left.max())))


def told_apart(bench: Bench, first: Drawing, best: Drawing) -> Drawing:
    """Return the curve without what these recordings do not tell of its line.

    A damper beside a force that bends over the speed takes any share of its slope: what
    the two come to would be left to chance. Where the damper takes all of it, as well
    as both do, both are told.
    """
    fitted, smooth = best.candidate.fitted, best.smooth
    lines = lines_in(best.candidate.hypothesis.strengths)
    shared, ways = _only_together(fitted, lines)
    open_ = [line for name, line in lines.items() if name in shared]
    without = frozenset(open_[:ways])
    if smooth is None or not without:
        return best
    begin, before = Start.where_ended(fitted), bench.base.values
    others = {name: before[name] for name in shared if name in before}
    begin = replace(begin, values={**begin.values, **others})
    smooth = replace(smooth, without=without)
    found = drawn_finely(bench, first.candidate.hypothesis, smooth, begin)
    if found is None or found.cost > AS_WELL * best.candidate.cost:
        return best
    return Drawing(found, first.chunks, smooth)


def is_fine(curve: Hypothesis) -> bool:
    """Return whether a curve is drawn finely: how much it bends is stated then."""
    return any(one.std for one in curve.edit.parameters)


def lines_in(strengths: Sequence[str]) -> dict[str, str]:
    """Return which of a smooth curve's numbers are its lines, by name."""
    own = _after_stem(strengths)
    return {
        name: line
        for line in LINES
        for name, after in own.items()
        if after.startswith(f"{line}_")
    }


def bends_in(strengths: Sequence[str]) -> dict[str, str]:
    """Return which of a smooth curve's numbers are its bends, by name."""
    found = {name: BEND.match(after) for name, after in _after_stem(strengths).items()}
    return {name: bend[0] for name, bend in found.items() if bend is not None}


def _after_stem(strengths: Sequence[str]) -> dict[str, str]:
    """Return what follows in the names of a curve's numbers on what is the curve's.

    A place may be called a level, too: what all names begin with alike is the curve's,
    but for a bend where there are bends alone.
    """
    letters = zip(*strengths, strict=False)
    same = takewhile(lambda alike: len(set(alike)) == 1, letters)
    alike = ALL_BENDS.sub("", "".join(one[0] for one in same))
    return {name: name.removeprefix(alike) for name in strengths}


def _only_together(fitted: FittedModel, lines: Collection[str]) -> tuple[set[str], int]:
    """Return which of a curve's lines and of the model's own numbers do the same.

    And in how many ways; by the data and what is stated of the machine, while the curve
    bends as it does: bends may do as lines do. A law that was found before may have to
    go, where the curve does all that it does.
    """
    problem, optimum = fitted.problem, fitted.optimum
    names, known = np.array(problem.free_names), fitted.graph.parameters
    found = np.array([known[name].source == PROPOSED for name in names])
    _, weight = prior_residuals(problem, optimum.theta)
    stated = np.where(found, 0.0, weight)
    hessian = reduced_hessian(optimum.linearisation, len(weight)) + np.diag(stated**2)
    kept = ~found | np.isin(names, list(lines))
    local = relative(Local(optimum.theta[kept], hessian[np.ix_(kept, kept)]))
    flat = flat_directions(local)
    return set(names[kept][taking_part(flat, local)]), len(flat)


def drawn_finely(
    bench: Bench, first: Hypothesis, smooth: Smooth, begin: Start
) -> Candidate | None:
    """Return the first curve drawn finely, fitted from a start.

    None where it cannot be: where no curve there is the same both ways, say, or no
    element has such a one.
    """
    physics = UnknownRelation(smooth, first.visited)
    hypothesis = _proposed(bench, first, physics)
    if hypothesis is None or (smooth.odd and BOTH_WAYS not in hypothesis.words):
        return None
    known = {**hypothesis.starts[0], **begin.values}
    trial = Trial(hypothesis, (replace(begin, values=known),))
    found = bench.candidates([trial], bench.run(fit_fully, [trial], "a smooth curve"))
    return None if not found or impossible(found[0]) else found[0]


def _proposed(
    bench: Bench, first: Hypothesis, physics: UnknownRelation
) -> Hypothesis | None:
    """Return the same curve as another form of the physics proposes it."""
    plain = UnknownRelation()
    same = [
        finer
        for place in all_places(bench.base.graph, measure_scales(bench.base))
        if place.name == first.place
        for form, finer in zip(plain.forms(place), physics.forms(place), strict=True)
        if form().words == first.words
    ]
    return same[0]() if len(same) == 1 else None
