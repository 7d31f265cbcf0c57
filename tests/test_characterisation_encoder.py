"""The encoder and its filter: what is printed, and what the formula gives."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from flegx_models.characterisation.encoder_filter import ButterworthPair, PwmEncoder
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.parameters_chapter3 import CHAPTER_3

P = CHAPTER_3.values_by_name()
ENCODER = PwmEncoder(
    step=P["encoder_step"], clock=P["encoder_clock"], frame=P["encoder_frame"]
)
FILTER = ButterworthPair(cutoff=2 * math.pi * P["f_filter"])
NOISE = 2 * math.pi * P["f_noise"]


def test_the_frame_rate_and_resolution_are_the_printed_ones() -> None:
    assert round(ENCODER.frame_rate) == P["f_pwm"]
    # 12 bits on the PWM output, of the 14 that the chip has on its bus.
    assert ENCODER.steps_per_turn == pytest.approx(2**12, rel=0.005)
    with pytest.raises(CharacterisationError, match="not below"):
        ENCODER.delay(600.0)
    assert ENCODER.delay(P["f_sampling"]) == pytest.approx(
        1.5 / ENCODER.frame_rate + 1.25e-3
    )


def test_rounding_has_the_standard_deviation_of_a_uniform_error() -> None:
    angle = np.linspace(0, 1.2345, 20001)
    error = ENCODER.read(angle) - angle
    assert np.max(np.abs(error)) <= ENCODER.step / 2 * (1 + 1e-9)
    assert np.std(error) == pytest.approx(ENCODER.quantisation_std, rel=0.01)


def test_only_25_hertz_gives_about_the_printed_attenuation() -> None:
    assert FILTER.attenuation(NOISE) == pytest.approx(58.1, abs=0.05)
    printed = ButterworthPair(
        cutoff=P["omega_filter"], damping_term=P["filter_damping_term"]
    )
    assert printed.attenuation(NOISE) == pytest.approx(121.9, abs=0.05)
    wanted = ButterworthPair.attenuating(P["filter_attenuation"], at=NOISE)
    assert wanted.attenuation(NOISE) == pytest.approx(60.0)
    assert wanted.cutoff / (2 * math.pi) == pytest.approx(23.66, abs=0.01)
    with pytest.raises(CharacterisationError, match="is none"):
        ButterworthPair.attenuating(0.0, at=NOISE)


@pytest.mark.parametrize("damping_term", [1.0, math.sqrt(2), 2.5])
def test_bandwidth_delay_and_noise_bandwidth_are_those_of_the_response(
    damping_term: float,
) -> None:
    pair = ButterworthPair(cutoff=30.0, damping_term=damping_term)
    assert abs(pair.response(pair.bandwidth)) == pytest.approx(1 / math.sqrt(2))
    small = 1e-4
    assert -np.angle(pair.response(small)) / small == pytest.approx(pair.delay)
    area = quad(lambda w: float(np.abs(pair.response(w)) ** 2), 0, np.inf)[0]
    assert pair.noise_bandwidth == pytest.approx(area / (2 * math.pi), rel=1e-6)
    s = 1j * 17.0
    assert pair.numerator[0] / np.polyval(pair.denominator, s) == pytest.approx(
        complex(pair.response(17.0))
    )


def test_the_filter_costs_18_milliseconds() -> None:
    assert FILTER.delay == pytest.approx(0.0180, abs=5e-5)
    assert FILTER.bandwidth / (2 * math.pi) == pytest.approx(20.06, abs=0.01)


def test_filtered_samples_lose_the_noise_and_keep_the_motion() -> None:
    rate = P["f_sampling"]
    t = np.arange(0, 6, 1 / rate)
    motion = 0.15 * np.sin(2 * math.pi * 0.5 * t)
    noise = P["encoder_noise"] / 2 * np.sin(2 * math.pi * rate / 3 * t + 0.3)
    read = ENCODER.read(motion + noise)
    filtered = FILTER.filtered(read, sampling=rate)
    late = t > 2
    delayed = 0.15 * np.sin(2 * math.pi * 0.5 * (t - FILTER.delay))
    assert np.std((read - motion)[late]) > 0.05
    # What is left is less than one step of the encoder.
    assert np.max(np.abs(filtered - delayed)[late]) < ENCODER.step
    settled = FILTER.filtered(np.full(50, 0.7), sampling=rate)
    np.testing.assert_allclose(settled, 0.7, rtol=1e-9)
