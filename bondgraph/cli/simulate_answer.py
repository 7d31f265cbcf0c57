"""What ``bondgraph simulate`` says: sentences, a table, and the same as JSON."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from bondgraph.cli.seen_noise import white_noise
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.state_equations import State
from bondgraph.fitting.simulate import Solution
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.names import join_header
from bondgraph.recordings.own_units import own_unit
from bondgraph.recordings.spread import spread
from bondgraph.reporting.diagnosis_json import json_value
from bondgraph.reporting.wording import (
    number_words,
    percent,
    relative_error,
    with_unit,
)
from bondgraph.simulation.energy_audit import EnergyAudit
from bondgraph.simulation.events import Event
from bondgraph.structure.domains import ANALOGUE, THERMAL
from bondgraph.structure.graph import FinishedGraph

LISTED_EVENTS = 8
"""More are counted by kind; all are in the JSON."""

LISTED_STATES = 8
"""Of more states it is not said where they begin."""

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


def found(
    solution: Solution, bound: BoundRecording, graph: FinishedGraph
) -> Iterator[str]:
    """Yield what came of it: errors, energy, events, and where it began."""
    yield from _errors(solution, bound, white_noise(bound))
    measure = "the standard deviation of what was measured"
    together = "Together that" if len(solution.output_names) > 1 else "That"
    yield f"{together} is {relative_error(solution.score, measure)}."
    # Pseudo bonds of heat carry no power, and analogue ones none that is in joules.
    if solution.audit.has_flowed and not set(graph.domains) <= {THERMAL, ANALOGUE}:
        yield _energy_words(solution.audit)
    yield _event_words(solution.events)
    yield from _begin_words(solution, derive(graph).states)


def advice(solution: Solution, bound: BoundRecording, *, whole: bool) -> Iterator[str]:
    """Yield what to do where a simulation of a whole recording is far off."""
    if whole and solution.score.nrmse > ASTRAY:
        yield FAR_OFF if bound.steady else STRETCHES


def _errors(
    solution: Solution, bound: BoundRecording, noise: Mapping[str, float]
) -> Iterator[str]:
    """Yield how far each output is from what was measured, also over its spread.

    Beside the white part of its noise, where that is known; in the recording's unit.
    """
    spreads = spread(solution.measured)
    for i, name in enumerate(solution.output_names):
        size = solution.score.rmse[name]
        times, unit = own_unit([bound], name, solution.output_units[i])
        rmse = f"{with_unit(number_words(size * times), unit)} rms"
        alone = len(solution.output_names) == 1 or name in solution.score.unchanging
        share = "" if alone else f", {percent(size / spreads[i])} of its spread"
        beside = ""
        if name in noise:
            own = with_unit(number_words(noise[name] * times, 2), unit)
            beside = f" (white noise {own})"
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


def _begin_words(solution: Solution, states: Sequence[State]) -> Iterator[str]:
    """Yield where the machine begins, as estimated; nothing of many states."""
    begun = _begun(solution)
    if begun and 0 < len(states) <= LISTED_STATES:
        told = (
            with_unit(
                f"{one.symbol} {number_words(begun[str(one.symbol)], 3)}", one.unit
            )
            for one in states
        )
        yield f"It begins, as estimated, with {', '.join(told)}."


def _begun(solution: Solution) -> dict[str, float]:
    """Return the states that a whole recording begins with; none of stretches."""
    if len(solution.runs) != 1:
        return {}
    (run,) = solution.runs
    return dict(zip(run.state_names, map(float, run.states[0]), strict=True))


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


def as_csv(solution: Solution) -> str:
    """Return time and, for each output, the measured and the simulated values."""
    headers, columns = [join_header("time", "s")], [solution.time]
    units = zip(solution.output_names, solution.output_units, strict=True)
    for i, (name, unit) in enumerate(units):
        headers += [join_header(name, unit), join_header(f"{name}_simulated", unit)]
        columns += [solution.measured[:, i], solution.simulated[:, i]]
    rows = (",".join(f"{x:.12g}" for x in row) for row in np.column_stack(columns))
    return "\n".join((",".join(headers), *rows)) + "\n"


def answer_json(solution: Solution) -> dict[str, Any]:
    """Return the answer as plain values."""
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
        "initial": {n: json_value(x) for n, x in _begun(solution).items()},
    }
