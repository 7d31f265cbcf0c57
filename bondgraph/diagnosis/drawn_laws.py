"""Laws as curves over the cloud of what is missing at a place, made comparable.

A law that was fitted instead of the chosen one came with parameters of its own: where
it is steeper, the model's viscous friction is less. Its curve is therefore shifted by
what the model's own elements at the place, local functions of the same variable, do
differently in its fit and in the final one. What then differs is the law.
"""

from collections.abc import Sequence

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.probing import common_signal, probe
from bondgraph.diagnosis.records import LawCurve
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.structure.domains import Quantity
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Junction,
    OneJunction,
    Resistance,
)
from bondgraph.structure.signals import Signal, f, flow, signals_in

Array = NDArray[np.float64]
CURVE_POINTS = 400
TELLS = 0.2
"""Of a factor's largest value, below which nothing is told of what it multiplies."""


def argument_of(candidate: Candidate) -> sympy.Expr | None:
    """Return what a curve without a name goes along; None for what is not known."""
    hypothesis = candidate.hypothesis
    if hypothesis.shape is not None:
        return hypothesis.shape.argument
    if len(hypothesis.depends_on) != 1:
        return None
    return _axes(candidate.fitted, candidate, hypothesis.depends_on[0])[0]


def law_curve(
    fitted: FittedModel, candidate: Candidate, quantity: str
) -> tuple[Array, Array]:
    """Return the law along the simulated motion of a fitted model, sorted.

    Of a law that multiplies a curve the curve, where its factor is not too small.

    Parameters
    ----------
    quantity
        What is on the abscissa: the variable common at the place, or displacement.
    """
    own, answer = _axes(fitted, candidate, quantity)
    factor = factor_at_place(candidate.hypothesis)
    read = probe(fitted, (own, answer, factor))
    told = tells(read[factor])
    x, y = read[own][told], read[answer][told] / read[factor][told]
    order = _thinned(x)
    return x[order], _sign(fitted, candidate) * y[order]


def curve_of(
    fitted: FittedModel, argument: sympy.Expr, value: sympy.Expr
) -> tuple[Array, Array]:
    """Return an expression over another along the simulated motion, sorted."""
    read = probe(fitted, (argument, value))
    order = _thinned(read[argument])
    return read[argument][order], read[value][order]


def factor_at_place(hypothesis: Hypothesis) -> sympy.Expr:
    """Return what multiplies the curve of a law, in the signals of its place."""
    return hypothesis.factor.xreplace({f: flow(hypothesis.place)})


def tells(factor: Array) -> NDArray[np.bool_]:
    """Return where a factor is so large that what it multiplies can be told."""
    large: NDArray[np.bool_] = np.abs(factor) >= TELLS * np.nanmax(np.abs(factor))
    return large


def rival_curves(
    final: FittedModel, others: Sequence[Candidate], quantity: str
) -> tuple[LawCurve, ...]:
    """Return the curves of other insertions at one place, beside the final model's."""
    return tuple(
        _rival(final, other, quantity)
        for other in others
        if isinstance(other.hypothesis.edit, InsertElement)
        and other.hypothesis.factor == 1
    )


def _rival(final: FittedModel, other: Candidate, quantity: str) -> LawCurve:
    own, answer = _axes(other.fitted, other, quantity)
    beside = [
        Signal(answer.quantity, name)
        for name in _local_elements(final, other.hypothesis.place, own)
        if name != other.hypothesis.element and name in other.fitted.graph.by_name
    ]
    here, there = (
        probe(other.fitted, (own, answer, *beside)),
        probe(final, (own, *beside)),
    )
    order, ahead = _thinned(here[own]), np.argsort(there[own])
    x = here[own][order]
    value = _sign(other.fitted, other) * here[answer][order]
    for signal in beside:
        instead = np.interp(x, there[own][ahead], there[signal][ahead])
        value = value + here[signal][order] - instead
    return LawCurve(physics=other.told.physics, argument=x, value=value)


def _axes(
    fitted: FittedModel, candidate: Candidate, quantity: str
) -> tuple[Signal, Signal]:
    """Return what the law reads, and what it gives."""
    place = candidate.hypothesis.place
    junction = fitted.graph.node(place)
    assert isinstance(junction, Junction)
    displaced = quantity == Quantity.DISPLACEMENT.value
    own = Signal(Quantity.DISPLACEMENT, place) if displaced else common_signal(junction)
    is_one = isinstance(junction, OneJunction)
    answer = Quantity.EFFORT if is_one else Quantity.FLOW
    return own, Signal(answer, candidate.hypothesis.element)


def _local_elements(final: FittedModel, place: str, own: Signal) -> list[str]:
    """Return the model's elements at a place that depend on nothing but `own`."""
    displaced = own.quantity is Quantity.DISPLACEMENT
    kind = Compliance if displaced else Resistance
    around = (bond.other(place) for bond in final.graph.bonds_at(place))
    return [
        name
        for name in around
        if isinstance(element := final.graph.node(name), kind)
        and (element.law is None or not signals_in(element.law))
    ]


def _sign(fitted: FittedModel, candidate: Candidate) -> float:
    """Return -1 for a source, which counts what it gives, and 1 for what takes."""
    element = fitted.graph.node(candidate.hypothesis.element)
    return -1.0 if isinstance(element, EffortSource | FlowSource) else 1.0


def _thinned(values: Array) -> NDArray[np.intp]:
    order = np.argsort(values)
    return order[:: max(len(order) // CURVE_POINTS, 1)]
