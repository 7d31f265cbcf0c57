"""The concealed drive is itself tested: its answers are the truth of other tests."""

import ast
import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from flegx_models import concealed_drive
from flegx_models.concealed_drive import (
    ENCODER_NOISE,
    ENCODER_STEP,
    HEADER,
    Drive,
    Motion,
    advance,
    multisine_reference,
    record,
    write_csv,
)

STEP = 1 / 8000


AT_REST = Motion(0.0, 0.0)


def travel(drive, motor, load, duration, motion=AT_REST, step=STEP):
    """Return times and motions under torques given as functions of time."""
    times = np.arange(round(duration / step) + 1) * step
    motions = [motion]
    for time in times[:-1]:
        middle = time + step / 2
        motions.append(advance(drive, motions[-1], motor(middle), load(middle), step))
    return times, motions


def back_and_forth(time):
    return 9.0 * math.sin(2 * math.pi * 1.1 * time)


def slow_load(time):
    return 5.0 * math.sin(2 * math.pi * 0.4 * time + 1.0)


@pytest.mark.parametrize("viscous", [0.0, 0.35, 5.0])
def test_without_friction_it_is_the_linear_machine(viscous):
    drive = Drive(mu=0.0, viscous=viscous)
    J, c, torque = drive.inertia, viscous, 6.0 + 1.5
    _, motions = travel(drive, lambda t: 6.0, lambda t: 1.5, 2.0)
    if c:
        rate = c / J
        speed = torque / c * (1 - math.exp(-rate * 2.0))
        angle = torque / c * (2.0 - (1 - math.exp(-rate * 2.0)) / rate)
    else:
        speed, angle = torque / J * 2.0, torque / J * 2.0
    assert motions[-1].omega == pytest.approx(speed, rel=1e-9)
    assert motions[-1].theta == pytest.approx(angle, rel=1e-9)


def test_friction_is_mu_times_the_transmitted_torque_and_opposes_motion():
    drive = Drive()
    generator = np.random.default_rng(0)
    for motor, load, omega in generator.normal(size=(500, 3)) * (10, 6, 1):
        a = advance(drive, Motion(0.0, omega), motor, load, 1e-9).acceleration
        friction = motor + load - drive.viscous * omega - drive.inertia * a
        mesh = drive.joint_inertia * a + drive.viscous * omega - load
        assert friction == pytest.approx(drive.mu * abs(mesh) * np.sign(omega))


def test_energy_is_accounted_for():
    drive = Drive()
    times, motions = travel(drive, back_and_forth, slow_load, 5.0)
    theta = np.array([m.theta for m in motions])
    omega = np.array([m.omega for m in motions])
    middle = (times[1:] + times[:-1]) / 2
    motor = np.array([back_and_forth(t) for t in middle])
    load = np.array([slow_load(t) for t in middle])
    moving = np.diff(theta)
    acceleration = np.diff(omega) / STEP
    speed = (omega[1:] + omega[:-1]) / 2
    mesh = drive.joint_inertia * acceleration + drive.viscous * speed - load
    lost = drive.mu * np.sum(np.abs(mesh) * np.abs(moving))
    lost += drive.viscous * np.sum(speed * moving)
    supplied = np.sum((motor + load) * moving)
    stored = drive.inertia * omega[-1] ** 2 / 2
    assert lost > 1.0
    assert supplied == pytest.approx(stored + lost, abs=2e-4 * lost)


def test_a_held_worm_does_not_creep():
    drive = Drive()
    limit = drive.mu * 5.0
    _, held = travel(drive, lambda t: -5.0 + 0.999 * limit, lambda t: 5.0, 3.0)
    assert {m.theta for m in held} == {0.0}
    assert {m.omega for m in held} == {0.0}
    _, slipping = travel(drive, lambda t: -5.0 + 1.001 * limit, lambda t: 5.0, 3.0)
    assert slipping[-1].theta > 0


def test_it_comes_to_rest_and_stays_there():
    drive = Drive()
    _, motions = travel(drive, lambda t: -5.0, lambda t: 5.0, 3.0, Motion(0.0, 1.0))
    rest = [m.theta for m in motions if m.omega == 0.0]
    assert len(rest) > 1000
    assert len(set(rest)) == 1


