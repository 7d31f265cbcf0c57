"""Notes on an answer: what was left aside and why, and how it was computed."""

import platform
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from bondgraph import __version__
from bondgraph.diagnosis.answer.evidence_shown import wider_than_chosen
from bondgraph.diagnosis.answer.wording import listed
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.round_found import Round, made_in
from bondgraph.diagnosis.work.limit import OUT_OF_TIME
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.result import FitResult
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.names import name_of
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.windows import SHORTEST_WINDOW, stretches

MOST_WITH_PLACES = 6
"""More laws than these are listed by name alone, each once."""


def notes_on(
    rounds: Sequence[Round], after: FitResult, options: Options
) -> tuple[str, ...]:
    """Return a sentence for each law that was left aside, taken out or is too wide."""
    notes = [f"Not identifiable: {sentence}." for sentence in after.unidentifiable]
    if options.seconds is not None and any(found.cut_short for found in rounds):
        kept = " What was worked out is kept: the same work goes on from there."
        notes.append(
            f"The search was cut short to end within {options.seconds / 60:.3g} min, "
            "its time limit; laws that were not tried may explain more or better."
            + (kept if options.resume else "")
        )
    stands = {(one.physics, one.place) for one in made_in(rounds)}
    for found in rounds:
        notes += [
            f"{_sentence_start(h)} was added first and taken out again: beside what "
            "was added later it does not predict left-out data better."
            for h in found.removed
            if (h.physics, h.place) not in stands  # chosen again: it is a finding
        ]
        for judged in wider_than_chosen(found, options):
            assert found.chosen is not None
            plain = found.chosen
            if judged.open:
                notes.append(f"{_sentence_start(judged)}: {judged.reason}.")
                continue
            same = (judged.physics, judged.place) == (plain.physics, plain.place)
            notes.append(
                f"{_sentence_start(judged)} "
                f"{'with more numbers' if same else 'instead'} is hardly supported: "
                "it does not predict left-out data better"
                f"{'' if same else f' than {plain.name}'}."
            )
    return tuple(dict.fromkeys((*notes, *_left_aside(rounds))))


def _left_aside(rounds: Sequence[Round]) -> list[str]:
    """Return for each reason which laws were left aside for it."""
    chosen = [found.chosen for found in rounds if found.chosen is not None]
    # What was found was left aside in another form only.
    told = {(one.physics, one.place) for one in chosen}
    by_reason: dict[str, dict[tuple[str, str], None]] = {}
    for rejected in (one for found in rounds for one in found.rejected):
        law = rejected.hypothesis
        # What there was no time for is told once, of all laws.
        if rejected.reason != OUT_OF_TIME and (law.physics, law.place) not in told:
            by_reason.setdefault(rejected.reason, {})[law.physics, law.place] = None
    return [
        f"{_capital(_laws_by_name(list(laws)))} "
        f"{'was' if len(laws) == 1 else 'were'} left aside: {reason}"
        for reason, laws in by_reason.items()
    ]


def _laws_by_name(laws: Sequence[tuple[str, str]]) -> str:
    """Return laws with their places, or by name alone where there are many."""
    if len(laws) <= MOST_WITH_PLACES:
        return listed([f"{name_of(law)} at {place}" for law, place in laws], "and")
    return listed(list(dict.fromkeys(name_of(law) for law, _ in laws)), "and")


def notes_on_gaps(recordings: Sequence[BoundRecording]) -> tuple[str, ...]:
    """Return a sentence for each recording that is cut at gaps in its time."""
    notes = []
    for recording in recordings:
        parts = () if recording.steady else stretches(recording.time)
        short = sum(len(part) for part in parts if len(part) < SHORTEST_WINDOW)
        if len(parts) > 1:
            left_out = (
                f"; {short} samples lie in stretches of fewer than {SHORTEST_WINDOW} "
                "and are not used"
                if short
                else ""
            )
            notes.append(
                f"The time of {recording.name} has gaps: it is simulated in "
                f"{len(parts)} stretches, each from a state of its own{left_out}."
            )
    return tuple(notes)


def _sentence_start(judged: Judged | Hypothesis) -> str:
    return _capital(f"{name_of(judged.physics)} at {judged.place}")


def _capital(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}"


def provenance(
    recordings: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
    options: Options,
    final: FittedModel,
) -> dict[str, Any]:
    """Return versions, digests of the recordings, and how everything was simulated."""
    # Our own number is in the source: a tree on the path has nothing installed to ask.
    packages = ("numpy", "scipy", "sympy", "numba")
    return {
        "versions": {"bondgraph-workbench": __version__}
        | {name: version(name) for name in packages}
        | {"python": platform.python_version()},
        "training": [{"name": r.name, "sha256": r.sha256} for r in recordings],
        "held_out": [{"name": r.name, "sha256": r.sha256} for r in held_out],
        "horizon": str(final.horizon),
        "solver": str(final.problem.solver),
        "inputs": final.problem.hold.value,
        "materiality": options.rule.materiality,
    }
