"""What chance would promise: the base model's residual with its phases drawn anew.

A surrogate has the spectrum of the residual, and so its colour, but no relation to what
the machine did (Theiler, Eubank, Longtin, Galdrikian and Farmer, Physica D 58, 1992).
The largest share of a surrogate that any hypothesis seems to explain is what the search
over all of them finds where nothing is missing; it counts the number of hypotheses, and
how alike they are, by itself.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.trials.posing import divided
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.problem import FitProblem, parts

Array = NDArray[np.float64]
DRAWS = 399
SEED = 7
NEAR = 8
"""Into how many pieces windows are divided for a nearer look."""

DEPENDENT = 1e-7
"""A direction this much shorter than the longest is no direction of its own."""


@dataclass(frozen=True, eq=False)
class Baseline:
    """The base model with its residual, and what its own parameters can explain.

    Parameters
    ----------
    fitted
        The base model at its optimum.
    residuals
        Scaled, (n, ny).
    """

    fitted: FittedModel
    residuals: Array

    @cached_property
    def quick(self) -> FittedModel:
        """The base model with one step per sample.

        Slopes need not be so exact as the residual: the same steps for the base model's
        and for what is added let the errors of both cancel.
        """
        fitted, solver = self.fitted, replace(self.fitted.problem.solver, substeps=1)
        return replace(fitted, problem=replace(fitted.problem, solver=solver))

    @cached_property
    def near(self) -> "Baseline | None":
        """The base model over windows an eighth as long; None if those are too short.

        What a small ripple does to a motion adds up over a window until slopes say
        nothing of it, long before the window is too long for all else.
        """
        near = divided(self.quick, NEAR)
        if near is None or not np.isfinite(near.optimum.cost):
            return None
        return Baseline(near, near.optimum.linearisation.residuals)

    @cached_property
    def _jacobian(self) -> Array:
        optimum = self.fitted.optimum
        return sensitivities(self.quick.problem, optimum.theta, optimum.initial)[0]

    @cached_property
    def _initial(self) -> list[Array]:
        """Orthonormal directions of every window's initial state."""
        nq = len(self.fitted.problem.free)
        windows = self.fitted.problem.shots.slices
        return [orthonormal(_flat(self._jacobian[w, :, nq:])) for w in windows]

    @cached_property
    def _shared(self) -> Array:
        """Orthonormal directions of the parameters, beside the initial states."""
        nq = len(self.fitted.problem.free)
        return orthonormal(self._without_initial(_flat(self._jacobian[:, :, :nq])))

    def project(self, columns: Array) -> Array:
        """Return columns (n ny, m) without what the base model's own fit explains."""
        own = self._without_initial(columns)
        rest: Array = own - self._shared @ (self._shared.T @ own)
        return rest

    def _without_initial(self, columns: Array) -> Array:
        ny = self.residuals.shape[1]
        rest = columns.copy()
        for part, basis in zip(
            self.fitted.problem.shots.slices, self._initial, strict=True
        ):
            rows = slice(part.start * ny, part.stop * ny)
            rest[rows] -= basis @ (basis.T @ rest[rows])
        return rest

    @cached_property
    def residual(self) -> Array:
        """The residual, projected, (n ny,)."""
        return self.project(self.residuals.reshape(-1, 1))[:, 0]

    @cached_property
    def draws(self) -> NDArray[np.float32]:
        """Surrogates of the residual, projected, of length one; (n ny, draws).

        In single precision: their number, not their digits, makes the work.
        """
        random = np.random.default_rng(SEED)
        drawn = np.empty((*self.residuals.shape, DRAWS))
        for part in self.fitted.problem.shots.slices:
            drawn[part] = _surrogates(self.residuals[part], random)
        rest = self.project(drawn.reshape(-1, DRAWS))
        unit = rest / np.maximum(np.linalg.norm(rest, axis=0), 1e-300)
        single: NDArray[np.float32] = unit.astype(np.float32)
        return single


def _surrogates(residual: Array, random: np.random.Generator) -> Array:
    """Return surrogates of one window, (m, ny, draws); the same phases for all outputs.

    The mean keeps its size and takes a random sign.
    """
    n = len(residual)
    spectrum = np.fft.rfft(residual, axis=0)
    turn = np.exp(2j * np.pi * random.random((spectrum.shape[0], DRAWS)))
    turn[0] = random.choice([-1.0, 1.0], DRAWS)
    return np.asarray(np.fft.irfft(spectrum[:, :, None] * turn[:, None], n, axis=0))


def sensitivities(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    about: NDArray[np.int64] | None = None,
) -> tuple[Array, Array]:
    """Return the scaled sensitivities of the outputs, (n, ny, nq + nx), and residuals.

    Parameters
    ----------
    about
        Parameters, by index, to which alone they are wanted.
    """
    found = list(parts(problem, theta, initial, about))
    jacobian = np.concatenate([part.jacobian for part in found])
    return jacobian, np.concatenate([part.residuals for part in found])


def orthonormal(columns: Array) -> Array:
    """Return an orthonormal basis of what the columns span, each scaled to one."""
    length = np.linalg.norm(columns, axis=0)
    used = columns[:, length > 0.0] / length[length > 0.0]
    if used.shape[1] == 0:
        nothing: Array = used
        return nothing
    left, size, _ = np.linalg.svd(used, full_matrices=False)
    basis: Array = left[:, size > DEPENDENT * size[0]]
    return basis


def _flat(columns: Array) -> Array:
    n, outputs, directions = columns.shape
    flat: Array = columns.reshape(n * outputs, directions)
    return flat
