"""Exchange: a law that came first gives way to the one that takes its place better.

Where two laws are missing, the first one found is the one that bends most easily to
both, and what is found beside it only mends its shape. The right one then comes too
late: beside the wrong one it adds little, or leaves nothing of it. So it is tried in
its place, and has to predict clearly better there than the model that was reached.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.evidence.judged import Judged, Rule, judge
from bondgraph.diagnosis.evidence.leads import clearly_better
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors, left_out_errors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.revising.curve_beside import FAR_MORE
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.errors import BondGraphError
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis

Array = NDArray[np.float64]
ERRORS = 2.0
"""What adds less than so many standard errors of it is not tried in another's place."""

HALF = 0.5
"""A law with more parameters takes the place of another only where it leaves at most
this share of what that left beyond the noise; a curve without a name only where it is
as far ahead as one that is told in the place of all named laws.
"""


@dataclass(frozen=True, slots=True)
class Exchanged:
    """The model with a law in place of an earlier one, and what speaks for that.

    ``better`` and ``rival`` are both judged as additions to all else that was found,
    which leaves the share ``without`` of the first model's error.
    """

    fitted: FittedModel
    kept: tuple[Hypothesis, ...]
    better: Judged
    rival: Judged
    probability: float
    without: float

    @property
    def error(self) -> float:
        """What the better one leaves of left-out data."""
        return float(self.better.errors.chunks.sum())


@dataclass(frozen=True, slots=True, eq=False)
class Reached:
    """What a search has come to: its first model, its last, and what lies between."""

    first: FittedModel
    current: FittedModel
    added: tuple[Hypothesis, ...]
    noise: Array


def exchanged(
    reached: Reached, newcomers: Sequence[Judged], tried: float, rule: Rule
) -> Exchanged | None:
    """Return the best exchange of an earlier law for one that was tried beside it.

    Parameters
    ----------
    newcomers
        Laws judged as additions to the current model.
    tried
        How many hypotheses they are the best of.
    """
    some = [j for j in newcomers if j.gain.value > ERRORS * j.gain.std]
    if not some or not reached.added:
        return None
    # On the chunks of the round, that all in it can be compared.
    errors = _Errors(some[0].errors.chunks.size, reached)
    now = errors.of(reached.current)
    tries = (
        _instead(new, old, reached, errors, now, tried, rule)
        for new in some
        for old in reached.added
    )
    found = [one for one in tries if one is not None]
    return min(found, key=attrgetter("error"), default=None)


@dataclass(frozen=True, slots=True)
class _Errors:
    """Errors on left-out data, all on the same chunks."""

    chunks: int
    reached: Reached

    def of(self, fitted: FittedModel) -> LeftOutErrors:
        """Return those of a model, with what noise alone would leave."""
        errors = left_out_errors(fitted, self.chunks)
        noise = (self.reached.noise / fitted.problem.sigma) ** 2
        return replace(errors, noise=float(np.sum(noise)) * errors.samples)


def _instead(
    new: Judged,
    old: Hypothesis,
    reached: Reached,
    errors: _Errors,
    now: LeftOutErrors,
    tried: float,
    rule: Rule,
) -> Exchanged | None:
    """Return the exchange, where it predicts clearly better than what was reached."""
    rest = [one for one in reached.added if one is not old]
    hypothesis, values = new.candidate.hypothesis, new.candidate.fitted
    try:
        without = fitted_with(reached.first, reached.current, rest, {})
        fitted = fitted_with(reached.first, values, [*rest, hypothesis], {})
    except BondGraphError:
        return None  # The one sits on what the other has added.
    then, before = errors.of(fitted), errors.of(without)
    more = len(fitted.problem.free) > len(reached.current.problem.free)
    unnamed = new.physics == CURVE and old.physics != CURVE
    most = 1.0 / FAR_MORE if unnamed else HALF
    if more and not then.beyond_noise <= most * now.beyond_noise:
        return None

    def judged(one: Hypothesis, made: FittedModel, left: LeftOutErrors) -> Judged:
        added = len(made.problem.free) - len(without.problem.free)
        return judge(Candidate(one, made, added), before, left, tried, rule)

    better, rival = judged(hypothesis, fitted, then), judged(old, reached.current, now)
    supported = better.support is Support.SUPPORTED
    if not supported or not clearly_better(better, rival, rule):
        return None
    sure = probability(better, [better, rival], before, rule)
    left = without.optimum.cost / reached.first.optimum.cost
    return Exchanged(fitted, (*rest, hypothesis), better, rival, sure, left)
