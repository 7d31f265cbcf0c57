"""What a wider law adds to a plainer one, as the final fit sees it.

Nothing and not known are two answers: where the load hardly changes, even the constant
part of a friction that grows with it is not known, and the growth may be all of it.
"""

from collections.abc import Sequence
from dataclasses import replace

from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.records import Support
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.told import report
from bondgraph.recordings.binding import BoundRecording

ERRORS = 2.58
"""Standard deviations within which a strength is nothing: one time in a hundred chance
goes beyond.
"""

NOTHING = "the final fit finds what it adds to the plainer law to be nothing"
LEFT_OPEN = "these recordings do not tell what it adds to the plainer law"

LOOSE = 0.1
"""Share of a number that both laws have: where it is not known to that beside an
addition, the addition may stand for a part of it.
"""


def added_strengths(wide: Judged, narrower: Judged) -> set[str]:
    """Return the strengths that the wider law has beyond the narrower one."""
    own = set(wide.candidate.hypothesis.strengths)
    return own - set(narrower.candidate.hypothesis.parameters)


def seen_again(
    wide: Judged,
    narrower: Judged,
    final: FittedModel,
    recordings: Sequence[BoundRecording],
) -> Judged:
    """Return the wider law as it is told after the final fit.

    As it was where what it adds is there; refuted where that is nothing; undecided and
    `open` where the recordings leave open what it is.

    Parameters
    ----------
    final
        The final fit with the wider law.
    """
    estimates = {e.name: e for e in report(final, final.graph, recordings).estimates}
    beyond = added_strengths(wide, narrower)
    added = [estimates[n] for n in sorted(beyond) if n in estimates]
    if any(e.std is not None and abs(e.value) > ERRORS * e.std for e in added):
        return wide
    common = set(wide.candidate.hypothesis.strengths) - beyond
    vague = any(
        e.std is None or e.std > LOOSE * abs(e.value)
        for e in estimates.values()
        if e.name in common
    )
    left_open = [e for e in added if e.value and (vague or e.std is None)]
    if not left_open:
        return replace(wide, support=Support.REFUTED, reason=NOTHING)
    numbers = ", ".join(
        f"{e.name} is not determined"
        if e.std is None
        else f"{e.name} {e.value:.2g} ± {e.std:.2g}"
        for e in left_open
    )
    reason = f"{LEFT_OPEN}: {numbers}"
    return replace(wide, support=Support.UNDECIDED, reason=reason, open=True)
