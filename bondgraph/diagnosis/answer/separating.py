"""The experiment of an answer: what to play where the recordings left laws close.

The alternatives of a finding are compared as they were fitted in the round that made
it, with the same other physics and over the same windows. Where nothing was found and
laws stayed undecided, the question is whether they are there at all.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.experiment.next_experiment import next_experiment
from bondgraph.diagnosis.experiment.records import Experiment, ExperimentStatus
from bondgraph.diagnosis.records import Support, Verdict
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.errors import BondGraphError
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording

MOST_RIVALS = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Rivalry:
    """Fitted models that the recordings leave close, with their names in words.

    Parameters
    ----------
    nested
        Whether the others are the first with something added.
    """

    names: tuple[str, ...]
    models: tuple[FittedModel, ...]
    nested: bool = False

    def first(self, count: int) -> "Rivalry":
        """Return the rivalry of the first few alone."""
        return replace(self, names=self.names[:count], models=self.models[:count])


def left_close(
    rounds: Sequence[Round], others: Mapping[str, Sequence[Judged]], verdict: Verdict
) -> Rivalry | None:
    """Return what the recordings leave close; None where they leave nothing so.

    Parameters
    ----------
    others
        For each element found, what the data do not tell from it.
    """
    for found in rounds:
        chosen = found.chosen
        if chosen is None:
            continue
        close = others.get(chosen.candidate.hypothesis.element, ())
        rivals = _strongest([j for j in close if j.physics != chosen.physics])
        rivals = rivals or _strongest([j for j in close if j.place != chosen.place])
        if rivals:
            return _rivalry([chosen, *rivals])
    first = rounds[0]
    undecided = [j for j in first.judged if j.support is Support.UNDECIDED]
    if verdict is not Verdict.CANNOT_TELL or not undecided:
        return None
    added = _rivalry(_strongest(undecided))
    return Rivalry(
        names=("nothing more", *added.names),
        models=(first.base, *added.models),
        nested=True,
    )


def designed(
    rivalry: Rivalry, recordings: Sequence[BoundRecording]
) -> tuple[Experiment | None, tuple[str, ...]]:
    """Return the experiment that separates what is left close, and notes on it.

    Without time or inputs there is none; where the design fails, a note says why. Where
    no input parts three, one that parts the first two is better than none.
    """
    first = recordings[0]
    if first.steady or not first.input_names:
        return None, ()
    count = len(rivalry.models)
    try:
        found = _between(rivalry, recordings)
        if found.status is ExperimentStatus.USELESS and count > 2:
            found = _between(rivalry.first(2), recordings)
    except (BondGraphError, np.linalg.LinAlgError, FloatingPointError) as error:
        names = " from ".join(rivalry.names)
        return None, (f"No experiment was designed to tell {names}: {error}",)
    return found, ()


def _between(rivalry: Rivalry, recordings: Sequence[BoundRecording]) -> Experiment:
    found = next_experiment(rivalry.models, recordings, nested=rivalry.nested)
    statement = f"{found.statement[:1].lower()}{found.statement[1:]}"
    names = " from ".join(rivalry.names)
    return replace(
        found, statement=f"To tell {names}: {statement}", between=rivalry.names
    )


def _strongest(judged: Sequence[Judged]) -> list[Judged]:
    """Return the best of each physics, the best first; of one alone, of each place."""
    ranked = sorted(judged, key=lambda j: -j.gain.value)
    kinds = {j.physics for j in ranked}
    best: dict[str, Judged] = {}
    for one in ranked:
        best.setdefault(one.physics if len(kinds) > 1 else one.place, one)
    return list(best.values())[:MOST_RIVALS]


def _rivalry(judged: Sequence[Judged]) -> Rivalry:
    return Rivalry(
        names=tuple(f"{j.name} at {j.place}" for j in judged),
        models=tuple(j.candidate.fitted for j in judged),
    )
