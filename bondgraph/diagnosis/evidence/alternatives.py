"""What the data do not tell from what was chosen: laws, and curves elsewhere."""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.judged import Judged, Rule
from bondgraph.diagnosis.evidence.leads import clearly_better, extends
from bondgraph.diagnosis.records import Support
from bondgraph.physics.sensing import SensorNonlinearity


def alternatives_to(
    chosen: Judged, judged: Sequence[Judged], rule: Rule
) -> tuple[Judged, ...]:
    """Return supported candidates that the data do not tell from the chosen one.

    A law that extends the chosen one without predicting better is no alternative: it
    contains the chosen one, and what it adds is not supported.
    """
    close = [
        j
        for j in judged
        if j is not chosen
        and j.support is Support.SUPPORTED
        and not clearly_better(chosen, j, rule)
        and j.physics != CURVE
        and not extends(j, chosen)
    ]
    return tuple(sorted(close, key=lambda j: -j.gain.value))


def curves_as_good(
    chosen: Judged, judged: Sequence[Judged], rule: Rule
) -> tuple[Judged, ...]:
    """Return curves elsewhere that speak against a chosen one, the best first.

    Against a curve those that it does not clearly beat. And against a sensor that bends
    those that clearly beat it: what is seen through one sensor may bend in the machine
    as well, and machines do so more often.
    """
    curves = [
        j
        for j in judged
        if j.physics == CURVE
        and j.support is Support.SUPPORTED
        and j.place != chosen.place
    ]
    if chosen.physics == CURVE:
        curves = [j for j in curves if not clearly_better(chosen, j, rule)]
    elif chosen.physics == SensorNonlinearity.word:
        curves = [j for j in curves if clearly_better(j, chosen, rule)]
    else:
        curves = []
    return tuple(sorted(curves, key=lambda j: -j.gain.value))
