"""How much of the residual a law at a place explains, on samples it was not fitted to.

A law's columns are sent through the chain of exact linear steps to the outputs, so that
they are compared with the residual itself: nothing is deconvolved, and what the free
parameters and initial states could do as well is taken out exactly. What existing
elements of the place already span is among that.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.virtual.chain import Chain
from bondgraph.fitting.truncated_inverse import truncated_inverse

Array = NDArray[np.float64]
CHUNKS, FOLDS = 24, 6
RIDGE = 1e-6
DEPENDENT = 1e-9
"""Directions smaller than this share of the largest are not there."""


@dataclass(frozen=True, slots=True, eq=False)
class Baseline:
    """The residual and parameter sensitivities, initial states projected out.

    Parameters
    ----------
    basis
        Orthonormal columns of the initial states, per window.
    target, theta
        (rows,), (rows, nq); a row is one output at one sample, in units of its noise.
    prior
        Precision of the parameters, in the same units.
    offset
        Prior mean of the parameters minus the values the chain is taken at.
    initial
        The outputs' response to each window's initial state, (n, ny, nx).
    weight
        One over the noise, zero where nothing was measured, (n, ny).
    chunk
        The chunk of each row.
    """

    edges: tuple[int, ...]
    basis: tuple[Array, ...]
    target: Array
    theta: Array
    prior: Array
    offset: Array
    initial: Array
    weight: Array
    chunk: NDArray[np.int64]


def baseline(chain: Chain, noise: Array, prior_std: Array, offset: Array) -> Baseline:
    """Return what is to be explained, and what parameters could do about it.

    Parameters
    ----------
    noise
        Scale per output.
    """
    measured = np.isfinite(chain.residuals)
    weight = np.where(measured, 1.0 / noise, 0.0)
    linked = chain.inside.astype(np.int64)
    jump = np.where(chain.inside[:, None], chain.jump, 0.0)
    moved = _respond(chain, linked, jump[:, :, None], _none(chain, 1))[:, :, 0]
    residual = np.where(measured, chain.residuals, 0.0) - moved
    theta, initial = theta_responses(chain), initial_responses(chain)
    nx = chain.phi.shape[1]
    edges = chain.shots.edges
    basis = tuple(
        span((initial[a:b] * weight[a:b, :, None]).reshape(-1, nx))
        for a, b in pairwise(edges)
    )
    ny = residual.shape[1]
    bare = Baseline(
        edges=edges,
        basis=basis,
        target=np.zeros(0),
        theta=np.zeros((0, 0)),
        prior=1.0 / prior_std**2,
        offset=offset,
        initial=initial,
        weight=weight,
        chunk=np.repeat(_chunks(edges), ny),
    )
    return replace(
        bare,
        target=projected(bare, residual[:, :, None])[:, 0],
        theta=projected(bare, theta),
    )


def theta_responses(chain: Chain) -> Array:
    """Return the outputs' sensitivities to the free parameters, (n, ny, nq)."""
    forcing = np.where(chain.inside[:, None, None], chain.gamma_theta, 0.0)
    return _respond(chain, chain.inside.astype(np.int64), forcing, chain.read_theta)


def initial_responses(chain: Chain) -> Array:
    """Return the outputs' sensitivities to their initial states, (n, ny, nx)."""
    nx = chain.phi.shape[1]
    start = np.zeros((len(chain.states), nx, nx))
    start[~chain.inside] = np.eye(nx)
    linked = chain.inside.astype(np.int64)
    return _respond(chain, linked, start, _none(chain, nx))


def _chunks(edges: tuple[int, ...]) -> NDArray[np.int64]:
    """Return the chunk of each sample: runs of whole windows where there are many."""
    n = edges[-1]
    windows = len(edges) - 1
    if windows >= CHUNKS:
        of_window = np.arange(windows) * CHUNKS // windows
        return np.repeat(of_window, np.diff(edges))
    return np.arange(n) * CHUNKS // n


def law_states(chain: Chain, base: Baseline, signal: Array, theta: Array) -> Array:
    """Return the states (n, nx) with a law's signal and changed parameters.

    Every window starts from the initial state that then fits it best.
    """
    nx = chain.phi.shape[1]
    linked = chain.inside.astype(np.int64)
    before = np.concatenate([[0.0], signal[:-1]])
    forcing = chain.jump + chain.gamma[:, :, 0] * before[:, None]
    forcing = forcing + chain.gamma_theta @ theta
    forcing = np.where(chain.inside[:, None], forcing, 0.0)
    direct = chain.direct[:, :, 0] * signal[:, None] + chain.read_theta @ theta
    moved = _respond(chain, linked, forcing[:, :, None], direct[:, :, None])[:, :, 0]
    measured = base.weight > 0.0
    residual = np.where(measured, chain.residuals - moved, 0.0) * base.weight
    for a, b in pairwise(base.edges):
        columns = (base.initial[a:b] * base.weight[a:b, :, None]).reshape(-1, nx)
        size = np.linalg.norm(columns, axis=0)
        size = np.where(size > 0.0, size, 1.0)
        start = np.linalg.lstsq(columns / size, residual[a:b].ravel(), rcond=1e-9)[0]
        forcing[a] = start / size
    whole = np.broadcast_to(np.eye(nx), (len(signal), nx, nx))
    read = replace(chain, read=np.ascontiguousarray(whole))
    none = np.zeros((len(signal), nx, 1))
    states: Array = (
        chain.states + _respond(read, linked, forcing[:, :, None], none)[:, :, 0]
    )
    return states


