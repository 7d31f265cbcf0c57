"""Modes from hammer hits: simulated strips of known modes, with noise."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

from flegx_models.characterisation.beam_modes import UniformBeam
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.frequency_response import (
    Estimator,
    FrequencyResponse,
    frequency_response,
    pulse_only,
)
from flegx_models.characterisation.impact_modes import (
    ModalStatus,
    identify_modes,
    modal_assurance,
    pick_peaks,
)

FloatArray = NDArray[np.float64]

BEAM = UniformBeam(length=0.25, bending_stiffness=31.5, mass=0.415, thickness=0.003)
DAMPING = (0.006, 0.004, 0.005, 0.006, 0.006)
TRUE = BEAM.frequencies(5) / (2 * math.pi)
PLACES = np.array([0.07, 0.13, 0.19, 0.25])
RATE, SAMPLES, OVERSAMPLING = 5000, 5000, 8
RUNS = 30


def strain_after(force: FloatArray, place: float) -> FloatArray:
    """Return the strain at the clamp for a force at `place`, mode by mode."""
    total = np.zeros_like(force)
    for r in range(5):
        w = 2 * math.pi * TRUE[r]
        gain = float(BEAM.shape(r + 1, place) * BEAM.surface_strain(r + 1, 0.01))
        system = ([gain / BEAM.mass], [1.0, 2 * DAMPING[r] * w, w**2])
        b, a, _ = cont2discrete(system, 1 / (RATE * OVERSAMPLING), method="foh")
        total += lfilter(b.ravel(), a, force)
    return total


def hits(
    place: float, *, seed: int, noise: float, number: int = 3
) -> tuple[FloatArray, FloatArray]:
    """Return force and strain ``[hit, sample]`` of half-sine hits of varying width."""
    rng = np.random.default_rng(seed)
    t = np.arange(SAMPLES * OVERSAMPLING) / (RATE * OVERSAMPLING)
    forces, strains = [], []
    for _ in range(number):
        width, height = rng.uniform(0.6e-3, 1e-3), rng.uniform(20, 60)
        during = (t > 0.01) & (t < 0.01 + width)
        force = np.where(during, height * np.sin(np.pi * (t - 0.01) / width), 0.0)
        strain = strain_after(force, place)[::OVERSAMPLING]
        measured = force[::OVERSAMPLING] + rng.normal(0, 0.1 * noise, SAMPLES)
        forces.append(measured)
        strains.append(strain + rng.normal(0, 2e-6 * noise, SAMPLES))
    return pulse_only(np.array(forces), samples=10), np.array(strains)


def responses(*, noise: float, decay: float, seed: int = 0) -> list[FrequencyResponse]:
    return [
        frequency_response(
            *hits(float(x), seed=seed + k, noise=noise),
            interval=1 / RATE,
            decay=decay,
        )
        for k, x in enumerate(PLACES)
    ]


@pytest.mark.parametrize("noise", [0.1, 1.0])
def test_frequencies_damping_and_shapes_are_recovered(noise: float) -> None:
    fit = identify_modes(responses(noise=noise, decay=4.0), band=(15.0, 800.0), count=3)
    assert fit.status is ModalStatus.CONVERGED
    for r, mode in enumerate(fit.modes):
        # Sampling and the modes above the band cost 2e-5, noise some of its std.
        assert abs(mode.frequency - TRUE[r]) < 4 * mode.frequency_std + 2e-5 * TRUE[r]
        assert abs(mode.damping - DAMPING[r]) < 4 * mode.damping_std + 0.01 * DAMPING[r]
        assert mode.frequency_std < 2e-4 * TRUE[r]
        assert modal_assurance(mode.shape, BEAM.shape(r + 1, PLACES)) > 0.999
        assert mode.complexity < 0.03


def test_the_exponential_weight_needs_no_correction() -> None:
    """A second is too short for the first mode; the weight makes that harmless."""
    damping = [
        identify_modes(responses(noise=0.05, decay=decay), band=(15.0, 800.0), count=3)
        .modes[0]
        .damping
        for decay in (3.0, 6.0)
    ]
    np.testing.assert_allclose(damping, DAMPING[0], rtol=0.02)


def test_peak_picking_is_a_line_wide_and_takes_the_weight_for_damping() -> None:
    found = responses(noise=0.1, decay=4.0)
    peaks = pick_peaks(found[-1].within(15.0, 800.0), 3)
    fit = identify_modes(found, band=(15.0, 800.0), count=3)
    for r, (peak, mode) in enumerate(zip(peaks, fit.modes, strict=True)):
        assert abs(peak.frequency - TRUE[r]) <= 1.0
        assert abs(mode.frequency - TRUE[r]) < 0.1 * max(
            abs(peak.frequency - TRUE[r]), 0.02
        )
    assert peaks[0].damping > 2 * DAMPING[0]


def synthetic(
    rng: np.random.Generator, *, noise: float, known: bool
) -> list[FrequencyResponse]:
    """Return exact responses of two close modes at two places, plus white noise."""
    frequency = np.arange(20.0, 60.0, 0.25)
    s = 2j * np.pi * frequency
    poles = 2 * np.pi * np.array([38.0, 40.0]) * (-0.01 + 1j)
    found = []
    for residues in ((1.0, 0.8), (0.7, -1.0)):
        value = sum(
            a / (1j * (s - p)) - a / (1j * (s - np.conj(p)))
            for a, p in zip(residues, poles, strict=True)
        )
        value = value + noise * (
            rng.standard_normal(len(s)) + 1j * rng.standard_normal(len(s))
        )
        found.append(
            FrequencyResponse(
                frequency=frequency,
                value=value,
                coherence=np.ones_like(frequency),
                std=np.full(len(s), noise) if known else None,
                decay=0.0,
            )
        )
    return found


@pytest.mark.parametrize("known", [True, False])
def test_standard_deviations_are_those_of_repeated_experiments(known: bool) -> None:
    rng = np.random.default_rng(5)
    true_frequency = np.array([38.0, 40.0]) * math.hypot(1, 0.01)
    pulls = []
    shapes = []
    for _ in range(RUNS):
        fit = identify_modes(
            synthetic(rng, noise=0.03, known=known), band=(20.0, 60.0), count=2
        )
        for mode, true in zip(fit.modes, true_frequency, strict=True):
            pulls.append((mode.frequency - true) / mode.frequency_std)
            pulls.append((mode.damping - 0.01 / math.hypot(1, 0.01)) / mode.damping_std)
        shapes.append((fit.modes[0].shape[1] - 0.7) / fit.modes[0].shape_std[1])
    # The scatter of n pulls is 1 within four of its own standard errors, 1/√(2n).
    assert np.std(pulls) == pytest.approx(1.0, abs=4 / math.sqrt(2 * 4 * RUNS))
    assert abs(np.mean(pulls)) < 4 / math.sqrt(4 * RUNS)
    assert np.std(shapes) == pytest.approx(1.0, abs=4 / math.sqrt(2 * RUNS))


def test_noise_after_the_weight_is_correlated_and_counted() -> None:
    """White noise on the strain only, many records of one hit: the stds must hold."""
    force, strain = hits(0.25, seed=1, noise=0.0, number=1)
    rng = np.random.default_rng(8)
    pulls = []
    for _ in range(40):
        noisy = strain + rng.normal(0, 4e-6, strain.shape)
        response = frequency_response(force, noisy, interval=1 / RATE, decay=8.0)
        mode = identify_modes([response], band=(200.0, 290.0), count=1).modes[0]
        pulls.append((mode.frequency - TRUE[1]) / mode.frequency_std)
    assert np.std(pulls) == pytest.approx(1.0, abs=4 / math.sqrt(2 * 40))


def test_noise_alone_holds_no_mode() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        found = [
            FrequencyResponse(
                frequency=np.arange(20.0, 120.0),
                value=rng.standard_normal(100) + 1j * rng.standard_normal(100),
                coherence=np.ones(100),
                std=np.ones(100),
                decay=0.0,
            )
            for _ in range(3)
        ]
        fit = identify_modes(found, band=(20.0, 120.0), count=1)
        assert fit.status is ModalStatus.FEWER_MODES
        assert fit.modes == ()


def test_h1_and_h2_bracket_the_response_between_two_noises() -> None:
    rng = np.random.default_rng(4)
    force, strain = hits(0.25, seed=3, noise=0.0, number=40)
    clean = frequency_response(force, strain, interval=1 / RATE, decay=4.0)
    noisy_force = force + rng.normal(0, 1.5, force.shape)
    noisy_strain = strain + rng.normal(0, 1e-5, strain.shape)
    both = [
        frequency_response(
            noisy_force, noisy_strain, interval=1 / RATE, decay=4.0, estimator=e
        )
        for e in Estimator
    ]
    band = (clean.frequency > 50) & (clean.frequency < 600)
    h1, h2 = (np.mean(np.abs(h.value / clean.value)[band]) for h in both)
    assert h1 < 0.98
    assert h2 > 1.02
    ratio = np.abs(both[0].value / both[1].value)
    np.testing.assert_allclose(ratio, both[0].coherence, rtol=1e-10)
    only_strain = frequency_response(force, noisy_strain, interval=1 / RATE, decay=4.0)
    assert np.mean(np.real(only_strain.value / clean.value)[band]) == pytest.approx(
        1.0, abs=0.02
    )


def test_refuses_what_does_not_belong_together() -> None:
    force, strain = hits(0.25, seed=0, noise=0.1)
    with pytest.raises(CharacterisationError, match=r"\(3, 5000\)"):
        frequency_response(force, strain[:, :-1], interval=1 / RATE)
    one = frequency_response(force, strain, interval=1 / RATE)
    two = frequency_response(force, strain, interval=1 / RATE, decay=1.0)
    with pytest.raises(CharacterisationError, match="not on the same lines"):
        identify_modes([one, two], band=(15.0, 800.0), count=3)
    with pytest.raises(CharacterisationError, match="too few for 9 modes"):
        identify_modes([one], band=(15.0, 30.0), count=9)
