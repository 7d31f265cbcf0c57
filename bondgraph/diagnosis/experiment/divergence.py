"""How far apart alternatives are, once each has done its best to look like the other.

One alternative is taken for true and simulated; the other adjusts its parameters, as
far as the recordings it was fitted to leave them free, and its initial state, to first
order. What difference remains, over the noise, an experiment would show (T-optimality:
Atkinson and Fedorov, Biometrika 62, 1975).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.location.regression import (
    initial_responses,
    theta_responses,
)
from bondgraph.diagnosis.virtual.chain import linear_chain
from bondgraph.fitting.estimate import FittedModel, prepare
from bondgraph.fitting.problem import truncated_inverse
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import Signal

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Behaviour:
    """What one alternative does under an input, and how it could adjust.

    ``slopes`` (n, ny, nq + nx) are to parameters and initial state, ``information``
    (nq + nx, nq + nx) is what is known of them already.
    """

    outputs: Array
    slopes: Array
    information: Array


def information(fitted: FittedModel, noise: Array) -> Array:
    """Return what the recordings say of the free parameters, (nq, nq).

    Initial states are taken out; parameters known beforehand count with their std.
    """
    chain = linear_chain(fitted, ())
    weight = np.where(np.isfinite(chain.residuals), 1.0 / noise, 0.0)[:, :, None]
    theta = theta_responses(chain) * weight
    initial = initial_responses(chain) * weight
    nq, nx = theta.shape[2], initial.shape[2]
    total = np.diag(1.0 / fitted.problem.prior_std[fitted.problem.free] ** 2)
    for part in chain.shots.slices:
        s, x = theta[part].reshape(-1, nq), initial[part].reshape(-1, nx)
        cross = x.T @ s
        total = total + s.T @ s - cross.T @ truncated_inverse(x.T @ x) @ cross
    return total


def behaviour(
    fitted: FittedModel,
    time: Array,
    inputs: Array,
    known: Array,
    sensors: tuple[Signal, ...] = (),
) -> Behaviour | None:
    """Return what an alternative does under an input; None where it fails.

    It starts from the median of the initial states it was fitted with.
    """
    more = tuple(Measurement(f"sensor_{i}", s, "1") for i, s in enumerate(sensors))
    graph = fitted.graph
    model = fitted.problem.model
    if more:
        model = prepare(replace(graph, measurements=(*graph.measurements, *more)))
    initial = np.median(fitted.optimum.initial, axis=0, keepdims=True)
    blank = np.zeros((len(time), len(model.output_names)))
    shot = shoot(
        model,
        Shots(time, inputs, blank, (0, len(time))),
        parameters=fitted.parameters,
        initial=initial,
        directions=fitted.problem.free,
        solver=fitted.problem.solver,
        hold=fitted.problem.hold,
    )
    if not (shot.completed.all() and np.isfinite(shot.sensitivities).all()):
        return None
    nd = shot.sensitivities.shape[2]
    whole = np.zeros((nd, nd))
    whole[: len(known), : len(known)] = known
    return Behaviour(shot.outputs, shot.sensitivities, whole)


def distance(true: Behaviour, other: Behaviour, noise: Array) -> float:
    """Return by how many sigmas `other`, adjusted, differs from `true` in all."""
    gap = ((true.outputs - other.outputs) / noise).ravel()
    nd = other.slopes.shape[2]
    slopes = (other.slopes / noise[:, None]).reshape(-1, nd)
    normal = slopes.T @ slopes + other.information
    right = slopes.T @ gap
    left = float(gap @ gap) - float(right @ truncated_inverse(normal) @ right)
    return float(np.sqrt(max(left, 0.0)))


def least_distance(behaviours: list[Behaviour], noise: Array) -> float:
    """Return the distance of the two alternatives that differ least."""
    return min(
        distance(one, other, noise)
        for i, one in enumerate(behaviours)
        for j, other in enumerate(behaviours)
        if i != j
    )
