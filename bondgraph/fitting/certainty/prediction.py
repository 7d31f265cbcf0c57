"""How far what a fit leaves open of its parameters moves a prediction.

To first order. The initial states of what is predicted are estimated there, so only
what they cannot take up counts.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.fitting.long_runs import posed_over, settled_over
from bondgraph.fitting.problem import parts
from bondgraph.recordings.binding import BoundRecording


def prediction_std(
    fitted: FittedModel, recordings: Sequence[BoundRecording]
) -> dict[str, float]:
    """Return per output the standard deviation of whole recordings as predicted.

    Root mean square over their samples, in SI units; of what nothing is known at all
    nothing is counted. NaN where a recording cannot be simulated.
    """
    problem = posed_over(fitted, recordings, WholeRecordings())
    # Slopes as they are, whatever the colour of the noise.
    problem = replace(problem, correlation=np.zeros(1))
    states, _ = settled_over(problem, fitted)
    theta, count = problem.start[problem.free], len(problem.free)
    covariance = uncertainty(fitted.problem, fitted.optimum).covariance
    squares = np.zeros(len(problem.sigma))
    for part in parts(problem, theta, states):
        if not (part.shot.completed.all() and np.isfinite(part.jacobian).all()):
            squares[:] = np.nan
            continue
        for first, last in pairwise(part.shots.edges):
            slopes = part.jacobian[first:last].reshape(-1, part.jacobian.shape[-1])
            own, began = slopes[:, :count], slopes[:, count:]
            own = own - began @ (np.linalg.pinv(began) @ own)
            squared = np.einsum("ij,jk,ik->i", own, covariance, own)
            squares += squared.reshape(last - first, -1).sum(axis=0)
    spread = problem.sigma * np.sqrt(squares / problem.measured)
    return dict(zip(problem.model.output_names, map(float, spread), strict=True))
