"""M(q) q̈ + h(q, q̇) + G(q) = τ (eq. 4.1) read off a bond graph at one posture.

The graph's equations give the accelerations for any torques and speeds. They are affine
in the torques, which gives M; at rest what is left is G, at speed also h, to which
friction is counted.

The angles are absolute, so τ are the torques of the two drives on their joints and
nothing else, and the inertia of each drive stands on M's diagonal. In the thesis's
relative angles θ1, θ2 the knee drive couples the joints by its whole reflected inertia:
see `EquationOfMotion.relative_mass`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph import FinishedGraph, derive
from flegx_models.planar_leg import CARRIERS, JOINTS

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class EquationOfMotion:
    """M q̈ + h + G = τ at one posture and speed, rows in the order of `joints`.

    ``mass`` in kg·m², ``velocity`` (h) and ``gravity`` (G) in N·m.
    """

    joints: tuple[str, ...]
    mass: Array
    velocity: Array
    gravity: Array

    @property
    def relative_mass(self) -> Array:
        """M in the relative angles θ1, θ2; of a leg with both joints free."""
        absolute_of_relative = np.tril(np.ones_like(self.mass))
        turned = absolute_of_relative.T @ self.mass @ absolute_of_relative
        return np.asarray(turned, dtype=np.float64)

    def acceleration(self, torque: Array) -> Array:
        """Return q̈ in rad/s² under these joint torques (N·m)."""
        rest = torque - self.velocity - self.gravity
        return np.asarray(np.linalg.solve(self.mass, rest), dtype=np.float64)


class Leg:
    """A finished planar leg whose equation of motion can be asked for anywhere.

    Parameters
    ----------
    graph
        One of `flegx_models.planar_leg`, all its parameters with values. The joints
        that move by themselves are those whose gear is a state of the graph.
    """

    def __init__(self, graph: FinishedGraph) -> None:
        self._equations = derive(graph)
        self._values = graph.parameters.values_by_name()
        put = {s: self._values[s.name] for s in self._equations.parameters}
        self._steps = [
            (a.symbol, a.expression.xreplace(put)) for a in self._equations.assignments
        ]
        self._rates = [rate.xreplace(put) for rate in self._equations.rates]
        self._residuals = [r.xreplace(put) for r in self._equations.residuals]
        states = {state.symbol.name for state in self._equations.states}
        self.joints = tuple(j for j in JOINTS if f"p_{CARRIERS[j]}" in states)

    @property
    def ratio(self) -> float:
        """Motor turns per joint turn."""
        return self._values["K_gearbox"] * self._values["K_worm_gear"]

    def equation_of_motion(
        self, posture: Mapping[str, float], speed: Mapping[str, float] | None = None
    ) -> EquationOfMotion:
        """Return eq. 4.1 there.

        Parameters
        ----------
        posture
            Angles ``hip`` and ``knee`` in rad.
        speed
            Of `joints` in rad/s; zero where not named.
        """
        fallen = self.accelerations(posture)
        columns = [
            self.accelerations(posture, torque={joint: 1.0 / self.ratio}) - fallen
            for joint in self.joints
        ]
        mass = np.asarray(np.linalg.inv(np.array(columns).T), dtype=np.float64)
        moved = self.accelerations(posture, speed) - fallen
        return EquationOfMotion(
            joints=self.joints,
            mass=mass,
            velocity=-mass @ moved,
            gravity=-mass @ fallen,
        )

    def accelerations(
        self,
        posture: Mapping[str, float],
        speed: Mapping[str, float] | None = None,
        torque: Mapping[str, float] | None = None,
    ) -> Array:
        """Return q̈ of `joints` (rad/s²) under motor torques by joint (N·m)."""
        speed, torque = speed or {}, torque or {}
        known = {f"q_{joint}": angle for joint, angle in posture.items()}
        known |= {f"T_{joint}": value for joint, value in torque.items()}
        for joint, carrier in CARRIERS.items():
            known[f"p_{carrier}"] = self._values[carrier] * speed.get(joint, 0.0)
        rates = self._evaluated(known)
        return np.array(
            [
                rates[f"p_{CARRIERS[joint]}"] / self._values[CARRIERS[joint]]
                for joint in self.joints
            ]
        )

    def _evaluated(self, known: Mapping[str, float]) -> dict[str, float]:
        """Return the rates, solving for the efforts of dependent storages."""
        equations = self._equations
        states = [state.symbol for state in equations.states]
        leaves = (*states, *equations.inputs)
        at: dict[sympy.Symbol, sympy.Expr] = {
            x: sympy.Float(known.get(x.name, 0.0)) for x in leaves
        }
        for symbol, expression in self._steps:
            at[symbol] = expression.xreplace(at)
        rates = [state.rate for state in equations.states]
        rows = [r - x.xreplace(at) for r, x in zip(rates, self._rates, strict=True)]
        # A rate that is known already makes the products with it linear.
        settled = {r: r - row for r, row in zip(rates, rows, strict=True)}
        settled = {r: x for r, x in settled.items() if not x.free_symbols}
        rows += [r.xreplace(at).xreplace(settled) for r in self._residuals]
        unknown = [*rates, *equations.unknowns]
        matrix, right = sympy.linear_eq_to_matrix(
            [row.xreplace(settled) for row in rows if row.xreplace(settled) != 0],
            [x for x in unknown if x not in settled],
        )
        names = [x.name for x in unknown if x not in settled]
        solved = np.linalg.solve(
            np.array(matrix.tolist(), float), np.array(right.tolist(), float).ravel()
        )
        found = {state.rate: state.symbol.name for state in equations.states}
        values = dict(zip(names, map(float, solved), strict=True))
        values |= {rate.name: float(x) for rate, x in settled.items()}
        return {name: values[rate.name] for rate, name in found.items()}
