"""What ``bondgraph fit`` says: sentences, and the same as JSON."""

from collections.abc import Iterator, Mapping, Sequence

from bondgraph.fitting.certainty.identifiability import (
    IdentifiabilityStatus,
    identifiability,
)
from bondgraph.fitting.certainty.profile import Profile
from bondgraph.fitting.certainty.solver_error import SolverError, SolverErrorStatus
from bondgraph.fitting.natural_bounds import gone_words
from bondgraph.fitting.result import FitResult, Score
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.commands import go_in_steps
from bondgraph.recordings.own_units import own_unit
from bondgraph.reporting.diagnosis_json import json_value
from bondgraph.reporting.model_text import to_python
from bondgraph.reporting.tables import INTERVAL
from bondgraph.reporting.wording import (
    number_words,
    relative_error,
    unit_words,
    with_unit,
)
from bondgraph.simulation.solvers import Hold
from bondgraph.structure.graph import FinishedGraph

ADDS_UP = 3.0
"""Times the error over windows, from which the one over whole recordings is another."""

FAR_REACHING = 4.0
"""Standard deviations: 95 of 100 are within two, with many independent samples."""

UNMOVED = 0.01
"""Of a standard deviation: what has moved by less has not moved."""


def intervals(result: FitResult) -> Iterator[str]:
    """Yield the intervals that are known, one a line, where there are any."""
    known = [(one, one.interval) for one in result.estimates if one.interval]
    if known:
        yield f"{INTERVAL}s"
    for one, interval in known:
        low, high = (number_words(end, 5) for end in interval)
        yield f"  {one.name}: {low} to {high} {unit_words(one.unit)}".rstrip()


def known(
    result: FitResult,
    whole: Score | None,
    graph: FinishedGraph,
    bound: Sequence[BoundRecording],
) -> Iterator[str]:
    """Yield what the fit knows: errors, and what it cannot tell."""
    units = {m.name: own_unit(bound, m.name, m.unit) for m in graph.measurements}
    if result.window is None:
        yield _score_words("over whole recordings", result.score, units)
    else:
        windows = f"over windows of {number_words(result.window, 3)} s"
        yield _score_words(windows, result.score, units)
        if whole is not None:
            yield _score_words("over whole recordings", whole, units)
            if whole.nrmse > ADDS_UP * result.score.nrmse:
                yield (
                    "Windows begin anew at what was measured: what adds up over longer "
                    "shows in whole recordings only. Mind the error over those; "
                    "--window whole fits to them."
                )
    yield from dict.fromkeys(note for one in bound for note in one.notes)
    yield from _pulled(result, graph)
    yield from _at_bounds(result)
    yield from _reaching_far(result)
    for name, phi in result.correlation.items():
        yield f"Noise of {name}: neighbouring samples correlate by {phi:.3f}."
    for sentence in result.unidentifiable:
        yield f"Not identifiable from these recordings: {sentence}."
    if result.unidentifiable:
        found = identifiability(graph, bound).status
        # The channels tell what these values of the parameters hide.
        if found is not IdentifiabilityStatus.IDENTIFIABLE:
            yield found.value
    for sentence in result.barely_known:
        yield f"Hardly {sentence}."
    error = result.solver_error
    if error is not None and error.status is not SolverErrorStatus.FINE:
        yield error.status.value


def hold_words(
    hold: Hold, recordings: Sequence[BoundRecording], where: str = ""
) -> str:
    """Return what inputs were taken to do between samples, and why.

    `where` says of what it is true that it fits better.
    """
    held = hold is Hold.ZERO
    option = "--hold zero" if held else "--hold first"
    alike = (
        "as they mostly stay the same from one sample to the next"
        if held
        else "as they change from sample to sample"
    )
    if any(go_in_steps([one]) is not held for one in recordings):
        alike += ", all recordings taken together"
    better = f"as that fits better {where}".rstrip()
    why = alike if held is go_in_steps(recordings) else better
    return f"Inputs are taken to be {hold.value} between samples, {why} ({option})."


