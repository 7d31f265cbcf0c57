"""Tendons, strip and bridge: the thesis's formulas against independent computation."""

import math

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from flegx_models.characterisation.cantilever import (
    Cantilever,
    without_clamp_rotation,
)
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.gauge_bridge import (
    HalfBridge,
    bridge_output,
    quarter_bridge_output,
)
from flegx_models.characterisation.tendons import (
    RoundColumn,
    spacing_for,
    tendon_force,
)
from flegx_models.parameters_chapter3 import CHAPTER_3

P = CHAPTER_3.values_by_name()
LINK = Cantilever(
    length=P["L_link"],
    width=P["b_link"],
    thickness=P["h_link"],
    youngs_modulus=P["E_tendon"],
)


def test_the_tendons_printed_radius_follows_from_the_printed_force() -> None:
    column = RoundColumn(
        length=P["L_tendon"],
        youngs_modulus=P["E_tendon"],
        end_factor=P["n_tendon"],
    )
    radius = column.smallest_radius(P["F_tendon_max"], safety=P["safety_tendon"])
    assert round(radius * 1e3, 1) == 4.0
    assert column.critical_force(radius) == pytest.approx(1.8 * 2500)
    # The 8 mm bar is a little thinner than asked for: 4.00 against 4.02 mm.
    assert column.safety(P["F_tendon_max"], radius=P["r_tendon"]) == pytest.approx(
        1.764, abs=1e-3
    )
    assert column.slenderness(P["r_tendon"]) > 90


def test_tendon_force_balances_the_torque_at_every_angle() -> None:
    spacing = spacing_for(
        P["T_knee_max"], force=P["F_tendon_max"], angle=P["theta_knee_max"]
    )
    assert spacing == pytest.approx(0.056)
    for angle in np.linspace(-1, 1, 7):
        force = tendon_force(70.0, spacing=spacing, angle=float(angle))
        assert 2 * force * spacing / 2 * math.cos(angle) == pytest.approx(70.0)
    with pytest.raises(CharacterisationError, match="no lever arm"):
        tendon_force(70.0, spacing=spacing, angle=1.6)


@pytest.mark.parametrize("load_at", [0.1, P["x_load"], P["L_link"]])
def test_displacement_is_the_twice_integrated_curvature(load_at: float) -> None:
    x = np.linspace(0, LINK.length, 4001)
    curvature = np.array(
        [LINK.bending_moment(float(v), 95.16, load_at=load_at) for v in x]
    ) / (P["E_tendon"] * 0.07 * 0.003**3 / 12)
    slope = cumulative_trapezoid(curvature, x, initial=0)
    shape = cumulative_trapezoid(slope, x, initial=0)
    ours = [LINK.displacement(float(v), 95.16, load_at=load_at) for v in x]
    np.testing.assert_allclose(ours, shape, atol=2e-7 * shape[-1])


def test_force_here_displaces_there_as_force_there_displaces_here() -> None:
    for a, b in ((0.05, 0.2), (0.243, 0.2385)):
        assert LINK.displacement(a, 1.0, load_at=b) == pytest.approx(
            LINK.displacement(b, 1.0, load_at=a)
        )


def test_the_printed_forms_of_tip_load_agree_with_each_other() -> None:
    F, L, b, h, E = 40.0, LINK.length, 0.07, 0.003, P["E_tendon"]
    assert LINK.tip_displacement(F) == pytest.approx(4 * F * L**3 / (b * h**3 * E))
    assert LINK.tip_displacement(F) == pytest.approx(LINK.displacement(L, F))
    assert LINK.bending_moment(0, F) == pytest.approx(F * L)
    assert LINK.surface_stress(0, F) == pytest.approx(6 * F * L / (b * h**2))
    strain = LINK.surface_strain(0, F)
    assert strain == pytest.approx(6 * F * L / (b * h**2 * E))
    assert LINK.tip_displacement_per_strain() * strain == pytest.approx(
        LINK.tip_displacement(F)
    )
    assert LINK.tip_displacement_per_strain() == pytest.approx(2 / 3 * L**2 / h)
    away = LINK.surface_strain(0.01, F) * LINK.tip_displacement_per_strain(0.01)
    assert away == pytest.approx(LINK.tip_displacement(F))
    with pytest.raises(CharacterisationError, match="not on the strip"):
        LINK.displacement(0.3, F)


def test_the_benchs_own_rotation_is_a_sixth_of_what_the_laser_reads() -> None:
    F, x = P["F_bench"], P["x_laser"]
    own = LINK.displacement(x, F, load_at=P["x_load"])
    bench = P["rotation_per_force"] * F * x
    assert without_clamp_rotation(
        own + bench, F, x=x, rotation_per_force=P["rotation_per_force"]
    ) == pytest.approx(own)
    assert bench / (own + bench) == pytest.approx(0.153, abs=0.005)


def test_half_bridge_is_linear_and_twice_a_quarter_bridge() -> None:
    bridge = HalfBridge(gauge_factor=P["K_s"], resistance=120.0, excitation=5.0)
    for strain in (-2e-2, 1e-3, 5e-2):
        assert bridge.output(strain) == pytest.approx(
            bridge.volts_per_strain * strain, rel=1e-12
        )
    small = 1e-7
    quarter = quarter_bridge_output(small, gauge_factor=P["K_s"], excitation=5.0)
    assert bridge.output(small) / quarter == pytest.approx(2, rel=1e-6)
    large = quarter_bridge_output(0.05, gauge_factor=P["K_s"], excitation=5.0)
    assert bridge.output(0.05) / large == pytest.approx(2 * (1 + 0.05 * P["K_s"] / 2))


def test_the_bridge_is_two_voltage_dividers() -> None:
    r1, r2, r3, r4, supply = 119.0, 121.5, 120.3, 122.0, 3.3
    difference = supply * (r4 / (r2 + r4) - r3 / (r1 + r3))
    assert bridge_output(r1, r2, r3, r4, excitation=supply) == pytest.approx(difference)


def test_axial_strain_only_scales_and_mismatch_exceeds_the_links_strain() -> None:
    bridge = HalfBridge(gauge_factor=P["K_s"], resistance=120.0, excitation=5.0)
    assert bridge.output(0.0, axial_strain=1e-3) == pytest.approx(0.0, abs=1e-15)
    assert bridge.output(1e-3, axial_strain=1e-2) == pytest.approx(
        bridge.output(1e-3) / (1 + P["K_s"] * 1e-2)
    )
    worst = HalfBridge(
        gauge_factor=P["K_s"], resistance=120.0, excitation=5.0, mismatch=0.003
    )
    assert worst.strain_of_mismatch == pytest.approx(0.003 / P["K_s"], rel=1e-6)
    strain = LINK.surface_strain(0, P["F_bench"], load_at=P["x_load"])
    assert worst.strain_of_mismatch > strain
