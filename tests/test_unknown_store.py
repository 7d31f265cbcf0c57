"""What a store answers with may be a curve of what it holds, without a name."""

import numpy as np
import pytest
import sympy
from scipy.interpolate import CubicSpline

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to, diagnose
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.curves import drawn
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.thermal import Radiation
from bondgraph.physics.unknown import UnknownRelation

OUTLET, AREA = 2.0e7, 4.0e-6  # Pa*s/m^3; m^3/Pa of the straight part


def vessel():
    graph = BondGraph("vessel", domain="hydraulic")
    graph.zero("vessel", Sf("inflow"), C("shape"), R("outlet"))
    graph.measure("pressure", effort="vessel")
    graph.parameter("shape", 3.5e-6, "m^3/Pa", bounds=(1e-8, 1e-3))
    graph.parameter("outlet", 2.2e7, "Pa*s/m^3", bounds=(1e4, 1e10))
    return graph.finish()


def pressure_of(volume):
    """Return the pressure in a vessel that grows narrow above its straight part."""
    return volume / AREA + 4e3 * np.expm1(np.maximum(volume - 0.012, 0.0) / 4e-3)


def recorded(graph, seed, samples=700, step=4.0, parts=20):
    random = np.random.default_rng(seed)
    inflow = np.repeat(random.uniform(0.0, 4.5e-4, samples // 35), 35)
    volume = np.full(samples, 0.004)
    for k in range(samples - 1):
        held = volume[k]
        for _ in range(parts):  # Heun's method, far finer than the samples
            first = inflow[k] - pressure_of(held) / OUTLET
            ahead = pressure_of(held + step / parts * first)
            held += step / parts * (first + inflow[k] - ahead / OUTLET) / 2.0
        volume[k + 1] = held
    channels = {
        "inflow": (inflow, "m^3/s"),
        "pressure": (pressure_of(volume) + 10.0 * random.normal(size=samples), "Pa"),
    }
    time = step * np.arange(samples)
    return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))


@pytest.mark.long
def test_a_vessel_of_another_shape_is_told_as_the_curve_of_what_it_holds():
    graph = vessel()
    library = (UnknownRelation(), QuadraticDrag(), CoulombFriction(), Radiation())
    found = diagnose(
        graph,
        [recorded(graph, 1)],
        held_out=[recorded(graph, 2)],
        options=Options(library=library),
    )
    assert found.verdict is Verdict.UNEXPLAINED
    (curve,) = found.findings
    assert (curve.physics, curve.place) == ("unknown_relation", "shape")
    assert "holds along an unnamed curve" in curve.statement
    (law,) = found.recovered
    volume, pressure = law.curve_argument, law.curve_value
    # A volume is known but for where it begins: nothing measures it.
    grid = np.linspace(0.0, 0.03, 2001)
    wrong = volume - np.interp(pressure, pressure_of(grid), grid)
    assert np.std(wrong) < 0.03 * np.std(volume)


def curves_at(name):
    places = all_places(vessel(), Scales())
    (place,) = (one for one in places if one.name == name)
    return place, list(UnknownRelation().propose(place))


def test_a_store_of_zero_curve_is_the_base_model_s():
    place, (curve,) = curves_at("shape")
    silent = {s: 0 for s in curve.law.free_symbols if s.name in curve.strengths}
    assert len(silent) == len(curve.strengths)
    assert sympy.simplify(curve.law.subs(silent) - place.usual_law) == 0


@pytest.mark.parametrize("knots", [(-1.0, 0.0, 0.4, 1.0), (0.0, 1.0, 2.0, 3.0, 5.0)])
def test_few_heights_of_a_store_are_joined_by_a_natural_spline(knots):
    place, _ = curves_at("shape")
    x = sympy.Symbol("x")
    curve, heights = drawn(place, "curve", "Pa", x, knots, None, bent=True)
    values = np.random.default_rng(4).normal(size=len(knots))
    known = {one.symbol: at for one, at in zip(heights, values, strict=True)}
    curve = sympy.lambdify(x, curve.subs(known))
    between = np.linspace(knots[0], knots[-1], 33)
    spline = CubicSpline(knots, values, bc_type="natural")
    assert np.allclose([curve(at) for at in between], spline(between), atol=1e-9)
    beyond = [curve(knots[-1] + at) for at in (0.0, 1.0, 2.0)]
    assert np.diff(beyond, 2) == pytest.approx(0.0, abs=1e-9)
