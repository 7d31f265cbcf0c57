"""The plainer law, where what a wider one adds turns out to be nothing.

The search compares laws over short windows; the final fit, over the horizon that suits
it, knows the parameters better. Where all that a chosen law has beyond a supported
narrower one is there zero within its error, the narrower one is told.
"""

from collections.abc import Sequence
from dataclasses import replace

from bondgraph.diagnosis.evidence.decision import Judged
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.removal import fitted_with
from bondgraph.diagnosis.search.rounds import Options, Round, sharpened
from bondgraph.fitting.estimate import FittedModel, report
from bondgraph.recordings.binding import BoundRecording

ERRORS = 2.0
"""Standard deviations within which a strength is nothing."""


def without_needless_parts(
    rounds: Sequence[Round],
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    options: Options,
) -> tuple[list[Round], FittedModel]:
    """Return the rounds and the final model with plainer laws where they suffice."""
    estimates = report(final, final.graph, recordings).estimates
    nothing = {
        e.name
        for e in estimates
        if e.std is not None and abs(e.value) <= ERRORS * e.std
    }
    plain = [_plainer(one, nothing) for one in rounds]
    if all(new is old for new, old in zip(plain, rounds, strict=True)):
        return list(rounds), final
    gone = {id(h) for one in plain for h in one.removed}
    hypotheses = [
        one.chosen.candidate.hypothesis
        for one in plain
        if one.chosen is not None and id(one.chosen.candidate.hypothesis) not in gone
    ]
    fitted = fitted_with(rounds[0].base, final, hypotheses)
    return plain, sharpened(fitted, recordings, options)


def _plainer(found: Round, nothing: set[str]) -> Round:
    """Return the round with a narrower law chosen, where the wider adds nothing."""
    if found.chosen is None:
        return found
    wide = found.chosen.candidate.hypothesis
    narrower = [
        j
        for j in found.judged
        if j.place == found.chosen.place
        and j.support is Support.SUPPORTED
        and j.physics in wide.extends
        and _added(wide.strengths, j) <= nothing
        and _added(wide.strengths, j)
    ]
    if not narrower:
        return found
    return replace(found, chosen=max(narrower, key=lambda j: j.gain.value))


def _added(strengths: Sequence[str], narrower: Judged) -> set[str]:
    return set(strengths) - set(narrower.candidate.hypothesis.parameters)
