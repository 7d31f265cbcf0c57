"""`adequacy`: whether what a fit leaves follows what the machine does.

The residual is compared with many families of functions: laws of what is local at every
place, sent through the model, and functions of inputs and states added to a sensor. The
statistic is the largest over all families; how large it gets by chance is found by
simulating the fitted model with noise like the residual's own, coloured and rounded.
Coloured sensor noise on a perfect model follows nothing, however slow it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.adequacy.coloured import autoregression, correlations
from bondgraph.diagnosis.adequacy.conclusion import conclude, too_few
from bondgraph.diagnosis.adequacy.draws import innovations_of, noise_model
from bondgraph.diagnosis.adequacy.feedback import fed_back, without_feedback
from bondgraph.diagnosis.adequacy.nuisance import Nuisance
from bondgraph.diagnosis.adequacy.records import Adequacy, OutputCheck
from bondgraph.diagnosis.adequacy.strongest import strongest
from bondgraph.diagnosis.adequacy.whiteness import white_p_value
from bondgraph.diagnosis.virtual.chain import Chain, linear_chain
from bondgraph.diagnosis.virtual.noise import output_noise
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import matched

Array = NDArray[np.float64]
MOST_ROWS = 40_000
"""Of more residuals than these, evenly spaced stretches are tested."""
STRETCH = 2000
DRAWS = 199
LEVEL = 0.01


def adequacy(
    fitted: FittedModel,
    recordings: Sequence[BoundRecording],
    *,
    level: float = LEVEL,
    draws: int = DRAWS,
    seed: int = 0,
) -> Adequacy:
    """Say whether a fitted model leaves more than noise.

    Parameters
    ----------
    fitted
        The model fitted to the recordings.
    recordings
        Those it was fitted to; measurement noise and rounding are estimated from them.
    level
        False-alarm probability; at least ``2 / (draws + 1)``.
    draws
        Simulations of the fitted model with noise.
    seed
        Of the simulations.
    """
    recordings = matched(fitted.graph, recordings)
    random = np.random.default_rng(seed)
    told = output_noise(recordings)
    chain = _thinned(linear_chain(fitted))
    residual = np.nan_to_num(chain.residuals)
    scale = np.sqrt(np.mean(residual**2, axis=0))
    scale = np.where(scale > 0.0, scale, 1.0)
    plain = Nuisance(chain, 1.0 / scale)
    if residual.size < 2 * plain.freedom + 8:
        return too_few(fitted, residual.size, level)
    left = plain.remove(residual[:, :, None])[:, 0]
    promise = 1.0 - float(left @ left) / max(
        float(np.sum((residual / scale) ** 2)), 1e-300
    )
    treat = tuple(_Treatment(plain, residual.shape, j) for j in range(len(told)))
    cleaned = left.reshape(residual.shape) * scale
    edges = chain.shots.edges
    models = tuple(
        autoregression(cleaned[:, j], edges, treat[j], random) for j in range(len(told))
    )
    steps = np.array([one.quantisation or 0.0 for one in told])
    noise = noise_model(chain, cleaned, models, steps)
    size = np.std(noise.innovations, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    fine = Nuisance(chain, 1.0 / size, models, plain.sensitivities)
    both = (plain, fine)
    driven = chain
    if fed_back(chain, innovations_of(models, cleaned, edges)):
        driven = without_feedback(chain, cleaned, fitted.problem.model.input_names)
    found, p_value = strongest(fitted, driven, residual, both, noise, draws, random)
    model = fitted.problem.model
    checks = tuple(
        OutputCheck(
            name=model.output_names[j],
            unit=model.output_units[j],
            noise=one.std,
            noise_is_white=one.white,
            quantisation=one.quantisation,
            residual=float(np.sqrt(np.nanmean(chain.residuals[:, j] ** 2))),
            white_p_value=white_p_value(cleaned[:, j], edges, treat[j], random),
            noise_order=models[j].order,
            correlation=float(correlations(cleaned[:, j], edges, 1)[1]),
        )
        for j, one in enumerate(told)
    )
    return conclude(found, checks, p_value, level, draws, promise, fitted)


@dataclass(frozen=True, slots=True)
class _Treatment:
    """Takes from draws (n, m) of one output what a fit could take of them."""

    nuisance: Nuisance
    shape: tuple[int, ...]
    output: int

    def __call__(self, draws: Array) -> Array:
        whole = np.zeros((*self.shape, draws.shape[1]))
        whole[:, self.output] = draws
        left: Array = self.nuisance.remove(whole).reshape(whole.shape)[:, self.output]
        return left


def _thinned(chain: Chain) -> Chain:
    n, ny = chain.residuals.shape
    if n * ny <= MOST_ROWS or not chain.follows.any():
        return chain
    count = MOST_ROWS // (ny * STRETCH)
    starts = np.linspace(0, n - STRETCH, max(count, 2)).astype(np.int64)
    rows = np.unique(np.concatenate([s + np.arange(STRETCH) for s in starts]))
    return chain.rows(rows)
