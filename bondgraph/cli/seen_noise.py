"""The noise that recordings show, beside what a model leaves of them."""

from collections.abc import Mapping, Sequence

import numpy as np

from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import estimate_noise
from bondgraph.reporting.wording import number_words

BEYOND = 3.0
"""Times its noise, from which what is left of an output may be physics."""


def white_noise(bound: BoundRecording) -> dict[str, float]:
    """Return the noise of each output that is seen to be white: of others none is."""
    if bound.steady:
        return {}
    columns = zip(bound.output_names, bound.outputs.T, strict=True)
    seen = (
        (n, estimate_noise(bound.time, x)) for n, x in columns if np.isfinite(x).any()
    )
    return {name: one.std for name, one in seen if one.white and one.std > 0.0}


def beyond_noise(
    left: Mapping[str, float], bound: Sequence[BoundRecording]
) -> str | None:
    """Return what to say of outputs of which much more than noise is left.

    Parameters
    ----------
    left
        Root mean square of what is left of each output, in the model's unit.
    """
    seen = [white_noise(one) for one in bound]
    over = {
        name: error / max(one[name] for one in seen if name in one)
        for name, error in left.items()
        if any(name in one for one in seen)
    }
    far = [f"{n} {number_words(x, 2)}" for n, x in over.items() if x > BEYOND]
    if not far:
        return None
    return (
        f"Left of what was measured, in times its noise: {', '.join(far)}. The model "
        "may lack something, which 'bondgraph diagnose' looks for."
    )
