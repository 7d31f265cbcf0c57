"""The fitted model as a chain of exact linear steps, one from sample to sample.

Each sample of the fitted trajectory starts a simulation of one step. Its sensitivities
to the state it starts from, to the parameters and to every virtual source, held over
the step, are exact, whatever the laws and the solver; so the response of the outputs to
anything at any place costs one pass over the samples::

    δx' = Φ δx + Γ s + Γ_θ δθ + jump        (jump: where a new window begins)
    y - ŷ = C δx + D s + D_θ δθ
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.virtual.sources import (
    VirtualModel,
    VirtualSource,
    virtual_model,
    virtual_sources,
)
from bondgraph.fitting.estimate import FittedModel
from bondgraph.simulation.shooting import Shooting, Shots, shoot

Array = NDArray[np.float64]
BLOCK = 20_000
"""Steps linearised at once; bounds the memory of their sensitivities."""
GAP = 3.0
"""A step longer than this many median steps is not simulated across."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """A fitted model linearised along its own trajectory; see the module's head.

    Parameters
    ----------
    sources
        The virtual sources, in the order of the columns of `gamma` and `direct`.
    shots
        The windows of the fit. `follows[k]` says whether sample k continues the sample
        before it (also from one window to the next, within one recording).
    states, outputs
        The trajectory: (n, nx) and (n, ny).
    residuals
        Measured minus simulated, (n, ny), NaN where not measured.
    phi, gamma, gamma_theta, jump
        Of the step that leads *to* sample k: (n, nx, nx), (n, nx, L), (n, nx, nq) and
        (n, nx); zero where nothing leads to it.
    read, direct, read_theta
        C, D and D_θ: (n, ny, nx), (n, ny, L), (n, ny, nq).
    inside
        Whether sample k continues the one before it within the same window.
    """

    sources: tuple[VirtualSource, ...]
    shots: Shots
    follows: NDArray[np.bool_]
    inside: NDArray[np.bool_]
    states: Array
    outputs: Array
    residuals: Array
    phi: Array
    gamma: Array
    gamma_theta: Array
    jump: Array
    read: Array
    direct: Array
    read_theta: Array

    def rows(self, chosen: NDArray[np.int64]) -> "Chain":
        """Return the chain over some samples, increasing; each break starts anew."""
        begins = np.diff(chosen, prepend=-2) != 1
        alone = begins | ~self.inside[chosen]
        edges = (*(int(i) for i in np.flatnonzero(alone)), len(chosen))
        shots = Shots(
            self.shots.time[chosen],
            self.shots.inputs[chosen],
            self.shots.outputs[chosen],
            edges,
        )
        parts = {
            field.name: getattr(self, field.name)[chosen]
            for field in fields(self)
            if field.name not in ("sources", "shots")
        }
        for name in ("follows", "inside"):
            parts[name] = parts[name] & ~begins
        return replace(self, shots=shots, **parts)

    @property
    def step(self) -> float:
        """The median step in seconds; 1 where no sample follows another."""
        steps = np.diff(self.shots.time)[self.follows[1:]]
        return float(np.median(steps)) if len(steps) else 1.0


def linear_chain(
    fitted: FittedModel,
    sources: Sequence[VirtualSource] | None = None,
    *,
    virtual: VirtualModel | None = None,
    theta: Array | None = None,
    states: Array | None = None,
) -> Chain:
    """Return the fitted model as a chain of linear steps with virtual sources.

    Parameters
    ----------
    sources
        At every junction, input and output when None.
    virtual
        The model with these sources, where it is at hand.
    theta, states
        Free parameters and states (n, nx) to linearise at, those of the fit when None.
        Any states will do: `Chain.jump` is what a step misses.
    """
    chosen = virtual_sources(fitted.graph) if sources is None else tuple(sources)
    virtual = virtual_model(fitted.graph, chosen) if virtual is None else virtual
    shots = fitted.problem.shots
    states = trajectory(fitted) if states is None else states
    if theta is not None:
        fitted = replace(fitted, optimum=replace(fitted.optimum, theta=theta))
    follows, inside = _links(shots)
    names = virtual.model.parameter_names
    free = fitted.problem.free_names
    directions = [names.index(name) for name in free]
    directions += [names.index(source.parameter) for source in chosen]
    ny, nq = virtual.n_outputs, len(free)
    outputs, at = _samples(fitted, virtual, shots, states, directions)
    end = nq + len(chosen)
    following = np.flatnonzero(follows)
    reached, steps = _steps(fitted, virtual, shots, states, following, directions)
    jump = np.zeros_like(states)
    jump[following] = reached - states[following]
    return Chain(
        sources=chosen,
        shots=shots,
        follows=follows,
        inside=inside,
        states=states,
        outputs=outputs,
        residuals=shots.outputs - outputs,
        phi=_spread(steps[:, :, end:], following, len(states)),
        gamma=_spread(steps[:, :, nq:end], following, len(states)),
        gamma_theta=_spread(steps[:, :, :nq], following, len(states)),
        jump=jump,
        read=np.ascontiguousarray(at[:, :ny, end:]),
        direct=at[:, :ny, nq:end],
        read_theta=at[:, :ny, :nq],
    )


def trajectory(fitted: FittedModel) -> Array:
    """Return the simulated states of the fitted model, (n, nx)."""
    problem = fitted.problem
    shot = shoot(
        problem.model,
        problem.shots,
        parameters=fitted.parameters,
        initial=fitted.optimum.initial,
        directions=None,
        solver=problem.solver,
        hold=problem.hold,
    )
    return shot.states


def _links(shots: Shots) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which samples follow the one before: at all, and in the same window."""
    n = len(shots.time)
    inside = np.ones(n, dtype=bool)
    inside[list(shots.edges[:-1])] = False
    follows = inside.copy()
    steps = np.diff(shots.time)
    usual = np.median(steps[inside[1:]]) if inside.any() else 0.0
    follows[1:] |= (steps > 0.0) & (steps <= GAP * usual)
    return follows, inside


