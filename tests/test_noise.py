"""The noise estimate against noise that is known, and the marks of a real sensor."""

import os
from pathlib import Path

import numpy as np
import pytest

from bondgraph.errors import RecordingError
from bondgraph.recordings.noise import (
    estimate_noise,
    noise_std,
    quantisation,
    saturation,
)
from bondgraph.recordings.outliers import outliers
from bondgraph.recordings.reading import read_recording

HERE = Path(__file__).parent
REAL = Path(
    os.environ.get("BONDGRAPH_RECORDINGS", HERE.parent.parent / "shared" / "recordings")
)
needs_real = pytest.mark.skipif(
    not REAL.is_dir(), reason=f"the real recordings are not at {REAL}"
)

ENCODER = 2 * np.pi / 4096


def clock(count: int = 4000, jitter: float = 0.0, seed: int = 9):
    steps = 1.0 + jitter * np.random.default_rng(seed).uniform(-1, 1, count)
    return 0.002 * np.cumsum(steps)


def swing(t):
    """A smooth motion with a fast and a slow part."""
    return np.sin(2 * np.pi * 1.3 * t) + 0.1 * np.sin(2 * np.pi * 9.0 * t + 1) + 0.2 * t


def steps_of_a_command(t):
    return np.where(np.sin(2 * np.pi * 0.7 * t) > 0, 2.0, -1.0)


def stick_and_slip(t):
    return np.floor(3 * t) + np.clip(5 * (3 * t % 1), 0, 1) ** 2


SIGNALS = [swing, steps_of_a_command, stick_and_slip, np.zeros_like]


@pytest.mark.parametrize("std", [1e-5, 1e-3, 0.1])
@pytest.mark.parametrize("jitter", [0.0, 0.6])
@pytest.mark.parametrize("signal", SIGNALS, ids=lambda f: f.__name__)
def test_white_noise_is_found_under_any_signal(signal, jitter, std):
    t = clock(jitter=jitter)
    noise = np.random.default_rng(int(1e6 * std)).normal(0.0, std, t.size)
    found = estimate_noise(t, signal(t) + noise)
    assert found.std == pytest.approx(std, rel=0.12)
    assert found.white or signal is not np.zeros_like


def test_the_estimate_is_not_biased():
    t = clock(500)
    rng = np.random.default_rng(0)
    found = [noise_std(t, swing(t) + rng.normal(0, 0.01, t.size)) for _ in range(60)]
    assert np.mean(found) == pytest.approx(0.01, rel=0.04)
    assert np.std(found) < 0.0015


def test_units_and_offsets_only_scale_it():
    t = clock()
    v = swing(t) + np.random.default_rng(1).normal(0, 0.01, t.size)
    assert noise_std(1000 * t, 50 - 1e6 * v) == pytest.approx(1e6 * noise_std(t, v))


def test_outliers_do_not_move_it():
    t = clock()
    rng = np.random.default_rng(2)
    v = swing(t) + rng.normal(0, 0.01, t.size)
    v[rng.choice(t.size, 40, replace=False)] += 30.0
    assert noise_std(t, v) == pytest.approx(0.01, rel=0.15)


@pytest.mark.parametrize("correlation", [0.5, 0.95])
def test_of_coloured_noise_it_is_a_lower_bound_that_says_so(correlation):
    t = clock(20_000)
    white = np.random.default_rng(3).normal(0, 0.01, t.size)
    assert estimate_noise(t, white).white
    coloured = np.zeros_like(white)
    for i in range(1, white.size):
        coloured[i] = correlation * coloured[i - 1] + white[i]
    found = estimate_noise(t, coloured)
    assert 0.2 * 0.01 < found.std < np.std(coloured)
    assert not found.white


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.5, 2.0])
def test_a_quantised_channel_has_at_least_the_noise_of_its_steps(ratio):
    t = clock()
    noise = np.random.default_rng(4).normal(0, 1.0, t.size) * ratio * ENCODER
    v = ENCODER * np.rint((swing(t) + noise) / ENCODER)
    found = estimate_noise(t, v)
    total = ENCODER * np.sqrt(ratio**2 + 1 / 12)
    assert found.quantisation == pytest.approx(ENCODER)
    assert found.std == pytest.approx(total, rel=0.2)


