"""State matrices and closed-loop poles of factored systems.

A realisation is a chain of first- and second-order sections, so that each root stays an
entry of its own. Closed-loop poles start as eigenvalues of that chain with the loop
closed and are polished together (Ehrlich and Aberth's iteration) on the factored
``D(s) + N(s)``, which keeps a pole at 10⁻³ exact beside one at 10⁶ rad/s.
"""

from typing import NamedTuple

import numpy as np

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.zero_pole_gain import (
    ComplexArray,
    FloatArray,
    ZeroPoleGain,
)

_STEPS = 40


class Matrices(NamedTuple):
    """``ẋ = A x + B u``, ``y = C x + D u``; the next x instead of ẋ if sampled."""

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray


def realise(system: ZeroPoleGain) -> Matrices:
    """Return state matrices of a system without its continuous delay.

    A sampled delay becomes states of its own.
    """
    poles = list(system.poles)
    if system.period is not None:
        poles += [0j] * round(system.delay / system.period)
    chain = Matrices(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.eye(1))
    scale = system.gain
    for some_poles, some_zeros in _sections(poles, list(system.zeros)):
        weight = _size(some_poles) / _size(some_zeros)
        scale /= weight
        chain = series(chain, _section(some_poles, some_zeros, weight))
    return Matrices(chain.A, chain.B, chain.C * scale, chain.D * scale)


Roots = list[complex]


def _size(roots: Roots) -> float:
    return float(np.prod([max(abs(r), 1e-3) for r in roots]))


def _sections(poles: Roots, zeros: Roots) -> list[tuple[Roots, Roots]]:
    """Return one or two poles at a time, each with zeros near them in size."""
    pairs = [[p, p.conjugate()] for p in poles if p.imag > 0]
    single = sorted((p for p in poles if p.imag == 0), key=abs)
    sections: list[tuple[Roots, Roots]] = []
    for zero in (z for z in zeros if z.imag > 0):
        if pairs:
            own = min(pairs, key=lambda pair: abs(abs(pair[0]) - abs(zero)))
            pairs.remove(own)
        else:  # a pair of zeros needs two poles
            own = [single.pop(), single.pop()]
        sections.append((own, [zero, zero.conjugate()]))
    open_: list[tuple[Roots, Roots]] = [(pair, []) for pair in pairs]
    open_ += [([p], []) for p in single]
    for zero in (z for z in zeros if z.imag == 0):
        free = [part for part in open_ if len(part[1]) < len(part[0])]
        near = min(free, key=lambda part: abs(abs(part[0][0]) - abs(zero)))
        near[1].append(zero)
    return sections + open_


def _section(poles: Roots, zeros: Roots, weight: float) -> Matrices:
    """Return ``weight Π(s - zero) / Π(s - pole)`` in controllable form."""
    n = len(poles)
    bottom = np.poly(poles).real
    top = np.zeros(n + 1)
    top[n - len(zeros) :] = weight * np.poly(zeros).real
    A = np.eye(n, k=1)
    A[-1] = -bottom[:0:-1]
    B = np.zeros((n, 1))
    B[-1] = 1.0
    rest = top[1:] - top[0] * bottom[1:]
    return Matrices(A, B, rest[None, ::-1].copy(), np.array([[top[0]]]))


def series(first: Matrices, second: Matrices) -> Matrices:
    """Return the system whose input enters `first` and whose output leaves `second`."""
    n, m = len(first.A), len(second.A)
    A = np.zeros((n + m, n + m))
    A[:n, :n], A[n:, n:] = first.A, second.A
    A[n:, :n] = second.B @ first.C
    B = np.concatenate([first.B, second.B @ first.D])
    C = np.concatenate([second.D @ first.C, second.C], axis=1)
    return Matrices(A, B, C, second.D @ first.D)


def closed_loop_poles(system: ZeroPoleGain) -> tuple[complex, ...]:
    """Return the poles of ``1 / (1 + L)``, hidden cancellations included.

    Poles that a zero of L cancels exactly stay poles of the closed loop.

    Raises
    ------
    LoopShapingError
        If there is a continuous delay (there are infinitely many poles), or L is -1 at
        infinite frequency (an algebraic loop without solution).
    """
    if system.delay and system.period is None:
        raise LoopShapingError(
            "A loop with a delay has infinitely many closed-loop poles.",
            remedy="Read the stability from measure(loop), which counts encirclements.",
        )
    A, B, C, D = realise(system)
    through = 1 + float(D[0, 0])
    if abs(through) < 1e-12 * (1 + abs(float(D[0, 0]))):
        raise LoopShapingError(
            "The loop gain is -1 at infinite frequency: the loop has no solution.",
            remedy="Add a pole, or change the gain.",
        )
    if not len(A):
        return ()
    starts = np.linalg.eigvals(A - B @ C / through)
    poles = _polished(system, np.asarray(starts, dtype=complex))
    return tuple(complex(p) for p in poles)


def _polished(system: ZeroPoleGain, starts: ComplexArray) -> ComplexArray:
    """Return the roots of ``D(s) + N(s)`` nearest to `starts`."""
    late = 0 if system.period is None else round(system.delay / system.period)
    zeros = np.array(system.zeros, dtype=complex)
    poles = np.array([*system.poles, *[0j] * late], dtype=complex)
    roots = starts.copy()
    for _ in range(_STEPS):
        newton = _newton_steps(roots, zeros, poles, system.gain)
        apart = roots[:, None] - roots[None, :]
        np.fill_diagonal(apart, 1.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            pull = 1 / apart
            np.fill_diagonal(pull, 0.0)
            step = newton / (1 - newton * pull.sum(axis=1))
        # Roots that coincide repel each other without bound; leave those alone.
        bad = ~np.isfinite(step) | (np.abs(step) > 1e-3 * (np.abs(roots) + 1e-9))
        step = np.where(bad, 0.0, step)
        roots = roots - step
        if (np.abs(step) <= 4e-16 * np.abs(roots)).all():
            break
    near = np.abs(roots.imag) < 1e-12 * np.abs(roots)
    return np.where(near, roots.real + 0j, roots)


def _newton_steps(
    at: ComplexArray, zeros: ComplexArray, poles: ComplexArray, gain: float
) -> ComplexArray:
    """Return ``(D + N) / (D + N)'`` at each point."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        to_zeros = at[:, None] - zeros
        to_poles = at[:, None] - poles
        # D + N = D (1 + N/D), so that its logarithmic derivative needs only ratios.
        ratio = gain * to_zeros.prod(axis=1) / to_poles.prod(axis=1)
        poles_sum, zeros_sum = (1 / to_poles).sum(axis=1), (1 / to_zeros).sum(axis=1)
        slope = (poles_sum + ratio * zeros_sum) / (1 + ratio)
        return np.asarray(1 / slope)
