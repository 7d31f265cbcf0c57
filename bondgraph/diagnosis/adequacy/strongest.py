"""The family that a residual follows most surely, and how surely by chance."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.adequacy.draws import NoiseModel, draw
from bondgraph.diagnosis.adequacy.families import families
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
    fine: Nuisance,
    noise: NoiseModel,
    draws: int,
    random: np.random.Generator,
) -> tuple[list[Dependence], float]:
    """Return the families by strength, and the calibrated chance of the strongest."""
    from scipy.special import fdtrc  # noqa: PLC0415

    whole = [fine.remove(residual[:, :, None])]
    whole += [
        fine.remove(draw(noise, min(BATCH, draws - first), random))
        for first in range(0, draws, BATCH)
    ]
    rows = np.concatenate(whole, axis=1)
    power = np.sum(rows**2, axis=0)
    freedom = rows.shape[0] - fine.freedom
    found, most = [], np.zeros(rows.shape[1])
    for family in families(fitted, chain):
        basis = span(fine.remove(family.columns))
        m = basis.shape[1]
        if m == 0 or freedom - m < m:
            continue
        share = np.sum((basis.T @ rows) ** 2, axis=0) / np.where(power > 0, power, 1.0)
        share = np.minimum(share, 1.0 - 1e-15)
        ratio = share / (1.0 - share) * (freedom - m) / m
        chance = np.maximum(fdtrc(m, freedom - m, ratio), 1e-300)
        most = np.maximum(most, -np.log(chance))
        found.append(
            Dependence(
                place=family.place,
                form=family.form,
                variable=family.variable,
                share=float(share[0]),
                p_value=float(chance[0]),
            )
        )
    beyond = int(np.sum(most[1:] >= most[0] * (1.0 - 1e-12)))
    found.sort(key=lambda one: (one.p_value, -one.share))
    return found, (1.0 + beyond) / (draws + 1.0)