def profile_words(one: Profile) -> str:
    """Return a profile in one line, an open end as such."""
    low, high = (
        "open" if end is None else number_words(end, 5) for end in one.interval
    )
    ends = f"{low} to {high} {unit_words(one.unit)}".rstrip()
    return f"Profile of {one.name}: {ends}. {one.status.value}"


def _pulled(result: FitResult, graph: FinishedGraph) -> Iterator[str]:
    """Yield how far what the model states with a std ended from what it states."""
    ended = [
        (one.name, one.away_from(graph.parameters[one.name]))
        for one in result.estimates
    ]
    told = [
        f"{name} {number_words(abs(away), 2) if abs(away) >= UNMOVED else 0}"
        for name, away in ended
        if away is not None
    ]
    if told:
        yield f"Stated with a std, and how many of it away: {', '.join(told)}."


def _reaching_far(result: FitResult) -> Iterator[str]:
    """Yield why 95 % intervals are so much wider than standard deviations, if so."""
    reaches = [
        max(one.interval[1] - one.value, one.value - one.interval[0]) / one.std
        for one in result.estimates
        if one.interval and one.std
    ]
    if max(reaches, default=0.0) > FAR_REACHING:
        yield (
            "The 95 % intervals reach as far as "
            f"{number_words(max(reaches), 2)} standard deviations: "
            "neighbouring samples are left so alike that they tell the numbers like a "
            "few independent ones."
        )


def _at_bounds(result: FitResult) -> Iterator[str]:
    """Yield the parameters that ended where the model lets them go no further."""
    yield from gone_words(result.model, result.estimates)
    for one in result.estimates:
        low, high = result.model.parameters[one.name].bounds
        # A loss that has come down to none is an answer.
        if one.value == high or (one.value == low and low != 0.0):
            bound = with_unit(number_words(one.value), one.unit)
            yield (
                f"{one.name} ended at its bound of {bound}: give it a wider one, or "
                "the model has not what the machine has."
            )


def _score_words(
    stretch: str, score: Score, units: Mapping[str, tuple[float, str]]
) -> str:
    channels = ", ".join(
        with_unit(f"{name} {number_words(rmse * times, 3)}", unit)
        for name, rmse in score.rmse.items()
        for times, unit in (units[name],)
    )
    share = relative_error(score, "the measured spread")
    return f"Error {stretch}: {share} ({channels} rms)."


def answer_json(
    result: FitResult,
    whole: Score | None,
    profiles: Sequence[Profile],
    *,
    hold: Hold,
) -> dict[str, object]:
    """Return the answer as plain values; `whole` is None where it fits no windows."""
    return {
        "schema": 1,
        "status": result.status.name.lower(),
        "sentence": result.status.value,
        "parameters": {
            e.name: {
                "value": json_value(e.value),
                "std": json_value(e.std),
                "interval": None if e.interval is None else list(e.interval),
                "unit": e.unit,
                "start": json_value(e.start),
            }
            for e in result.estimates
        },
        "nrmse": json_value(result.score.nrmse),
        "rmse": json_value(result.score.rmse),
        "whole_nrmse": None if whole is None else json_value(whole.nrmse),
        "whole_rmse": None if whole is None else json_value(whole.rmse),
        "unidentifiable": list(result.unidentifiable),
        "barely_known": list(result.barely_known),
        "noise_correlation": dict(result.correlation),
        "solver_error": _plain_solver_error(result.solver_error),
        "profiles": {
            one.name: {
                "status": one.status.name.lower(),
                "sentence": one.status.value,
                "interval": list(one.interval),
                "values": list(one.values),
                "rise": list(one.rise),
                "threshold": one.threshold,
            }
            for one in profiles
        },
        "iterations": result.iterations,
        "window": json_value(result.window),
        "inputs": hold.value,
        "model": to_python(result.model),
    }


def _plain_solver_error(error: SolverError | None) -> dict[str, object] | None:
    if error is None:
        return None
    return {
        "status": error.status.name.lower(),
        "sentence": error.status.value,
        "rmse": json_value(error.rmse),
        "shift": json_value(error.shift),
    }
