"""Evidence: a candidate is judged on training data that it was not fitted to.

The training samples are dealt into chunks; each fold leaves every K-th chunk out, the
models are refitted without it, and the squared errors there are compared chunk by
chunk. Chunks are the units of the statistics, so coloured residuals cost nothing but
power, and the number of candidates tried enters as a Bonferroni factor.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.surprise import surprise
from bondgraph.fitting.certainty.uncertainty import correlation_time
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.horizon import SHORTEST
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.problem import FitProblem, linearise_windows
from bondgraph.fitting.settling import settle

Array = NDArray[np.float64]
MOST_CHUNKS, LEAST_CHUNKS = 24, 6
APART = 3
SETTLE_ITERATIONS = 5
FOLDS = 4
FOLD_ITERATIONS = 3
LOST = 1e12
"""The squared error at samples where the model could not be simulated."""


@dataclass(frozen=True, slots=True, eq=False)
class LeftOutErrors:
    """What a model that was not fitted to them does on the chunks of a recording.

    Parameters
    ----------
    chunks
        Sum of squared, scaled errors on each chunk.
    surprise
        Sum of the surprise on each of the shorter blocks, in nats; empty where it was
        not asked for.
    samples
        How many were summed over, all outputs of an instant together.
    noise
        What measurement noise alone would leave of the whole sum, 0 if it is not known.
    """

    chunks: Array
    surprise: Array = field(default_factory=lambda: np.zeros(0))
    samples: int = 0
    noise: float = 0.0

    @property
    def per_sample(self) -> float:
        """The error of a sample, in the mean."""
        return float(self.chunks.sum()) / max(self.samples, 1)

    @property
    def beyond_noise(self) -> float:
        """The whole error without what noise alone would leave."""
        return max(float(self.chunks.sum()) - self.noise, 0.0)


def chunk_count(fitted: FittedModel) -> int:
    """Return into how many chunks to deal the data, from the model's residuals.

    Windows are independent: their initial states are their own. Within a window a chunk
    must be several correlation times long, or what is left out is known from its
    neighbours and errors are counted as independent that are not. So are the rows of a
    steady table, each a point of operation of its own.
    """
    residuals = fitted.optimum.linearisation.residuals
    windows = fitted.problem.shots.n_windows
    if windows >= MOST_CHUNKS:
        return MOST_CHUNKS
    if fitted.problem.shots.timeless:
        return max(LEAST_CHUNKS, windows)
    longest = max(correlation_time(column) for column in residuals.T)
    independent = len(residuals) // (APART * longest)
    return max(LEAST_CHUNKS, min(independent, MOST_CHUNKS))


def chunk_labels(problem: FitProblem, chunks: int) -> NDArray[np.int64]:
    """Return for each sample the number of its chunk.

    Where there are many windows a chunk is a run of whole windows. Rows of a table are
    dealt in turn: it is mostly sorted, and what happens at one end would be left out
    whole.
    """
    shots = problem.shots
    n = len(shots.time)
    if shots.timeless:
        return np.arange(n, dtype=np.int64) % chunks
    if shots.n_windows >= chunks:
        sizes = [part.stop - part.start for part in shots.slices]
        of_window = np.arange(shots.n_windows) * chunks // shots.n_windows
        return np.repeat(of_window, sizes)
    return np.arange(n, dtype=np.int64) * chunks // n


def left_out_errors(
    fitted: FittedModel, chunks: int, *, in_one: bool = False
) -> LeftOutErrors:
    """Refit without each fold in turn and return the errors on what was left out.

    Parameters
    ----------
    in_one
        Leave out neighbouring chunks together, a quarter of the recordings in one piece
        each time. What a machine does between two chunks that are known a law of many
        numbers may know by heart, and still not carry over to another stretch.

    Notes
    -----
    Where whole windows are left out, their initial states have to come from somewhere:
    from their first halves, and the second halves are predicted. A model with more
    states would else be judged by how well they fit what it is judged on.
    """
    problem = fitted.problem
    labels = chunk_labels(problem, chunks)
    blocks = chunk_labels(problem, MOST_CHUNKS)
    totals, nats = np.zeros(chunks), np.zeros(MOST_CHUNKS)
    unknowns, samples = len(problem.free) + fitted.optimum.initial.size, 0
    for fold in range(FOLDS):
        fold_of = labels * FOLDS // chunks if in_one else labels % FOLDS
        test = fold_of == fold
        begins = _first_halves(problem, test)
        residuals = _fold_residuals(fitted, test, begins)
        squared = (residuals**2).sum(axis=1)
        squared = np.where(np.isfinite(squared), squared, LOST)
        told = surprise(residuals, problem.shots.slices, unknowns)
        scored = test & ~begins
        samples += int(np.count_nonzero(scored))
        totals += np.bincount(labels, weights=squared * scored, minlength=chunks)
        nats += np.bincount(blocks, weights=told * scored, minlength=MOST_CHUNKS)
    return LeftOutErrors(totals, nats, samples)


def _first_halves(problem: FitProblem, test: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the first halves of windows that lie wholly in the test set."""
    begins = np.zeros_like(test)
    for part in problem.shots.slices:
        if test[part].all():
            begins[part.start : part.start + (part.stop - part.start) // 2] = True
    return begins


def _fold_residuals(
    fitted: FittedModel, test: NDArray[np.bool_], begins: NDArray[np.bool_]
) -> Array:
    """Return the residuals (n, ny) of a fit to the samples not in `test`."""
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
    return at.residuals


def _settle_unseen(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    test: NDArray[np.bool_],
    begins: NDArray[np.bool_],
) -> Array:
    """Give windows that lie wholly in the test set initial states from their begin."""
    unseen = np.array([bool(test[part].all()) for part in problem.shots.slices])
    if not unseen.any():
        return initial
    windows = np.flatnonzero(unseen)
    shown = np.where((test & ~begins)[:, None], np.nan, problem.shots.outputs)
    shots = replace(problem.shots, outputs=shown).subset(windows)
    part = replace(problem, shots=shots)
    own = initial.copy()
    own[windows], _ = settle(part, theta, initial[windows], SETTLE_ITERATIONS)
    return own
