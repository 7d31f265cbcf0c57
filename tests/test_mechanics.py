"""Mechanisms by modulated transformers, against Lagrange's equations made by sympy.

The bond graph knows masses, their velocities as ratios of joint speeds, and weights.
Lagrange's method knows kinetic and potential energy. Both must accelerate alike.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
import sympy
from catalogue.evaluation import Observed, observed
from sympy import cos, sin
from sympy.physics.mechanics import (
    LagrangesMethod,
    Particle,
    Point,
    ReferenceFrame,
    dynamicsymbols,
)

from bondgraph import TF, BondGraph, C, I, Se, displacement, flow, p, q
from bondgraph.structure.signals import parameter_symbol

Expr = sympy.Expr


@dataclass(frozen=True)
class Mechanism:
    """A planar mechanism in generalised coordinates, for both methods.

    ``inertias`` are J of each coordinate, ``masses`` their positions (x, y up),
    ``springs`` (stiffness, coordinate) and ``gravity`` acts along -y.
    """

    coordinates: tuple[str, ...]
    inertias: dict[str, str]
    masses: dict[str, tuple[Expr, Expr]]
    springs: tuple[tuple[str, str], ...] = ()


def angle(name: str) -> sympy.Symbol:
    """Return the symbol of a coordinate in a position."""
    return sympy.Symbol(f"at_{name}", real=True)


def drawn(mechanism: Mechanism) -> BondGraph:
    """Return the bond graph: a 1-junction per coordinate and per velocity component.

    The velocity of each component is a 0-junction's sum of transformed joint speeds.
    """
    graph = BondGraph("mechanism")
    gravity = parameter_symbol("g")
    read = {angle(c): displacement(c) for c in mechanism.coordinates}
    for name in mechanism.coordinates:
        store = [I(mechanism.inertias[name])] if name in mechanism.inertias else []
        graph.one(name, Se(f"drive_{name}"), *store)
    for stiffness, name in mechanism.springs:
        graph.put(C(f"spring_{name}", law=parameter_symbol(stiffness) * q), on=name)
    for mass, position in mechanism.masses.items():
        m = parameter_symbol(mass)
        for axis, component in zip("xy", position, strict=True):
            place = f"{mass}_{axis}"
            weight = [Se(f"weight_{mass}", value=-m * gravity)] if axis == "y" else []
            graph.one(place, I(f"inertia_{place}", law=p / m), *weight)
            parts = [
                (c, component.diff(angle(c)).xreplace(read))
                for c in mechanism.coordinates
                if component.diff(angle(c)) != 0
            ]
            if not parts:
                raise AssertionError(f"{place} never moves")
            graph.zero(f"sum_{place}")
            for c, ratio in parts:
                # The joint's speed times the ratio flows into the sum.
                graph.one(f"{c}_of_{place}")
                graph.join(c, TF(f"by_{c}_{place}", law=1 / ratio), f"{c}_of_{place}")
                graph.join(f"{c}_of_{place}", f"sum_{place}")
            graph.join(f"sum_{place}", place)
    for name in mechanism.coordinates:
        graph.measure(f"speed_{name}", flow(name))
    return graph


def accelerations(seen: Observed, mechanism: Mechanism) -> list[float]:
    """Return θ'' of the bond graph; every coordinate has an inertia as a state."""
    number = {symbol.name: value for symbol, value in seen.at.items()}
    return [
        seen.rates[f"p_{mechanism.inertias[c]}"] / number[mechanism.inertias[c]]
        for c in mechanism.coordinates
    ]


@cache
def lagrange(name: str) -> tuple[dict[str, Expr], sympy.Matrix, sympy.Matrix]:
    """Return coordinates, mass matrix and forcing by sympy's LagrangesMethod."""
    mechanism = MECHANISMS[name]
    frame, origin = ReferenceFrame("N"), Point("O")
    origin.set_vel(frame, 0)
    time = dynamicsymbols._t
    moving = {c: dynamicsymbols(f"x_{c}") for c in mechanism.coordinates}
    put = {angle(c): x for c, x in moving.items()}
    gravity = parameter_symbol("g")
    potential = kinetic = sympy.S.Zero
    for mass, position in mechanism.masses.items():
        m = parameter_symbol(mass)
        x, y = (component.xreplace(put) for component in position)
        point = origin.locatenew(mass, x * frame.x + y * frame.y)
        point.set_vel(frame, x.diff(time) * frame.x + y.diff(time) * frame.y)
        kinetic += Particle(mass, point, m).kinetic_energy(frame)
        potential += m * gravity * y
    for c, inertia in mechanism.inertias.items():
        kinetic += parameter_symbol(inertia) * moving[c].diff(time) ** 2 / 2
    for stiffness, c in mechanism.springs:
        potential += parameter_symbol(stiffness) * moving[c] ** 2 / 2
    method = LagrangesMethod(kinetic - potential, list(moving.values()))
    method.form_lagranges_equations()
    return moving, method.mass_matrix, method.forcing


def by_lagrange(name: str, number: dict[str, float]) -> np.ndarray:
    """Return θ'' at the numbers of the bond graph."""
    mechanism, (moving, matrix, forcing) = MECHANISMS[name], lagrange(name)
    time = dynamicsymbols._t
    speeds = {c: _speed(c, mechanism, number) for c in mechanism.coordinates}
    at = {x.diff(time): speeds[c] for c, x in moving.items()}
    here = {x: _position(c, number) for c, x in moving.items()}
    named = {parameter_symbol(n): v for n, v in number.items()}

    def numbers(m: sympy.Matrix) -> np.ndarray:
        # A rate holds its coordinate, so rates are replaced before coordinates.
        return np.array(m.xreplace(at).xreplace(here | named).tolist(), float)

    drives = np.array([number[f"drive_{c}"] for c in mechanism.coordinates])
    return np.linalg.solve(numbers(matrix), numbers(forcing).ravel() + drives)


