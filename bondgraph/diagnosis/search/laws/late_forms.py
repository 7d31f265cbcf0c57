"""Forms in which a signal comes late: in one stage, in two, or by a fixed time.

A first look at a delay promises next to nothing where the true one is many samples
long, and the lag that looks best there is only its nearest form. Where a lag leads, or
ties with what leads, the time that it takes says where the other forms begin.
"""

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.search.trials.trying import Start, Trial
from bondgraph.physics.dynamics import Delay, Lag
from bondgraph.physics.hypothesis import Hypothesis

MAKE_LATE = (Lag.word, Delay.word)

SHARES = (0.5, 1.0, 2.0)
"""Of the time of the form that leads: where another begins."""

AS_GOOD = 1.01
"""A form that costs no more than so many times what leads ties with it."""


def other_forms(
    candidates: Sequence[Candidate], hypotheses: Sequence[Hypothesis]
) -> list[Trial]:
    """Return fits of the forms of a lag that were not kept, from the one that leads.

    Or that ties with what leads: on the only way from an input to a reading a slip does
    the same.
    """
    late = [one for one in candidates if one.hypothesis.physics in MAKE_LATE]
    if not late:
        return []
    best = min(late, key=attrgetter("cost"))
    if best.cost > AS_GOOD * min(one.cost for one in candidates):
        return []
    kept = {id(candidate.hypothesis) for candidate in candidates}
    there = Start.where_ended(best.fitted)
    (time,) = best.hypothesis.parameters
    return [
        Trial(other, _starts(there, there.values[time], other))
        for other in hypotheses
        if id(other) not in kept
        and other.physics in MAKE_LATE
        and other.place == best.hypothesis.place
    ]


def _starts(there: Start, time: float, other: Hypothesis) -> tuple[Start, ...]:
    """Return starts of another form beside all else that was found."""
    (own,) = other.parameters
    return tuple(
        replace(there, values={**there.values, own: share * time}) for share in SHARES
    )
