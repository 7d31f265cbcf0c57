"""What a fit may take from noise: the span of its sensitivities, removed exactly.

The residual of a fit is noise minus what parameters and initial states took of it. That
is linear in the noise, and removing the sensitivities' span (again) leaves the same of
both: so simulated noise need not be fitted, and it does not matter how outputs were
weighed. A fit that stopped early loses its first-order error in the same way.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.adequacy.coloured import Autoregression, whitened
from bondgraph.diagnosis.location.regression import (
    initial_responses,
    span,
    theta_responses,
)
from bondgraph.diagnosis.virtual.chain import Chain

Array = NDArray[np.float64]


class Nuisance:
    """Sensitivities of weighted outputs to parameters and initial states.

    Parameters
    ----------
    weight
        Per output, one over its scale.
    models
        Filter each output by the autoregression of its noise; none when None.
    theta, initial
        Responses (n, ny, nq) and (n, ny, nx).
    """

    def __init__(
        self,
        chain: Chain,
        weight: Array,
        models: Sequence[Autoregression] | None = None,
        sensitivities: tuple[Array, Array] | None = None,
    ) -> None:
        self._edges = chain.shots.edges
        self._measured = np.isfinite(chain.residuals)
        self._weight = weight
        self._models = models
        if sensitivities is None:
            sensitivities = theta_responses(chain), initial_responses(chain)
        self.sensitivities = sensitivities
        theta, initial = (self._rows(part) for part in sensitivities)
        ny = len(weight)
        bounds = [ny * edge for edge in self._edges]
        self._windows = list(pairwise(bounds))
        self._initial = [span(initial[a:b]) for a, b in self._windows]
        self._theta = span(self._without_initial(theta))

    @property
    def freedom(self) -> int:
        """How many directions are removed."""
        own = sum(int(basis.shape[1]) for basis in self._initial)
        return int(self._theta.shape[1]) + own

    def _rows(self, values: Array) -> Array:
        """Return values (n, ny, m) as weighted, filtered rows (n ny, m)."""
        kept = np.where(self._measured[:, :, None], values, 0.0)
        if self._models is not None:
            for j, model in enumerate(self._models):
                kept[:, j] = whitened(model, kept[:, j], self._edges)
        rows: Array = (kept * self._weight[:, None]).reshape(-1, values.shape[2])
        return rows

    def _without_initial(self, rows: Array) -> Array:
        for basis, (a, b) in zip(self._initial, self._windows, strict=True):
            rows[a:b] -= basis @ (basis.T @ rows[a:b])
        return rows

    def remove(self, values: Array) -> Array:
        """Return values (n, ny, m) as rows (n ny, m) without what a fit could take."""
        rows = self._without_initial(self._rows(values))
        rows -= self._theta @ (self._theta.T @ rows)
        return rows
