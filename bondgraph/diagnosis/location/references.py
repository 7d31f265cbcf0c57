"""Where to linearise: a fit that lacks physics has bent its parameters to make up.

The exact linear steps are taken twice, at the fitted parameters and at those the fit
started from, and for each place the one is kept from which a free signal there, with
parameters near by, makes the recordings more likely. From there parameters and states
move to what the smoothing finds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.location.smoothing import (
    Priors,
    Process,
    SmoothedSource,
    smooth,
    stretches,
)
from bondgraph.diagnosis.virtual.chain import Chain, linear_chain, trajectory
from bondgraph.diagnosis.virtual.sources import VirtualModel, VirtualSource
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.settling import settle

Array = NDArray[np.float64]
NEAR = 0.3
"""Parameters are known beforehand to this share of themselves, if nothing is said."""
FACTOR = 3.0
"""Nor do they leave this factor of where they were."""
BENT = 0.1
"""A fit that moved a parameter by more than this share may have bent it."""


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """Parameters, states and what is known of the parameters around them."""

    theta: Array
    states: Array
    center: Array
    std: Array


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """A place smoothed from a reference, and its chain taken where that led."""

    chain: Chain
    smoothed: SmoothedSource
    theta: Array
    center: Array
    std: Array


def references(fitted: FittedModel) -> tuple[Reference, ...]:
    """Return the fitted model as it is, and where it started if it moved far."""
    problem = fitted.problem
    found, start = fitted.optimum.theta, problem.start[problem.free]
    size = np.maximum(np.abs(start), np.abs(found))
    std = np.where(start == 0.0, size, NEAR * size)
    std = np.minimum(np.where(std > 0.0, std, 1.0), problem.prior_std[problem.free])
    here = Reference(found, trajectory(fitted), found, std)
    if not (np.abs(found - start) > BENT * np.abs(start)).any():
        return (here,)
    _, at = settle(problem, start, fitted.optimum.initial)
    if not np.isfinite(at.states).all():
        return (here,)
    return here, Reference(start, at.states, start, std)


def better_reference(
    fitted: FittedModel,
    virtual: VirtualModel,
    sources: Sequence[VirtualSource],
    noise: Array,
) -> tuple[Reference, tuple["First", ...]]:
    """Return the reference from which one missing signal does best, smoothed first.

    One reference for all places, so that they are compared on equal terms.
    """
    tried = [
        (one, tuple(_first(fitted, virtual, source, one, noise) for source in sources))
        for one in references(fitted)
    ]
    return max(tried, key=lambda pair: max(f.likelihood for f in pair[1]))


def settled_at(
    fitted: FittedModel,
    virtual: VirtualModel,
    source: VirtualSource,
    reference: Reference,
    first: "First",
    noise: Array,
) -> Settled:
    """Return one place smoothed, and the chain at what the smoothing found."""
    begin = moved(fitted, reference.center, first.theta)
    near = _smoothed(fitted, virtual, source, reference, first, noise, begin)
    smoothed = near.smoothed
    theta = moved(fitted, reference.center, smoothed.theta + begin)
    chain = linear_chain(
        fitted, (source,), virtual=virtual, theta=theta, states=smoothed.states
    )
    return replace(near, chain=chain, theta=theta)


def unmoved_at(
    fitted: FittedModel,
    virtual: VirtualModel,
    source: VirtualSource,
    reference: Reference,
    first: "First",
    noise: Array,
) -> Settled:
    """Return one place smoothed at the reference itself.

    For where nothing can be simulated with the parameters that it would move to: those
    of a stiff coupling may lead anywhere.
    """
    at = reference.theta
    return _smoothed(fitted, virtual, source, reference, first, noise, at)


def _smoothed(
    fitted: FittedModel,
    virtual: VirtualModel,
    source: VirtualSource,
    reference: Reference,
    first: "First",
    noise: Array,
    theta: Array,
) -> Settled:
    """Return one place smoothed with these parameters, its chain taken there."""
    chain = linear_chain(
        fitted, (source,), virtual=virtual, theta=theta, states=reference.states
    )
    smoothed = smooth(chain, _priors(reference, theta, noise), first.process)
    return Settled(chain, smoothed, theta, reference.center, reference.std)


@dataclass(frozen=True, slots=True, eq=False)
class First:
    """A first smoothing, over a part of long recordings: parameters and process."""

    likelihood: float
    theta: Array
    process: Process


def _first(
    fitted: FittedModel,
    virtual: VirtualModel,
    source: VirtualSource,
    reference: Reference,
    noise: Array,
) -> First:
    chain = linear_chain(
        fitted,
        (source,),
        virtual=virtual,
        theta=reference.theta,
        states=reference.states,
    )
    part = chain.rows(stretches(len(chain.states)))
    smoothed = smooth(part, _priors(reference, reference.theta, noise))
    process = Process(smoothed.size / smoothed.level, smoothed.correlation_time)
    return First(smoothed.likelihood, smoothed.theta + reference.theta, process)


def _priors(reference: Reference, theta: Array, noise: Array) -> Priors:
    return Priors(noise=noise, theta=reference.std, offset=reference.center - theta)


def moved(fitted: FittedModel, center: Array, theta: Array) -> Array:
    """Return parameters within their bounds and not too far from the reference."""
    problem = fitted.problem
    low, high = problem.low[problem.free], problem.high[problem.free]
    positive = (low >= 0.0) & (center > 0.0)
    least = np.where(positive, np.maximum(low, center / FACTOR), low)
    most = np.where(positive, np.minimum(high, center * FACTOR), high)
    inside: Array = np.clip(theta, least, most)
    return inside
