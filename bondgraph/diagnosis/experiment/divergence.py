"""How far apart alternatives are, once each has done its best to look like the other.

One alternative is taken for true and simulated; the other adjusts its parameters, as
far as the recordings it was fitted to leave them free, and its initial state, to first
order. What difference remains, over the noise, an experiment would show (T-optimality:
Atkinson and Fedorov, Biometrika 62, 1975).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.virtual.noise import noise_scale
from bondgraph.fitting.estimate import FittedModel, prepare
from bondgraph.fitting.loss import SquaredError
from bondgraph.fitting.noise import lag_one
from bondgraph.fitting.problem import linearise_windows, reduced_hessian
from bondgraph.fitting.truncated_inverse import truncated_inverse
from bondgraph.numeric.model import NumericModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import Signal

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Behaviour:
    """What one alternative does under an input, and how it could adjust.

    ``slopes`` (n, ny, nq + nx) are to parameters and initial state, ``information``
    (nq + nx, nq + nx) is what is known of them already.
    """

    outputs: Array
    slopes: Array
    information: Array

    def of(self, chosen: Sequence[int]) -> "Behaviour":
        """Return the behaviour as some of the outputs show it."""
        rows = list(chosen)
        return replace(self, outputs=self.outputs[:, rows], slopes=self.slopes[:, rows])


def unexplained(
    alternatives: Sequence[FittedModel], recordings: Sequence[BoundRecording]
) -> Array:
    """Return the size per output of what no alternative would explain anyway, (ny,).

    The noise, or what the best alternative leaves of the recordings where that is more.
    Where neighbouring samples of it are alike, each counts as the part of a sample that
    it is: a first-order autoregression with φ hides slow differences like white noise
    that is sqrt((1 + φ)/(1 - φ)) times as large.
    """
    left = [one.residuals() for one in alternatives]
    size = [np.sqrt(np.nanmean(residual**2, axis=0)) for residual in left]
    best = np.argmin(size, axis=0)
    result = np.zeros(len(best))
    for output, k in enumerate(best):
        one = alternatives[int(k)]
        residual = np.nan_to_num(left[int(k)][:, [output]])
        phi = lag_one(residual, one.problem.shots.edges, len(one.problem.free))[0]
        slowness = np.sqrt((1.0 + phi) / (1.0 - phi)) if phi > 0.0 else 1.0
        noise = noise_scale(one, recordings)[output]
        result[output] = max(noise, slowness * size[int(k)][output])
    return result


def information(fitted: FittedModel, noise: Array) -> Array:
    """Return what the recordings say of the free parameters, (nq, nq).

    Initial states are taken out; parameters known beforehand count with their std.
    """
    plain = replace(
        fitted.problem,
        sigma=noise,
        correlation=np.zeros_like(noise),
        loss=SquaredError(),
    )
    at = linearise_windows(plain, fitted.optimum.theta, fitted.optimum.initial)
    prior = np.diag(1.0 / plain.prior_std[plain.free] ** 2)
    total: Array = prior + reduced_hessian(at, len(plain.free))
    return total


def with_sensors(fitted: FittedModel, sensors: Sequence[Signal]) -> NumericModel:
    """Return an alternative's equations with further outputs, last."""
    if not sensors:
        return fitted.problem.model
    more = tuple(Measurement(f"sensor_{i}", s, "1") for i, s in enumerate(sensors))
    graph = fitted.graph
    return prepare(replace(graph, measurements=(*graph.measurements, *more)))


def behaviour(
    fitted: FittedModel,
    time: Array,
    inputs: Array,
    known: Array,
    model: NumericModel | None = None,
) -> Behaviour | None:
    """Return what an alternative does under an input; None where it fails.

    It starts from the median of the initial states it was fitted with.

    Parameters
    ----------
    model
        The alternative with further sensors; its own when None.
    """
    model = fitted.problem.model if model is None else model
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


def least_distance(
    behaviours: Sequence[Behaviour], noise: Array, *, nested: bool = False
) -> float:
    """Return the distance of the two alternatives that differ least.

    Parameters
    ----------
    nested
        Whether the others are the first with something added. They could do as it does
        then, and are not asked to.
    """
    return min(
        distance(one, other, noise)
        for i, one in enumerate(behaviours)
        for j, other in enumerate(behaviours)
        if i != j and not (nested and i == 0)
    )
