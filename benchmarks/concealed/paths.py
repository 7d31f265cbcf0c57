"""What lies between a machine and its recording: inputs, sensors, and a controller.

A command reaches the machine through its input's path, a reading the recording through
its sensor's. A loop may be closed: the controller sees what the sensor gives, noise and
steps included.
"""

import math

import numpy as np

from benchmarks.concealed.compiling import compiled

IN_NONE, IN_BIAS, IN_SATURATION, IN_DEAD_ZONE, IN_LAG, IN_DELAY = range(6)
IN_SPEED_GAIN, IN_SCALE = 6, 7
OUT_NONE, OUT_SCALE, OUT_BIAS, OUT_CUBIC, OUT_LAG, OUT_DELAY, OUT_CLIP = range(7)
OUT_DRIFT = 7


@compiled()
def through_input(kind, a, command, commands, k, into, dt, state, speed):
    """Return what reaches the machine of a commanded input, `into` s after sample k."""
    applied = command
    if kind == IN_BIAS:
        applied = command + a[0]
    elif kind == IN_SCALE:
        applied = command * (1.0 + a[0])
    elif kind == IN_SATURATION:
        applied = min(max(command, -a[0]), a[0])
    elif kind == IN_DEAD_ZONE:
        applied = np.sign(command) * max(abs(command) - a[0], 0.0)
    elif kind == IN_LAG:
        applied = state
    elif kind == IN_DELAY:
        index = math.floor(k + (into - a[0]) / dt)
        applied = commands[max(index, 0)]
    elif kind == IN_SPEED_GAIN:
        applied = command * (1.0 + a[0] * math.tanh((speed / a[1]) ** 2))
    return applied


@compiled()
def through_sensor(kind, a, reading, fine, at, h, state):
    """Return what a sensor gives for the true `reading`; `fine` holds the past."""
    given = reading
    if kind == OUT_SCALE:
        given = reading * (1.0 + a[0])
    elif kind == OUT_BIAS:
        given = reading + a[0]
    elif kind == OUT_CUBIC:
        given = reading + a[0] * reading**3
    elif kind == OUT_LAG:
        given = state
    elif kind == OUT_DELAY:
        given = fine[max(at - int(a[0] / h), 0)]
    elif kind == OUT_CLIP:
        given = min(max(reading, -a[0]), a[0])
    elif kind == OUT_DRIFT:
        given = reading + a[0] * at * h
    return given


@compiled()
def drive(inputs, commands, k, i, dt, h, state, speed, u):
    """Write to `u` what drives the machine in small step i after sample k."""
    kind, a = inputs
    for j in range(u.size):
        asked = commands[j, k]
        if kind[j] == IN_LAG:
            fade = math.exp(-h / a[j, 0])
            u[j] = asked + (state[j] - asked) * math.sqrt(fade)
            state[j] = asked + (state[j] - asked) * fade
        else:
            u[j] = through_input(
                kind[j], a[j], asked, commands[j], k, (i + 0.5) * h, dt, state[j], speed
            )


@compiled()
def sense(sensors, truth, k, fine, early, noise, h, state, given):
    """Write to `given` what the sensors give at sample k of the `truth` so far."""
    kind, a, step = sensors
    for j in range(given.size):
        at = max(k * fine - early[j], 0)
        through = through_sensor(kind[j], a[j], truth[j, at], truth[j], at, h, state[j])
        given[j] = through + noise[j]
        if step[j] > 0.0:
            given[j] = np.round(given[j] / step[j]) * step[j]


@compiled()
def lag_readings(sensors, y, h, state):
    """Let what lags in a sensor follow its reading for one small step."""
    kind, a, _ = sensors
    for j in range(y.size):
        if kind[j] == OUT_LAG:
            fade = math.exp(-h / a[j, 0])
            state[j] = y[j] + (state[j] - y[j]) * fade


@compiled()
def command(control, feed, reference, given, dt, first, slope, before, commands):
    """Write to `commands` what is asked at a sample of which `given` was seen.

    `slope` and `before` are what the controller remembers.
    """
    kp, kd, channel, tau, limit, step = control
    for j in range(commands.size):
        commands[j] = feed[j]
    for j in range(kp.size):
        sensed = given[channel[j]]
        if first:
            before[j] = sensed
        share = dt / (dt + tau[j])
        slope[j] += share * ((sensed - before[j]) / dt - slope[j])
        before[j] = sensed
        commands[j] += kp[j] * (reference[j] - sensed) - kd[j] * slope[j]
        commands[j] = min(max(commands[j], -limit), limit)
        if step > 0.0:
            commands[j] = np.round(commands[j] / step) * step
