"""Both models run through what was recorded: errors before and after."""

from collections.abc import Sequence
from dataclasses import replace

from bondgraph.diagnosis.answer.carrying import Shown
from bondgraph.diagnosis.answer.left_open import is_left_open
from bondgraph.diagnosis.records import Comparison
from bondgraph.diagnosis.search.base.stretches import stretch
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.long_runs import simulate_stretches, simulate_whole
from bondgraph.recordings.binding import BoundRecording

BETTER = 0.9
"""Whole recordings below this share of the error are clearly better simulated."""


def compared(
    base: FittedModel,
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
) -> Shown:
    """Return what both models leave of training and of held-out recordings."""
    kept_back = _comparison(base, final, held_out)
    shown = Shown(
        kept_back,
        _comparison(base, final, recordings),
        _over_stretches(base, final, held_out, kept_back),
    )
    return replace(shown, left_open=is_left_open(final, held_out, shown))


def _over_stretches(
    base: FittedModel,
    final: FittedModel,
    held_out: Sequence[BoundRecording],
    shown: Comparison,
) -> Comparison | None:
    """Return the errors over stretches of held-out recordings, where fits were.

    They are as long as the shorter of those that the two models were fitted over. None
    where whole recordings are clearly better simulated than before.
    """
    if shown.after.nrmse < BETTER * shown.before.nrmse:
        return None
    shots = (fitted.problem.shots for fitted in (base, final))
    samples = min(int(one.lengths.max()) for one in shots)
    if not base.problem.model.n_states or samples >= max(map(len, held_out), default=0):
        return None
    return _stretched(base, final, held_out, samples)


def over_long(
    base: FittedModel,
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    trained: Comparison,
) -> Comparison:
    """Return the errors over training recordings, or over what tells of these.

    A machine that drifts off over a whole recording, whatever it is made of, is
    compared over stretches of several windows.
    """
    if trained.after.nrmse < BETTER * trained.before.nrmse:
        return trained
    samples = stretch(base, recordings)
    return trained if samples is None else _stretched(base, final, recordings, samples)


def _stretched(
    base: FittedModel,
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    samples: int,
) -> Comparison:
    before, after = (
        simulate_stretches(one, recordings, samples).score for one in (base, final)
    )
    return Comparison(before=before, after=after)


def _comparison(
    base: FittedModel, final: FittedModel, recordings: Sequence[BoundRecording]
) -> Comparison:
    return Comparison(
        before=simulate_whole(base, recordings).score,
        after=simulate_whole(final, recordings).score,
    )
