"""How large an effect is: what the best base model leaves of it, over the noise.

The machine with the effect is compared with the machine without it, which may change
its free parameters and its state at the start of every window to first order. What
remains, over the sensor's noise, is the strength. It is computed by this simulator, on
the training recordings, and is no opinion of the tool under test.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.concealed.effects import Effect, Scales
from benchmarks.concealed.machine import Array, Machine, Site
from benchmarks.concealed.recording import Plan, Run, replayed, simulate

RELATIVE_STEP = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """A machine with its true numbers, and the scales of its motion without effects."""

    machine: Machine
    values: Mapping[str, float]
    scales: Mapping[str, Scales]
    plans: tuple[Plan, ...]

    def run(self, plan: Plan, effects: Sequence[Effect], *, exact: bool) -> Run:
        """Return a run with effects."""
        return simulate(
            self.machine,
            plan,
            effects,
            values=self.values,
            scales=self.scales,
            exact=exact,
        )


def noise_levels(machine: Machine) -> Array:
    """Return the noise per output: the sensor's and that of rounding."""
    return np.array(
        [np.hypot(one.noise, one.step / np.sqrt(12.0)) for one in machine.sensors]
    )


def edges_of(machine: Machine, samples: int) -> list[tuple[int, int]]:
    """Return first and last sample of every window."""
    length = machine.window or samples
    starts = range(0, max(samples - length // 2, 1), length)
    return [(first, min(first + length, samples)) for first in starts]


def base_readings(
    truth: Truth, run: Run, plan: Plan, change: Mapping[str, float], bump: int = -1
) -> Array:
    """Return what the machine without effects reads, window by window.

    Each window starts in the state in which `run` was, with state number `bump` moved.
    """
    machine = truth.machine
    n = machine.coordinates
    given = np.full_like(run.readings, np.nan)
    values = {**truth.values, **change}
    for first, last in edges_of(machine, len(run.time)):
        state = base_state(machine, run.states[first])
        if bump >= 0:
            state[bump] += state_steps(machine, run)[bump]
        piece = replace(
            replayed(plan, run.commands),
            feed=run.commands[first:last],
            reference=plan.reference[first:last],
            noise=np.zeros_like(plan.noise[first:last]),
            early=np.zeros_like(plan.early[first:last]),
        )
        start = {"q": state[:n], "v": state[n : 2 * n], "z": state[2 * n :]}
        given[first:last] = simulate(
            machine, piece, values=values, start=start, exact=True
        ).readings
    return given


def base_state(machine: Machine, state: Array) -> Array:
    """Return the state of the base machine; one with more coordinates has more."""
    n, extra = machine.coordinates, (state.size - machine.stores) // 2
    if extra == n:
        return state.copy()
    q, v, z = state[:extra], state[extra : 2 * extra], state[2 * extra :]
    kept = slice(0, n) if n > 1 else slice(extra - n, extra)
    return np.concatenate((q[kept], v[kept], z))


def state_steps(machine: Machine, run: Run) -> Array:
    states = np.array([base_state(machine, state) for state in run.states])
    return 1e-3 * (states.std(axis=0) + 1e-9)


def tangent(truth: Truth, run: Run, plan: Plan, base: Array) -> tuple[Array, Array]:
    """Return changes of the readings with the free parameters, and with the states.

    Shapes (free, N, ny) and (states, N, ny); the states are those at window starts.
    """
    with_parameters = [
        (
            base_readings(truth, run, plan, {n: truth.values[n] * (1 + RELATIVE_STEP)})
            - base
        )
        / RELATIVE_STEP
        for n in truth.machine.free
    ]
    count = 2 * truth.machine.coordinates + truth.machine.stores
    with_states = [
        base_readings(truth, run, plan, {}, bump=i) - base for i in range(count)
    ]
    return np.array(with_parameters), np.array(with_states)


@dataclass(frozen=True, slots=True)
class Absorbed:
    """What free parameters and window states of the base model can absorb.

    Computed once for a machine and its plans: it hardly depends on the effect.
    """

    truth: Truth
    by_state: tuple[Array, ...]
    by_parameter: Array

    @classmethod
    def of(cls, truth: Truth) -> "Absorbed":
        """Return it about the motion without effects."""
        machine, sigma = truth.machine, noise_levels(truth.machine)
        states, blocks = [], []
        for plan in truth.plans:
            run = truth.run(plan, (), exact=True)
            run = truth.run(replayed(plan, run.commands), (), exact=True)
            base = base_readings(truth, run, plan, {})
            by_parameter, by_state = tangent(truth, run, plan, base)
            for first, last in edges_of(machine, len(plan.time)):
                columns = (by_parameter / sigma)[:, first:last]
                own = (by_state / sigma)[:, first:last].reshape(len(by_state), -1)
                columns = columns.reshape(len(machine.free), -1).T
                states.append(orthonormal(own.T))
                blocks.append(columns - states[-1] @ (states[-1].T @ columns))
        return cls(truth, tuple(states), orthonormal(np.concatenate(blocks)))

    def strength(self, effects: Sequence[Effect]) -> Array:
        """Return per output the rms that the best base model leaves, over the noise."""
        truth, sigma = self.truth, noise_levels(self.truth.machine)
        rests = []
        bases = iter(self.by_state)
        for plan in truth.plans:
            run = truth.run(plan, effects, exact=True)
            run = truth.run(replayed(plan, run.commands), effects, exact=True)
            if not np.all(np.isfinite(run.readings)):
                return np.full(sigma.size, np.inf)
            rest = (run.readings - base_readings(truth, run, plan, {})) / sigma
            for first, last in edges_of(truth.machine, len(plan.time)):
                piece, basis = rest[first:last].reshape(-1), next(bases)
                rests.append(piece - basis @ (basis.T @ piece))
        remaining = np.concatenate(rests)
        remaining -= self.by_parameter @ (self.by_parameter.T @ remaining)
        return np.sqrt(np.mean(remaining.reshape(-1, sigma.size) ** 2, axis=0))


def orthonormal(columns: Array) -> Array:
    """Return an orthonormal basis of the columns' span."""
    sizes = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(sizes > 0.0, sizes, 1.0)
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    return np.asarray(left[:, singular > 1e-9 * max(singular.max(), 1e-300)])


def amplitude_for(absorbed: Absorbed, site: Site, wanted: float) -> float:
    """Return the amplitude at which the strength is about `wanted`.

    It is at most the largest that makes sense. Strength grows roughly in proportion; a
    few corrected steps come close enough.
    """
    amplitude = 0.05 * site.largest
    low, high = 0.0, site.largest
    for _ in range(6):
        reached = float(absorbed.strength([Effect(site, amplitude)]).max())
        if abs(np.log(max(reached, 1e-12) / wanted)) < 0.1:
            break
        if reached < wanted:
            low = amplitude
        else:
            high = amplitude
        step = amplitude * min(max(wanted / max(reached, 1e-12), 0.03), 30.0)
        inside = low < step < high
        amplitude = step if inside else (high if low == 0.0 else (low + high) / 2.0)
        if step >= site.largest and low < site.largest == high:
            amplitude = site.largest
            if low == amplitude:
                break
    return amplitude
