"""A family of test signals between -1 and 1: steps, sines, triangles, sweeps."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def waves(time: Array, random: np.random.Generator) -> dict[str, Array]:
    """Return signals by name, one value per time, between -1 and 1.

    Slow ones take a good part of the duration for one period, fast ones some fifty
    samples.
    """
    duration, step = float(time[-1] - time[0]), float(np.median(np.diff(time)))
    slow, fast = 2.0 / duration, 1.0 / (50.0 * step)
    middle = float(np.sqrt(slow * fast))
    elapsed = time - time[0]
    return {
        "slow triangle": _triangle(elapsed, slow),
        "triangle": _triangle(elapsed, middle),
        "slow multisine": _multisine(elapsed, slow, middle, random),
        "fast multisine": _multisine(elapsed, middle, fast, random),
        "multisine": _multisine(elapsed, slow, fast, random),
        "slow staircase": _steps(elapsed, 4.0 * slow, random),
        "staircase": _steps(elapsed, 4.0 * middle, random),
        "sweep": _sweep(elapsed, slow, fast),
        "small multisine": 0.1 * _multisine(elapsed, slow, middle, random),
    }


def _triangle(time: Array, frequency: float) -> Array:
    phase = (time * frequency + 0.25) % 1.0
    wave: Array = 1.0 - 4.0 * np.abs(phase - 0.5)
    return wave


def _multisine(
    time: Array, low: float, high: float, random: np.random.Generator
) -> Array:
    """Return ten sines, evenly on a logarithmic scale, of which none repeats."""
    frequencies = np.geomspace(low, high, 10) * random.uniform(0.9, 1.1, 10)
    phases = random.uniform(0.0, 2.0 * np.pi, 10)
    wave = np.sin(2.0 * np.pi * np.outer(time, frequencies) + phases).sum(axis=1)
    unit: Array = wave / np.abs(wave).max()
    return unit


def _steps(time: Array, rate: float, random: np.random.Generator) -> Array:
    """Return levels that change about `rate` times a second."""
    changes = np.floor(time * rate).astype(np.int64)
    levels: Array = random.uniform(-1.0, 1.0, changes.max() + 1)
    return levels[changes]


def _sweep(time: Array, low: float, high: float) -> Array:
    """Return a sine whose frequency grows evenly on a logarithmic scale."""
    growth = np.log(high / low) / time[-1]
    wave: Array = np.sin(2.0 * np.pi * low * np.expm1(growth * time) / growth)
    return wave
