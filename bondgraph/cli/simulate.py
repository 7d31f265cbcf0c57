"""``bondgraph simulate``: a model beside a recording."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

import click
import numpy as np

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.fit_answer import hold_words
from bondgraph.cli.fit_options import fit_options, substeps_option
from bondgraph.cli.inputs import (
    model_argument,
    read_model,
    read_recordings,
    recording_argument,
)
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.reading_options import Reading, recording_options
from bondgraph.cli.session import Session
from bondgraph.errors import FitError
from bondgraph.fitting.either_hold import simulated_either_way
from bondgraph.fitting.estimate import FitSettings
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.fitting.simulate import Solution, SolveStatus, simulate
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.misreadings import without_misreadings
from bondgraph.recordings.names import join_header
from bondgraph.recordings.noise import estimate_noise
from bondgraph.recordings.spread import spread
from bondgraph.reporting.diagnosis_json import json_value
from bondgraph.reporting.wording import (
    number_words,
    percent,
    relative_error,
    unit_words,
)
from bondgraph.simulation.energy_audit import EnergyAudit
from bondgraph.simulation.events import Event
from bondgraph.structure.domains import ANALOGUE, THERMAL

LISTED_EVENTS = 8
"""More are counted by kind; all are in the JSON."""

ASTRAY = 1.0
"""Standard deviations: the mean of what was measured is not further away."""

STRETCHES = (
    "Over the whole recording the simulation goes astray. Values may be far off: "
    "'bondgraph fit' fits them. The model may lack something: 'bondgraph diagnose' "
    "looks for it. Or the machine is unstable or drifts: then --window SECONDS "
    "compares stretches, each from a state of its own."
)

FAR_OFF = (
    "That is no nearer than the mean of what was measured: values are far off, which "
    "'bondgraph fit' mends, or the model lacks something, which 'bondgraph diagnose' "
    "looks for."
)


@click.command(
    "simulate",
    cls=Command,
    examples=(
        ("simulate axis.py run.csv", "How far the model is from the recording"),
        ("simulate axis.py run.csv --set mass=95 -o both.csv", "Another value, kept"),
        ("simulate axis.py run.mat --map 'x=qm[m]'", "Channels with other names"),
    ),
)
@model_argument
@recording_argument("recording")
@click.option(
    "-o",
    "--output",
    metavar="FILE",
    type=OutputFile(),
    help="Write measured and simulated.",
)
@fit_options(window="whole")
@substeps_option
@recording_options
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    recording: str,
    output: str | None,
    settings: FitSettings,
    either_hold: bool,
    reading: Reading,
    json_file: str | None,
) -> None:
    """Drive MODEL with the inputs of the recording REC and compare its outputs.

    The initial state is estimated from the recording; no parameter is changed.
    """
    session.answers_in(json_file)
    graph = read_model(model, values)
    read = without_misreadings(read_recordings([recording], graph, reading))
    (bound,) = read.recordings
    hold = None
    with session.progress(loops=True) as progress:
        progress(f"simulating {bound.name}")
        if either_hold:
            solution, hold = simulated_either_way(graph, bound, settings)
        else:
            solution = simulate(graph, bound, settings=settings)
    if solution.status is SolveStatus.FAILED:
        raise _failed(graph.name, bound, solution)
    noise = _noise(bound)
    for line in _errors(solution, noise):
        session.say(line)
    spread = "the standard deviation of what was measured"
    together = "Together that" if len(solution.output_names) > 1 else "That"
    session.say(f"{together} is {relative_error(solution.score, spread)}.")
    whole = isinstance(settings.horizon, WholeRecordings)
    if whole and solution.score.nrmse > ASTRAY:
        session.hint(FAR_OFF if bound.steady else STRETCHES)
    # Pseudo bonds of heat carry no power, and analogue ones none that is in joules.
    if solution.audit.has_flowed and not set(graph.domains) <= {THERMAL, ANALOGUE}:
        session.say(_energy_words(solution.audit))
    session.say(_event_words(solution.events))
    for note in read.notes:  # What is left out of a recording is said in any case.
        session.say(note)
    held = [] if hold is None else [hold_words(hold, [bound], "with these values")]
    for hint in (*bound.notes, *held):
        session.hint(hint)
    if solution.reason:  # of a run with accounts, where the one without them went on
        session.say(solution.reason)
    if output is not None:
        session.write(output, _csv(solution))
    session.deliver(json_file, _plain(solution))


def _failed(model: str, bound: BoundRecording, solution: Solution) -> FitError:
    """Return where a simulation stopped; of a table which rows have no solution."""
    if not bound.steady:
        return FitError(
            f"The simulation of {model!r} along {bound.name!r} does not stay "
            f"finite. {solution.reason}".rstrip(),
            (model, bound.name),
            "Simulate shorter stretches with --window SECONDS.",
        )
    missing = np.isfinite(solution.measured) & ~np.isfinite(solution.simulated)
    rows = np.flatnonzero(missing.any(axis=1))
    verb = "has" if rows.size == 1 else "have"
    return FitError(
        f"{rows.size} of the {len(missing)} rows of {solution.recording!r} {verb} no "
        f"solution with {model!r}: the first is row {rows[0]}, counted from 0.",
        (model, solution.recording),
        "Look whether a law falls there where it should rise, or leave such rows out.",
    )


def _noise(bound: BoundRecording) -> dict[str, float]:
    """Return the noise of each output that is seen to be white: of others none is."""
    if bound.steady:
        return {}
    columns = zip(bound.output_names, bound.outputs.T, strict=True)
    seen = (
        (n, estimate_noise(bound.time, x)) for n, x in columns if np.isfinite(x).any()
    )
    return {name: one.std for name, one in seen if one.white and one.std > 0.0}


def _errors(solution: Solution, noise: Mapping[str, float]) -> Iterator[str]:
    """Yield how far each output is from what was measured, also over its spread.

    Beside the white part of its noise, where that is known.
    """
    spreads = spread(solution.measured)
    for i, name in enumerate(solution.output_names):
        size = solution.score.rmse[name]
        unit = unit_words(solution.output_units[i])
        rmse = f"{number_words(size)} {unit} rms"
        alone = len(solution.output_names) == 1 or name in solution.score.unchanging
        share = "" if alone else f", {percent(size / spreads[i])} of its spread"
        own = number_words(noise[name], 2) if name in noise else ""
        beside = f" (white noise {own} {unit})" if own else ""
        yield f"{name}: simulated minus measured {rmse}{share}{beside}"


def _energy_words(audit: EnergyAudit) -> str:
    """Return where the energy went, in a sentence."""
    parts = [("supplied", audit.supplied), ("exchanged", audit.exchanged)]
    came = [f"{number_words(x)} J {what}" for what, x in parts if x or what[0] == "s"]
    gone = f"{number_words(audit.dissipated)} J dissipated"
    kept = f"{number_words(audit.stored)} J more stored"
    balance = (
        "an exchange has no formula, so the balance cannot be checked"
        if math.isnan(audit.relative)
        else f"the balance closes to {number_words(audit.relative, 2)} of what flowed"
    )
    return f"Energy: {', '.join([*came, gone, kept])}; {balance}."


def _event_words(events: tuple[Event, ...]) -> str:
    """Return the events: each while they are few, else how many of each kind."""
    if len(events) > LISTED_EVENTS:
        kinds: dict[str, Counter[str]] = {}
        for event in events:
            kinds.setdefault(event.place, Counter())[event.kind.value] += 1
        told = [
            f"{place} ({', '.join(f'{kind} {n} times' for kind, n in counts.items())})"
            for place, counts in kinds.items()
        ]
    else:
        told = [f"{e.place} {e.kind.value} at {e.time:.4g} s" for e in events]
    return f"Events: {', '.join(told) or 'none'}."


def _csv(solution: Solution) -> str:
    """Return time and, for each output, the measured and the simulated values."""
    headers, columns = [join_header("time", "s")], [solution.time]
    units = zip(solution.output_names, solution.output_units, strict=True)
    for i, (name, unit) in enumerate(units):
        headers += [join_header(name, unit), join_header(f"{name}_simulated", unit)]
        columns += [solution.measured[:, i], solution.simulated[:, i]]
    rows = (",".join(f"{x:.12g}" for x in row) for row in np.column_stack(columns))
    return "\n".join((",".join(headers), *rows)) + "\n"


def _plain(solution: Solution) -> dict[str, Any]:
    return {
        "schema": 1,
        "recording": solution.recording,
        "status": solution.status.name.lower(),
        "nrmse": json_value(solution.score.nrmse),
        "rmse": json_value(solution.score.rmse),
        "reason": solution.reason,
        "energy": {
            name: json_value(value) for name, value in asdict(solution.audit).items()
        },
        "events": [
            {"time": json_value(e.time), "place": e.place, "kind": e.kind.name.lower()}
            for e in solution.events
        ],
        "units": dict(zip(solution.output_names, solution.output_units, strict=True)),
    }
