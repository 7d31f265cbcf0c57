"""What the true structure leaves on the held-out recording when its numbers are fitted.

The measure of what can be achieved: nobody knows the numbers of a machine better than
its training recordings tell them.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.concealed.effects import Effect
from benchmarks.concealed.machine import Array
from benchmarks.concealed.recording import Plan, Run, replayed, simulate
from benchmarks.concealed.strength import (
    RELATIVE_STEP,
    Truth,
    base_state,
    noise_levels,
    orthonormal,
    state_steps,
)


def parameter_noise(
    truth: Truth,
    effects: Sequence[Effect],
    held_out: Plan,
    commands: Array,
) -> Array:
    """Return what fitting adds to the held-out error of the true structure, rms (ny,).

    To first order in the noise, which is taken as white: free parameters, the sizes of
    the effects and the initial states have the covariance of least squares on whole
    training recordings; on the held-out one its initial state is fitted again.
    """
    sigma = noise_levels(truth.machine)
    blocks = []
    for plan in truth.plans:
        played = replayed(plan, truth.run(plan, effects, exact=True).commands)
        own, shared = _whole_tangents(truth, effects, played, sigma)
        basis = orthonormal(own)
        blocks.append(shared - basis @ (basis.T @ shared))
    _, singular, right = np.linalg.svd(np.concatenate(blocks), full_matrices=False)
    known = singular > 1e-9 * singular.max()
    spread = right[known].T / singular[known]
    own, shared = _whole_tangents(truth, effects, replayed(held_out, commands), sigma)
    basis = orthonormal(own)
    error = (shared - basis @ (basis.T @ shared)) @ spread
    per_output = np.sum(error.reshape(-1, sigma.size, error.shape[1]) ** 2, axis=2)
    return np.asarray(np.sqrt(per_output.mean(axis=0)) * sigma)


def _whole_tangents(
    truth: Truth, effects: Sequence[Effect], plan: Plan, sigma: Array
) -> tuple[Array, Array]:
    """Return changes of the readings over noise, (N ny, states) and (N ny, shared)."""
    n = truth.machine.coordinates
    count = 2 * n + truth.machine.stores
    values = [
        {**truth.values, name: truth.values[name] * (1 + RELATIVE_STEP)}
        for name in truth.machine.free
    ]
    sizes = [
        [replace(e, amplitude=e.amplitude * (1 + RELATIVE_STEP * (e is one)))
         for e in effects]
        for one in effects
    ]  # fmt: skip
    plain = truth.run(plan, effects, exact=True)
    start = base_state(truth.machine, plain.states[0])
    steps = 0.01 * state_steps(truth.machine, plain)

    def change(run: Run) -> Array:
        return ((run.readings - plain.readings) / sigma).reshape(-1)

    def from_state(i: int) -> Run:
        state = start.copy()
        state[i] += steps[i]
        given = {"q": state[:n], "v": state[n : 2 * n], "z": state[2 * n :]}
        if any(effect.site.variant for effect in effects):
            given = {}  # its state is another one; its start at rest is known
        return simulate(
            truth.machine, plan, effects, values=truth.values, scales=truth.scales,
            start=given, exact=True,
        )  # fmt: skip

    own = np.array([change(from_state(i)) for i in range(count)]).reshape(count, -1).T
    shared = [
        change(replace(truth, values=one).run(plan, effects, exact=True))
        for one in values
    ]
    shared += [change(truth.run(plan, one, exact=True)) for one in sizes]
    return own, np.array(shared).T / RELATIVE_STEP
