"""Two laws in place of a row of laws, where these still leave what is no noise.

Of two effects that are there at once a third law may do a part of what either does, and
more than either does alone: a leak of the tank between one that leaks and one whose
gauge is bent. It comes first, and what comes after it only mends. So the laws that
promised most from the first model are fitted two by two, as where none helps alone, and
what one such pair does better than all that was found is told in its place.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.base.beyond_noise import explainable, left_beside
from bondgraph.diagnosis.search.considered import Setting
from bondgraph.diagnosis.search.one_round import MUCH
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.pairs.together import two_rounds
from bondgraph.diagnosis.search.round_found import Round, made_in
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.recordings.binding import BoundRecording

Array = NDArray[np.float64]
LITTLE = 0.01
"""Of what the first model left beyond noise: who leaves no more has found all."""

ROW = 3
"""So many laws are a row. In place of two that were found one by one two others that
leave less are as likely to bend as they.
"""

LESS = 0.8
"""Two laws in place of a row leave no more than this share of what it leaves."""


def pair_instead(
    rounds: Sequence[Round],
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
) -> list[Round] | None:
    """Return two rounds in place of those of a search, where they leave less.

    Parameters
    ----------
    rounds
        From the first model to what the search has ended with.
    noise
        Residual per output that noise excuses, 0 where it is not known.
    """
    made, first, final = made_in(rounds), rounds[0], rounds[-1].base
    if len(made) < ROW or shop.limit.passed or explainable(final, noise) <= MUCH:
        return None
    if left_beside(first.base, final, noise) <= LITTLE:
        return None
    shop.progress("two laws in place of those that were found")
    setting = Setting(
        first.base, recordings, noise, options, number=1, found=(), curves=True
    )
    two = two_rounds(setting, first, shop)
    if not two:
        return None
    left, left_by_two = (one[-1].errors.per_sample for one in (made, made_in(two)))
    return list(two) if left_by_two < LESS * left else None
