"""A stand-in for the real lower leg drive, with a worm friction the models leave out.

This file shares nothing with the toolkit that must find the friction: it imports only
numpy, writes the mechanics by hand and resolves dry friction by cases, without
smoothing.

The drive is one rigid train seen from the joint, with N the ratio from motor to joint,
J the whole reflected inertia, J_j the part behind the worm and c a viscous friction::

    J dω/dt = N T_motor + T_load - c ω - F          all torques at the joint, N·m
    T_mesh  = J_j dω/dt + c ω - T_load              transmitted by the worm to the joint
    F       = μ |T_mesh| sign(ω)        while the worm turns
    |F|    ≤ μ |T_mesh|, dω/dt = 0      while it is held

F depends on the acceleration it causes. For given signs of ω and T_mesh that is linear
and has one solution, because μ J_j < J; the signs are found by trying. Within one short
step the forces are constant and the motion is an exponential, so the instant at which
the worm stops is computed, not searched.

When the motor drives, the worm passes on T_mesh of (1 + μ) T_mesh: μ = 0.4 is an
efficiency of 71 %, usual for a worm of 14° lead.

Sensors: the encoder's 14 bits (FlegX thesis, 2.1.3) with 0.03° rms of noise, as the
maker states for a sister encoder; 400 Hz (3.4). Motor current to 14 bits over ±10 A
with 0.5 mA rms, as torque by 42.7 mN·m/A (Table 2.1): chosen, because noise of an input
is integrated twice and must not outgrow the encoder's. Load torque by the knee's
strain-gauge sensor, 47.69 N·m/V (eq. 3.22) read to 12 bits over 1.8 V, 5 mN·m rms.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAMPLING_RATE = 400.0  # Hz, section 3.4
SUBSTEPS = 20  # internal steps per sampling period
ENCODER_STEP = 2 * math.pi / 2**14  # rad
ENCODER_NOISE = math.radians(0.03)  # rad rms
TORQUE_CONSTANT = 42.7e-3  # N·m/A
TORQUE_STEP = TORQUE_CONSTANT * 20.0 / 2**14  # N·m
TORQUE_NOISE = TORQUE_CONSTANT * 0.5e-3  # N·m rms
LOAD_STEP = 47.69 * 1.8 / 2**12  # N·m
LOAD_NOISE = 0.005  # N·m rms
WORM_FRICTION = 0.4  # μ


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One individual drive; its numbers differ a little from the data sheets.

    Parameters
    ----------
    ratio
        N, motor to joint.
    inertia, joint_inertia
        J and J_j in kg·m², at the joint.
    viscous
        c in N·m·s, bearings and grease, at the joint.
    mu
        Friction torque per transmitted torque, both at the joint; 0 ≤ μ < 1.
    """

    ratio: float = 26.0 * 29.0 / 3.0
    inertia: float = 1.436
    joint_inertia: float = 0.0131
    viscous: float = 0.35
    mu: float = WORM_FRICTION

    def __post_init__(self) -> None:
        if not 0 <= self.mu < 1:
            raise ValueError(f"mu = {self.mu}; the cases are unique for 0 ≤ mu < 1.")
        if not 0 < self.joint_inertia < self.inertia:
            raise ValueError("The joint inertia must be a part of the whole inertia.")


@dataclass(frozen=True, slots=True)
class Motion:
    """Angle in rad, speed in rad/s, and the acceleration at the step's begin."""

    theta: float
    omega: float
    acceleration: float = 0.0


def advance(
    drive: Drive, motion: Motion, motor: float, load: float, step: float
) -> Motion:
    """Return the motion `step` seconds later under constant torques at the joint.

    Parameters
    ----------
    motor, load
        N T_motor and T_load in N·m; positive torques accelerate the joint.
    """
    theta, omega, first = motion.theta, motion.omega, None
    remaining = step
    while remaining > 0:
        way = _direction(drive, omega, motor, load)
        if way == 0.0:
            return Motion(theta, 0.0, first or 0.0)
        grip = _grip(drive, omega, motor, load, way)
        inertia = drive.inertia + grip * drive.joint_inertia
        damping = drive.viscous * (1 + grip)
        acceleration = (motor + load * (1 + grip) - damping * omega) / inertia
        first = acceleration if first is None else first
        rate = damping / inertia
        halt = _halt(omega, acceleration, rate)
        lapse = min(halt, remaining)
        speed_gain, angle_gain = _responses(rate, lapse)
        theta += omega * lapse + acceleration * angle_gain
        omega = 0.0 if halt <= remaining else omega + acceleration * speed_gain
        remaining -= lapse
    return Motion(theta, omega, first or 0.0)


