"""A size that changes along the way is told as its curve, and a constant one is not."""

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, R, Recording, Sf, bind_to, diagnose
from bondgraph.diagnosis.answer.showing import recovered_law
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.unknown import UnknownRelation
from bondgraph.reporting.page.laws import law_picture
from bondgraph.structure.signals import flow, parameter_symbol

LIBRARY = (CoulombFriction(), UnknownRelation())


def slider():
    """Return a slider that is pulled at known speeds, its force and its way read."""
    g = BondGraph("slider", domain="translation")
    g.one("cart", Sf("speed"), R("damper"))
    g.measure("force", effort="speed")
    g.measure("way", displacement="cart")
    g.parameter("damper", 1.0, "N*s/m", bounds=(0, 100))
    return g.finish()


def recorded(force_of, seed):
    rng = np.random.default_rng(seed)
    time = np.arange(1200) * 0.01
    way = 0.4 * np.sin(1.3 * time + seed) + 0.3 * np.sin(0.7 * time)
    speed = np.gradient(way, time)
    force = force_of(way, speed) + 0.02 * rng.normal(size=time.size)
    channels = {
        "speed": (speed, "m/s"),
        "force": (force, "N"),
        "way": (way + 1e-4 * rng.normal(size=time.size), "m"),
    }
    return bind_to(slider(), Recording.from_arrays(f"run {seed}", time, channels))


def said(force_of):
    run, other = (recorded(force_of, seed) for seed in (1, 2))
    return diagnose(slider(), [run], held_out=[other], options=Options(library=LIBRARY))


def bump(way):
    return np.exp(-((way / 0.3) ** 2))


@pytest.mark.parametrize(
    ("words", "size_of", "factor", "unit"),
    [
        pytest.param(
            "against the motion",
            lambda q: 0.5 + 2 * bump(q),
            np.sign,
            "N",
            marks=pytest.mark.long,
        ),
        ("proportional to", lambda q: 4 * bump(q), np.asarray, "(N)/(m/s)"),
    ],
)
def test_a_size_that_changes_along_the_way_is_told_as_its_curve(
    words, size_of, factor, unit
):
    found = said(lambda way, speed: speed + size_of(way) * factor(speed))
    assert found.verdict is Verdict.UNEXPLAINED
    curve, law = found.findings[-1], found.recovered[-1]
    assert (curve.physics, curve.place) == ("unknown_relation", "cart")
    assert words in curve.statement
    assert law.value_unit == unit
    # What is in proportion to the speed is the damper's as well: both together count.
    more = found.fit_after.estimate("damper").value - 1.0 if factor(2) == 2 else 0.0
    # What dry friction was found before has its share of the size.
    before = sum(e.value for f in found.findings[:-1] for e in f.estimates)
    drawn, true = law.curve_value + more + before, size_of(law.curve_argument)
    assert np.sqrt(np.mean((drawn - true) ** 2) / np.mean(true**2)) < 0.1
    # So does the cloud, of which nothing is shown where the motion turns around.
    cloud = law.value + more + before
    assert np.median(np.abs(cloud - size_of(law.argument))) < 0.1 * true.max()


def test_a_constant_size_is_the_law_with_a_name():
    found = said(lambda way, speed: speed + 1.5 * np.sign(speed))
    assert [one.physics for one in found.findings] == ["coulomb_friction"]


def test_a_curve_of_a_command_spans_what_was_commanded():
    signal, drive = flow("speed"), slider()
    ranges = {signal.name: (0.0, 100.0)}
    place = InputPlace(drive, "speed", Scales(sizes={signal.name: 60.0}, ranges=ranges))
    (curve,) = UnknownRelation().propose(place)  # its gain is the same curve
    width = parameter_symbol("curve_input_speed")
    bends = curve.shape.value.atoms(sympy.Abs)
    ends = [sympy.solve(bend.args[0], signal)[0] for bend in bends]
    knots = sorted(float(end.subs(width, place.peak / 2.0)) for end in ends)
    assert (knots[0], knots[-1]) == pytest.approx((0.0, 100.0))


def test_a_curve_that_changes_a_law_is_drawn_without_a_cloud():
    time = np.arange(1200) * 0.01
    told = 0.5 * np.sin(1.3 * time) + 0.4 * np.sin(0.7 * time)
    acts = told - 0.3 * told**3
    way = np.cumsum(acts) * 0.01 - acts * 0.005
    channels = {"speed": (told, "m/s"), "force": (acts, "N"), "way": (way, "m")}
    run = bind_to(slider(), Recording.from_arrays("run", time, channels))
    base = fit_model(slider(), [run], FitSettings())
    places = all_places(base.graph, measure_scales(base))
    (place,) = (one for one in places if isinstance(one, InputPlace))
    (curve,) = UnknownRelation().propose(place)  # its gain is the same curve
    fitted = fitted_with(base, base, [curve], curve.starts[0])
    law = recovered_law(base, Candidate(curve, fitted, 6), fitted, [run])
    assert (law.argument_unit, law.value_unit, law.argument.size) == ("m/s", "m/s", 0)
    # The damper's number is free as well: it takes the size of the curve.
    true = law.curve_argument - 0.3 * law.curve_argument**3
    drawn = fitted.values["damper"] * law.curve_value
    assert np.sqrt(np.mean((drawn - true) ** 2) / np.mean(true**2)) < 0.05
    shown = law_picture(law)
    assert list(dict(shown.key).values()) == ["the law found"]
    assert shown.rows
