"""One run of a machine: from numbers, effects and a test signal to samples."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.concealed import laws
from benchmarks.concealed.effects import (
    INPUT_LAWS,
    OUTPUT_LAWS,
    Effect,
    Scales,
    hung,
    kind_of_place,
    law_of,
)
from benchmarks.concealed.excitation import excitation
from benchmarks.concealed.machine import Array, Machine, Place
from benchmarks.concealed.stepping import march

Signals = tuple[NDArray[np.int64], Array]
"""The law of every input or reading, and its numbers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Nuisance:
    """What a sensor does besides measuring, in units of its noise and step.

    ``colour`` is the correlation from one sample to the next of an AR(1) noise,
    ``outliers`` their share, ``jitter`` the largest early sampling in sampling steps.
    """

    noise: float = 1.0
    colour: float = 0.0
    outliers: float = 0.0
    jitter: float = 0.0


QUIET = Nuisance(noise=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What is played: drawn once, so that runs with and without effects compare.

    Parameters
    ----------
    feed
        (N, nu) commands in an open loop, what is added to the controller in a closed.
    reference
        (N, nu) what closed loops track.
    noise
        (N, ny) of the sensors; `early` the small steps of jitter.
    """

    time: Array
    feed: Array
    reference: Array
    noise: Array
    early: Array
    closed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What came out.

    Commands (N, nu), readings (N, ny), states (N, q v z), and displacement and flow at
    every place that was watched.
    """

    time: Array
    commands: Array
    readings: Array
    states: Array
    motion: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)


def plan(machine: Machine, kind: str, seed: int, nuisance: Nuisance) -> Plan:
    """Draw test signal and noise of one recording."""
    random = np.random.default_rng(seed)
    drive, N = machine.drive, machine.samples
    time = np.arange(N) / machine.rate
    wave = excitation(kind, time, drive.band, random)
    signal = drive.offset + drive.size * wave
    feed = np.zeros((N, len(machine.inputs)))
    reference = np.zeros_like(feed)
    reference[:, 0] = signal
    if drive.loop is None:
        feed[:, 0] = drive.offset + np.clip(
            signal - drive.offset, -drive.limit, drive.limit
        )
    slow = (drive.band[0] / 2.0, drive.band[1] / 3.0)
    for j, (size, offset) in enumerate(drive.others, start=1):
        if j < len(drive.loops):
            wave = excitation(kind, time, drive.band, random)
            reference[:, j] = offset + size * wave
        else:
            feed[:, j] = offset + size * excitation("multisine", time, slow, random)
    white = random.normal(size=(N, len(machine.sensors)))
    noise = _coloured(white, nuisance.colour) * nuisance.noise
    wild = random.random(white.shape) < nuisance.outliers
    noise = noise + wild * 30.0 * random.normal(size=white.shape)
    stds = np.array([sensor.noise for sensor in machine.sensors])
    jitter = random.uniform(0.0, nuisance.jitter * machine.fine, size=white.shape)
    return Plan(
        time=time,
        feed=feed,
        reference=reference,
        noise=noise * stds,
        early=jitter.astype(np.int64),
        closed=drive.loop is not None,
    )


def replayed(original: Plan, commands: Array) -> Plan:
    """Return the plan that plays recorded commands in an open loop, without noise."""
    return replace(
        original,
        feed=commands,
        noise=np.zeros_like(original.noise),
        early=np.zeros_like(original.early),
        closed=False,
    )


def _coloured(white: Array, colour: float) -> Array:
    if colour == 0.0:
        return white
    noise = white.copy()
    for k in range(1, len(noise)):
        noise[k] = colour * noise[k - 1] + np.sqrt(1.0 - colour**2) * white[k]
    return noise


def simulate(
    machine: Machine,
    plan: Plan,
    effects: Sequence[Effect] = (),
    *,
    values: Mapping[str, float] | None = None,
    scales: Mapping[str, Scales] | None = None,
    start: Mapping[str, Array] | None = None,
    watch: bool = False,
    exact: bool = False,
) -> Run:
    """Run a machine.

    Parameters
    ----------
    values
        Parameters other than nominal.
    scales
        Of all places, see `scales_of`; needed with effects.
    start
        ``q``, ``v``, ``z`` at the first sample, where not at rest.
    watch
        Also return displacement and flow at every place.
    exact
        Without quantisation.
    """
    for effect in effects:
        if effect.site.variant:
            machine = machine.variants[effect.site.variant]
    numbers = {**machine.values, **(values or {})}
    hanging, inputs, outputs = _concealed(machine, effects, scales or {}, numbers)
    if watch:
        hanging += [(place, laws.VISCOUS, (0.0,)) for place in machine.places]
    steps = np.array([0.0 if exact else sensor.step for sensor in machine.sensors])
    loops = machine.drive.loops if plan.closed else ()
    commands, readings, states, trail = march(
        machine.forces,
        machine.masses,
        machine.readings,
        np.array([numbers[number.name] for number in machine.numbers]),
        _first_state(machine, start or {}),
        _slots(hanging, machine.coordinates),
        inputs,
        (*outputs, steps),
        (
            np.array([loop.kp for loop in loops]),
            np.array([loop.kd for loop in loops]),
            np.array([loop.channel for loop in loops], dtype=np.int64),
            np.array([loop.derivative_time for loop in loops]),
            machine.drive.limit,
            machine.drive.resolution if plan.closed else 0.0,
        ),
        plan.feed,
        plan.reference,
        plan.noise,
        plan.early,
        1.0 / machine.rate,
        machine.fine,
    )
    first = len(hanging) - len(machine.places)
    motion = {
        place.name: (trail[:, 2 * (first + i)], trail[:, 2 * (first + i) + 1])
        for i, place in enumerate(machine.places if watch else ())
    }
    return Run(
        time=plan.time,
        commands=commands.T.copy(),
        readings=readings,
        states=states,
        motion=motion,
    )


