"""The leg's mechanics as numbers: read off the bond graph once, evaluated quickly.

From the graph's equations follow, for v = (ḣeight, θ̇_hip, θ̇_knee),

    M(q) v̇ = b(q, v) + torques on the joints + Jᵀ F_foot

with b the gravity and velocity terms and J the foot's velocity per v. M, b and J are
collected in symbols and compiled; nothing about the leg is written here by hand.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph import BondGraphError, ParameterSet, derive
from flegx_models.jump.leg_graph import leg_graph, leg_parameters

Array = NDArray[np.float64]

COORDINATES = ("support", "hip", "knee")
"""The junctions whose displacements are q and whose flows are v."""

_CARRIERS = ("m_motors_support", "I_gear", "I_gear_tendons")
_RATES = sympy.symbols("a_support a_hip a_knee")
_SPEEDS = sympy.symbols("v_support v_hip v_knee")
_PLACES = sympy.symbols("q_support q_hip q_knee")


@dataclass(frozen=True, slots=True)
class Posture:
    """What the mechanics are at one q and v.

    Parameters
    ----------
    mass
        M, shape (3, 3), in kg, kg·m and kg·m².
    bias
        b, shape (3,), in N and N·m.
    foot
        J, rows x and y, shape (2, 3).
    """

    mass: Array
    bias: Array
    foot: Array


@dataclass(frozen=True, slots=True)
class Leg:
    """The mechanics of a leg with the given parameters; see the module's head."""

    parameters: ParameterSet
    _compiled: Callable[..., Any]
    _fallen: Callable[..., Any]

    def at(self, q: Array, v: Array) -> Posture:
        """Return M, b and J at `q` and `v`, in the order of `COORDINATES`."""
        entries = self._compiled(*q[1:3], *v)
        return Posture(
            np.array(entries[:9]).reshape(3, 3),
            np.array(entries[9:12]),
            np.array(entries[12:]).reshape(2, 3),
        )

    def foot_height(self, q: Array) -> float:
        """Return the foot's height above the hip's, plus q's support height, in m."""
        return float(q[0]) + float(self._fallen(*q[1:3])[1])

    def foot_forward(self, q: Array) -> float:
        """Return how far the foot is in front of the hip, in m."""
        return float(self._fallen(*q[1:3])[0])

    def potential(self, q: Array) -> float:
        """Return the potential energy of all weights in J, zero with links at hip."""
        return float(self._fallen(*q[1:3])[2]) + self._weight * float(q[0])

    @property
    def _weight(self) -> float:
        return float(self._fallen(0.0, 0.0)[3])


def leg(parameters: ParameterSet | None = None) -> Leg:
    """Return the mechanics of a leg; of `leg_parameters()` by default."""
    return _leg(leg_parameters() if parameters is None else parameters)


@cache
def _leg(parameters: ParameterSet) -> Leg:
    mass, bias, foot = symbolic_mechanics(parameters)
    values = parameters.values_by_name()
    entries = [_with(values, x) for x in (*mass, *bias, *foot)]
    # Work is the integral of the forces: the foot's place of its velocity, and the
    # potential of the weights at rest.
    hip, knee = _PLACES[1:]
    place = [
        sum(sympy.integrate(foot[row, k], _PLACES[k]) for k in (1, 2)) for row in (0, 1)
    ]
    still = bias.xreplace(dict.fromkeys(_SPEEDS, sympy.S.Zero))
    potential = -sum(sympy.integrate(still[k], _PLACES[k]) for k in (1, 2))
    fallen = [_with(values, x) for x in (*place, potential, -still[0])]
    return Leg(
        parameters,
        sympy.lambdify((hip, knee, *_SPEEDS), entries, modules="math", cse=True),
        sympy.lambdify((hip, knee), fallen, modules="math", cse=True),
    )


def _with(values: Mapping[str, float], expression: sympy.Expr) -> sympy.Expr:
    """Return the expression with its parameters' values."""
    used = (s for s in expression.free_symbols if s.name in values)
    return expression.xreplace({s: sympy.Float(values[s.name]) for s in used})


def symbolic_mechanics(
    parameters: ParameterSet | None = None,
) -> tuple[sympy.Matrix, sympy.Matrix, sympy.Matrix]:
    """Return M, b and J in symbols, derived from `leg_graph`.

    Raises
    ------
    BondGraphError
        If the graph's equations do not have the expected states.
    """
    equations = derive(leg_graph(parameters).finish())
    at = _leaves(equations)
    for assignment in equations.assignments:
        at[assignment.symbol] = assignment.expression.xreplace(at)
    found: dict[sympy.Symbol, sympy.Expr] = {}
    for unknown, residual in zip(equations.unknowns, equations.residuals, strict=True):
        # The effort of a dependent mass follows from the accelerations alone.
        row = residual.xreplace(at)
        slope = row.diff(unknown)
        found[unknown] = -(row - slope * unknown) / slope
    momenta = dict(
        zip((s.place for s in equations.states), equations.rates, strict=True)
    )
    inertias = {symbol.name: symbol for symbol in equations.parameters}
    rows = [
        inertias[carrier] * rate - momenta[carrier].xreplace(at).xreplace(found)
        for carrier, rate in zip(_CARRIERS, _RATES, strict=True)
    ]
    balance = sympy.Matrix(rows)
    forces = dict.fromkeys(equations.inputs, sympy.S.Zero)
    mass = balance.jacobian(_RATES)
    rest = balance.xreplace({**forces, **dict.fromkeys(_RATES, sympy.S.Zero)})
    outputs = {o.name: o.expression.xreplace(at) for o in equations.outputs}
    foot = sympy.Matrix([outputs["foot_x"], outputs["foot_y"]]).jacobian(_SPEEDS)
    return mass, -rest, foot


def _leaves(equations: Any) -> dict[sympy.Symbol, sympy.Expr]:
    """Return states and rates in terms of q, v and v̇."""
    at: dict[sympy.Symbol, sympy.Expr] = {}
    by_place = {state.place: state for state in equations.states}
    inertias = {symbol.name: symbol for symbol in equations.parameters}
    for name, speed, rate, q in zip(COORDINATES, _SPEEDS, _RATES, _PLACES, strict=True):
        carrier = _CARRIERS[COORDINATES.index(name)]
        if name not in by_place or carrier not in by_place:
            raise BondGraphError(
                f"The leg's equations have no state at {name!r} and {carrier!r}.",
                (name, carrier),
                "Let the graph prefer these inertances as integral.",
            )
        inertia = inertias[carrier]
        at[by_place[carrier].symbol] = inertia * speed
        at[by_place[carrier].rate] = inertia * rate
        at[by_place[name].symbol] = q
        at[by_place[name].rate] = speed
    return at
