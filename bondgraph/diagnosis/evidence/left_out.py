"""Evidence: a candidate is judged on training data that it was not fitted to.

The training samples are dealt into chunks; each fold leaves every K-th chunk out, the
models are refitted without it, and the squared errors there are compared chunk by
chunk. Chunks are the units of the statistics, so coloured residuals cost nothing but
power, and the number of candidates tried enters as a Bonferroni factor.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr

from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.horizon import SHORTEST
from bondgraph.fitting.levenberg_marquardt import minimise, settle
from bondgraph.fitting.problem import FitProblem, linearise_windows
from bondgraph.fitting.uncertainty import correlation_time

Array = NDArray[np.float64]
MOST_CHUNKS, LEAST_CHUNKS = 24, 6
APART = 3
SETTLE_ITERATIONS = 5
FOLDS = 4
FOLD_ITERATIONS = 3


@dataclass(frozen=True, slots=True)
class LeftOutErrors:
    """Sum of squared, scaled errors on each chunk, by a model not fitted to it."""

    chunks: Array


def chunk_count(fitted: FittedModel) -> int:
    """Return into how many chunks to deal the data, from the model's residuals.

    Windows are independent: their initial states are their own. Within a window a chunk
    must be several correlation times long, or what is left out is known from its
    neighbours and errors are counted as independent that are not.
    """
    residuals = fitted.optimum.linearisation.residuals
    windows = fitted.problem.shots.n_windows
    if windows >= MOST_CHUNKS:
        return MOST_CHUNKS
    longest = max(correlation_time(column) for column in residuals.T)
    independent = len(residuals) // (APART * longest)
    return int(np.clip(independent, LEAST_CHUNKS, MOST_CHUNKS))


@dataclass(frozen=True, slots=True)
class Gain:
    """Relative reduction of the squared error on left-out chunks, with its error.

    ``p_value`` is one-sided, for the hypothesis that there is no reduction.
    """

    value: float
    std: float
    p_value: float


def chunk_labels(problem: FitProblem, chunks: int) -> NDArray[np.int64]:
    """Return for each sample the number of its chunk.

    Where there are many windows a chunk is a run of whole windows.
    """
    shots = problem.shots
    n = len(shots.time)
    if shots.n_windows >= chunks:
        sizes = [part.stop - part.start for part in shots.slices]
        of_window = np.arange(shots.n_windows) * chunks // shots.n_windows
        return np.repeat(of_window, sizes)
    return np.arange(n, dtype=np.int64) * chunks // n


def left_out_errors(fitted: FittedModel, chunks: int) -> LeftOutErrors:
    """Refit without each fold in turn and return the errors on what was left out.

    Where whole windows are left out, their initial states have to come from somewhere:
    from their first halves, and the second halves are predicted. A model with more
    states would else be judged by how well they fit what it is judged on.
    """
    problem = fitted.problem
    labels = chunk_labels(problem, chunks)
    totals = np.zeros(chunks)
    for fold in range(FOLDS):
        test = labels % FOLDS == fold
        begins = _first_halves(problem, test)
        squared = _fold_errors(fitted, test, begins)
        scored = test & ~begins
        totals += np.bincount(labels, weights=squared * scored, minlength=chunks)
    return LeftOutErrors(totals)


def _first_halves(problem: FitProblem, test: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the first halves of windows that lie wholly in the test set."""
    begins = np.zeros_like(test)
    for part in problem.shots.slices:
        if test[part].all():
            begins[part.start : part.start + (part.stop - part.start) // 2] = True
    return begins


def _fold_errors(
    fitted: FittedModel, test: NDArray[np.bool_], begins: NDArray[np.bool_]
) -> Array:
    """Return the squared error per sample of a fit to the samples not in `test`."""
    problem, optimum = fitted.problem, fitted.optimum
    hidden = test.copy()
    for part in problem.shots.slices:
        # A window that is trained on later needs its initial state from somewhere.
        if not test[part].all():
            hidden[part.start : part.start + SHORTEST] = False
    masked = np.where(hidden[:, None], np.nan, problem.shots.outputs)
    training = replace(problem, shots=replace(problem.shots, outputs=masked))
    found = minimise(
        training, optimum.theta, optimum.initial, iterations=FOLD_ITERATIONS
    )
    initial = _settle_unseen(problem, found.theta, found.initial, test, begins)
    at = linearise_windows(problem, found.theta, initial)
    squared: Array = (at.residuals**2).sum(axis=1)
    return np.where(np.isfinite(squared), squared, 1e12)


def _settle_unseen(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    test: NDArray[np.bool_],
    begins: NDArray[np.bool_],
) -> Array:
    """Give windows that lie wholly in the test set initial states from their begin."""
    unseen = np.array([bool(test[part].all()) for part in problem.shots.slices])
    if not unseen.any() or problem.model.n_states == 0:
        return initial
    windows = np.flatnonzero(unseen)
    shown = np.where((test & ~begins)[:, None], np.nan, problem.shots.outputs)
    shots = replace(problem.shots, outputs=shown).subset(windows)
    part = replace(problem, shots=shots)
    own = initial.copy()
    own[windows], _ = settle(part, theta, initial[windows], SETTLE_ITERATIONS)
    return own


def compare(before: LeftOutErrors, after: LeftOutErrors) -> Gain:
    """Return how much smaller the error is `after`, with its jackknife error.

    Two tests share the level: one of the sum of squared errors, and one of the mean log
    ratio, which is that of a likelihood in which every chunk has a noise of its own. A
    few chunks with large errors hide in the sum what all of them show in the other.
    """
    b, a = before.chunks, after.chunks
    total = b.sum()
    if total <= 0.0:
        return Gain(0.0, 0.0, 1.0)
    value = 1.0 - a.sum() / total
    leave_one = 1.0 - (a.sum() - a) / np.maximum(total - b, 1e-300)
    n = len(b)
    std = float(np.sqrt((n - 1) / n * ((leave_one - leave_one.mean()) ** 2).sum()))
    if std == 0.0:
        return Gain(float(value), 0.0, 0.0 if value > 0 else 1.0)
    of_sum = float(stdtr(n - 1, -value / std))
    return Gain(float(value), std, min(2.0 * min(of_sum, _of_ratios(b, a)), 1.0))


def _of_ratios(before: Array, after: Array) -> float:
    """Return the p-value of a t-test that the mean log ratio is not above zero."""
    tiny = 1e-12 * max(before.max(), after.max())
    ratios = np.log((before + tiny) / (after + tiny))
    n = len(ratios)
    std = float(ratios.std(ddof=1)) / np.sqrt(n)
    if std == 0.0:
        return 0.0 if ratios[0] > 0.0 else 1.0
    return float(stdtr(n - 1, -float(ratios.mean()) / std))