def _concealed(
    machine: Machine,
    effects: Sequence[Effect],
    known: Mapping[str, Scales],
    numbers: dict[str, float],
) -> tuple[list[tuple[Place, int, tuple[float, ...]]], Signals, Signals]:
    """Return what hangs at places, and what is done to inputs and to readings.

    Effects that change the machine's own numbers write them into `numbers`.
    """
    hanging: list[tuple[Place, int, tuple[float, ...]]] = []
    inputs, outputs = (
        (np.zeros(n, np.int64), np.zeros((n, laws.NUMBERS)))
        for n in (len(machine.inputs), len(machine.sensors))
    )
    sizes = {
        f"{name}.{size}": getattr(scale, size)
        for name, scale in known.items()
        for size in ("effort", "flow", "reach", "flow_highest")
    }
    for effect in effects:
        site = effect.site
        if site.sets is not None:
            numbers.update(site.sets(effect.amplitude, sizes))
        elif kind_of_place(machine, site.place) == "place":
            hanging.append(hung(machine, effect, known[site.place]))
        else:
            _put_in_signal(machine, effect, known[site.place], inputs, outputs)
    return hanging, inputs, outputs


def _first_state(
    machine: Machine, given: Mapping[str, Array]
) -> tuple[Array, Array, Array]:
    """Return displacements, flows and contents at the first sample."""
    still = np.zeros(machine.coordinates)
    z = np.array(machine.start) if machine.start else np.zeros(machine.stores)
    return (
        np.array(given.get("q", still), dtype=float),
        np.array(given.get("v", still), dtype=float),
        np.array(given.get("z", z), dtype=float),
    )


def _put_in_signal(
    machine: Machine,
    effect: Effect,
    scale: Scales,
    inputs: Signals,
    outputs: Signals,
) -> None:
    """Write an effect of an input or output into its array."""
    names = [name for name, _ in machine.inputs]
    table, arrays = INPUT_LAWS, inputs
    if effect.site.place not in names:
        names = [sensor.name for sensor in machine.sensors]
        table, arrays = OUTPUT_LAWS, outputs
    j = names.index(effect.site.place)
    kind, numbers = table[law_of(effect.site)]
    period = 1.0 / machine.drive.band[1]
    found = numbers(effect.amplitude, scale.effort, scale.flow_highest, period)
    if law_of(effect.site) == "speed_dependent_gain":
        found = (found[0], scale.flow)
    arrays[0][j] = kind
    arrays[1][j, : len(found)] = found


def _slots(
    hanging: Sequence[tuple[Place, int, tuple[float, ...]]], coordinates: int
) -> tuple[Array, ...]:
    """Return the slot arrays of the laws that hang on places."""
    count = len(hanging)
    kind, cell = np.zeros(count, np.int64), np.zeros(count, np.int64)
    row, loaded = np.zeros((count, coordinates)), np.zeros(count, np.int64)
    numbers = np.zeros((count, laws.NUMBERS))
    for k, (place, law, given) in enumerate(hanging):
        kind[k], cell[k], loaded[k] = law, place.cell, place.load
        row[k, : len(place.row)] = place.row
        numbers[k, : len(given)] = given
    return kind, row, cell, numbers, loaded, np.zeros((count, laws.MEMORIES))


def scales_of(machine: Machine, plans: Sequence[Plan]) -> dict[str, Scales]:
    """Return typical sizes at every place, input and output, without any effect."""
    runs = [simulate(machine, one, watch=True, exact=True) for one in plans]
    commands = np.concatenate([run.commands for run in runs])
    readings = np.concatenate([run.readings for run in runs])
    typical = _rms(commands[:, 0] - (machine.drive.offset if machine.drive.offset and
                   not plans[0].closed else 0.0))  # fmt: skip
    found = {}
    for place in machine.places:
        s = np.concatenate([run.motion[place.name][0] for run in runs])
        w = np.concatenate([run.motion[place.name][1] for run in runs])
        found[place.name] = Scales(
            place.gain * typical, _rms(w), s.min(), s.max(), w.max()
        )
    speed = _rms(next(iter(found.values())).flow * np.ones(1))
    for j, (name, _) in enumerate(machine.inputs):
        u = commands[:, j]
        found[name] = Scales(_rms(u - u.mean()), speed, 0, 0, float(np.abs(u).max()))
    for j, sensor in enumerate(machine.sensors):
        y = readings[:, j]
        found[sensor.name] = Scales(_rms(y - y.mean()), 1, 0, 0, float(abs(y).max()))
    return found


def _rms(signal: Array) -> float:
    return float(np.sqrt(np.mean(np.square(signal))))
