"""The family that a residual follows most surely, and how surely by chance."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.adequacy.draws import NoiseModel, draw
from bondgraph.diagnosis.adequacy.families import Family, families
from bondgraph.diagnosis.adequacy.nuisance import Nuisance
from bondgraph.diagnosis.adequacy.records import Dependence
from bondgraph.diagnosis.location.regression import span
from bondgraph.diagnosis.virtual.chain import Chain
from bondgraph.fitting.estimate import FittedModel

Array = NDArray[np.float64]
BATCH = 25


def strongest(
    fitted: FittedModel,
    chain: Chain,
    residual: Array,
    nuisances: tuple[Nuisance, Nuisance],
    noise: NoiseModel,
    draws: int,
    random: np.random.Generator,
) -> tuple[list[Dependence], float]:
    """Return the families by strength, and the calibrated chance of the strongest.

    The residual is compared with the families twice, as it is and whitened: what is
    small beside coloured noise shows whitened; what is so large and slow that it was
    taken for coloured noise itself shows as it is. The two are one statistic: the
    smaller of their chances, among the draws.

    Parameters
    ----------
    nuisances
        Of the outputs as they are, and whitened.
    """
    plain, fine = (
        np.concatenate([one.remove(residual[:, :, None])], axis=1) for one in nuisances
    )
    for first in range(0, draws, BATCH):
        drawn = draw(noise, min(BATCH, draws - first), random)
        plain = np.concatenate([plain, nuisances[0].remove(drawn)], axis=1)
        fine = np.concatenate([fine, nuisances[1].remove(drawn)], axis=1)
    powers = [np.sum(rows**2, axis=0) for rows in (plain, fine)]
    found: list[Dependence] = []
    most = np.zeros((2, draws + 1))
    for family in families(fitted, chain):
        as_it_is, _ = _shares(nuisances[0], family, plain, powers[0])
        most[0] = np.maximum(most[0], -np.log1p(-as_it_is))
        share, m = _shares(nuisances[1], family, fine, powers[1])
        chance = _chance(share, m, len(fine) - nuisances[1].freedom)
        most[1] = np.maximum(most[1], -np.log(chance))
        found.append(
            Dependence(
                place=family.place,
                form=family.form,
                variable=family.variable,
                share=float(as_it_is[0]),
                p_value=float(chance[0]),
            )
        )
    ranks = _ranks(most)
    if ranks[0, 0] < ranks[1, 0]:
        found.sort(key=lambda one: -one.share)
    else:
        found.sort(key=lambda one: (one.p_value, -one.share))
    better = ranks.min(axis=0)
    return found, float(np.sum(better <= better[0])) / len(better)


def _shares(
    nuisance: Nuisance, family: Family, rows: Array, power: Array
) -> tuple[Array, int]:
    """Return which share of each column of `rows` a family explains, and its size."""
    basis = span(nuisance.remove(family.columns))
    m = int(basis.shape[1])
    if m == 0 or len(rows) - nuisance.freedom < 2 * m:
        return np.zeros(rows.shape[1]), 0
    share = np.sum((basis.T @ rows) ** 2, axis=0) / np.where(power > 0.0, power, 1.0)
    return np.minimum(share, 1.0 - 1e-15), m


def _chance(share: Array, m: int, freedom: int) -> Array:
    """Return the chance of a share in white noise (F test); 1 of an empty family."""
    from scipy.special import fdtrc  # noqa: PLC0415

    if m == 0:
        return np.ones_like(share)
    ratio = share / (1.0 - share) * (freedom - m) / m
    chance: Array = np.maximum(fdtrc(m, freedom - m, ratio), 1e-300)
    return chance


def _ranks(most: Array) -> NDArray[np.int64]:
    """Return for both statistics how many columns reach each column's value."""
    ranks: NDArray[np.int64] = (
        most[:, None, :] >= most[:, :, None] * (1.0 - 1e-12)
    ).sum(axis=2)
    return ranks
