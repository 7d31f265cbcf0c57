"""One by one: a number of the machine that is another one in every recording.

A second load, the oil of another day, a bearing that was changed in between: each
recording is explained by itself, and no law that is the same in all of them explains
them together.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.answer.wording import listed
from bondgraph.fitting.estimate import FittedModel, fit_model
from bondgraph.fitting.settings import FitSettings
from bondgraph.recordings.binding import BoundRecording

MUCH = 0.5
"""Of its squared error beyond noise a model leaves, or there is nothing to explain."""

LEFT = 0.1
"""What explains a difference leaves no more than this share of it."""

Floor = Mapping[str, float]


def differs_between(
    base: FittedModel, recordings: Sequence[BoundRecording], floor: Floor
) -> str:
    """Return that the recordings differ, and in which number; empty where they do not.

    Parameters
    ----------
    base
        The model as fitted to all recordings together.
    floor
        The noise of each output.
    """
    if len(recordings) < 2 or any(one.steady for one in recordings):
        return ""
    together, all_of_it = _beyond(base, base, floor), _squared(base, base)
    if not together > MUCH * all_of_it:
        return ""
    alone = [_fitted_alone(base, one) for one in recordings]
    if not sum(_beyond(one, base, floor) for one in alone) < LEFT * together:
        return ""
    told = (
        "By itself each recording is explained, and all together are not: something "
        "of the machine was another one from recording to recording."
    )
    for number, fitted in enumerate(alone):
        others = [one for one in recordings if one is not recordings[number]]
        allowed = LEFT * together - _beyond(fitted, base, floor)
        needs = list(_one_number(fitted, base, others, floor, allowed))
        if needs:
            return f"{told} {_in_words(needs, recordings[number].name)}"
    return f"{told} No single number of the model does it, if all else stays."


def _fitted_alone(base: FittedModel, recording: BoundRecording) -> FittedModel:
    graph = base.graph.with_parameters(base.values)
    return fit_model(graph, [recording], _as_before(base))


def _as_before(base: FittedModel) -> FitSettings:
    """Return settings by which a fit is made as that of all recordings was."""
    problem = base.problem
    return replace(
        base.settings, horizon=base.horizon, solver=problem.solver, hold=problem.hold
    )


def _one_number(
    fitted: FittedModel,
    base: FittedModel,
    others: Sequence[BoundRecording],
    floor: Floor,
    allowed: float,
) -> Iterator[tuple[str, dict[str, tuple[float, float]]]]:
    """Yield numbers any one of which makes up for what differs.

    Each with the name of the number, and for every other recording the value that it
    needs there in place of the one in the recording that was fitted alone.

    Parameters
    ----------
    fitted
        To one recording alone.
    allowed
        What the other recordings may leave beyond noise.
    """
    known = fitted.graph.with_parameters(fitted.values).parameters
    for free in fitted.problem.free_names:
        held = [p if p.name == free else replace(p, std=0.0) for p in known.values()]
        graph = fitted.graph.with_parameters(held)
        left, needs = 0.0, {}
        for one in others:
            there = fit_model(graph, [one], _as_before(base))
            left += _beyond(there, base, floor)
            needs[one.name] = there.values[free], fitted.values[free]
            if not left <= allowed:
                break
        else:
            yield free, needs


def _in_words(
    needs: Sequence[tuple[str, dict[str, tuple[float, float]]]], alone: str
) -> str:
    """Return which recording needs which number, where all else is as in one."""
    first = needs[0][1]
    told = []
    for name in first:
        ways = [
            f"{number} = {there[name][0]:.4g} in place of {there[name][1]:.4g}"
            for number, there in needs
        ]
        told.append(f"{name} needs {listed(ways)}")
    return f"If all else is as in {alone}, {'; '.join(told)}."


def _beyond(fitted: FittedModel, base: FittedModel, floor: Floor) -> float:
    """Return the squared error beyond noise, each output by its own scale."""
    names = fitted.problem.model.output_names
    noise = np.array([floor[name] for name in names]) ** 2
    squares = fitted.residuals() ** 2
    count = np.count_nonzero(np.isfinite(squares), axis=0)
    beyond = np.maximum(np.nansum(squares, axis=0) - count * noise, 0.0)
    return float(np.sum(beyond / base.problem.sigma**2))


def _squared(fitted: FittedModel, base: FittedModel) -> float:
    """Return the whole squared error, each output by its own scale."""
    squares = np.nansum(fitted.residuals() ** 2, axis=0)
    return float(np.sum(squares / base.problem.sigma**2))
