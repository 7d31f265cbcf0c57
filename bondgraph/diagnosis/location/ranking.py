"""Rank laws and places, and say what the ranking says.

Differences are judged chunk by chunk of the recordings: what does not exceed two
standard errors of its chunks is no difference, and of laws that predict alike the
plainest is taken.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr

from bondgraph.diagnosis.location.laws import Form
from bondgraph.diagnosis.location.records import (
    Location,
    LocationStatus,
    PlaceEvidence,
    Relation,
)
from bondgraph.fitting.estimate import FittedModel

Array = NDArray[np.float64]
PLAINNESS = (Form.PERIODIC, Form.CURVE, Form.RATE, Form.LOAD)
LEVEL = 0.01
LEAST_SHARE = 0.01
"""Of what parameters leave, a law must remove this much, beyond being significant."""


def standard_errors(worse: Array, better: Array) -> float:
    """Return by how many standard errors `better` leaves less, chunk by chunk.

    Ratios are compared, on a logarithmic scale, so that one bad chunk does not decide.
    """
    if not np.isfinite(worse).all():
        return 0.0 if not np.isfinite(better).all() else np.inf
    floor = 1e-12 * float(better.max())
    ratio = np.log((worse + floor) / (better + floor))
    error = float(np.std(ratio, ddof=1)) / math.sqrt(len(ratio))
    mean = float(ratio.mean())
    if error == 0.0:
        return float(np.copysign(np.inf, mean)) if mean else 0.0
    return mean / error


def plainest_first(relations: Sequence[Relation]) -> tuple[Relation, ...]:
    """Return relations by what they leave, the plainest of the best alike first."""
    ranked = sorted(relations, key=lambda r: float(r.left.sum()))
    if not ranked:
        return ()
    best = ranked[0]
    alike = [
        r
        for r in ranked
        if r is best
        or (
            standard_errors(r.left, best.left) < 1.0
            and r.left.sum() < 1.5 * best.left.sum()
        )
    ]
    first = min(
        alike,
        key=lambda r: (
            r.variable == "time",
            PLAINNESS.index(r.form),
            float(r.left.sum()),
        ),
    )
    return (first, *(r for r in ranked if r is not first))


def conclude(
    found: Sequence[tuple[PlaceEvidence, Array]], fitted: FittedModel, noise: Array
) -> Location:
    """Return the places ranked, with what is to be said of them.

    Parameters
    ----------
    found
        Each place with what parameters alone leave there, per chunk.
    """
    ranked = sorted(found, key=lambda pair: _least(pair[0]))
    names = fitted.problem.model.output_names
    tried = sum(len(place.relations) for place, _ in found)
    status, leading, reasons = _said(ranked, tried)
    return Location(
        status=status,
        places=tuple(place for place, _ in ranked),
        leading=leading,
        time=fitted.problem.shots.time,
        noise=dict(zip(names, map(float, noise), strict=True)),
        reasons=reasons,
    )


def _least(place: PlaceEvidence) -> float:
    return min((float(r.left.sum()) for r in place.relations), default=np.inf)


def _best_left(place: PlaceEvidence) -> Array:
    return min((r.left for r in place.relations), key=lambda left: float(left.sum()))


def _said(
    ranked: Sequence[tuple[PlaceEvidence, Array]], tried: int
) -> tuple[LocationStatus, tuple[str, ...], tuple[str, ...]]:
    first = ranked[0][0]
    if not first.relations:
        return LocationStatus.NOTHING, (), ("No place has a variable that moves.",)
    best = _best_left(first)
    # Parameters alone do at least as well as the fit; what linear steps promise beyond
    # it from far away is no fact.
    without = ranked[0][1]
    sure = standard_errors(without, best)
    chance = min(1.0, tried * float(stdtr(len(best) - 1, -sure)))
    share = 1.0 - float(best.sum()) / float(without.sum())
    tested = (
        f"{tried} laws were tried; the best removes {100 * share:.2g} % of what "
        f"parameters leave on left-out chunks (chance of that by luck {chance:.2g})."
    )
    if chance > LEVEL or share < LEAST_SHARE:
        return LocationStatus.NOTHING, (), (tested,)
    leading = [
        place.place
        for place, _ in ranked
        if place is first
        or (place.relations and standard_errors(_best_left(place), best) < 2.0)
    ]
    law = first.best
    told = (
        f"{first.place}: {first.kind}, {law.form} {law.variable}, leaves "
        f"{float(law.left.sum()):.3g} squares of the noise per sample; parameters "
        f"alone leave {float(without.sum()):.3g}."
    )
    if law.variable == "time":
        return LocationStatus.NO_LAW, tuple(leading), (tested, told)
    status = (
        LocationStatus.ONE_PLACE if len(leading) == 1 else LocationStatus.SEVERAL_PLACES
    )
    return status, tuple(leading), (tested, told)
