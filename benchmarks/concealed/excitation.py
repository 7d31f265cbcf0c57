"""Test signals: training and held-out recordings are excited in different ways."""

import numpy as np
from numpy.random import Generator

from benchmarks.concealed.machine import Array

TRAINING = ("multisine", "random_steps")
HELD_OUT = ("sweep", "splines", "triangles")


def excitation(
    kind: str, time: Array, band: tuple[float, float], random: Generator
) -> Array:
    """Return a signal of about unit size in a frequency band, starting at zero."""
    signal = _KINDS[kind](time, band, random)
    rise = np.minimum(1.0, (time - time[0]) * 2.0 * band[0])
    return np.asarray((signal - signal[0]) * rise)


def multisine(time: Array, band: tuple[float, float], random: Generator) -> Array:
    """Return ten sines at random frequencies, evenly on a logarithmic scale."""
    frequencies = np.exp(random.uniform(*np.log(band), size=10))
    phases = random.uniform(0.0, 2.0 * np.pi, size=10)
    waves = np.sin(2.0 * np.pi * np.outer(time, frequencies) + phases)
    return np.asarray(waves.sum(axis=1) / 2.5)


def random_steps(time: Array, band: tuple[float, float], random: Generator) -> Array:
    """Return random levels held for random times, rounded at the corners."""
    signal = np.zeros_like(time)
    at = float(time[0])
    while at < time[-1]:
        signal[time >= at] = random.uniform(-1.0, 1.0)
        at += random.uniform(0.5, 1.5) / band[0] / 4.0
    return _smoothed(signal, time, 1.0 / (2.0 * np.pi * band[1]))


def sweep(time: Array, band: tuple[float, float], random: Generator) -> Array:
    """Return a sine whose frequency rises through the band, and a slower one."""
    length = time[-1] - time[0]
    ratio = np.log(band[1] / band[0])
    phase = band[0] * length / ratio * np.expm1(ratio * (time - time[0]) / length)
    slow = np.sin(np.pi * band[0] * time + random.uniform(0.0, 2.0 * np.pi))
    return np.asarray(0.8 * np.sin(2.0 * np.pi * phase) + 0.4 * slow)


def splines(time: Array, band: tuple[float, float], random: Generator) -> Array:
    """Return fifth-order splines between random levels, with pauses."""
    signal, at, level = np.zeros_like(time), float(time[0]), 0.0
    while at < time[-1]:
        span = random.uniform(0.3, 1.0) / band[0] / 2.0
        target = level if random.random() < 0.2 else random.uniform(-1.0, 1.0)
        inside = (time >= at) & (time <= at + span)
        s = (time[inside] - at) / span
        signal[inside] = level + (target - level) * s**3 * (10 - 15 * s + 6 * s**2)
        at, level = at + span, target
    return signal


def triangles(time: Array, band: tuple[float, float], random: Generator) -> Array:
    """Return straight lines between random levels at changing speeds."""
    corners, levels = [float(time[0])], [0.0]
    while corners[-1] < time[-1]:
        corners.append(corners[-1] + random.uniform(0.2, 1.0) / band[0] / 2.0)
        levels.append(random.uniform(0.3, 1.0) * (-1.0) ** len(levels))
    return np.interp(time, corners, levels)


def _smoothed(signal: Array, time: Array, constant: float) -> Array:
    share = 1.0 - np.exp(-(time[1] - time[0]) / constant)
    smooth, level = np.empty_like(signal), signal[0]
    for i, value in enumerate(signal):
        level += share * (value - level)
        smooth[i] = level
    return smooth


_KINDS = {
    "multisine": multisine,
    "random_steps": random_steps,
    "sweep": sweep,
    "splines": splines,
    "triangles": triangles,
}
