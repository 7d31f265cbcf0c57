"""A numeric model at one instant: rates, residuals, outputs, for solvers in Python."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import EquationError
from bondgraph.numeric.model import NumericModel, evaluate

Array = NDArray[np.float64]

ITERATIONS = 60
TOLERANCE = 1e-11


class Dynamics:
    """The equations of a model with values for its parameters.

    States x, rates ẋ, unknowns z, inputs u and their rates u̇ are arrays in the model's
    order.
    """

    def __init__(self, model: NumericModel, parameters: Array) -> None:
        self.model = model
        self._parameters = parameters
        self._nothing = np.zeros((model.dynamics.n_variables, 0))
        n, nx = model.dynamics.n_variables, model.n_states
        nw = nx + model.n_unknowns
        self._along_w = np.zeros((n, nw))
        self._along_w[nx : nx + nw] = np.eye(nw)
        self._along_x = np.zeros((n, nx))
        self._along_x[:nx] = np.eye(nx)

    def _point(self, t: float, *parts: Array) -> Array:
        x, rates, z, u, du = parts
        return np.concatenate([x, rates, z, u, du, self._parameters, [t]])

    def residual(self, t: float, *parts: Array) -> tuple[Array, Array]:
        """Return the rates' right-hand sides and what must vanish."""
        found, _ = evaluate(self.model.dynamics, self._point(t, *parts), self._nothing)
        return found[: self.model.n_states], found[self.model.n_states :]

    def slopes(self, t: float, *parts: Array) -> tuple[Array, Array]:
        """Return the derivatives of `residual` along x."""
        point = self._point(t, *parts)
        _, slopes = evaluate(self.model.dynamics, point, self._along_x)
        return slopes[: self.model.n_states], slopes[self.model.n_states :]

    def output(self, t: float, *parts: Array) -> Array:
        """Return the outputs."""
        nothing = self._nothing
        return evaluate(self.model.output, self._point(t, *parts), nothing)[0]

    def settle(
        self, t: float, x: Array, z: Array, u: Array, du: Array
    ) -> tuple[Array, Array]:
        """Return the rates and unknowns at a state, by Newton's method from `z`.

        Raises
        ------
        EquationError
            If none are found.
        """
        nx = self.model.n_states
        w = np.concatenate([np.zeros(nx), z])
        if not self.model.n_unknowns:
            return self.residual(t, x, w, z, u, du)[0], z
        for _ in range(ITERATIONS):
            point = self._point(t, x, w[:nx], w[nx:], u, du)
            left, slopes = evaluate(self.model.dynamics, point, self._along_w)
            left[:nx] = w[:nx] - left[:nx]
            slopes[:nx] *= -1.0
            slopes[:nx, :nx] += np.eye(nx)
            step = np.linalg.lstsq(slopes, left, rcond=None)[0]
            w -= step
            if np.abs(step).max(initial=0.0) <= TOLERANCE * (1.0 + np.abs(w).max()):
                return w[:nx], w[nx:]
            if not np.isfinite(w).all():
                break
        raise EquationError(
            f"The equations of {self.model.name!r} have no solution that Newton's "
            f"method finds at t = {t:.6g} s.",
            (self.model.name,),
            "Start elsewhere, or use fixed implicit steps.",
        )