def _samples(
    fitted: FittedModel,
    virtual: VirtualModel,
    shots: Shots,
    states: Array,
    directions: Sequence[int],
) -> tuple[Array, Array]:
    """Return outputs and their sensitivities at every sample, without any step."""
    n, ny = len(states), virtual.n_outputs
    outputs, slopes = [], []
    for first in range(0, n, BLOCK):
        rows = np.arange(first, min(first + BLOCK, n))
        shot = _shoot(fitted, virtual, shots, rows[:, None], states[rows], directions)
        outputs.append(shot.outputs[:, :ny])
        slopes.append(shot.sensitivities[:, :ny].copy())
    return np.concatenate(outputs), np.concatenate(slopes)


def _steps(
    fitted: FittedModel,
    virtual: VirtualModel,
    shots: Shots,
    states: Array,
    following: NDArray[np.int64],
    directions: Sequence[int],
) -> tuple[Array, Array]:
    """Return where each step to `following` ends, and its sensitivities."""
    ny, nx = virtual.n_outputs, virtual.model.n_states
    ends, slopes = [np.zeros((0, nx))], [np.zeros((0, nx, len(directions) + nx))]
    for first in range(0, len(following), BLOCK):
        to = following[first : first + BLOCK]
        pairs = np.column_stack([to - 1, to])
        shot = _shoot(fitted, virtual, shots, pairs, states[to - 1], directions)
        ends.append(shot.outputs[1::2, ny:])
        slopes.append(shot.sensitivities[1::2, ny:].copy())
    return np.concatenate(ends), np.concatenate(slopes)


def _shoot(
    fitted: FittedModel,
    virtual: VirtualModel,
    shots: Shots,
    rows: NDArray[np.int64],
    initial: Array,
    directions: Sequence[int],
) -> Shooting:
    """Simulate windows given by their rows, (windows, samples)."""
    flat = rows.ravel()
    width = len(virtual.model.output_names)
    edges = tuple(range(0, len(flat) + 1, rows.shape[1]))
    part = Shots(
        shots.time[flat], shots.inputs[flat], np.zeros((len(flat), width)), edges
    )
    known = dict(
        zip(fitted.problem.model.parameter_names, fitted.parameters, strict=True)
    )
    return shoot(
        virtual.model,
        part,
        parameters=np.array([known.get(n, 0.0) for n in virtual.model.parameter_names]),
        initial=initial,
        directions=np.array(directions, dtype=np.int64),
        solver=fitted.problem.solver,
        hold=fitted.problem.hold,
    )


def _spread(values: Array, rows: NDArray[np.int64], n: int) -> Array:
    """Return an array of `n` rows: `values` at the given ones, zero elsewhere."""
    spread = np.zeros((n, *values.shape[1:]))
    spread[rows] = values
    return spread