def _direction(drive: Drive, omega: float, motor: float, load: float) -> float:
    """Return the sign of the motion that follows; 0 while the worm is held."""
    if omega != 0.0:
        return math.copysign(1.0, omega)
    if abs(motor + load) <= drive.mu * abs(load):
        return 0.0
    return math.copysign(1.0, motor + load)


def _grip(drive: Drive, omega: float, motor: float, load: float, way: float) -> float:
    """Return F / T_mesh, that is ±μ, for the one consistent sign of T_mesh."""
    passive = drive.viscous * omega - load
    for sign in (1.0, -1.0):
        grip = drive.mu * sign * way
        inertia = drive.inertia + grip * drive.joint_inertia
        acceleration = (motor - passive * (1 + grip)) / inertia
        if sign * (drive.joint_inertia * acceleration + passive) >= 0.0:
            return grip
    return 0.0  # T_mesh vanishes to the last bit: no friction either


def _halt(omega: float, acceleration: float, rate: float) -> float:
    """Return when the speed reaches zero, infinity if it does not."""
    if omega == 0.0 or omega * acceleration >= 0.0:
        return math.inf
    if rate == 0.0:
        return -omega / acceleration
    rest = rate * omega / acceleration
    return -math.log1p(rest) / rate if rest > -1.0 else math.inf


def _responses(rate: float, lapse: float) -> tuple[float, float]:
    """Return the speed and angle that unit acceleration, decaying at `rate`, gives."""
    if rate == 0.0:
        return lapse, lapse * lapse / 2
    speed = -math.expm1(-rate * lapse) / rate
    return speed, (lapse - speed) / rate


class _Controller:
    """The tuned lower leg controller of eq. 6.1 with the encoder filter of eq. 3.34.

    The filter has its cut-off at 25 Hz, as the text says (the formula reads 25 rad/s).
    The gain is set so that the crossover is the thesis's 10 rad/s. The load torque is
    compensated by feed-forward, as figure 5.2 does for gravity.
    """

    _GAIN = 0.06  # N·m·s/rad at the motor
    _ZERO, _POLE = 2.5, 50.0  # rad/s, eq. 6.1
    _CUT_OFF = 2 * math.pi * 25.0  # rad/s

    def __init__(self, period: float) -> None:
        self._period = period
        self._filter = [0.0, 0.0, 0.0, 0.0]
        self._lead = 0.0

    def command(self, reference: float, measured: float) -> float:
        """Return the motor torque in N·m for one sample."""
        error = reference - self._filtered(measured)
        # K (s + z) / (1 + s/p) = K p + K (z - p) / (1 + s/p), backward Euler
        share = 1 / (1 + self._period * self._POLE)
        self._lead = share * self._lead + (1 - share) * error
        lead = self._POLE * error + (self._ZERO - self._POLE) * self._lead
        return self._GAIN * lead

    def _filtered(self, signal: float) -> float:
        """Return `signal` through two Butterworth low passes, backward Euler."""
        step = self._period * self._CUT_OFF
        for stage in (0, 2):
            level, slope = self._filter[stage : stage + 2]
            slope = (slope + step * (signal - level)) / (1 + 1.414 * step + step**2)
            level = level + step * slope
            self._filter[stage : stage + 2] = level, slope
            signal = level
        return signal


def spline_reference(generator: np.random.Generator, time: Array) -> Array:
    """Return fifth-order splines between random angles up to 20° apart (section 6.1).

    A spline takes 0.5 to 0.9 s around the thesis's 0.7 s; one in six is a pause.
    """
    reference = np.empty_like(time)
    start, angle = 0.0, 0.0
    while start <= time[-1]:
        span = generator.uniform(0.5, 0.9)
        target = math.radians(generator.uniform(-20.0, 20.0))
        if generator.random() < 1 / 6:
            target = angle
        inside = (time >= start) & (time <= start + span)
        s = (time[inside] - start) / span
        shape = s**3 * (10 - 15 * s + 6 * s**2)
        reference[inside] = angle + (target - angle) * shape
        start, angle = start + span, target
    return reference