def test_the_moment_of_rest_does_not_depend_on_the_step():
    drive = Drive()
    ends = [
        travel(drive, lambda t: -5.0, lambda t: 5.0, 1.0, Motion(0.0, 0.5), step)[1][
            -1
        ].theta
        for step in (1e-2, 1e-3, 1e-4)
    ]
    assert ends == pytest.approx([ends[0]] * 3, rel=1e-9)


def test_one_solution_for_every_state():
    """Exactly one sign of the mesh torque is consistent, so nothing is chosen."""
    drive = Drive(mu=0.9)
    for omega, motor, load in itertools.product((-1.0, 1.0), (-9, -2, 3), (-4, 1, 5)):
        consistent = 0
        way = math.copysign(1, omega)
        for sign in (1, -1):
            grip = drive.mu * sign * way
            passive = drive.viscous * omega - load
            a = (motor - passive * (1 + grip)) / (
                drive.inertia + grip * drive.joint_inertia
            )
            consistent += sign * (drive.joint_inertia * a + passive) > 0
        assert consistent == 1


def test_refuses_a_friction_without_a_unique_solution():
    with pytest.raises(ValueError, match="mu"):
        Drive(mu=1.0)


def test_recordings_are_repeatable_and_differ_by_seed():
    first, again, other = record(1, 1.0), record(1, 1.0), record(2, 1.0)
    assert all(np.array_equal(first[k], again[k]) for k in first)
    assert not np.array_equal(first["T_motor"], other["T_motor"])
    held_out = record(1, 1.0, reference=multisine_reference)
    assert not np.array_equal(first["theta"], held_out["theta"])


def test_the_encoder_reads_whole_steps_with_its_noise():
    theta = record(3, 4.0)["theta"] / ENCODER_STEP
    assert np.abs(theta - np.round(theta)).max() < 1e-6
    # Third differences of a smooth motion vanish; of white noise they are √20 times it.
    noise = np.std(np.diff(theta * ENCODER_STEP, n=3)) / math.sqrt(20)
    expected = math.hypot(ENCODER_NOISE, ENCODER_STEP / math.sqrt(12))
    assert noise == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    "reference", [concealed_drive.spline_reference, multisine_reference]
)
def test_the_effect_is_in_the_recording_and_only_with_friction(reference):
    """The linear machine's torque balance leaves the friction, and else only noise."""
    drive = Drive()

    def unexplained(recording):
        period = 20  # samples, 50 ms: averages the encoder noise
        time = recording["time"][::period]
        theta = recording["theta"]
        theta = theta[: len(theta) // period * period].reshape(-1, period).mean(axis=1)
        torque = drive.ratio * recording["T_motor"] + recording["T_load"]
        torque = (
            torque[: len(torque) // period * period].reshape(-1, period).mean(axis=1)
        )
        h = time[1] - time[0]
        omega = (theta[2:] - theta[:-2]) / (2 * h)
        alpha = (theta[2:] - 2 * theta[1:-1] + theta[:-2]) / h**2
        left = torque[1:-1] - drive.inertia * alpha - drive.viscous * omega
        return np.sqrt(np.mean(left**2))

    with_friction = unexplained(record(4, 10.0, reference=reference))
    without = unexplained(record(4, 10.0, without_effect=True, reference=reference))
    assert with_friction > 3 * without


def test_csv_has_units_and_reads_back(tmp_path):
    recording = record(5, 0.5)
    path = tmp_path / "drive.csv"
    write_csv(path, recording)
    assert path.read_text().splitlines()[0] == HEADER
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert table[:, 0] == pytest.approx(recording["time"], abs=1e-9)
    assert table[:, 3] == pytest.approx(recording["theta"], abs=1e-6)


def test_the_simulator_shares_no_code_with_the_toolkit():
    tree = ast.parse(Path(concealed_drive.__file__).read_text(encoding="utf-8"))
    imported = {
        name.name if isinstance(node, ast.Import) else node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in node.names
    }
    roots = {name.partition(".")[0] for name in imported}
    assert roots <= {"math", "collections", "dataclasses", "pathlib", "numpy"}
