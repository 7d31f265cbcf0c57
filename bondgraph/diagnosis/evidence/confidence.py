"""How sure is the leading answer: who wins when the recordings are dealt anew.

The errors of all judged models on the left-out chunks are resampled chunk by chunk
(block bootstrap), the same chunks for all, so that what is hard for every model decides
nothing. The share of resamples in which an answer, or one that cannot be told from it,
predicts best is its probability; "nothing is missing" takes part like any other answer
(bootstrap stacking: Yao, Vehtari, Simpson and Gelman, Bayesian Analysis 13, 2018).
Resampling sees the noise and nothing else. That the cause is in no library, or that a
law nearly like it won, is a doubt of its own, and is measured on concealed cases.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.left_out import LeftOutErrors

Array = NDArray[np.float64]
RESAMPLES = 2000
SEED = 20

UNSEEN = 0.15
"""How often a finding that wins (nearly) every resample is not what was concealed: 7 of
45 on the development cases of `docs/proof.md`, and 7 of 51 on final ones since.
"""


USUAL_CHUNKS, CHUNK = 24, 8
"""On so many chunks that was measured; a chunk of fewer samples is part of one."""


def beyond_resampling(share: float, errors: LeftOutErrors) -> float:
    """Return the probability to state for a share of resamples won.

    Few chunks dealt anew say little of what others would say: as if two more had been
    lost (the rule of succession).

    Parameters
    ----------
    errors
        Those of the winner.
    """
    n = min(float(errors.chunks.size), errors.samples / CHUNK, float(USUAL_CHUNKS))
    usual = USUAL_CHUNKS / (USUAL_CHUNKS + 2.0)
    return (1.0 - UNSEEN) * share * n / (n + 2.0) / usual


def winning_shares(
    models: Sequence[LeftOutErrors], handicaps: Sequence[float]
) -> Array:
    """Return for each model the share of resamples in which it predicts best.

    Parameters
    ----------
    models
        Errors of every model on the same chunks.
    handicaps
        Factor on the error of each, 1 for none: what a wider law must be better by.
    """
    errors = np.array([model.chunks for model in models])
    drawn = np.random.default_rng(SEED).integers(
        0, errors.shape[1], (RESAMPLES, errors.shape[1])
    )
    counts = np.zeros((RESAMPLES, errors.shape[1]))
    np.add.at(counts, (np.arange(RESAMPLES)[:, None], drawn), 1.0)
    totals = counts @ errors.T * np.asarray(handicaps)
    best = totals <= totals.min(axis=1, keepdims=True) * (1 + 1e-12)
    shares: Array = (best / best.sum(axis=1, keepdims=True)).mean(axis=0)
    return shares
