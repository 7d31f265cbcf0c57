"""Small machines with concealed physics, simulated without any code of the library.

Semi-implicit Euler at a fine step; dry friction is set-valued (a clip that can hold).
"""

import numpy as np

FINE = 20


def multisine(time, seed, size):
    rng = np.random.default_rng(seed)
    frequencies = rng.uniform(0.2, 3.0, 8)
    phases = rng.uniform(0, 2 * np.pi, 8)
    waves = np.sin(2 * np.pi * np.outer(time, frequencies) + phases)
    return size * waves.sum(axis=1) / 2


def cart(
    seed,
    *,
    duration=8.0,
    step=0.005,
    noise=2e-4,
    mass=1.3,
    viscous=2.0,
    stiffness=0.0,
    coulomb=0.0,
    drag=0.0,
    spring=0.0,
    size=6.0,
):
    """Return time, force and measured position of a cart with what is concealed."""
    time = np.arange(0.0, duration, step)
    force = multisine(time, seed, size)
    fine = step / FINE
    x, v = 0.0, 0.0
    position = np.empty(time.size)
    for i in range(time.size):
        position[i] = x
        following = force[min(i + 1, time.size - 1)]
        for k in range(FINE):
            drive = force[i] + (following - force[i]) * k / FINE
            smooth = drive - viscous * v - drag * v * abs(v)
            smooth -= (stiffness + spring) * x
            free = v + fine * smooth / mass
            hold = fine * coulomb / mass
            v = np.sign(free) * max(abs(free) - hold, 0.0)
            x += fine * v
    rng = np.random.default_rng(seed + 10_000)
    return time, force, position + noise * rng.standard_normal(time.size)
