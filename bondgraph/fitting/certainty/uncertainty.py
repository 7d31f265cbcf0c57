"""What a fit knows: covariance that survives coloured residuals, and null directions.

The covariance is the sandwich H⁻¹ M H⁻¹. H is the curvature of the cost, M the variance
of its slope, told in two ways of which the larger counts, parameter by parameter:

* from the colour of the residuals over windows long enough to show it, an
  autoregression (`fitting.colour`);
* from the scores of contiguous blocks of samples, longer than the residuals'
  correlation, M = Σ_b s_b s_bᵀ, which needs no model of the noise and also sees where
  along the recording it is larger.

Both are estimates themselves: intervals take Student's quantile, with the degrees of
freedom of the blocks, or of the samples that are worth one white sample each.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.colour import Colour, colour_of
from bondgraph.fitting.certainty.combinations import (
    FLAT,
    Local,
    flat_directions,
    relative,
    taking_part,
)
from bondgraph.fitting.levenberg_marquardt import Optimum
from bondgraph.fitting.loss import mean_curvature, weight_of
from bondgraph.fitting.noise import whitened
from bondgraph.fitting.problem import FitProblem, Part, parts, prior_residuals
from bondgraph.fitting.truncated_inverse import truncated_inverse

Array = NDArray[np.float64]
MOST_BLOCKS, LEAST_BLOCKS = 20, 6
CORRELATIONS_PER_BLOCK = 5
CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty:
    """Covariance of the free parameters, and the combinations nothing is known about.

    ``std`` is NaN for a parameter that takes part in such a combination; each row of
    ``null`` is one of them, in relative parameter changes. ``quantile`` times ``std``
    is half a 95 % interval; ``inverse`` is that of
    the cost's Hessian; ``inflation`` is how much larger each variance is than
    that of white residuals.
    """

    covariance: Array
    inverse: Array
    std: Array
    null: Array
    quantile: Array
    inflation: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Scores:
    """JᵀJ of the projected sensitivities, M from the colour, and scores per sample."""

    squared: Array
    coloured: Array
    samples: Array


def uncertainty(problem: FitProblem, optimum: Optimum) -> Uncertainty:
    """Return what the data say about the free parameters at the optimum."""
    nq = len(optimum.theta)
    _, weight = prior_residuals(problem, optimum.theta)
    errors = influence(problem, optimum)
    colours = _colours(problem, errors, nq)
    scores = _scores(problem, optimum, colours)
    count = int(problem.measured.sum())
    variance = float((errors**2).sum()) / float(max(count - problem.unknowns, 1))
    curved = mean_curvature(problem.loss, whitened_squares(problem, optimum))
    hessian: Array = np.float64(curved) * scores.squared + np.diag(weight**2)
    inverse = truncated_inverse(hessian, FLAT)
    blocks = _block_count(errors, problem.shots.n_windows)
    own = variance * np.diag(weight**2)
    gathered = _gathered(scores.samples, problem.shots.edges, blocks)
    by_blocks = inverse @ (gathered + own) @ inverse
    by_colour = inverse @ (scores.coloured + own) @ inverse
    white = inverse @ (variance * scores.squared + own) @ inverse
    wide = np.diag(by_blocks) > np.diag(by_colour)
    largest = np.maximum(np.diag(by_blocks), np.diag(by_colour))
    std: Array = np.sqrt(np.maximum(largest, 0.0))
    local = relative(Local(optimum.theta, hessian))
    null = flat_directions(local)
    involved = taking_part(null, local)
    stretch = max((colour.stretch for colour in colours), default=1.0)
    dof = np.where(wide, blocks - 1, max(count / stretch - nq, 1.0))
    return Uncertainty(
        _with_diagonal(by_colour, std),
        inverse,
        np.where(involved, np.nan, std),
        null,
        _quantile(dof),
        largest / np.maximum(np.diag(white), 1e-300),
    )


def _quantile(dof: Array) -> Array:
    from scipy.special import stdtrit  # noqa: PLC0415  (slow to import)

    quantile: Array = np.asarray(stdtrit(dof, 0.5 + CONFIDENCE / 2), np.float64)
    return quantile


def _with_diagonal(covariance: Array, std: Array) -> Array:
    """Return the covariance with its correlations kept and these std."""
    own = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale = np.divide(std, own, out=np.ones(len(own)), where=own > 0)
    scaled: Array = covariance * np.outer(scale, scale)
    return (scaled + scaled.T) / 2


def whitened_squares(problem: FitProblem, optimum: Optimum) -> Array:
    """Return the squared whitened residuals of what was measured."""
    measured = np.isfinite(problem.shots.outputs)
    return _whitened(problem, optimum)[measured] ** 2


def influence(problem: FitProblem, optimum: Optimum) -> Array:
    """Return ψ(r) per sample and output: residuals with the loss's weights."""
    errors = _whitened(problem, optimum)
    weighed: Array = errors * weight_of(problem.loss, errors**2)
    return weighed


