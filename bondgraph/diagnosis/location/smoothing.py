"""The signal that a virtual source must give, recovered by smoothing.

The signal s is an Ornstein-Uhlenbeck process, s' = -s/τ + white noise with standard
deviation σ; states, parameters and s are estimated together by a Kalman filter and
smoother along the chain of exact linear steps. σ and τ maximise the likelihood, in
which the noise level is concentrated out: what a filter that knows nothing of a source
needs as noise, a source must explain (Hartikainen and Särkkä 2010; the smoother is that
of Bryson and Frazier 1963).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.virtual.chain import Chain

Array = NDArray[np.float64]
STRETCHES, STRETCH = 4, 500
"""Of long recordings so many stretches of so many samples choose σ and τ."""
SHARES = (0.01, 0.1, 1.0, 10.0, 100.0)
TIMES = (4.0, 40.0, 400.0)
EVALUATIONS = 30
DIFFUSE = 10.0
"""Initial states are known to so many times their own spread."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Priors:
    """What is known before the recordings speak.

    Parameters
    ----------
    noise
        Standard deviation of the white measurement noise per output.
    theta
        Standard deviation of every free parameter.
    offset
        Prior mean of the parameters minus the values that the chain is taken at.
    """

    noise: Array
    theta: Array
    offset: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SmoothedSource:
    """What one place must have given.

    Parameters
    ----------
    signal, std
        Of the source, one value per sample, in its unit.
    likelihood, evidence
        Log likelihood, and its gain over no source, in nats; 0 where none is best.
    size, correlation_time
        σ, and τ in seconds, of the process.
    level
        By how much the noise had to be larger than what was said of it.
    states, theta
        Smoothed states (n, nx) and the change of the free parameters.
    """

    signal: Array
    std: Array
    likelihood: float
    evidence: float
    size: float
    correlation_time: float
    level: float
    states: Array
    theta: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Filter:
    """A chain with one source, scaled so that states and parameters are about one."""

    phi: Array
    gamma: Array
    gamma_theta: Array
    jump: Array
    follows: NDArray[np.int64]
    read: Array
    direct: Array
    read_theta: Array
    residual: Array
    noise: Array
    steps: Array
    prior: Array

    def run(self, size: float, time: float, kept: "_Kept") -> float:
        """Return the log likelihood, the noise level concentrated out."""
        from bondgraph.diagnosis.location.recursions import (  # noqa: PLC0415
            filter_chain,
        )

        logs, squares, count = filter_chain(
            self.phi, self.gamma, self.gamma_theta, self.jump, self.follows,
            self.read, self.direct, self.read_theta, self.residual, self.noise,
            np.exp(-self.steps / time), size**2, self.prior,
            np.ones(self.gamma_theta.shape[2]), *kept.arrays,
        )  # fmt: skip
        kept.level = squares / max(count, 1)
        if not math.isfinite(logs) or not kept.level > 0.0:
            return -math.inf
        return -0.5 * (logs + count * math.log(kept.level))


class _Kept:
    """What a filter run leaves for the smoother; empty arrays keep nothing."""

    def __init__(self, n: int, ny: int, d: int) -> None:
        self.arrays = (
            np.zeros((n, d)),
            np.zeros((n, d, d)),
            np.zeros((n, ny, d)),
            np.zeros((n, ny)),
            np.zeros((n, ny)),
        )
        self.level = 1.0


@dataclass(frozen=True, slots=True)
class Process:
    """The prior of a signal: σ over the noise level, and τ in seconds."""

    size: float
    time: float


def smooth(
    chain: Chain, priors: Priors, process: Process | None = None
) -> SmoothedSource:
    """Return the signal recovered at the only source of a chain.

    Parameters
    ----------
    process
        Of the signal; the most likely one when None.
    """
    scale = _state_scale(chain)
    model = _scaled(chain, 0, priors, scale)
    process = _most_likely(model, chain.step) if process is None else process
    size, time = process.size, process.time
    n, ny, nx = chain.read.shape
    d = nx + 1 + chain.read_theta.shape[2]
    kept = _Kept(n, ny, d)
    likelihood = model.run(size, time, kept)
    without = model.run(0.0, time, _Kept(0, ny, d))
    smoothed, variance = _smoothed(model, time, kept)
    return SmoothedSource(
        signal=smoothed[:, nx],
        std=np.sqrt(np.maximum(variance, 0.0) * kept.level),
        likelihood=likelihood,
        evidence=max(float(likelihood - without), 0.0),
        size=size * math.sqrt(kept.level),
        correlation_time=time,
        level=math.sqrt(kept.level),
        states=chain.states + smoothed[:, :nx] * scale,
        theta=smoothed[-1, nx + 1 :] * priors.theta + priors.offset,
    )


