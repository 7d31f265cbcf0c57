"""What a fit knows: covariance that survives coloured residuals, and null directions.

The covariance is the sandwich H⁻¹ (Σ_b s_b s_bᵀ) H⁻¹, where s_b is the score of one of
about twenty contiguous blocks of samples. Residuals of real machines are never white;
blocks longer than their correlation make the answer right all the same.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.levenberg_marquardt import Optimum
from bondgraph.fitting.problem import (
    FitProblem,
    parts,
    prior_residuals,
    truncated_inverse,
)

Array = NDArray[np.float64]
BLOCKS = 20
UNIDENTIFIABLE = 1e-9


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Covariance of the free parameters, and the combinations nothing is known about.

    ``std`` is NaN for a parameter that takes part in such a combination; each row of
    ``null`` is one of them, in relative parameter changes.
    """

    covariance: Array
    std: Array
    null: Array


def uncertainty(problem: FitProblem, optimum: Optimum) -> Uncertainty:
    """Return what the data say about the free parameters at the optimum."""
    at, nq = optimum.linearisation, len(optimum.theta)
    _, weight = prior_residuals(problem, optimum.theta)
    own = truncated_inverse(at.hessian[:, nq:, nq:])
    gain = own @ at.hessian[:, nq:, :nq]
    data, pieces = np.zeros((nq, nq)), []
    for part in parts(problem, optimum.theta, optimum.initial):
        windows = np.repeat(
            np.arange(len(part.shots.edges) - 1), np.diff(part.shots.edges)
        )
        projected = part.jacobian[:, :, :nq] - np.einsum(
            "njx,nxq->njq", part.jacobian[:, :, nq:], gain[part.windows][windows]
        )
        flat = projected.reshape(projected.shape[0] * projected.shape[1], nq)
        data += flat.T @ flat
        pieces.append(np.einsum("njq,nj->nq", projected, part.errors))
    scores = np.concatenate(pieces)
    hessian = data + np.diag(weight**2)
    null = _null_directions(hessian, optimum.theta)
    inverse = truncated_inverse(hessian, UNIDENTIFIABLE)
    blocks = np.array_split(scores, BLOCKS)
    totals = np.array([block.sum(axis=0) for block in blocks])
    count = int(problem.measured.sum())
    variance = float((at.residuals**2).sum()) / max(count - nq, 1)
    meat = totals.T @ totals * BLOCKS / (BLOCKS - 1) + variance * np.diag(weight**2)
    covariance = inverse @ np.maximum(meat, meat.T) @ inverse
    # White-noise covariance is the floor: few blocks can look better by chance.
    floor = inverse * variance
    own = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    std = np.sqrt(np.maximum(np.diag(covariance), np.diag(floor)))
    scale = np.divide(std, own, out=np.ones(nq), where=own > 0)
    covariance = covariance * np.outer(scale, scale)
    involved = np.abs(null).max(axis=0) > 0.05 if len(null) else np.zeros(nq, bool)
    return Uncertainty(covariance, np.where(involved, np.nan, std), null)


def _null_directions(hessian: Array, theta: Array) -> Array:
    """Return directions, as relative changes, along which the cost does not change."""
    if not len(theta):
        return np.zeros((0, 0))
    scale = np.where(theta == 0.0, 1.0, np.abs(theta))
    relative = hessian * np.outer(scale, scale)
    values, vectors = np.linalg.eigh(relative)
    flat = values < UNIDENTIFIABLE * max(values[-1], 1e-300)
    result: Array = vectors[:, flat].T
    return result


def null_sentences(names: Sequence[str], null: Array) -> tuple[str, ...]:
    """Return one sentence per combination the recordings do not determine."""
    sentences = []
    for direction in null:
        moving = [
            (name, weight)
            for name, weight in zip(names, direction, strict=True)
            if abs(weight) > 0.05 * np.abs(direction).max()
        ]
        if len(moving) == 1:
            sentences.append(f"{moving[0][0]} has no effect on these recordings")
        else:
            largest = max(abs(weight) for _, weight in moving)
            terms = ", ".join(f"{n} by {w / largest:+.2g}" for n, w in moving)
            sentences.append(
                "these recordings do not change when the parameters move together, in "
                f"relative steps: {terms}"
            )
    return tuple(sentences)


def correlation_time(residual: Array) -> int:
    """Return after how many samples the residual's autocorrelation falls below 1/e."""
    centred = residual - residual.mean()
    power = float(centred @ centred)
    if power == 0.0:
        return 1
    spectrum = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    autocorrelation = np.fft.irfft(spectrum)[: len(centred)] / power
    below = np.flatnonzero(autocorrelation < math.exp(-1))
    return int(below[0]) if len(below) else len(centred)
