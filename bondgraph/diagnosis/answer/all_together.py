"""Whether what the training recordings tell is there when all recordings are fitted.

The model is handed on as fitted to all of them, and held-out ones may want none of a
law that the others asked for. Nothing is chosen for that; but what does not stand there
is told as half as probable, and a reader is told why.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.answer.doubt import less_probable
from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.numbers import none_told
from bondgraph.diagnosis.records import Finding
from bondgraph.fitting.result import Estimate, FitResult

GONE = 0.5
"""What is left of a probability where more recordings leave nothing of a law. A
judgement: of 80 answers on file two held a finding of that kind, a drifting sensor
told of a leak, and a softening spring beside a weight. Neither was there.
"""

WHY = (
    " Fitted to all recordings together, the held-out ones among them, the model has "
    "no number of it that is told from none: what the training recordings say of it "
    "does not stand there."
)


def doubted_together(
    findings: Sequence[Finding], everywhere: FitResult | None, *, stands: bool = True
) -> list[Finding]:
    """Return the findings, less probable where no number of the last fit tells them.

    Parameters
    ----------
    everywhere
        The fit to all recordings; None where there is none.
    stands
        Whether held-out recordings have given no reason to doubt already.
    """
    if everywhere is None:
        return list(findings)
    share = GONE if stands else 1.0
    last = {estimate.name: estimate for estimate in everywhere.estimates}
    return [
        less_probable(one, share, WHY) if _is_gone(one, last) else one
        for one in findings
    ]


def _is_gone(finding: Finding, last: dict[str, Estimate]) -> bool:
    """Return whether a named law had a number and has none any more."""
    own = finding.estimates
    there = [last[one.name] for one in own if one.name in last]
    if finding.physics == CURVE or not there or _nothing(own):
        return False
    return _nothing(there)


def _nothing(estimates: Sequence[Estimate]) -> bool:
    return none_told([(one.name, one.value, one.std) for one in estimates])