def test_a_channel_at_rest_has_the_noise_of_its_step():
    t = clock()
    v = ENCODER * np.rint(np.where(t > 6.0, swing(t - 6.0), 0.0) / ENCODER)
    assert noise_std(t, v) == pytest.approx(ENCODER / np.sqrt(12))


def test_what_is_timed_as_it_passes_a_step_is_not_rounded():
    turns = 2 * np.pi * np.arange(250.0)
    smooth = 1.5 * np.sqrt(1.0 + turns) - 1.5  # The times of a wheel that slows down.
    timed = smooth + np.random.default_rng(1).normal(size=250) * 1e-4
    found = estimate_noise(timed, turns)
    assert found.quantisation is None
    assert found.std < 1e-2
    # Read at times of a clock, the same wheel is rounded to whole turns.
    clock = np.linspace(timed[0], timed[-1], 100)
    read = np.floor(np.interp(clock, timed, turns) / (2 * np.pi)) * 2 * np.pi
    rounded = estimate_noise(clock, read)
    assert rounded.quantisation == pytest.approx(2 * np.pi)
    assert rounded.std >= 2 * np.pi / np.sqrt(12)


def test_constant_and_tiny_channels_have_none():
    assert noise_std(clock(50), np.full(50, 3.3)) == 0.0
    assert noise_std(clock(9), np.sqrt(np.arange(9.0))) == 0.0


@pytest.mark.parametrize("values", [[], [np.nan] * 20])
def test_a_channel_that_was_not_measured_is_not_free_of_noise(values):
    with pytest.raises(RecordingError, match="nothing was measured"):
        estimate_noise(np.arange(float(len(values))), values)


# --- the grid ------------------------------------------------------------------------


@pytest.mark.parametrize("step", [ENCODER, 1e-3, 0.1, 7.0, 1e-7, 35.15 * 2**-12])
@pytest.mark.parametrize("offset", [0.0, 0.123456, -9.7])
@pytest.mark.parametrize("written", ["exact", "nine digits", "single"])
def test_a_grid_is_found_however_it_is_written(step, offset, written):
    t = clock()
    v = step * np.rint(swing(t) * 300) + offset * step
    if written == "nine digits":
        v = np.array([float(f"{x:.9g}") for x in v])
    if written == "single":
        v = v.astype(np.float32).astype(np.float64)
    assert quantisation(v) == pytest.approx(step, rel=1e-4)


def test_a_grid_is_found_when_no_two_samples_are_one_step_apart():
    counts = np.cumsum(np.random.default_rng(5).choice([2, 3, 5], 400))
    assert quantisation(ENCODER * counts) == pytest.approx(ENCODER)


def test_a_failed_read_off_the_grid_is_forgiven():
    v = ENCODER * np.rint(swing(clock()) / ENCODER)
    v[100] = -np.pi + 1e-4
    assert quantisation(v) == pytest.approx(ENCODER)


@pytest.mark.parametrize("count", [20, 300, 20_000])
def test_continuous_values_have_no_grid(count):
    rng = np.random.default_rng(count)
    for values in (rng.normal(size=count), rng.uniform(size=count)):
        assert quantisation(values) is None
        assert quantisation([float(f"{x:.9g}") for x in values]) is None


def test_a_command_has_levels_and_no_grid_but_a_flicker_has():
    t = clock()
    three = steps_of_a_command(t) + steps_of_a_command(2 * t)
    assert quantisation(three) is None
    assert quantisation(np.where(t > 3, 1.0, 0.0)) is None
    assert quantisation([]) is None
    flicker = 12.0 + 0.1 * np.random.default_rng(6).integers(0, 4, t.size)
    assert quantisation(flicker) == pytest.approx(0.1)