def _smoothed(model: _Filter, time: float, kept: _Kept) -> tuple[Array, Array]:
    from bondgraph.diagnosis.location.recursions import smooth_chain  # noqa: PLC0415

    means = kept.arrays[0]
    smoothed, variance = np.zeros_like(means), np.zeros(len(means))
    smooth_chain(
        model.phi, model.gamma, model.gamma_theta, model.follows, model.read,
        model.direct, model.read_theta, np.exp(-model.steps / time), *kept.arrays,
        smoothed, variance,
    )  # fmt: skip
    return smoothed, variance


def _state_scale(chain: Chain) -> Array:
    """Return the typical size of every state, never zero."""
    size = np.sqrt(np.mean(chain.states**2, axis=0))
    return np.where(size > 0.0, size, 1.0)


def _scaled(chain: Chain, source: int, priors: Priors, scale: Array) -> _Filter:
    """Return the chain with states, parameters and outputs in units of about one."""
    shift = chain.gamma_theta @ priors.offset
    known = chain.read_theta @ priors.offset
    steps = np.diff(chain.shots.time, prepend=chain.shots.time[:1])
    return _Filter(
        phi=chain.phi * (scale / scale[:, None]),
        gamma=np.ascontiguousarray(chain.gamma[:, :, source] / scale),
        gamma_theta=chain.gamma_theta * priors.theta / scale[:, None],
        jump=(chain.jump + shift) / scale,
        follows=chain.follows.astype(np.int64),
        read=np.ascontiguousarray(chain.read * scale / priors.noise[:, None]),
        direct=np.ascontiguousarray(chain.direct[:, :, source] / priors.noise),
        read_theta=chain.read_theta * priors.theta / priors.noise[:, None],
        residual=(chain.residuals - known) / priors.noise,
        noise=np.ones(len(priors.noise)),
        steps=np.where(chain.follows, np.maximum(steps, 0.0), 0.0),
        prior=np.full(len(scale), DIFFUSE**2),
    )


def _most_likely(model: _Filter, step: float) -> Process:
    """Return σ and τ that maximise the likelihood."""
    from scipy.optimize import minimize  # noqa: PLC0415

    ny, nx = model.read.shape[1:]
    kept = _Kept(0, ny, nx + 1 + model.read_theta.shape[2])
    model.run(0.0, step, kept)
    # Where the filter fails without a source, the noise alone tells what is large.
    unit = _unit(model, math.sqrt(kept.level) or 1.0)

    def cost(point: Array) -> float:
        return -model.run(math.exp(point[0]), math.exp(point[1]), kept)

    grid = [np.log([share * unit, many * step]) for share in SHARES for many in TIMES]
    start = min(grid, key=cost)
    best = minimize(
        cost,
        start,
        method="Nelder-Mead",
        options={
            "maxfev": EVALUATIONS,
            "xatol": 0.05,
            "fatol": 0.05,
            "initial_simplex": start + np.array([[0, 0], [1.0, 0], [0, 1.0]]),
        },
    )
    size, time = np.exp(best.x)
    return Process(float(size), float(time))


def _unit(model: _Filter, level: float) -> float:
    """Return the size of a source whose effect over ten samples is as the misfit."""
    from bondgraph.diagnosis.location.recursions import (  # noqa: PLC0415
        respond_to_features,
    )

    n, ny, _ = model.read.shape
    linked = model.follows.copy()
    linked[::10] = 0
    out = np.zeros((n, ny, 1))
    respond_to_features(
        model.phi, model.read, linked, model.gamma, model.direct, np.ones((n, 1)), out
    )
    size = float(np.sqrt(np.mean(out**2)))
    return level / size if size > 0.0 else 1.0


def stretches(n: int) -> NDArray[np.int64]:
    """Return the samples of a few stretches spread over `n`, all if they are few."""
    if n <= STRETCHES * STRETCH:
        return np.arange(n)
    starts = np.linspace(0, n - STRETCH, STRETCHES).astype(np.int64)
    return np.concatenate([start + np.arange(STRETCH) for start in starts])
