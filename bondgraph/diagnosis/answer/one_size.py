"""One size: where all steps are alike, what bends and what lags look the same.

A linear machine answers a step twice as large with twice as much. Where every step, or
every decay, has one size, each value is passed in one way only: a loss that grows with
the temperature, a second store that lags behind, and whatever changes meanwhile draw
the same curve. A law that bends is half as sure there, but where it is what models of
its domain leave out most; and so is what was found beside it later.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.diagnosis.answer.at_jumps import jumps_in
from bondgraph.diagnosis.answer.doubt import less_probable
from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.drawn_laws import argument_of
from bondgraph.diagnosis.evidence.judged import TYPICAL
from bondgraph.diagnosis.probing import probe
from bondgraph.diagnosis.records import Finding
from bondgraph.diagnosis.search.round_found import Round, made_in
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.actuation import Saturation
from bondgraph.physics.hysteresis import DahlHysteresis
from bondgraph.structure.signals import e, f, p, q, signals_in

Array = NDArray[np.float64]

STILL = 0.02
"""Of all that an input goes through: it moves by no more between two steps."""

ONCE = 1.5
"""Who travels less than so many times his range comes hardly anywhere twice."""

COUNTS = 0.3
"""A step that moves an output by less than this share of the largest was cut short."""

ALIKE = 1.2
"""Steps of which the largest is no larger than so many times the smallest are alike."""

LEFT = 0.5
"""What is left of a probability: a judgement. Of eight laws that bend, told with 55 and
more of recordings of strangers that hold one size of step, one was right, two were half
right and five wrong.
"""

BEND = frozenset({Saturation.word, DahlHysteresis.word, CURVE})
"""Laws that bend in what their states do, or by what they are."""

AS_WELL = (
    " Each value is passed in one way only in these recordings: what changes with "
    "time, or a store or a lag that is not in the model, would look the same. Steps or "
    "decays of several sizes would tell."
)

BESIDE = " Nor do they tell this from what changes with time."
"""Of what was found beside such a law: the reason stands there."""


def doubted_in_one_size(
    findings: Sequence[Finding], rounds: Sequence[Round]
) -> list[Finding]:
    """Return the findings, those that bend half as sure where all steps are alike.

    Parameters
    ----------
    rounds
        In which they were found, one each, and others.
    """
    made = [one.candidate for one in made_in(rounds)]
    alike = bool(made) and all_alike(made[-1].fitted)
    told: list[Finding] = []
    doubted = False
    for finding, one in zip(findings, made, strict=True):
        before = doubted and alike
        own = _is_doubted(one, finding, alike=alike)
        if own or before:
            told.append(less_probable(finding, LEFT, BESIDE if doubted else AS_WELL))
        else:
            told.append(finding)
        doubted = doubted or own
    return told


def _is_doubted(candidate: Candidate, finding: Finding, *, alike: bool) -> bool:
    typical = finding.physics in TYPICAL.get(finding.domain, frozenset())
    return (alike and not typical and bends(candidate)) or passes_once(candidate)


def bends(candidate: Candidate) -> bool:
    """Return whether a law is no linear one of the signals that it reads."""
    told = candidate.told
    if told.physics in BEND:
        return True
    read = [*signals_in(told.law), *({e, f, p, q} & told.law.free_symbols)]
    return any(sympy.diff(told.law, one, other) != 0 for one in read for other in read)


def passes_once(candidate: Candidate) -> bool:
    """Return whether a curve goes along something that comes to no value twice."""
    shots = candidate.fitted.problem.shots
    if candidate.hypothesis.physics != CURVE or shots.timeless:
        return False
    argument = argument_of(candidate)
    if argument is None:
        return False
    along = probe(candidate.fitted, (argument,))[argument]
    parts = [along[a:b] for a, b in pairwise(shots.edges)]
    return sum(map(_way, parts)) < ONCE * _range(along)


def all_alike(fitted: FittedModel) -> bool:
    """Return whether all steps and decays of the recordings have one size.

    Each output goes one way from one step of the inputs to the next, and so far each
    time. Inputs that move otherwise, and tables, are of many sizes.
    """
    shots = fitted.problem.shots
    steps = None if shots.timeless else _steps(shots.time, shots.inputs)
    if steps is None:
        return False
    simulated = shots.outputs - fitted.residuals()
    return all(_is_alike([one[part] for part in steps]) for one in simulated.T)


def _steps(time: Array, inputs: Array) -> list[slice] | None:
    """Return where the inputs stand still; None where they move otherwise.

    A decay with a hole in it is one.
    """
    another = np.diff(time) <= 0.0  # Another recording begins.
    cuts = np.flatnonzero(another | jumps_in(inputs)[1:]) + 1
    steps = [slice(a, b) for a, b in pairwise([0, *cuts.tolist(), len(time)])]
    most = STILL * np.ptp(inputs, axis=0)
    still = all((np.ptp(inputs[step], axis=0) <= most).all() for step in steps)
    return steps if still else None


def _is_alike(steps: Sequence[Array]) -> bool:
    """Return whether an output goes one way in each step, and so far in all."""
    least = COUNTS * max(map(_range, steps))
    counted = [step for step in steps if _range(step) >= least]
    sizes = [_range(step) for step in counted]
    one_way = all(
        _way(step) <= ONCE * size for step, size in zip(counted, sizes, strict=True)
    )
    return one_way and max(sizes) <= ALIKE * min(sizes)


def _range(values: Array) -> float:
    seen = values[np.isfinite(values)]
    return float(np.ptp(seen)) if seen.size else 0.0


def _way(values: Array) -> float:
    return float(np.nansum(np.abs(np.diff(values))))
