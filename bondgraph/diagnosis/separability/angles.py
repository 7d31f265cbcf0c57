"""Angles between what free signals at two places do to the outputs, by frequency."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.virtual.chain import Chain

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
POINTS = 5
FREQUENCIES = 60
VISIBLE = 1e-3
"""Where a response is below this share of its largest, noise hides it anyway."""
SAME = 1.0
"""Degrees; places closer than this are one class."""


def responses(chain: Chain, noise: Array, samples: int) -> Complex:
    """Return frequency responses over the noise, (points × frequencies, ny, L).

    At a few samples of the trajectory, of the steps linearised there, from one period
    per `samples` to half the sampling rate.
    """
    inner = np.flatnonzero(chain.inside)
    if not len(inner):
        return (chain.direct / noise[:, None]).astype(complex)
    chosen = inner[np.linspace(0, len(inner) - 1, POINTS).astype(int)]
    angles = np.geomspace(2 * np.pi / samples, np.pi, FREQUENCIES)
    # Off the unit circle by a little: an integrator has no response at rest.
    z = np.exp(1j * angles) * (1.0 + 1e-6)
    nx = chain.phi.shape[1]
    found = []
    for k in chosen:
        inverse = np.linalg.inv(z[:, None, None] * np.eye(nx) - chain.phi[k])
        found.append(chain.read[k] @ inverse @ chain.gamma[k] + chain.direct[k])
    whole = np.concatenate(found).astype(np.complex128)
    return whole / noise[:, None]


def angle_matrix(response: Complex) -> Array:
    """Return the largest angle over frequencies between all pairs, in degrees."""
    size = np.linalg.norm(response, axis=1)
    visible = size > VISIBLE * size.max(axis=0, initial=0.0)
    unit = response / np.where(size > 0.0, size, 1.0)[:, None, :]
    cosine = np.einsum("foa,fob->fab", unit.conj(), unit)
    # The sine by the part across keeps small angles exact, the cosine does not.
    across = np.abs(unit[:, :, None, :] - unit[:, :, :, None] * cosine[:, None])
    sine = np.sqrt(np.sum(across**2, axis=1))
    both = visible[:, :, None] & visible[:, None, :]
    angles: Array = np.degrees(np.arcsin(np.minimum(sine, 1.0)))
    apart = np.where(both, angles, 0.0).max(axis=0)
    # Never visible together: told apart by where in frequency they act at all.
    return np.where(both.any(axis=0), apart, 90.0)


def classes_of(
    places: Sequence[str], together: NDArray[np.bool_]
) -> tuple[tuple[str, ...], ...]:
    """Return the groups of places connected by `together`, in order."""
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    _, labels = connected_components(together, directed=False)
    return tuple(
        tuple(p for p, own in zip(places, labels, strict=True) if own == label)
        for label in dict.fromkeys(labels.tolist())
    )
