"""Initial states of a model that is begun where another one is."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.estimate import FittedModel

Array = NDArray[np.float64]


def initial_states(base: FittedModel, names: Sequence[str]) -> Array:
    """Return the base model's initial states, with zeros for new states."""
    known = dict(
        zip(base.problem.model.state_names, base.optimum.initial.T, strict=True)
    )
    zeros = np.zeros(base.problem.shots.n_windows)
    columns = [known.get(name, zeros) for name in names]
    return np.column_stack(columns) if columns else zeros[:, None][:, :0]
