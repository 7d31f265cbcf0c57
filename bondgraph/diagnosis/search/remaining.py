"""What findings leave of the left-out error, beyond noise."""

import math
from collections.abc import Mapping, Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.estimate import FittedModel

Array = NDArray[np.float64]
MUCH_REMAINING = 0.1
"""More than this share of the error is worth saying that it remains."""


def remaining(rounds: Sequence[Round], floor: Mapping[str, float]) -> float:
    """Return the share of the left-out error that the findings leave beyond noise.

    From the first model to the last one: what was found on the way may have been taken
    out again, and its gain with it. Where outputs were weighed anew on the way, it is
    what was left by then times what is left of that.
    """
    made = [(one.base, one.chosen) for one in rounds if one.chosen is not None]
    if not made:
        return 1.0
    noise = np.array([floor[name] for name in floor])
    shares = [
        _left_by(list(alike), np.array(scale), noise)
        for scale, alike in groupby(
            made, lambda one: tuple(one[1].candidate.fitted.problem.sigma)
        )
    ]
    return math.prod(shares)


def _left_by(
    made: Sequence[tuple[FittedModel, Judged]], scale: Array, noise: Array
) -> float:
    """Return the share that findings leave, the outputs of all weighed alike."""
    (base, first), (_, last) = made[0], made[-1]
    whole = first.errors.per_sample / max(1.0 - first.gain.value, 1e-12)
    share = last.errors.per_sample / whole if whole > 0.0 else 1.0
    power = np.nanmean((base.residuals() / scale) ** 2, axis=0)
    # The gains are of the errors of all outputs together, weighed by these scales. A
    # model that is far off is farther off where it was not fitted, and noise is not.
    error = max(whole, float(power.sum()))
    beyond = 1.0 - float(np.sum(np.minimum((noise / scale) ** 2, power))) / error
    return max(share - (1.0 - beyond), 0.0) / max(beyond, 1e-12)