# --- limits and slips ----------------------------------------------------------------


def test_a_clipped_channel_is_seen_at_the_side_it_is_clipped():
    t = clock()
    (top,) = saturation(np.minimum(swing(t), 0.9))
    assert (top.side, top.level) == ("greatest", 0.9)
    assert top.samples == np.count_nonzero(swing(t) >= 0.9)
    assert top.runs > 3
    (bottom,) = saturation(-np.minimum(swing(t), 0.9))
    assert (bottom.side, bottom.level) == ("least", -0.9)


def test_the_peaks_of_a_quantised_channel_and_a_switch_are_no_limits():
    t = clock()
    for step in (0.01, 0.03, ENCODER):
        assert saturation(step * np.rint(np.sin(5 * t) / step)) == ()
    assert saturation(np.where(t > 3, 1.0, 0.0)) == ()
    assert saturation(swing(t)) == ()


def test_isolated_jumps_are_found_and_motion_is_not():
    t = clock()
    rng = np.random.default_rng(7)
    v = swing(t) + rng.normal(0, 0.001, t.size)
    assert outliers(t, v).size == 0
    slips = np.array([24, 528, 3000])
    v[slips] -= np.pi
    np.testing.assert_array_equal(outliers(t, v), slips)


@pytest.mark.parametrize("signal", [*SIGNALS[1:], lambda t: abs(t % 1 - 0.5)])
def test_corners_steps_and_rest_are_no_outliers(signal):
    t = clock()
    assert outliers(t, signal(t)).size == 0
    noisy = signal(t) + np.random.default_rng(8).normal(0, 1e-3, t.size)
    assert outliers(t, noisy).size == 0


def test_a_misreading_amid_fast_motion_is_found():
    t = np.arange(2000) * 0.02
    turned = 70.0 * t + 8.0 * np.sin(3.0 * t)  # some 1.4 rad from sample to sample
    v = turned + np.random.default_rng(9).normal(0, 0.03, t.size)
    assert outliers(t, v).size == 0
    v[[310, 1200]] += [9.4, -9.4]
    np.testing.assert_array_equal(outliers(t, v), [310, 1200])


def test_what_rings_flickers_or_turns_at_once_is_no_misreading():
    t = np.arange(2000) * 0.02
    rng = np.random.default_rng(10)
    turning = np.abs((t % 1.6) - 0.8)
    kicked = np.exp(-9.0 * (t % 4.0)) * np.cos(60.0 * (t % 4.0))
    flicker = np.rint(20.0 + 0.45 * np.sin(0.3 * t) + 0.12 * rng.normal(size=t.size))
    for motion in (turning, kicked):
        assert outliers(t, motion + 1e-3 * rng.normal(size=t.size)).size == 0
    assert outliers(t, flicker).size == 0


# --- real files ----------------------------------------------------------------------


@needs_real
@pytest.mark.parametrize(
    ("path", "channel", "step"),
    [
        ("two_link_flexible/lqr_10deg_full.csv", "joint2_angle", ENCODER / 50),
        ("spring_mass_control/spring_mass.csv", "position", 1.0),
        ("worm_drive/steady_state/hoist_100rpm.csv", "motor_speed", np.pi / 30),
        ("xl330/kp200_sin_sin.csv", "position", ENCODER),
    ],
)
def test_the_steps_of_real_sensors_are_found(path, channel, step):
    values = read_recording(REAL / path).channel(channel).values
    assert quantisation(values) == pytest.approx(step, rel=1e-5)


@needs_real
def test_the_failed_reads_and_the_full_duty_of_real_servos_are_found():
    log = read_recording(REAL / "sts3215/m0p535_l0p15_kp16_lift_and_drop.csv")
    np.testing.assert_array_equal(
        outliers(log.time, log.channel("position").values), [24]
    )
    log = read_recording(REAL / "xl330/kp800_sin_sin.csv")
    sides = {s.side: s.level for s in saturation(log.channel("load").values)}
    assert sides == {"least": -885.0, "greatest": 885.0}