def _none(chain: Chain, m: int) -> Array:
    n, ny, _ = chain.read.shape
    return np.zeros((n, ny, m))


def _respond(
    chain: Chain, linked: NDArray[np.int64], forcing: Array, direct: Array
) -> Array:
    from bondgraph.diagnosis.location.recursions import respond  # noqa: PLC0415

    out = np.zeros_like(direct)
    respond(
        chain.phi, chain.read, linked, np.ascontiguousarray(forcing),
        np.ascontiguousarray(direct), out,
    )  # fmt: skip
    return out


def span(columns: Array) -> Array:
    """Return an orthonormal basis of the columns' span, each scaled to one."""
    size = np.linalg.norm(columns, axis=0)
    kept: Array = columns[:, size > 0.0] / size[size > 0.0]
    if not kept.shape[1]:
        return kept
    u, s, _ = np.linalg.svd(kept, full_matrices=False)
    basis: Array = u[:, s > DEPENDENT * s[0]]
    return basis


def projected(base: Baseline, responses: Array) -> Array:
    """Return responses (n, ny, m) as weighted rows, initial states projected out."""
    rows = (responses * base.weight[:, :, None]).reshape(-1, responses.shape[2])
    ny = responses.shape[1]
    for basis, (a, b) in zip(base.basis, pairwise(base.edges), strict=True):
        part = rows[a * ny : b * ny]
        part -= basis @ (basis.T @ part)
    return rows


def law_responses(chain: Chain, source: int, columns: Array) -> Array:
    """Return the outputs' response to a source that gives each column, (n, ny, m)."""
    from bondgraph.diagnosis.location.recursions import (  # noqa: PLC0415
        respond_to_features,
    )

    n, ny, _ = chain.read.shape
    out = np.zeros((n, ny, columns.shape[1]))
    respond_to_features(
        chain.phi,
        chain.read,
        chain.inside.astype(np.int64),
        np.ascontiguousarray(chain.gamma[:, :, source]),
        np.ascontiguousarray(chain.direct[:, :, source]),
        np.ascontiguousarray(columns),
        out,
    )
    return out


@dataclass(frozen=True, slots=True, eq=False)
class Explained:
    """What is left per chunk when a law is fitted to the others, and the fit to all."""

    left: Array
    coefficients: Array
    theta: Array
    in_sample: float


def explain(base: Baseline, rows: Array) -> Explained:
    """Fit parameters and a law's rows, (rows, m); judge on left-out chunks.

    The squares left, per chunk, are those of folds that the fit did not see.
    """
    nq = base.theta.shape[1]
    scale = np.sqrt(np.mean(rows**2, axis=0)) if rows.shape[1] else np.zeros(0)
    scale = np.where(scale > 0.0, scale, 1.0)
    columns = np.column_stack([base.theta, rows / scale, base.target])
    chunks = int(base.chunk.max()) + 1
    gram = np.zeros((chunks, columns.shape[1], columns.shape[1]))
    bounds = np.searchsorted(base.chunk, np.arange(chunks + 1))
    for c in range(chunks):
        part = columns[bounds[c] : bounds[c + 1]]
        gram[c] = part.T @ part
    total = gram.sum(axis=0)
    left = np.zeros(chunks)
    for fold in range(FOLDS):
        test = np.arange(chunks) % FOLDS == fold
        found = _solved(base, total - gram[test].sum(axis=0))
        ends = np.append(-found, 1.0)
        left[test] = np.einsum("i,cij,j->c", ends, gram[test], ends)
    found = _solved(base, total)
    ends = np.append(-found, 1.0)
    return Explained(left, found[nq:] / scale, found[:nq], float(ends @ total @ ends))


def _solved(base: Baseline, gram: Array) -> Array:
    nq = base.theta.shape[1]
    normal = gram[:-1, :-1].copy()
    slope = gram[:-1, -1].copy()
    diagonal = np.diag(normal).copy()
    m = len(slope)
    normal[np.arange(nq), np.arange(nq)] += base.prior
    slope[:nq] += base.prior * base.offset
    normal[np.arange(nq, m), np.arange(nq, m)] += RIDGE * diagonal[nq:]
    found: Array = truncated_inverse(normal, 1e-12) @ slope
    return found
