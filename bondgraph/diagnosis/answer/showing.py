"""To show, not to choose: traces and the recovered law."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.drawn_laws import (
    curve_of,
    factor_at_place,
    law_curve,
    rival_curves,
    tells,
)
from bondgraph.diagnosis.probing import common_signal, recover
from bondgraph.diagnosis.records import RecoveredLaw, Trace
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.horizon import Windows
from bondgraph.fitting.long_runs import simulate_whole
from bondgraph.physics.hypothesis import Hypothesis, Shape
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.domains import Quantity
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import OneJunction
from bondgraph.structure.signals import f, parameter_symbol

Array = NDArray[np.float64]
CLOUD_POINTS = 200
FACTOR = "factor"
"""Read beside the local variables: what multiplies a curve."""


def traces(
    base: FittedModel, final: FittedModel, recordings: Sequence[BoundRecording]
) -> tuple[Trace, ...]:
    """Return every output of every recording: measured, before and after."""
    found = []
    model = base.problem.model
    for recording in recordings:
        before = simulate_whole(base, [recording])
        after = simulate_whole(final, [recording])
        for i, channel in enumerate(model.output_names):
            found.append(
                Trace(
                    recording=recording.name,
                    channel=channel,
                    unit=model.output_units[i],
                    time=before.time,
                    measured=before.measured[:, i],
                    before=before.outputs[:, i],
                    after=after.outputs[:, i],
                    steady=recording.steady,
                )
            )
    return tuple(found)


def recovered_law(
    base: FittedModel,
    candidate: Candidate,
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    others: Sequence[Candidate] = (),
) -> RecoveredLaw | None:
    """Return the recovered signal at the candidate's place against what it depends on.

    The signal is recovered with the *final* model's parameters and the candidate's
    element taken out again, so that the cloud shows the law and not the bias that its
    absence put into other parameters. None where the model has no time, or where the
    candidate replaced a law, so that nothing can be taken out again: of a curve that
    changes a law there is the curve alone. `others` at the same place are drawn beside
    it where they are insertions too.
    """
    hypothesis = candidate.hypothesis
    if hypothesis.shape is not None:
        return _curve_alone(hypothesis.place, hypothesis.shape, final)
    if base.problem.model.n_states == 0 or not hypothesis.depends_on:
        return None
    if not isinstance(hypothesis.edit, InsertElement):
        return None
    # What a later round took out again is only in the model of this one.
    values = {**base.values, **final.values}
    without = _at(base, values)
    factor = factor_at_place(hypothesis).subs(
        {parameter_symbol(name): value for name, value in values.items()}
    )
    signal = recover(
        without,
        hypothesis.place,
        recordings,
        _cloud_windows(recordings),
        {FACTOR: factor},
    )
    argument = (
        Quantity.DISPLACEMENT.value
        if "displacement" in hypothesis.depends_on
        else common_signal(_junction(base, hypothesis.place)).quantity.value
    )
    if argument not in signal.local:
        return None
    told = tells(signal.local[FACTOR])
    x = signal.local[argument][told]
    y = -signal.value[told] / signal.local[FACTOR][told]
    curve_x, curve_y = law_curve(final, candidate, argument)
    domain = base.graph.domain_at(hypothesis.place)
    name, unit = _given(base, hypothesis)
    return RecoveredLaw(
        place=hypothesis.place,
        argument_name=domain.word(Quantity(argument)),
        argument_unit=domain.unit(Quantity(argument)),
        value_name=name,
        value_unit=unit,
        argument=x,
        value=y,
        curve_argument=curve_x,
        curve_value=curve_y,
        others=rival_curves(final, others if factor == 1 else (), argument),
    )


def _curve_alone(place: str, shape: Shape, final: FittedModel) -> RecoveredLaw:
    """Return a curve that changes a law, over what it has gone through; no cloud."""
    x, y = curve_of(final, shape.argument, shape.value)
    return RecoveredLaw(
        place=place,
        argument_name=shape.argument_name,
        argument_unit=shape.argument_unit,
        value_name=shape.value_name,
        value_unit=shape.value_unit,
        argument=np.zeros(0),
        value=np.zeros(0),
        curve_argument=x,
        curve_value=y,
    )


def _at(fitted: FittedModel, values: Mapping[str, float]) -> FittedModel:
    """Return a model with other values of its parameters, not fitted again."""
    known = {name: values[name] for name in fitted.graph.parameters if name in values}
    start = np.array([values[name] for name in fitted.problem.model.parameter_names])
    return replace(
        fitted,
        graph=fitted.graph.with_parameters(known),
        problem=replace(fitted.problem, start=start),
        optimum=replace(fitted.optimum, theta=start[fitted.problem.free]),
    )


def _given(base: FittedModel, hypothesis: Hypothesis) -> tuple[str, str]:
    """Return what a law (or the curve that it multiplies) gives, and its unit."""
    domain = base.graph.domain_at(hypothesis.place)
    is_one = isinstance(_junction(base, hypothesis.place), OneJunction)
    answer = Quantity.EFFORT if is_one else Quantity.FLOW
    name, unit = domain.word(answer), domain.unit(answer)
    if hypothesis.factor == f:
        return f"{name} per {domain.flow}", f"({unit})/({domain.unit(Quantity.FLOW)})"
    return name, unit


def _junction(fitted: FittedModel, place: str):  # type: ignore[no-untyped-def]
    return next(j for j in fitted.graph.junctions if j.name == place)


def _cloud_windows(recordings: Sequence[BoundRecording]) -> Windows:
    samples = sum(len(recording) for recording in recordings) // CLOUD_POINTS
    return Windows(max(samples, 12))
