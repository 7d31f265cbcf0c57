"""What findings leave of the left-out error, beyond noise."""

from collections.abc import Mapping, Sequence

import numpy as np

from bondgraph.diagnosis.search.round_found import Round

MUCH_REMAINING = 0.1
"""More than this share of the error is worth saying that it remains."""


def remaining(rounds: Sequence[Round], floor: Mapping[str, float]) -> float:
    """Return the share of the left-out error that the findings leave beyond noise.

    From the first model to the last one: what was found on the way may have been taken
    out again, and its gain with it.
    """
    made = [found.chosen for found in rounds if found.chosen is not None]
    if not made:
        return 1.0
    whole = made[0].errors.per_sample / max(1.0 - made[0].gain.value, 1e-12)
    share = made[-1].errors.per_sample / whole if whole > 0.0 else 1.0
    base = rounds[0].base
    scale = base.problem.sigma
    power = np.nanmean((base.residuals() / scale) ** 2, axis=0)
    noise = (np.array([floor[name] for name in floor]) / scale) ** 2
    # The gains are of the errors of all outputs together, weighted by these scales.
    beyond = 1.0 - float(np.sum(np.minimum(noise, power)) / np.sum(power))
    return max(share - (1.0 - beyond), 0.0) / max(beyond, 1e-12)