def _whitened(problem: FitProblem, optimum: Optimum) -> Array:
    return whitened(
        optimum.linearisation.residuals,
        problem.correlation,
        problem.shots.edges,
        np.isfinite(problem.shots.outputs),
    )


def _colours(problem: FitProblem, errors: Array, nq: int) -> tuple[Colour, ...]:
    """Return the colour of each output's residuals, scaled to what was measured."""
    fitted = problem.unknowns / len(problem.sigma)
    found = []
    for column, measured in zip(errors.T, problem.measured, strict=True):
        share = len(column) / int(measured)
        colour = colour_of(column, problem.shots.edges, int(fitted))
        found.append(Colour(colour.coefficients, colour.innovation * share))
    return tuple(found)


def projected(problem: FitProblem, optimum: Optimum, part: Part) -> Array:
    """Return the sensitivities (m, ny, nq) with each window's initial state free."""
    at, nq = optimum.linearisation, len(optimum.theta)
    own = truncated_inverse(at.hessian[part.windows, nq:, nq:])
    gain = own @ at.hessian[part.windows, nq:, :nq]
    sizes = part.shots.lengths
    windows = np.repeat(np.arange(len(sizes)), sizes)
    result: Array = part.jacobian[:, :, :nq] - np.einsum(
        "njx,nxq->njq", part.jacobian[:, :, nq:], gain[windows]
    )
    return result


def _scores(
    problem: FitProblem, optimum: Optimum, colours: tuple[Colour, ...]
) -> _Scores:
    nq = len(optimum.theta)
    squared, coloured, pieces = np.zeros((nq, nq)), np.zeros((nq, nq)), []
    for part in parts(problem, optimum.theta, optimum.initial):
        slopes = projected(problem, optimum, part)
        flat = slopes.reshape(slopes.shape[0] * slopes.shape[1], nq)
        squared += flat.T @ flat
        for j, colour in enumerate(colours):
            if not len(colour.coefficients):
                coloured += colour.gathered(slopes[:, j])
                continue
            for window in part.shots.slices:
                coloured += colour.gathered(slopes[window, j])
        weight = weight_of(problem.loss, part.errors**2)
        pieces.append(np.einsum("njq,nj->nq", slopes, part.errors * weight))
    return _Scores(squared, coloured, np.concatenate(pieces))


def _block_count(errors: Array, windows: int) -> int:
    """Return into how many blocks to cut: each several correlation times long.

    Many windows are not cut: their initial states tie their samples together.
    """
    longest = max(correlation_time(column) for column in errors.T)
    most = min(windows, MOST_BLOCKS) if windows >= LEAST_BLOCKS else MOST_BLOCKS
    independent = len(errors) // (CORRELATIONS_PER_BLOCK * longest)
    return int(np.clip(independent, LEAST_BLOCKS, most))


def _gathered(samples: Array, edges: tuple[int, ...], blocks: int) -> Array:
    """Return M from the scores of blocks of samples, or of whole windows if many."""
    windows = len(edges) - 1
    cuts = np.arange(blocks + 1) * len(samples) // blocks
    if windows >= blocks:
        cuts = np.array(edges)[np.arange(blocks + 1) * windows // blocks]
    totals = np.add.reduceat(samples, cuts[:-1], axis=0)
    gathered: Array = totals.T @ totals * blocks / (blocks - 1)
    return gathered


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
