"""Machines to practise on, stepped by hand: each has one thing that its model lacks.

No law and no solver of the toolkit is used, so that what is found is not put in by it.
Short explicit steps between samples; dry friction holds a speed at zero as long as the
other torques cannot overcome it. Sensors add white noise.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rates = Callable[[Array, float], Array]
"""The rates of the states, from states and input."""

SUBSTEPS = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """How a machine is driven: levels at random, each held for some samples.

    Parameters
    ----------
    step
        Seconds between samples.
    held
        Samples for which a level is held, fewest and most.
    low, high
        The range of the levels.
    """

    step: float
    held: tuple[int, int]
    low: float
    high: float

    def levels(self, count: int, generator: np.random.Generator) -> Array:
        """Return so many samples of the input."""
        pieces: list[Array] = []
        while sum(piece.size for piece in pieces) < count:
            level = generator.uniform(self.low, self.high)
            pieces.append(np.full(generator.integers(*self.held), level))
        return np.concatenate(pieces)[:count]


def motor_columns(count: int, seed: int) -> Mapping[str, Array]:
    """Return a motor's recording: dry friction of its bearing is what is hidden."""
    resistance, constant, inertia, viscous, dry = 2.6, 0.062, 2.1e-4, 4e-5, 0.012
    generator = np.random.default_rng(seed)
    drive = Drive(step=0.01, held=(10, 60), low=-12.0, high=12.0)
    voltage = drive.levels(count, generator)
    speed = np.zeros(count)
    short = drive.step / SUBSTEPS
    now = 0.0
    for k, volts in enumerate(voltage):
        speed[k] = now
        for _ in range(SUBSTEPS):
            torque = constant * (volts - constant * now) / resistance - viscous * now
            free = now + short / inertia * torque
            # What friction takes away, at most all of the speed that is left.
            now = np.sign(free) * max(abs(free) - short / inertia * dry, 0.0)
    current = (voltage - constant * speed) / resistance
    return {
        "t [s]": drive.step * np.arange(count, dtype=np.float64),
        "U [V]": voltage,
        "i [A]": current + 0.02 * generator.normal(size=count),
        "n [rpm]": 60 / (2 * np.pi) * speed + 5.0 * generator.normal(size=count),
    }


def spring_columns(count: int, seed: int) -> Mapping[str, Array]:
    """Return a carriage's recording: that its spring hardens is what is hidden."""
    mass, stiffness, cubic, damper = 1.4, 120.0, 4e4, 2.2

    def rates(state: Array, force: float) -> Array:
        position, velocity = state
        pull = stiffness * position + cubic * position**3
        return np.array([velocity, (force - pull - damper * velocity) / mass])

    generator = np.random.default_rng(seed)
    drive = Drive(step=0.01, held=(15, 80), low=-8.0, high=8.0)
    force = drive.levels(count, generator)
    position = _stepped(rates, np.zeros(2), force, drive.step)[:, 0]
    return {
        "t [s]": drive.step * np.arange(count, dtype=np.float64),
        "F [N]": force,
        "x [mm]": 1e3 * position + 0.1 * generator.normal(size=count),
    }


def tanks_columns(count: int, seed: int) -> Mapping[str, Array]:
    """Return two tanks' recording: that the upper one runs over is what is hidden."""
    upper, lower, pipe, outlet = 2.4e-6, 1.7e-6, 1.5e7, 1.2e7
    edge, over = 3.2e3, 4e-7

    def rates(state: Array, pump: float) -> Array:
        between = (state[0] - state[1]) / pipe
        spilt = over * max(state[0] - edge, 0.0)
        into = pump - between - spilt
        return np.array([into / upper, (between - state[1] / outlet) / lower])

    generator = np.random.default_rng(seed)
    drive = Drive(step=1.0, held=(20, 120), low=2e-5, high=2e-4)
    pump = drive.levels(count, generator)
    levels = _stepped(rates, np.array([3e3, 2e3]), pump, drive.step)
    noise = 0.02 * generator.normal(size=(count, 2))
    return {
        "t [s]": drive.step * np.arange(count, dtype=np.float64),
        "Q [L/min]": 6e4 * pump,
        "p1 [kPa]": 1e-3 * levels[:, 0] + noise[:, 0],
        "p2 [kPa]": 1e-3 * levels[:, 1] + noise[:, 1],
    }


def _stepped(rates: Rates, start: Array, driven: Array, step: float) -> Array:
    """Return the states at the samples, the input held between them."""
    states, now, short = np.zeros((driven.size, start.size)), start, step / SUBSTEPS
    for k, level in enumerate(driven):
        states[k] = now
        for _ in range(SUBSTEPS):
            half = now + 0.5 * short * rates(now, level)
            now = now + short * rates(half, level)
    return states
