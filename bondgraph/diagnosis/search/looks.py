"""A look at recordings from one fit; and further ones where the first was blind.

Over short windows, each with a state of its own, the small and quick stands out, and
what shows only in the long run is taken by the states: dry friction beside a spring.
And a parameter that has run away takes with it what would have shown the way. Where
the model that a look has come to simulates whole recordings hardly better than the base
model does that was fitted to them, another is taken: over whole recordings, and with
what has run away held to its stated value. It has to end clearly better there.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.evidence.leftover import SLOWLY, noise_floor, too_large
from bondgraph.diagnosis.search.base.beginnings import Known
from bondgraph.diagnosis.search.base.beyond_noise import within
from bondgraph.diagnosis.search.base.horizons import sharpened
from bondgraph.diagnosis.search.base.short_runs import keeps_what_windows_show
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.remaining import MUCH_REMAINING, remaining
from bondgraph.diagnosis.search.revising.hollow import (
    ends_as_nothing,
    without_hollow,
)
from bondgraph.diagnosis.search.revising.plainer import without_needless_parts
from bondgraph.diagnosis.search.round_found import Round, accepted, chosen_in
from bondgraph.diagnosis.search.rounds import search
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.fine_steps import told_finely
from bondgraph.fitting.horizon import Automatic, WholeRecordings
from bondgraph.fitting.long_runs import goes_on_growing, simulate_whole
from bondgraph.fitting.strategy import Direct
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
CLEARLY = 0.9
"""An error of whole recordings below this share of another's is clearly smaller."""

AS_WINDOWS = 1.3
"""What whole recordings are left with, over what windows are: more is a disturbance."""

HURRIED = 15
"""Iterations of the last fit where the time for the search has passed already."""


@dataclass(frozen=True, slots=True)
class Look:
    """What a search over one horizon has found, and the model that it ended with."""

    rounds: list[Round]
    final: FittedModel

    @property
    def is_named(self) -> bool:
        """Whether a law with a name was found.

        A curve bends to what windows leave of a motion that is longer than they are.
        """
        return bool(self._named())

    @property
    def is_told(self) -> bool:
        """Whether a law with a name was found that has a number."""
        return any(not ends_as_nothing(self.final, one) for one in self._named())

    def _named(self) -> list[Candidate]:
        """Return the laws with a name that were found."""
        found = chosen_in(self.rounds)
        return [one for one in found if one.hypothesis.physics != CURVE]

    def error(self, recordings: Sequence[BoundRecording]) -> float:
        """Return how far whole recordings are from being simulated, over the spread."""
        return _whole_error(self.final, recordings)


def look(
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
    *,
    another: bool = False,
) -> Look:
    """Return what a search finds from a fitted model, and the model refitted at last.

    Parameters
    ----------
    noise
        Residual per output that noise excuses, 0 where it is not known.
    another
        Whether it is to end where no one law explains anything, for another look.
    """
    rounds = search(base, recordings, noise, options, shop, another=another)
    if rounds[-1].base is base:
        return Look(rounds, base)
    shop.progress("refitting the improved model")
    limit = shop.limit
    last = _hurried(options) if limit.passed else options
    final = sharpened(rounds[-1].base, recordings, last, base)
    if not limit.passed:
        # What a law adds is told from nothing by numbers that steps do not bend.
        final = told_finely(final)
    rounds, final = without_needless_parts(rounds, final, recordings, options, limit)
    seen = Look(*without_hollow(rounds, final, recordings, options, limit))
    return _as_begun(seen, base, recordings)


def _as_begun(
    seen: Look, base: FittedModel, recordings: Sequence[BoundRecording]
) -> Look:
    """Return a look without what misses the recordings that it was fitted to by more.

    A model that has come to an edge, beyond which the least step of its solver sends it
    elsewhere, is another one each time that it is simulated.
    """
    whole = isinstance(seen.final.horizon, WholeRecordings)
    if not whole or seen.error(recordings) <= _whole_error(base, recordings) / CLEARLY:
        return seen
    first, late = seen.rounds[0], any(one.cut_short for one in seen.rounds)
    nothing = replace(first, chosen=None, probability=None, cut_short=late)
    return Look([nothing], base)


def _hurried(options: Options) -> Options:
    """Return the options of a fit for which there is hardly time.

    Over whole recordings at once: to grow windows takes many fits.
    """
    settings = options.settings
    automatic = isinstance(settings.horizon, Automatic)
    hurried = replace(
        settings,
        iterations=min(HURRIED, settings.iterations),
        strategy=Direct(),
        horizon=WholeRecordings() if automatic else settings.horizon,
    )
    return replace(options, settings=hurried)


