"""Whether what the training recordings tell is there when all recordings are fitted.

The model is handed on as fitted to all of them, and held-out ones may want none of a
law that the others asked for. Nothing is chosen or doubted for it here: a reader is
told why a number of the answer is not in the model.
"""

from collections.abc import Iterator, Sequence

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.numbers import none_told
from bondgraph.diagnosis.records import Finding
from bondgraph.fitting.result import Estimate, FitResult


def gone_together(
    findings: Sequence[Finding], everywhere: FitResult | None
) -> Iterator[str]:
    """Yield a sentence for each named finding that no number of the last fit tells."""
    if everywhere is None:
        return
    last = {estimate.name: estimate for estimate in everywhere.estimates}
    for finding in findings:
        own = finding.estimates
        there = [last[one.name] for one in own if one.name in last]
        if finding.physics == CURVE or not there or _nothing(own):
            continue
        if _nothing(there):
            yield (
                "Fitted to all recordings together, the held-out ones among them, the "
                f"model has no number of {finding.name} at {finding.place} that is "
                "told from none: what the training recordings say of it does not stand "
                "there."
            )


def _nothing(estimates: Sequence[Estimate]) -> bool:
    return none_told([(one.name, one.value, one.std) for one in estimates])