def multisine_reference(generator: np.random.Generator, time: Array) -> Array:
    """Return five sines between 0.2 and 2 Hz around the thesis's 1.43 Hz, in rad."""
    frequencies = generator.uniform(0.2, 2.0, size=5)
    phases = generator.uniform(0.0, 2 * math.pi, size=5)
    angles = np.radians(6.0) / np.sqrt(frequencies / 0.5)
    sines = np.sin(2 * math.pi * np.outer(time, frequencies) + phases) - np.sin(phases)
    return np.asarray(sines @ angles * np.minimum(time, 1.0))


def load_torque(generator: np.random.Generator, time: Array) -> Array:
    """Return a slow torque of a loading rig on the joint, up to about 12 N·m."""
    frequencies = generator.uniform(0.05, 0.5, size=3)
    phases = generator.uniform(0.0, 2 * math.pi, size=3)
    sines = np.sin(2 * math.pi * np.outer(time, frequencies) + phases)
    return np.asarray(generator.uniform(-2.0, 2.0) + sines @ np.array([4.0, 3.0, 2.5]))


Reference = Callable[[np.random.Generator, Array], Array]


def record(
    seed: int,
    duration: float,
    *,
    mu: float = WORM_FRICTION,
    without_effect: bool = False,
    reference: Reference = spline_reference,
) -> dict[str, Array]:
    """Return a closed-loop recording: ``time``, ``T_motor``, ``T_load``, ``theta``.

    Parameters
    ----------
    seed
        Of references, loads and noise; equal seeds give equal recordings.
    duration
        s.
    mu, without_effect
        The concealed friction, and whether the machine has none.
    reference
        What the loop tracks: `spline_reference`, `multisine_reference` or your own.
    """
    generator = np.random.default_rng(seed)
    drive = Drive(mu=0.0 if without_effect else mu)
    samples = round(duration * SAMPLING_RATE) + 1
    steps = np.arange((samples - 1) * SUBSTEPS + 1) / (SAMPLING_RATE * SUBSTEPS)
    time = steps[::SUBSTEPS]
    load = load_torque(generator, steps)
    wanted = reference(generator, time)
    noise = generator.normal(size=(3, samples))
    torque, theta = _closed_loop(drive, wanted, load, ENCODER_NOISE * noise[0])
    return {
        "time": time,
        "T_motor": _read(torque + TORQUE_NOISE * noise[1], TORQUE_STEP),
        "T_load": _read(load[::SUBSTEPS] + LOAD_NOISE * noise[2], LOAD_STEP),
        "theta": theta,
    }


def _closed_loop(
    drive: Drive, reference: Array, load: Array, encoder_noise: Array
) -> tuple[Array, Array]:
    """Return motor torque and measured angle at the samples.

    The driver slews the torque linearly from one command to the next over a sampling
    period, so the torque at a sample is the command of the sample before.
    """
    step = 1 / (SAMPLING_RATE * SUBSTEPS)
    controller = _Controller(1 / SAMPLING_RATE)
    samples = len(reference)
    torque, theta = np.zeros(samples), np.zeros(samples)
    middle = (load[1:] + load[:-1]) / 2
    motion = Motion(0.0, 0.0)
    now = -load[0] / drive.ratio
    for k in range(samples):
        torque[k] = now
        theta[k] = _read(np.array(motion.theta + encoder_noise[k]), ENCODER_STEP)
        if k + 1 == samples:
            break
        command = controller.command(reference[k], theta[k])
        goal = command - load[k * SUBSTEPS] / drive.ratio
        for j in range(SUBSTEPS):
            motor = now + (goal - now) * (j + 0.5) / SUBSTEPS
            torques = (drive.ratio * motor, float(middle[k * SUBSTEPS + j]))
            motion = advance(drive, motion, *torques, step)
        now = goal
    return torque, theta


def _read(signal: Array, step: float) -> Array:
    """Return `signal` rounded to a sensor's steps."""
    return np.asarray(np.round(signal / step) * step)


HEADER = "time [s],T_motor [N*m],T_load [N*m],theta [rad]"


def write_csv(path: Path, recording: dict[str, Array]) -> None:
    """Write what `record` returned to `path`, with units in the header."""
    columns = [recording[name] for name in ("time", "T_motor", "T_load", "theta")]
    np.savetxt(
        path,
        np.column_stack(columns),
        fmt=("%.4f", "%.7f", "%.5f", "%.7f"),
        delimiter=",",
        header=HEADER,
        comments="",
    )
