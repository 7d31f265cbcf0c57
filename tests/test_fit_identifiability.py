"""What can be known of parameters; the answers follow from the equations by hand."""

import numpy as np
import pytest
import sympy
from test_fitting import (
    WHOLE,
    excitation,
    free_motion,
    motor,
    motor_recording,
    recorded,
    spring_mass,
    spring_mass_recording,
)

from bondgraph import (
    TF,
    BondGraph,
    C,
    FitSettings,
    I,
    R,
    Sdirk2,
    Se,
    WholeRecordings,
    displacement,
    fit,
    q,
)
from bondgraph.fitting.certainty.combinations import (
    Local,
    combination_sentences,
    flat_directions,
    relative,
    taking_part,
)
from bondgraph.fitting.certainty.identifiability import (
    IdentifiabilityStatus,
    identifiability,
)
from bondgraph.fitting.certainty.solver_error import SolverErrorStatus

TIME = 0.01 * np.arange(300)


def test_a_motor_is_identifiable_from_current_and_speed():
    graph = motor()
    found = identifiability(graph, [motor_recording(graph, n=300)])
    assert found.status is IdentifiabilityStatus.IDENTIFIABLE
    assert found.from_channels == found.from_recordings == ()


def test_without_the_force_only_ratios_are_known():
    graph = free_motion()
    recording = recorded(graph, TIME, x=np.cos(TIME))
    found = identifiability(graph, [recording])
    assert found.status is IdentifiabilityStatus.NOT_FROM_CHANNELS
    assert found.from_channels == ("m and k only as k/m",)


def test_a_force_that_was_zero_is_the_recordings_fault():
    graph = spring_mass()
    recording = recorded(graph, TIME, force=np.zeros(300), x=np.cos(TIME))
    found = identifiability(graph, [recording])
    assert found.status is IdentifiabilityStatus.NOT_FROM_RECORDINGS
    assert found.from_channels == ()
    (sentence,) = found.from_recordings
    assert set(sentence.split(" only as ")[0].replace(" and ", ", ").split(", ")) == {
        *("m", "k", "b")
    }


def test_dampers_side_by_side_are_known_as_their_sum():
    g = BondGraph("two dampers", domain="translation")
    k = sympy.Symbol("k")
    spring = C("spring", law=k * q)
    g.one("mass", Se("force"), I("m"), R("b_1"), R("b_2"), spring)
    g.measure("x", displacement="mass")
    for name, value, unit in (
        ("m", 1.0, "kg"), ("k", 30.0, "N/m"), ("b_1", 0.5, "N*s/m"),
        ("b_2", 0.8, "N*s/m"),
    ):  # fmt: skip
        g.parameter(name, value, unit)
    graph = g.finish()
    recording = spring_mass_recording(graph)
    found = identifiability(graph, [recording])
    assert found.from_channels == ("b_1 and b_2 only as b_1 + b_2",)
    fitted = fit(graph, [recording], settings=WHOLE)
    assert fitted.unidentifiable == found.from_channels
    assert fitted.estimate("b_1").interval is None
    total = sum(fitted.estimate(name).value for name in ("b_1", "b_2"))
    assert total == pytest.approx(1.5, rel=0.02)


def test_a_zero_that_springs_may_have_begun_with_is_told_to_be_so():
    # Two springs side by side may each begin as stretched as the other is pressed.
    g = BondGraph("cone in a box", domain="translation")
    g.one("cone", Se("force"), I("m"), R("b"), C("edge"), C("air"))
    g.measure("x", displacement("edge") + sympy.Symbol("zero"), unit="m")
    for name, value, unit in (
        ("m", 1.0, "kg"), ("b", 0.5, "N*s/m"), ("edge", 0.05, "m/N"), ("zero", 0, "m"),
    ):  # fmt: skip
        g.parameter(name, value, unit)
    g.parameter("air", 0.1, "m/N", std=0.0)
    fitted = fit(g.finish(), [spring_mass_recording(g.finish())], settings=WHOLE)
    assert fitted.unidentifiable == (
        "zero cannot be told from the states in which recordings begin",
    )
    assert fitted.estimate("edge").interval is not None


