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

import numpy as np

from bondgraph.diagnosis.answer.leftover import excusable
from bondgraph.diagnosis.answer.telling import answer
from bondgraph.diagnosis.misreadings import refuse_unchanging, without_misreadings
from bondgraph.diagnosis.records import Diagnosis
from bondgraph.diagnosis.search.between_samples import finely_stepped, fitted_either_way
from bondgraph.diagnosis.search.horizons import search_settings, sharpened
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.plainer import without_needless_parts
from bondgraph.diagnosis.search.rounds import search
from bondgraph.diagnosis.work.clock import Progress
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.limit import Limit
from bondgraph.diagnosis.work.workers import workshop
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import fit_model
from bondgraph.recordings.binding import BoundRecording
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
        If the base model cannot be simulated at all.
    RecordingError
        If a measured output never changes in any of the training recordings.
    """
    chosen = Options() if options is None else options
    limit = Limit.after(chosen.seconds)
    refuse_unchanging(recordings)
    read, kept_back = without_misreadings(recordings), without_misreadings(held_out)
    recordings, held_out = read.recordings, kept_back.recordings
    progress("fitting the base model")
    settings = search_settings(graph, recordings, chosen.settings)
    fit = fitted_either_way if chosen.either_hold else fit_model
    base = fit(graph, recordings, settings)
    if not np.isfinite(base.optimum.cost):
        raise FitError(
            f"{graph.name!r} cannot be simulated at its start values.",
            (graph.name,),
            "Give start values nearer to the machine, or bounds that keep it finite.",
        )
    noise = excusable(recordings)
    base = finely_stepped(base, noise)
    journal = Journal(chosen.resume)
    with workshop(chosen.where, journal, progress, limit) as shop:
        rounds = search(base, recordings, noise, chosen, shop)
    final = base
    if rounds[-1].base is not base:
        progress("refitting the improved model")
        final = sharpened(rounds[-1].base, recordings, chosen)
        rounds, final = without_needless_parts(rounds, final, recordings, chosen)
    progress("simulating the held-out recordings")
    found = answer(graph, recordings, held_out, rounds, final, chosen)
    return replace(found, notes=(*found.notes, *read.notes, *kept_back.notes))


__all__ = ["Options", "diagnose"]
