"""Growth within a step: what steps should follow, and implicit ones calm instead.

A motion that grows tenfold within one step is not followed by the next: an implicit
method damps it, as it damps what decays fast, and ends with a quiet answer to a machine
that runs away. Whoever passes such growth for a moment leaves it at once; so it is told
where both ends of a step are in it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import EquationError
from bondgraph.numeric.dynamics import Dynamics
from bondgraph.numeric.model import NumericModel, evaluate
from bondgraph.simulation.inputs import Inputs
from bondgraph.simulation.trouble import RunStatus, Trouble

Array = NDArray[np.float64]

STEPS_LOOKED_AT = 16
MANY_TIMES = 10.0
NOISE = 1e-8
"""A rate that is smaller than this share of the largest may be rounding."""


@dataclass(frozen=True, slots=True)
class Growth:
    """The fastest growth at an instant: its rate in 1/s, and the state it shows in."""

    rate: float
    state: str


def growth_not_followed(
    model: NumericModel,
    parameters: Array,
    inputs: Inputs,
    states: Array,
    *,
    substeps: int,
    own: Sequence[str],
) -> Trouble | None:
    """Return the first step, of some that are looked at, whose growth is not followed.

    Parameters
    ----------
    states
        ``[sample, state]``, finite.
    substeps
        Steps from one sample to the next.
    own
        The model's own states, the first of all: what follows them keeps accounts.

    Returns
    -------
    trouble
        None where no motion grows tenfold within a step, and where the equations cannot
        be solved again at a state.
    """
    count = len(states)
    if count < 2 or not own:
        return None
    looking = _Looking(model, parameters, inputs, states, tuple(own))
    steps = np.diff(inputs.time[:count]) / substeps
    chosen = np.unique(np.linspace(0, count - 2, STEPS_LOOKED_AT).astype(int))
    for row in map(int, chosen):
        here = looking.at(row)
        if here is None or not _too_fast(here, steps[row]):
            continue
        after = looking.at(row + 1)
        if after is not None and _too_fast(after, steps[row]):
            return Trouble(
                status=RunStatus.GROWTH_NOT_FOLLOWED,
                time=float(inputs.time[row]),
                unknown=f"{here.state} grows e-fold in {1.0 / here.rate:.2g} s, and a "
                f"step takes {steps[row]:.2g} s",
            )
    return None


def _too_fast(growth: Growth, step: float) -> bool:
    return growth.rate * step > math.log(MANY_TIMES)


class _Looking:
    """A run that is looked at again, sample by sample."""

    def __init__(
        self,
        model: NumericModel,
        parameters: Array,
        inputs: Inputs,
        states: Array,
        own: tuple[str, ...],
    ) -> None:
        self.model, self.parameters, self.own = model, parameters, own
        self.inputs, self.states = inputs, states
        self.dynamics = Dynamics(model, parameters)

    def at(self, row: int) -> Growth | None:
        """Return the fastest growth at a sample, None where there is none."""
        matrix = self._state_matrix(row)
        if matrix is None or not np.isfinite(matrix).all():
            return None
        values, vectors = np.linalg.eig(matrix)
        fastest = int(np.argmax(values.real))
        rate = float(values[fastest].real)
        if rate <= NOISE * float(np.abs(values).max()):
            return None
        return Growth(rate, self.own[int(np.argmax(np.abs(vectors[:, fastest])))])

    def _state_matrix(self, row: int) -> Array | None:
        """Return dẋ/dx of the own states, None where ẋ or z is not found."""
        model, time = self.model, float(self.inputs.time[row])
        u, du = self.inputs.between(row)(time)
        x, z = self.states[row], np.zeros(model.n_unknowns)
        try:
            rates, z = self.dynamics.settle(time, x, z, u, du)
        except EquationError:
            return None
        point = np.concatenate([x, rates, z, u, du, self.parameters, [time]])
        nx, nw = model.n_states, model.n_states + model.n_unknowns
        along = np.eye(model.dynamics.n_variables)[:, : nx + nw]
        _, slopes = evaluate(model.dynamics, point, along)
        by_state, by_unknown = slopes[:, :nx], slopes[:, nx:].copy()
        by_unknown[:nx] -= np.eye(nx, nw)
        if not np.isfinite(slopes).all():
            return None
        try:
            found = np.linalg.solve(-by_unknown, by_state)
        except np.linalg.LinAlgError:
            return None
        own = len(self.own)
        return np.asarray(found[:own, :own], float)
