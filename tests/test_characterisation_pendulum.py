"""The physical pendulum: swings of known inertia and friction give them back."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp

from bondgraph import derive, fit, linearise, read_for
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.free_decay import (
    damping_factor,
    free_decay,
    large_swing_factor,
    natural_frequency,
    printed_damping_factor,
    small_swing_amplitude,
)
from flegx_models.characterisation.pendulum import (
    centre_of_mass,
    inertia_of_point,
    joint_centre,
    pendulum,
    swinging_part,
    tendon_radius,
)
from flegx_models.parameters_chapter3 import CHAPTER_3

P = CHAPTER_3.values_by_name()
FloatArray = NDArray[np.float64]
INERTIA, FRICTION, WEIGHT = 0.0602, 0.0452, 2.447


def swing(
    amplitude: float,
    *,
    friction: float = FRICTION,
    dry: float = 0.0,
    duration: float = 12.0,
) -> tuple[FloatArray, FloatArray]:
    """Return time and angle of eq. 3.25, integrated without approximation."""
    t = np.arange(0, duration, 0.004)

    def rates(_t: float, x: FloatArray) -> list[float]:
        drag = friction * x[1] + dry * math.tanh(x[1] / 1e-3)
        return [x[1], -(WEIGHT * math.sin(x[0]) + drag) / INERTIA]

    solution = solve_ivp(
        rates, (0, duration), [amplitude, 0.0], t_eval=t, rtol=1e-9, atol=1e-11
    )
    return t, solution.y[0]


def test_the_correct_damping_relation_is_that_of_the_decaying_oscillation() -> None:
    for zeta in (0.01, 0.0588, 0.4):
        decrement = 2 * math.pi * zeta / math.sqrt(1 - zeta**2)
        assert damping_factor(decrement) == pytest.approx(zeta)
        assert printed_damping_factor(decrement) == pytest.approx(zeta * decrement)
        damped = 5.0 * math.sqrt(1 - zeta**2) / (2 * math.pi)
        assert natural_frequency(damped, decrement=decrement) == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("part", "inertia", "friction", "right"),
    [
        ("upperleg", "I_upperleg_total", "c_hip", 4.5e-2),
        ("lowerleg", "I_lowerleg", "c_knee", 3.5e-3),
        ("lowerleg_total", "I_lowerleg_total", "c_tot", 7.5e-3),
    ],
)
def test_printed_frictions_are_too_small_by_the_decrement(
    part: str, inertia: str, friction: str, right: float
) -> None:
    delta, omega = CHAPTER_3[f"delta_{part}"], P[f"omega_{part}"]
    assert delta.value is not None
    assert delta.rounding is not None
    ends = (delta.value - delta.rounding, delta.value + delta.rounding)
    low, high = (2 * printed_damping_factor(d) * omega * P[inertia] for d in ends)
    assert low < P[friction] < high
    low, high = (printed_damping_factor(d) for d in ends)
    assert low < P[f"zeta_{part}"] < high
    ours = 2 * damping_factor(delta.value) * omega * P[inertia]
    assert ours == pytest.approx(right, rel=0.015)
    assert natural_frequency(P[f"f_{part}"], decrement=delta.value) == pytest.approx(
        omega, abs=2 * math.pi * 0.005
    )


def test_printed_inertias_follow_from_the_printed_masses() -> None:
    for part, mass, name in (
        ("upperleg_total", "m_upperleg_total", "upperleg"),
        ("lowerleg", "m_lowerleg", "lowerleg"),
        ("lowerleg_total", "m_lowerleg_total", "lowerleg_total"),
    ):
        weight = P[mass] * P["g"] * P[f"L_cm_{part}"]
        inertia = weight / P[f"omega_{name}"] ** 2
        assert inertia == pytest.approx(P[f"I_{part}"], rel=0.006)
    upper = centre_of_mass(P["T_upperleg"], mass=P["m_upperleg"], gravity=P["g"])
    assert round(upper, 2) == P["L_cm_upperleg"]
    lower = centre_of_mass(P["T_lowerleg"], mass=P["m_lowerleg"], gravity=P["g"])
    assert round(lower, 2) == P["L_cm_lowerleg"]
    gears = P["m_upperleg_total"] - P["m_upperleg"]
    both = joint_centre([(P["m_upperleg"], upper), (gears, 0.0)])
    assert both == pytest.approx(P["L_cm_upperleg_total"], rel=0.02)


def test_the_tendons_inertia_needs_the_square_of_the_radius() -> None:
    difference = P["I_lowerleg_total"] - P["I_lowerleg"]
    radius = tendon_radius(difference, gear_inertia=4.81e-4, tendon_mass=0.125)
    assert 4.81e-4 + 2 * inertia_of_point(0.125, radius=radius) == pytest.approx(
        difference
    )
    # b/2 of eq. 3.2 is 28 mm; the printed 2 m r would need half a millimetre.
    assert radius == pytest.approx(0.0218, abs=1e-4)
    assert (difference - 4.81e-4) / (2 * 0.125) == pytest.approx(4.8e-4, abs=1e-5)
    with pytest.raises(CharacterisationError, match="more than the difference"):
        tendon_radius(4e-4, gear_inertia=4.81e-4, tendon_mass=0.125)


@pytest.mark.parametrize("amplitude", [0.1, 0.5, 1.5])
def test_large_swings_follow_the_elliptic_integrals(amplitude: float) -> None:
    # Independent quadratures with θ = θ0 sin φ, no elliptic integrals.
    def speed(angle: float) -> float:
        return math.sqrt(max(2 * (math.cos(angle) - math.cos(amplitude)), 1e-300))

    period = quad(
        lambda x: amplitude * math.cos(x) / speed(amplitude * math.sin(x)),
        0,
        math.pi / 2,
    )[0]
    assert large_swing_factor(amplitude) == pytest.approx(
        period / (math.pi / 2), rel=1e-6
    )
    action = quad(
        lambda x: speed(amplitude * math.sin(x)) * amplitude * math.cos(x),
        0,
        math.pi / 2,
    )[0]
    assert small_swing_amplitude(amplitude) == pytest.approx(
        math.sqrt(4 * action / math.pi), rel=1e-6
    )


@pytest.mark.parametrize("amplitude", [0.2, 0.6, 1.2])
def test_inertia_and_friction_come_back_at_any_amplitude(amplitude: float) -> None:
    t, angle = swing(amplitude)
    decay = free_decay(t, angle + 0.03, smallest=0.02)
    part = swinging_part(decay, weight_torque=WEIGHT)
    assert part.inertia == pytest.approx(INERTIA, rel=2e-3)
    assert part.friction == pytest.approx(FRICTION, rel=4e-3)


def test_standard_deviations_hold_under_noise() -> None:
    t, angle = swing(0.35)
    rng = np.random.default_rng(6)
    pulls = []
    for _ in range(60):
        noisy = angle + rng.normal(0, 0.003, len(t))
        part = swinging_part(
            free_decay(t, noisy, smallest=0.02),
            weight_torque=WEIGHT * (1 + rng.normal(0, 0.01)),
            weight_torque_std=0.01 * WEIGHT,
        )
        pulls.append((part.inertia - INERTIA) / part.inertia_std)
        pulls.append((part.friction - FRICTION) / part.friction_std)
    assert np.std(pulls) == pytest.approx(1.0, abs=4 / math.sqrt(120))


def test_dry_friction_shows_as_a_growing_decrement() -> None:
    t, angle = swing(0.5)
    viscous = free_decay(t, angle, smallest=0.03)
    t, angle = swing(0.5, friction=0.03, dry=0.01, duration=9.0)
    dry = free_decay(t, angle, smallest=0.03)
    assert abs(viscous.drift) < 1e-3
    assert dry.drift > 0.01
    assert dry.drift > 5 * dry.drift_std


def test_the_graph_is_equation_3_27() -> None:
    graph = pendulum(inertia=INERTIA, friction=FRICTION, weight_torque=WEIGHT)
    system = linearise(derive(graph.finish()))
    transfer = system.transfer_function("theta", "T_joint")
    values = graph.finish().parameters.values_by_name()
    assert max(abs(pole) for pole in transfer.poles(values)) == pytest.approx(
        math.sqrt(WEIGHT / INERTIA)
    )
    numerator, denominator = transfer.coefficients(values)
    np.testing.assert_allclose(
        np.array(denominator) / denominator[0],
        [1, FRICTION / INERTIA, WEIGHT / INERTIA],
    )
    assert numerator[-1] / denominator[0] == pytest.approx(1 / INERTIA)


def test_a_fit_of_the_graph_agrees_with_the_peaks(tmp_path: Path) -> None:
    t, angle = swing(0.5)
    noisy = angle + np.random.default_rng(2).normal(0, 0.003, len(t))
    path = tmp_path / "swing.csv"
    table = np.column_stack([t, 0 * t, noisy])[::2]
    np.savetxt(
        path,
        table,
        delimiter=",",
        header="time [s],T_joint [N*m],theta [rad]",
        comments="",
    )
    graph = pendulum(inertia=0.05, friction=0.02, weight_torque=WEIGHT).finish()
    result = fit(graph, [read_for(graph, path)])
    part = swinging_part(free_decay(t, noisy, smallest=0.03), weight_torque=WEIGHT)
    for name, true, peaks in (
        ("I_part", INERTIA, part.inertia),
        ("c_bearing", FRICTION, part.friction),
    ):
        estimate = result.estimate(name)
        assert estimate.value == pytest.approx(true, rel=0.01)
        assert peaks == pytest.approx(estimate.value, rel=0.01)


def test_refuses_a_swing_that_is_too_short() -> None:
    t, angle = swing(0.5, duration=1.5)
    with pytest.raises(CharacterisationError, match="extremes above"):
        free_decay(t, angle, smallest=0.02)
    t, angle = swing(0.5)
    with pytest.raises(CharacterisationError, match="fifty times per period"):
        free_decay(t[::60], angle[::60], smallest=0.02)
