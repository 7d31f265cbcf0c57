"""The unscented filter over all samples: by turns, and one after another.

By turns is a few simulations; where laws bend so much that what is found at one sample
moves the next ones for long, the samples are taken one after another instead.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.kalman.filter_setting import (
    Filtered,
    Setting,
    Unknowns,
    process_of,
    starts_of,
)
from bondgraph.fitting.kalman.kalman_choices import Unscented
from bondgraph.fitting.kalman.unscented import Beliefs, points, regressed, simulated
from bondgraph.fitting.kalman.unscented_filter import (
    Belief,
    Plane,
    carried_on,
    taken_in,
)

Array = NDArray[np.float64]
Planes = Callable[[int, Belief], Plane]
TURNS = 12
STILL = 1e-6
NARROW = 1e-3  # of a state's size, how wide the first beliefs are


def filtered_by_points(
    setting: Setting, rule: Unscented, at: Unknowns, begun: Filtered
) -> Filtered:
    """Filter by points and simulate them by turns until the beliefs stand still.

    Parameters
    ----------
    begun
        What was found at unknowns close by, or by the extended filter.
    """
    beliefs = begun.beliefs
    if beliefs is None:
        n, nx = begun.states.shape
        narrow = np.broadcast_to(np.diag((NARROW * setting.scale) ** 2), (n, nx, nx))
        beliefs = Beliefs(begun.states, narrow, begun.states, narrow)
    for _ in range(TURNS):
        found = _turn(setting, rule, at, beliefs)
        if found.beliefs is None or not np.isfinite(found.loss):
            break
        if _difference(found.beliefs, beliefs, setting.scale) <= STILL:
            return found
        beliefs = found.beliefs
    return _one_after_another(setting, rule, at)


def _difference(one: Beliefs, other: Beliefs, scale: Array) -> float:
    """Return the largest change of a mean or a standard deviation, over the scale."""
    widths = [np.sqrt(np.einsum("nii->ni", x.after)) for x in (one, other)]
    moved = np.abs(one.states - other.states) + np.abs(widths[0] - widths[1])
    return float((moved / scale).max())


def _turn(
    setting: Setting, rule: Unscented, at: Unknowns, beliefs: Beliefs
) -> Filtered:
    """Simulate points spread like the beliefs and filter along their regressions."""
    read, moved = (
        _planes(setting, rule, at, means, covariances, last=last)
        for means, covariances, last in (
            (beliefs.predicted, beliefs.before, False),
            (beliefs.states, beliefs.after, True),
        )
    )
    return _filter(setting, at, lambda k, _: read[k], lambda k, _: moved[k])


def _one_after_another(setting: Setting, rule: Unscented, at: Unknowns) -> Filtered:
    """Filter sample by sample, points spread around what is believed there."""

    def spread(last: bool) -> Planes:
        def plane(k: int, belief: Belief) -> Plane:
            here = belief.mean[None], belief.covariance[None]
            return _planes(setting, rule, at, *here, last=last, sample=k)[0]

        return plane

    return _filter(setting, at, spread(False), spread(True))


def _planes(
    setting: Setting, rule: Unscented, at: Unknowns, means: Array, covariances: Array,
    *, last: bool, sample: int | None = None,
) -> list[Plane]:  # fmt: skip
    """Return outputs, or states one sample later, as planes around the beliefs."""
    pairs, scale = setting.pairs, setting.scale
    if sample is not None:
        pairs = pairs.subset(np.array([sample]))
    sent = points(means, covariances, scale, rule)
    values = simulated(setting.problem, at.theta, pairs, sent, last=last)
    if not np.isfinite(values).all():
        return [_nowhere(mean, values.shape[2]) for mean in means]
    found = regressed(values, covariances, scale, rule)
    return list(map(Plane, means, found.mean, found.slopes, found.left))


def _nowhere(around: Array, count: int) -> Plane:
    """Return the plane of a function that is not a number."""
    nx = len(around)
    shapes = (count,), (count, nx), (count, count)
    return Plane(around, *(np.full(shape, np.nan) for shape in shapes))


def _filter(setting: Setting, at: Unknowns, read: Planes, moved: Planes) -> Filtered:
    """Filter all samples along the planes given for each sample and belief."""
    measured, pairs = setting.problem.shots.outputs, setting.pairs
    (n, ny), nx = measured.shape, len(setting.scale)
    innovations, variances = np.zeros((n, ny)), np.full((n, ny), -1.0)
    means, wide = (n, nx), (n, nx, nx)
    found = Beliefs(*map(np.zeros, (means, wide, means, wide)))
    starts, process = starts_of(setting), process_of(setting, at)
    ends = pairs.edge_array
    steps = pairs.time[ends[1:] - 1] - pairs.time[ends[:-1]]
    noise, window = np.exp(2.0 * at.noise), -1
    belief = Belief(np.zeros(nx), np.zeros((nx, nx)))
    for k in range(n):
        if starts[k]:
            window += 1
            belief = Belief(setting.initial[window], np.diag(setting.spread))
        found.predicted[k], found.before[k] = belief.mean, belief.covariance
        plane = read(k, belief)
        if not (np.isfinite(plane.mean).all() and np.isfinite(belief.mean).all()):
            return Filtered(innovations, variances, found.states)
        belief, innovations[k], variances[k] = taken_in(
            belief, measured[k], plane, noise
        )
        found.states[k], found.after[k] = belief.mean, belief.covariance
        belief = carried_on(belief, moved(k, belief), float(steps[k]), process)
    return Filtered(innovations, variances, found.states, found)
