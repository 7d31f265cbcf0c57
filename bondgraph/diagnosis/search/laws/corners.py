"""Corners: where a curve bends at few knots, it is drawn so.

A smooth curve may bend as much at each of its many knots, and rounds a corner between
straight pieces. How much each bend may be is told by the recordings, too: those that
are needed grow, the others go, and a curve that is round everywhere stays so. Near the
optimum the model is linear in its bends, and their sizes are found there without a fit
(sparse Bayesian learning; Tipping, J. Mach. Learn. Res. 1, 2001, with the fixed point
of MacKay, Neural Comput. 4, 1992). Whether corners are there is told by left-out data.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.laws.drawing import Drawing, bends_in, drawn_finely
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.problem import prior_residuals, reduced_hessian
from bondgraph.fitting.truncated_inverse import truncated_inverse

Array = NDArray[np.float64]

ROUNDS = 200
"""How often the sizes are found anew; they hardly change after some tens."""

LEAST, MOST = 1e-3, 1e2
"""How little and how much a bend may be, of what it may be in a smooth curve."""


def with_corners(bench: Bench, first: Drawing, smooth: Drawing) -> Drawing:
    """Return a smooth curve as one with corners where that predicts better.

    Left-out chunks, and whole quarters that are left out.
    """
    if smooth.smooth is None:
        return smooth
    candidate = smooth.candidate
    names = bends_in(candidate.hypothesis.strengths)
    sizes = _sizes(candidate.fitted, list(names))
    corners = tuple(zip(names.values(), map(float, sizes), strict=True))
    form = replace(smooth.smooth, corners=corners)
    begin = Start.where_ended(candidate.fitted)
    found = drawn_finely(bench, first.candidate.hypothesis, form, begin)
    if found is None:
        return smooth
    drawn = Drawing(found, smooth.chunks, form)
    better = drawn.typical < smooth.typical
    carries = drawn.in_one.mean() <= smooth.in_one.mean()
    return drawn if better and carries else smooth


def _sizes(fitted: FittedModel, names: list[str]) -> Array:
    """Return how large each bend is likely to be, of what it may be by its prior."""
    problem, optimum = fitted.problem, fitted.optimum
    count = max(int(problem.measured.sum()) - problem.unknowns, 1)
    residuals = optimum.linearisation.residuals
    noise = float(np.nansum(residuals**2)) / count
    apart, weight = prior_residuals(problem, optimum.theta)
    at = [problem.free_names.index(name) for name in names]
    data = reduced_hessian(optimum.linearisation, len(weight)) / noise
    before = weight**2 / noise  # Of a cost that counts residuals as multiples of sigma.
    known = problem.start[problem.free]
    told = data @ optimum.theta - apart * weight / noise
    now = before.copy()
    for _ in range(ROUNDS):
        covariance = truncated_inverse(data + np.diag(now))
        mean = covariance @ (told + now * known)
        own = np.maximum(1.0 - np.diag(covariance)[at] * now[at], 1e-9)
        squared = np.maximum(mean[at] ** 2, 1e-300)
        now[at] = np.clip(own / squared, before[at] / MOST**2, before[at] / LEAST**2)
    return np.asarray(np.sqrt(before[at] / now[at]))