def second_look(
    graph: FinishedGraph,
    first: Look,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
) -> Look:
    """Return the best of further looks where the first one was blind, or the first.

    Where named laws have left little it was not blind; it was where windows leave no
    more than noise and whole recordings more. Where windows have shown nothing, whole
    recordings have to come down to what windows are left with. A plant on which the
    least disturbance goes on growing says nothing in the long run; but windows take for
    states of their own what holds a machine, so that is asked of both fits.
    """
    base = first.rounds[0].base
    small = within(base, noise, options.rule)
    windowed = base.problem.shots.n_windows > len(recordings)
    if shop.limit.passed or (small and not windowed):
        return first
    if explains(first, recordings) and not _spoils(first, base, recordings):
        return first
    known = Known(graph, recordings, noise, _halved(options))
    long = known.fitted_again(base)
    if all(goes_on_growing(one, recordings) for one in (base, long)):
        return first
    if too_large(long, noise_floor(recordings), SLOWLY) is None:
        return first
    least = _whole_error(long, recordings)
    best, reached = first, min(first.error(recordings), least)
    if reached < CLEARLY * least and first.is_told:
        return first
    others = () if long is base else (long,)
    for other in (*others, *known.as_stated(long)):
        if shop.limit.passed:
            break
        shop.progress("another look, from another fit of the model")
        seen = look(other, recordings, noise, known.options, shop)
        seen = replace(seen, final=known.released(seen.final, other))
        error = seen.error(recordings)
        clean = bool(accepted(first.rounds)) or _as_windows(seen, base, recordings)
        better = is_better(seen, error, best, reached)
        keeps = clean and better and _still_shows(seen, first, recordings)
        if accepted(seen.rounds) and keeps:
            best, reached = seen, error
    return best


def is_better(seen: Look, error: float, best: Look, reached: float) -> bool:
    """Return whether a look explains whole recordings better than the best until then.

    Clearly; but a law with a name is told in place of a curve that does no better.

    Parameters
    ----------
    error, reached
        What each leaves of whole recordings.
    """
    named = seen.is_named and not best.is_named and bool(accepted(best.rounds))
    return error < (1.0 / CLEARLY if named else CLEARLY) * reached


def _as_windows(
    seen: Look, base: FittedModel, recordings: Sequence[BoundRecording]
) -> bool:
    """Return whether whole recordings are left with hardly more than windows were.

    A slow disturbance that nobody recorded bends any law towards it, but not so far.
    """
    whole = simulate_whole(seen.final, recordings).score.rmse
    left = np.sqrt(np.nanmean(base.residuals() ** 2, axis=0))
    names = base.problem.model.output_names
    return all(
        whole[name] <= AS_WINDOWS * size for name, size in zip(names, left, strict=True)
    )


def _still_shows(seen: Look, first: Look, recordings: Sequence[BoundRecording]) -> bool:
    """Return whether what laws with names explained in windows is explained still.

    Where they have left much, there is nothing to keep to.
    """
    if not explains(first, recordings):
        return True
    return keeps_what_windows_show(seen.final, first.final, first.rounds[0].base)


def explains(seen: Look, recordings: Sequence[BoundRecording]) -> bool:
    """Return whether named laws have left little over what was looked at.

    On a machine that integrates, whole recordings may still drift off, and any law that
    bends them back fits. Laws of which no number is told explain nothing.
    """
    return (
        seen.is_told
        and remaining(seen.rounds, noise_floor(recordings)) < MUCH_REMAINING
    )


def _spoils(
    seen: Look, base: FittedModel, recordings: Sequence[BoundRecording]
) -> bool:
    """Return whether whole recordings are missed by more than before.

    What explains windows by their initial states, or by a bend, does so.
    """
    return seen.error(recordings) > _whole_error(base, recordings)


def _halved(options: Options) -> Options:
    """Return the options at half the level: a second look is a second chance."""
    level = options.rule.false_alarm_probability / 2.0
    return replace(options, rule=replace(options.rule, false_alarm_probability=level))


def _whole_error(fitted: FittedModel, recordings: Sequence[BoundRecording]) -> float:
    """Return the error of whole recordings over their spread; inf where none ends."""
    simulated = simulate_whole(fitted, recordings)
    error = simulated.score.nrmse
    return error if simulated.whole and np.isfinite(error) else np.inf
