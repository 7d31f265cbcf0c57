"""How slopes of the states pass an impact.

The time of an impact depends on the parameters, so the slopes jump with the states:
``S⁺ = R_x (S⁻ + ẋ⁻ dt) + R_p + R_t dt - ẋ⁺ dt`` with the jump x⁺ = R(x⁻, p, t)
and dt = -g_p / ġ⁻ (Aizerman and Gantmacher, Q. J. Mech. Appl. Math. 11, 1958;
Leine and Nijmeijer, 2004, chapter 7). The slopes of R, an algebraic map without steps,
are central differences, right to about nine digits.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bondgraph.simulation.contact_segments import Position, Segments
from bondgraph.simulation.impact import ImpactLaw, Instant, Watched

Array = NDArray[np.float64]
Jump = Callable[[ImpactLaw, Instant, Array], Array]

NUDGE = 1e-5  # of a number's size; the differences err by its square
NOTHING = 1e-300


def slopes_after(
    segments: Segments, jump: Jump, start: Position, at: Instant, span: float,
    before: Watched, after: Watched, gap_slopes: Array, approach: float,
) -> Array:  # fmt: skip
    """Return the slopes of the states after an impact.

    Parameters
    ----------
    jump
        R, as a function of the law (which holds p), the instant and the states.
    span
        The step in s, over which rates say how large a state is.
    gap_slopes, approach
        Of the penetration that shut, along the directions, and its rate before.
    """
    assert segments.directions is not None
    later = -gap_slopes / approach if approach > 0.0 else 0.0 * gap_slopes
    law = ImpactLaw(segments.form, segments.parameters)
    x = start.x
    size = np.abs(x) + np.abs(before.state_rates) * span
    size = NUDGE * (size + np.abs(jump(law, at, x) - x)) + NOTHING

    along_x = np.zeros((len(x), len(x)))
    for i, step in enumerate(size):
        moved = step * np.eye(len(x))[i]
        change = jump(law, at, x + moved) - jump(law, at, x - moved)
        along_x[:, i] = change / (2.0 * step)
    found: Array = along_x @ (start.slopes + np.outer(before.state_rates, later))
    for m, p in enumerate(segments.directions):
        step = NUDGE * (abs(segments.parameters[p]) or 1.0)
        ends = []
        for side in (step, -step):
            values = segments.parameters.copy()
            values[p] += side
            ends.append(jump(ImpactLaw(segments.form, values), at, x))
        found[:, m] += (ends[0] - ends[1]) / (2.0 * step)
    ends = []
    step = NUDGE * span
    for side in (step, -step):
        moved_inputs = at.inputs + at.rates * side
        ends.append(jump(law, Instant(at.time + side, moved_inputs, at.rates), x))
    found += np.outer((ends[0] - ends[1]) / (2.0 * step), later)
    return found - np.outer(after.state_rates, later)
