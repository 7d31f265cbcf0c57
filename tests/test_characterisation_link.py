"""The flexible link: its modes in a bond graph against the exact beam."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import least_squares

from bondgraph import BondGraph, I, assign_causality, derive, state_space
from flegx_models.characterisation.added_mass import (
    EXACT_SHARE,
    RAYLEIGH_SHARE,
    THESIS_SHARE,
    corrected_frequency,
    equivalent_mass,
    loaded_frequency,
    tip_mass_between,
)
from flegx_models.characterisation.beam_modes import UniformBeam, wave_numbers
from flegx_models.characterisation.cantilever import Cantilever
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.flexible_link import (
    Load,
    OpenPort,
    PointMass,
    StaticCorrection,
    Truncated,
    Truncation,
    flexible_link,
)
from flegx_models.parameters_chapter3 import CHAPTER_3

P = CHAPTER_3.values_by_name()
STRIP = Cantilever(length=0.25, width=0.07, thickness=0.003, youngs_modulus=200e9)
BEAM = UniformBeam(
    length=STRIP.length,
    bending_stiffness=STRIP.bending_stiffness,
    mass=0.415,
    thickness=STRIP.thickness,
)
FloatArray = NDArray[np.float64]


def frequencies(
    load: Load | None, *, modes: int, truncation: Truncation | None = None
) -> FloatArray:
    """Return the natural frequencies that the graph gives, rad/s, ascending."""
    graph = flexible_link(
        BEAM, modes=modes, force_at=0.1, load=load, truncation=truncation
    )
    poles = state_space(graph.finish()).poles()
    return np.sort(np.abs(poles))[::2]


def test_wave_numbers_are_those_of_the_literature() -> None:
    # Blevins, Formulas for natural frequency and mode shape (1979), table 8-1.
    np.testing.assert_allclose(
        wave_numbers(5),
        [1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839],
        atol=1e-8,
    )
    ratio = (wave_numbers(3) / wave_numbers(1)) ** 2
    np.testing.assert_allclose(ratio, [1, 6.27, 17.55], atol=5e-3)
    # A heavy tip is a pinned one: tan λ = tanh λ from the second root on.
    np.testing.assert_allclose(
        wave_numbers(3, mass_ratio=1e8)[1:], [3.92660231, 7.06858275], atol=1e-6
    )


@pytest.mark.parametrize("mode", [1, 2, 5, 20, 300])
def test_shapes_are_normalised_clamped_and_free(mode: int) -> None:
    x = np.linspace(0, BEAM.length, 40001)
    shape = BEAM.shape(mode, x)
    assert np.trapezoid(shape**2, x) / BEAM.length == pytest.approx(1, abs=2e-5)
    assert shape[0] == pytest.approx(0, abs=1e-9)
    assert shape[1] / shape.max() == pytest.approx(0, abs=2e-3)
    assert abs(shape[-1]) == pytest.approx(2)
    curvature = BEAM.curvature(mode, x)
    assert abs(curvature[-1]) < 1e-6 * np.max(np.abs(curvature))
    spacing = x[1] - x[0]
    twice = np.diff(shape, 2) / spacing**2
    np.testing.assert_allclose(
        twice, curvature[1:-1], atol=2e-2 * np.max(np.abs(curvature))
    )


def test_without_load_the_graph_has_the_beams_frequencies() -> None:
    np.testing.assert_allclose(
        frequencies(None, modes=4), BEAM.frequencies(4), rtol=1e-10
    )


@pytest.mark.parametrize("mass", [0.01, 0.0447, 0.4])
def test_truncated_modes_fall_to_the_exact_frequencies_like_the_cube(
    mass: float,
) -> None:
    exact = BEAM.frequencies(3, tip_mass=mass)
    counts = (4, 8, 16)
    errors = np.array(
        [frequencies(PointMass(mass), modes=n)[:3] / exact - 1 for n in counts]
    )
    assert np.all(errors > 0)  # Rayleigh-Ritz: from above
    rates = np.log2(errors[:-1] / errors[1:])
    assert np.all(np.diff(errors, axis=0) < 0)
    np.testing.assert_allclose(rates[-1], 3, atol=0.45)


def test_static_correction_converges_faster_and_frees_the_mass() -> None:
    mass = 0.0447
    exact = BEAM.frequencies(3, tip_mass=mass)
    plain = frequencies(PointMass(mass), modes=5, truncation=Truncated())
    better = frequencies(PointMass(mass), modes=5, truncation=StaticCorrection())
    assert len(better) == len(plain) + 1
    gain = np.abs(plain[:3] / exact - 1) / np.abs(better[:3] / exact - 1)
    assert np.all(gain > 40)

    def dependent(truncation: Truncation) -> tuple[str, ...]:
        graph = flexible_link(
            BEAM,
            modes=3,
            force_at=0.1,
            load=PointMass(mass),
            truncation=truncation,
        ).finish()
        return assign_causality(graph).derivative

    assert dependent(Truncated()) == ("m_load",)
    assert dependent(StaticCorrection()) == ()


def test_static_response_is_that_of_the_cantilever() -> None:
    graph = flexible_link(BEAM, modes=40, force_at=0.25, gauge_at=0.02).finish()
    model = state_space(graph)
    strain, displacement = model.response(np.array([1e-3]))[0, :, 0].real
    assert model.outputs == ("strain", "displacement")
    assert displacement == pytest.approx(STRIP.tip_displacement(1.0), rel=1e-5)
    # Strain converges with the square of the number of modes only.
    assert strain == pytest.approx(STRIP.surface_strain(0.02, 1.0), rel=5e-3)


def test_the_masss_acceleration_is_its_displacement_twice_differentiated() -> None:
    graph = flexible_link(
        BEAM, modes=3, force_at=0.2, load=PointMass(0.05), damping=0.01
    ).finish()
    model = state_space(graph)
    omega = np.array([50.0, 250.0, 1500.0])
    response = model.response(omega)[:, :, 0]
    at = model.outputs.index
    np.testing.assert_allclose(
        response[:, at("acceleration")],
        -(omega**2) * response[:, at("displacement")],
        rtol=1e-9,
    )


def test_modes_have_the_damping_asked_for() -> None:
    model = state_space(
        flexible_link(BEAM, modes=3, force_at=0.2, damping=0.02).finish()
    )
    poles = model.poles()
    np.testing.assert_allclose(-poles.real / np.abs(poles), 0.02, rtol=1e-9)


def test_an_open_port_takes_another_graph() -> None:
    machine = BondGraph("link with a foot", domain="translation")
    foot = BondGraph("foot", domain="translation")
    foot.one("ankle", I("m_foot"))
    foot.parameter("m_foot", 0.0447, "kg")
    link = machine.include(
        flexible_link(BEAM, modes=4, force_at=0.1, load=OpenPort()), "link"
    )
    machine.join(machine.include(foot, "foot")["ankle"], link["load"])
    poles = state_space(machine.finish()).poles()
    np.testing.assert_allclose(
        np.sort(np.abs(poles))[::2],
        frequencies(PointMass(0.0447), modes=4),
        rtol=1e-9,
    )


def test_refuses_places_off_the_strip_and_no_modes() -> None:
    with pytest.raises(CharacterisationError, match=r"mass_at = 0\.3 m"):
        flexible_link(BEAM, modes=2, force_at=0.1, load=PointMass(0.1, at=0.3))
    with pytest.raises(CharacterisationError, match="0 modes"):
        flexible_link(BEAM, modes=0, force_at=0.1)


def test_the_shares_of_the_strips_mass() -> None:
    x = np.linspace(0, 1, 10001)
    assert pytest.approx(np.trapezoid((x**2 * (3 - x) / 2) ** 2, x)) == RAYLEIGH_SHARE
    first = BEAM.frequencies(1)[0] / (2 * math.pi)
    for share, error in ((EXACT_SHARE, 0.0), (THESIS_SHARE, 0.0272)):
        ours = loaded_frequency(STRIP.tip_stiffness, equivalent_mass=share * BEAM.mass)
        assert ours / first - 1 == pytest.approx(error, abs=1e-4)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.3, 2.0])
def test_added_mass_formula_against_the_exact_beam(ratio: float) -> None:
    exact = BEAM.frequencies(1, tip_mass=ratio * BEAM.mass)[0] / (2 * math.pi)
    ours = loaded_frequency(
        STRIP.tip_stiffness,
        equivalent_mass=EXACT_SHARE * BEAM.mass,
        tip_mass=ratio * BEAM.mass,
    )
    assert ours == pytest.approx(exact, rel=0.004)


def test_the_printed_correction_from_35_to_30_hz() -> None:
    """Eq. 3.21 needs an accelerometer of 43 to 46 g: m_eq is printed to two digits."""
    mass = tip_mass_between(
        P["m_eq"],
        unloaded_frequency=P["f_1"],
        loaded_frequency=P["f_1_corrected"],
    )
    assert mass == pytest.approx(0.0447, abs=2e-4)
    again = corrected_frequency(P["f_1"], equivalent_mass=P["m_eq"], tip_mass=mass)
    assert round(again, 2) == P["f_1_corrected"]
    # The strip's own stiffness and the printed 35 Hz give the printed 0.13 kg ...
    ours = equivalent_mass(STRIP.tip_stiffness, frequency=P["f_1"])
    assert round(ours, 2) == P["m_eq"]
    # ... and eq. 3.20's 37.26 Hz then stands for a strip of 0.48 kg, not 0.42 kg.
    strip = equivalent_mass(STRIP.tip_stiffness, frequency=P["f_1_expected"])
    assert strip / THESIS_SHARE == pytest.approx(0.48, abs=0.002)
    with pytest.raises(CharacterisationError, match="cannot change 30 Hz to 35 Hz"):
        tip_mass_between(0.13, unloaded_frequency=30.0, loaded_frequency=35.0)


def test_one_mass_a_little_inside_explains_all_three_frequencies() -> None:
    """No mass at the tip does: it would lower the second and third mode much more."""
    measured = np.array([P[f"f_{k}_accelerometer"] / P[f"f_{k}"] for k in (1, 2, 3)])

    def misfit(z: FloatArray) -> FloatArray:
        load = PointMass(z[0] * BEAM.mass, at=z[1] * BEAM.length)
        return frequencies(load, modes=6)[:3] / BEAM.frequencies(3) - measured

    at_tip = [
        (wave_numbers(3, mass_ratio=float(mu)) / wave_numbers(3)) ** 2 - measured
        for mu in np.linspace(0, 0.3, 601)
    ]
    best_at_tip = min(float(np.max(np.abs(m))) for m in at_tip)
    # Even within the rounding to 5 Hz no mass at the tip gives modes two and three.
    low, high = (
        np.array(
            [
                (P[f"f_{k}_accelerometer"] + sign * 2.5) / (P[f"f_{k}"] - sign * 2.5)
                for k in (2, 3)
            ]
        )
        for sign in (-1, 1)
    )
    inside = [np.all((m + measured)[1:] >= low) for m in at_tip]
    assert not any(
        ok and np.all((m + measured)[1:] <= high)
        for ok, m in zip(inside, at_tip, strict=True)
    )
    found = least_squares(misfit, [0.09, 0.95], diff_step=1e-4)
    assert best_at_tip > 0.03
    assert np.max(np.abs(found.fun)) < 1e-3
    assert (1 - found.x[1]) * BEAM.length == pytest.approx(0.015, abs=0.001)


def test_the_fem_frequencies_are_those_of_the_drawn_strip() -> None:
    """AISI 304, 250 x 70 x 3 mm: 39.0, 244, 684 Hz against the FEM's 39, 241, 676."""
    ours = BEAM.frequencies(3) / (2 * math.pi)
    np.testing.assert_allclose(ours, [P[f"f_{k}_fem"] for k in (1, 2, 3)], rtol=0.015)
    states = derive(flexible_link(BEAM, modes=3, force_at=0.2).finish()).states
    assert len(states) == 6
