"""Families of functions that a residual may follow: laws at every place, and sensors.

A law of what is local at a place acts through the model: its columns are responses of
the outputs to a virtual source there. Besides, each sensor may read a function of every
input and state.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.location.laws import curve_columns, laws_of
from bondgraph.diagnosis.location.locals import Probes, local_variables
from bondgraph.diagnosis.location.regression import law_responses
from bondgraph.diagnosis.virtual.chain import Chain
from bondgraph.fitting.estimate import FittedModel
from bondgraph.structure.domains import ROTATION

Array = NDArray[np.float64]
FEW = 200
"""With fewer rows than this a curve has fewer knots."""
COARSE = (0.0, 0.5, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class Family:
    """Columns (n, ny, m) with the words for them."""

    place: str
    form: str
    variable: str
    columns: Array


def families(fitted: FittedModel, chain: Chain) -> Iterator[Family]:
    """Yield every family, one at a time: together they may be large."""
    quantiles = COARSE if len(chain.states) < FEW else None
    signals = Probes(fitted, chain.sources).read(
        chain.shots, fitted.optimum.theta, chain.states
    )
    for i, source in enumerate(chain.sources):
        graph = fitted.graph
        rotating = source.at_junction and graph.domain_at(source.place) == ROTATION
        variables = local_variables(fitted, chain, source, signals)
        laws = laws_of(
            variables,
            chain.shots.time,
            chain.follows,
            rotating=rotating,
            quantiles=quantiles,
        )
        for law in laws:
            columns = law_responses(chain, i, law.columns)
            yield Family(source.place, law.form, law.variable.name, columns)
    yield from _read_by_sensors(fitted, chain, quantiles)


def _read_by_sensors(
    fitted: FittedModel, chain: Chain, quantiles: tuple[float, ...] | None
) -> Iterator[Family]:
    """Yield functions of inputs and states, added to each output."""
    model = fitted.problem.model
    read = [
        *zip(model.input_names, chain.shots.inputs.T, strict=True),
        *zip(model.state_names, chain.states.T, strict=True),
    ]
    n, ny, _ = chain.read.shape
    for name, values in read:
        if not np.isfinite(values).all() or np.ptp(values) == 0.0:
            continue
        curve = curve_columns(values, quantiles)
        for j, output in enumerate(model.output_names):
            columns = np.zeros((n, ny, curve.shape[1]))
            columns[:, j] = curve
            yield Family(output, "a function of", name, columns)
