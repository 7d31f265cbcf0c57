"""`diagnose`: from a model and recordings to a ranked, calibrated answer.

1. Fit the base model: wrong parameters are fitted away, what remains is structure.
2. Propose every hypothesis of the library at every place; screen by what it promises.
3. Fit the best; judge the best of these by left-out chunks of the *training*
   recordings; accept the simplest that is supported; repeat on the improved model until
   nothing more is.
4. Open the held-out recordings once, to show. No choice has seen them.
"""

from collections.abc import Sequence
from dataclasses import replace

from bondgraph.choices import refuse_other
from bondgraph.diagnosis.answer.notes import notes_on_gaps
from bondgraph.diagnosis.answer.telling import answer
from bondgraph.diagnosis.each_alone import with_each_alone
from bondgraph.diagnosis.evidence.leftover import excusable
from bondgraph.diagnosis.records import Diagnosis
from bondgraph.diagnosis.search.base.beginnings import base_fit
from bondgraph.diagnosis.search.base.horizons import search_settings
from bondgraph.diagnosis.search.looks import second_look
from bondgraph.diagnosis.search.nearer_look import first_look
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.unchanging import refuse_unchanging
from bondgraph.diagnosis.work.clock import Progress
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.limit import Limit
from bondgraph.diagnosis.work.workers import workshop
from bondgraph.errors import FitError
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.misreadings import without_misreadings
from bondgraph.recordings.model_channels import matched, refuse_twice
from bondgraph.recordings.windows import windows
from bondgraph.structure.graph import FinishedGraph


def diagnose(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    held_out: Sequence[BoundRecording],
    options: Options | None = None,
    progress: Progress = lambda _: None,
) -> Diagnosis:
    """Say whether physics is missing from a model, where and which, and show it.

    Parameters
    ----------
    graph
        The base model with starting values for its parameters.
    recordings
        Training recordings: everything is chosen and fitted on these.
    held_out
        Opened once, at the end, to show.
    options
        Fit settings, decision rule and library; the defaults when None.
    progress
        Called with a sentence at each step.

    Raises
    ------
    FitError
        If the base model cannot be simulated at all, or `options` are none.
    RecordingError
        If there is none to train on or to hold out, a measured output never changes in
        any of the training recordings, or one of the recordings is too short, or too
        full of gaps, to simulate anything over.
    """
    chosen = Options() if options is None else options
    refuse_other(chosen, Options, "What is to set the diagnosis", FitError)
    limit = Limit.after(chosen.seconds)
    recordings = matched(graph, recordings, " to diagnose from")
    refuse_twice(recordings)
    held_out = matched(graph, held_out, " to show the answer on")
    refuse_unchanging(recordings)
    read, kept_back = without_misreadings(recordings), without_misreadings(held_out)
    recordings, held_out = read.recordings, kept_back.recordings
    for one in (*recordings, *held_out):
        if not one.steady:
            windows(one)  # Refused before the work, where it is too short.
    progress("fitting the base model")
    settings = search_settings(graph, recordings, chosen.settings)
    noise = excusable(recordings)
    base = base_fit(graph, recordings, settings, noise, chosen)
    with workshop(chosen.where, Journal(chosen.resume), progress, limit) as shop:
        first = first_look(graph, base, recordings, noise, chosen, shop)
        seen = second_look(graph, first, recordings, noise, chosen, shop)
        progress("simulating the held-out recordings")
        found = answer(graph, recordings, held_out, seen.rounds, seen.final, chosen)
        found = with_each_alone(found, graph, recordings, noise, settings, chosen, shop)
    gaps = notes_on_gaps((*recordings, *held_out))
    notes = (*found.notes, *read.notes, *kept_back.notes, *gaps)
    return replace(found, notes=notes)


__all__ = ["Options", "diagnose"]
