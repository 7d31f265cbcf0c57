"""Noise like a residual's own: coloured as it is, and rounded as its channel is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.adequacy.coloured import Autoregression, coloured, whitened
from bondgraph.diagnosis.virtual.chain import Chain

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class NoiseModel:
    """Everything that noise is drawn from.

    Parameters
    ----------
    innovations
        Those of the residual, (n, ny), of mean zero; drawn whole rows at a time, so
        that outputs disturbed together stay so.
    size
        Standard deviation of the residual per output.
    steps
        Step of each channel's grid, 0 where it has none.
    """

    models: tuple[Autoregression, ...]
    innovations: Array
    size: Array
    steps: Array
    outputs: Array


def noise_model(
    chain: Chain, residual: Array, models: tuple[Autoregression, ...], steps: Array
) -> NoiseModel:
    """Return the noise that the residual would be if nothing were missing."""
    edges = chain.shots.edges
    innovations = innovations_of(models, residual, edges)
    order = max(model.order for model in models)
    inner = np.ones(len(residual), dtype=bool)
    for start in edges[:-1]:
        inner[start : start + order] = False
    kept = innovations[inner]
    return NoiseModel(
        models=models,
        innovations=kept - kept.mean(axis=0),
        size=np.sqrt(np.mean(residual**2, axis=0)),
        steps=steps,
        outputs=chain.outputs,
    )


def innovations_of(
    models: tuple[Autoregression, ...], residual: Array, edges: tuple[int, ...]
) -> Array:
    """Return what is new in every sample of a residual, (n, ny)."""
    return np.column_stack(
        [
            whitened(m, column, edges)
            for m, column in zip(models, residual.T, strict=True)
        ]
    )


def draw(noise: NoiseModel, count: int, random: np.random.Generator) -> Array:
    """Return `count` draws, (n, ny, count)."""
    n, ny = noise.outputs.shape
    rows = random.integers(0, len(noise.innovations), (n, count))
    drawn = np.empty((n, ny, count))
    for j, model in enumerate(noise.models):
        # The colour is an estimate: were it exact, slow noise would seem too sure.
        made = np.column_stack(
            [
                coloured(model.another(random), noise.innovations[one, j])
                for one in rows.T
            ]
        )
        size = np.sqrt(np.mean(made**2, axis=0))
        size = np.where(size > 0.0, size, 1.0)
        step = noise.steps[j]
        # What rounding adds is part of the residual that the noise was read from.
        before = np.sqrt(max(noise.size[j] ** 2 - step**2 / 12.0, 0.0))
        drawn[:, j] = made / size * before
        if step > 0.0:
            grid = noise.outputs[:, j, None] + random.uniform(0.0, step, count)
            drawn[:, j] = np.rint((grid + drawn[:, j]) / step) * step - grid
    return drawn