def _speed(coordinate: str, mechanism: Mechanism, number: dict[str, float]) -> float:
    """Return a coordinate's speed: given, or the momentum over its inertia."""
    if f"speed_{coordinate}" in number:
        return number[f"speed_{coordinate}"]
    inertia = mechanism.inertias[coordinate]
    return number[f"p_{inertia}"] / number[inertia]


def _position(coordinate: str, number: dict[str, float]) -> float:
    """Return a coordinate's value; no state holds one that nothing reads."""
    spring = f"q_spring_{coordinate}"
    return number.get(spring, number.get(f"q_{coordinate}", 0.0))


a, b, c = (angle(name) for name in "abc")
l1, l2, l3, lc = (parameter_symbol(name) for name in ("l1", "l2", "l3", "lc"))

MECHANISMS = {
    "pendulum": Mechanism(("a",), {"a": "ja"}, {"m1": (l1 * sin(a), -l1 * cos(a))}),
    "double pendulum": Mechanism(
        ("a", "b"),
        {"a": "ja", "b": "jb"},
        {
            "m1": (l1 * sin(a), -l1 * cos(a)),
            "m2": (l1 * sin(a) + l2 * sin(b), -l1 * cos(a) - l2 * cos(b)),
        },
    ),
    "triple pendulum": Mechanism(
        ("a", "b", "c"),
        {"a": "ja", "b": "jb", "c": "jc"},
        {
            "m1": (l1 * sin(a), -l1 * cos(a)),
            "m2": (l1 * sin(a) + l2 * sin(b), -l1 * cos(a) - l2 * cos(b)),
            "m3": (
                l1 * sin(a) + l2 * sin(b) + l3 * sin(c),
                -l1 * cos(a) - l2 * cos(b) - l3 * cos(c),
            ),
        },
    ),
    "cart and pole": Mechanism(
        ("a", "b"),
        {"a": "cart", "b": "jb"},
        {"m1": (a + l1 * sin(b), l1 * cos(b))},
    ),
    "two-link arm with relative angle": Mechanism(
        ("a", "b"),
        {"a": "ja", "b": "jb"},
        {
            "m1": (lc * cos(a), lc * sin(a)),
            "m2": (l1 * cos(a) + l2 * cos(a + b), l1 * sin(a) + l2 * sin(a + b)),
        },
        springs=(("kb", "b"),),
    ),
    "spring pendulum": Mechanism(
        ("a", "b"),
        {"a": "ja", "b": "slider"},
        {"m1": ((l1 + b) * sin(a), -(l1 + b) * cos(a))},
        springs=(("kb", "b"),),
    ),
    "slider-crank": Mechanism(
        ("a",),
        {"a": "ja"},
        {
            "m1": (lc * cos(a), lc * sin(a)),
        },
    ),
    "bead on a parabola": Mechanism(("a",), {"a": "ja"}, {"m1": (a, l1 * a**2)}),
}


@pytest.mark.parametrize("name", MECHANISMS)
def test_mechanisms_accelerate_as_lagrange_says(name: str) -> None:
    mechanism = MECHANISMS[name]
    graph = drawn(mechanism).finish()
    for values in _places(mechanism):
        seen = observed(graph, values)
        number = {symbol.name: v for symbol, v in seen.at.items()}
        found = accelerations(seen, mechanism)
        assert found == pytest.approx(by_lagrange(name, number), rel=1e-8)


def _places(mechanism: Mechanism) -> Sequence[dict[str, float]]:
    """Return two places: the arbitrary one, and one with other signs."""
    turned = {f"p_{inertia}": -0.83 for inertia in mechanism.inertias.values()}
    turned |= {f"q_{name}": 2.2 for name in mechanism.coordinates}
    return [{}, turned]


def test_a_double_pendulum_of_two_point_masses_alone() -> None:
    # Nothing turns but the masses: two of four momenta are states, two follow.
    whole = MECHANISMS["double pendulum"]
    bare = Mechanism(whole.coordinates, {}, whole.masses)
    seen = observed(drawn(bare).finish())
    assert len(seen.equations.states) == 4
    number = {symbol.name: v for symbol, v in seen.at.items()}
    speeds = {c: seen.outputs[f"speed_{c}"] for c in "ab"}
    # With inertias so small that they do not matter, Lagrange's are the same.
    number |= {"ja": 0.0, "jb": 0.0}
    given = number | {f"speed_{c}": v for c, v in speeds.items()}
    turning = by_lagrange("double pendulum", given)
    put = {angle(c): number[f"q_{c}"] for c in "ab"}
    put |= {parameter_symbol(n): v for n, v in number.items()}
    for mass, position in whole.masses.items():
        for axis, component in zip("xy", position, strict=True):
            state = f"p_inertia_{mass}_{axis}"
            if state in seen.rates:
                expected = sum(
                    component.diff(angle(i)) * turning["ab".index(i)] for i in "ab"
                ) + sum(
                    component.diff(angle(i), angle(j)) * speeds[i] * speeds[j]
                    for i in "ab"
                    for j in "ab"
                )
                value = number[mass] * float(expected.xreplace(put))
                assert seen.rates[state] == pytest.approx(value, rel=1e-8)
