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
from numpy.typing import NDArray

from bondgraph import FinishedGraph, to_nonlinear_io
from flegx_models.planar_leg import CARRIERS, JOINTS

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class EquationOfMotion:
    """M q̈ + h + G = τ (eq. 4.1) at one posture, rows in the order of `joints`.

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
        self._values = graph.parameters.values_by_name()
        self._machine = to_nonlinear_io(graph)
        states = self._machine.state_labels
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
        x, u = (
            np.array([known.get(name, 0.0) for name in names])
            for names in (self._machine.state_labels, self._machine.input_labels)
        )
        rates = dict(
            zip(
                self._machine.state_labels,
                self._machine.dynamics(0.0, x, u),
                strict=True,
            )
        )
        return np.array(
            [
                rates[f"p_{CARRIERS[joint]}"] / self._values[CARRIERS[joint]]
                for joint in self.joints
            ]
        )