def test_a_gear_and_what_lies_behind_it_are_known_as_products():
    g = BondGraph("geared flywheel", domain="rotation")
    g.one("shaft", Se("torque"), R("c"))
    g.one("load", I("J"))
    g.join("shaft", TF("K"), "load")
    g.measure("angle", displacement="shaft")
    for name, value, unit in (("c", 0.4, "N*m*s"), ("J", 2.0, "kg*m^2")):
        g.parameter(name, value, unit)
    g.parameter("K", 3.0, "1")
    graph = g.finish()
    torque = excitation(300, seed=1)
    recording = recorded(graph, TIME, torque=torque, angle=np.cumsum(torque))
    found = identifiability(graph, [recording])
    (sentence,) = found.from_channels
    # The load as seen from the shaft, J/K^2 or its inverse, in either order.
    assert sentence.split(" only as ")[1] in ("K^2/J", "J/K^2", "K/J^1/2")


def test_channels_that_tell_nothing_are_named():
    g = BondGraph("cart and clock", domain="translation")
    g.one("cart", Se("push"), I("m"), R("b"))
    g.measure("x", displacement="cart")
    g.measure("force", effort="push")
    g.parameter("m", 2.0, "kg")
    g.parameter("b", 0.5, "N*s/m")
    graph = g.finish()
    channels = {"push": np.sin(TIME), "x": TIME, "force": TIME}
    found = identifiability(graph, [recorded(graph, TIME, **channels)])
    assert found.silent_outputs == ("force",)
    assert found.unused_inputs == ()


def test_sentences_follow_from_hessians_by_hand():
    slopes = np.array([[2.0, -1.0, 0.0], [0.0, 0.0, 0.0]])

    def at(*theta):
        size = np.array(theta)
        jacobian = slopes / size  # log(a^2 / b), and nothing of c
        return Local(size, jacobian.T @ jacobian)

    points = [at(1.0, 2.0, 3.0), at(1.3, 1.7, 2.0), at(0.8, 2.9, 4.0)]
    assert combination_sentences(("a", "b", "c"), points, "here") == (
        "c has no effect on here",
        "a and b only as b/a^2",
    )


@pytest.mark.parametrize(
    ("others", "told"),
    [
        ([], "1 combination: state 2 of them to know the rest"),
        ([lambda a, b, c: (0.0, 1.0, 2.0 * c)], "2 combinations: state one of them"),
    ],
)
def test_what_is_no_product_and_no_sum_says_what_to_state(others, told):
    def at(a, b, c):
        """a b + c shows, and what else is asked for."""
        slopes = [(b, a, 1.0), *(other(a, b, c) for other in others)]
        jacobian = np.array(slopes)
        return Local(np.array([a, b, c]), jacobian.T @ jacobian)

    points = [at(1.0, 2.0, 3.0), at(1.3, 1.7, 2.0), at(0.8, 2.9, 4.0)]
    *_, said = combination_sentences(("a", "b", "c"), points, "here")
    assert said.startswith(f"a, b and c only in {told}")


def test_a_step_that_is_too_coarse_is_said():
    graph = spring_mass()
    recording = spring_mass_recording(graph, noise=1e-6)
    coarse = fit(graph, [recording], settings=WHOLE)
    assert coarse.solver_error.status is SolverErrorStatus.COARSE
    chosen = FitSettings(horizon=WholeRecordings(), solver=Sdirk2(substeps=64))
    fine = fit(graph, [recording], settings=chosen)
    assert fine.solver_error.status is SolverErrorStatus.FINE


def test_what_is_far_from_zero_takes_part_beside_what_is_near_it():
    # A damper of about 1 and a slope of about 0 that do the same, and a mass apart.
    sensitivities = np.array([[1.0, 2.0, 0.0], [3.0, 6.0, 0.0], [0.0, 0.0, 1.0]])
    theta = np.array([0.97, 1e-5, 4.0])
    local = relative(Local(theta, sensitivities.T @ sensitivities))
    flat = flat_directions(local)
    assert len(flat) == 1
    assert taking_part(flat, local).tolist() == [True, True, False]
    assert not taking_part(flat[:0], local).any()
    # A step of the damper is small in such a direction, as relative steps go.
    assert abs(flat[0, 0]) < 0.05 * abs(flat[0, 1])
