"""The experiment of section 6.2: plan, controllers, sensors and machine together.

400 times a second the controller reads the two encoders and the knee's torque sensor,
decides whether the ground is felt, asks the planner for the references and commands two
currents; between samples the machine moves (`flegx_models.jump.machine`). The knee
encoder measures θ2, the knee motor turns θ1 + θ2, so the reading of θ1 is added.

The ground is felt as in section 6.2: by the torque in the knee sensor beyond what the
hanging lower leg needs.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from flegx_models.controllers import controller
from flegx_models.gravity import FeedForward, printed_feed_forward
from flegx_models.jump.condition import Condition, Counterweight, Event, Ledger
from flegx_models.jump.instant import Ground
from flegx_models.jump.machine import Machine
from flegx_models.jump.mechanics import leg
from flegx_models.jump.sampled import Encoder, JointController, encoder_filter
from flegx_models.jump.worm import WormGear, irreversible_worm
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CHOSEN, CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.planning import JumpPlan, Phase, Planner, printed_plan
from flegx_models.splines import Motion

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """One run of the jump.

    Parameters
    ----------
    worm
        Both drives; `irreversible_worm` by default, with the least friction for which
        the thesis's word on it is true.
    counterweight
        Mass on the rope in kg; 0 for none.
    version
        Of the controllers, see `flegx_models.controllers.controller`.
    duration
        s.
    substeps
        Integration steps per sampling period.
    seed
        Of the torque sensor's noise.
    """

    worm: WormGear = field(default_factory=irreversible_worm)
    counterweight: float = 0.0
    version: str = "tuned"
    duration: float = 2.0
    substeps: int = int(CHOSEN.values_by_name()["substeps"])
    seed: int = 1
    plan: JumpPlan = field(default_factory=printed_plan)


@dataclass(frozen=True, slots=True, kw_only=True)
class JumpRecord:
    """What happened, sample by sample.

    Parameters
    ----------
    time
        s.
    angles, references
        Absolute angles of hip and knee in rad, (n, 2).
    currents
        Of the two motors in A, (n, 2).
    meshes
        Torques that the worm wheels pass on, N·m, (n, 2).
    height, clearance
        Of the support above its start, of the foot above the ground, in m.
    push
        Force of the ground on the foot in N, mean over the last integration step.
    ledger
        The final one; ``energy_error`` is what it leaves unexplained, in J.
    """

    time: Array
    angles: Array
    references: Array
    currents: Array
    meshes: Array
    height: Array
    clearance: Array
    push: Array
    phases: tuple[Phase, ...]
    events: tuple[Event, ...]
    ledger: Ledger
    energy_error: float

    @property
    def flights(self) -> tuple[tuple[float, float], ...]:
        """Start and end in s of every time in the air of over two samples."""
        period = float(self.time[1] - self.time[0])
        aloft = np.concatenate([[False], self.clearance > 0.0, [False]])
        edges = np.flatnonzero(np.diff(aloft.astype(int)))
        pairs = zip(edges[::2], edges[1::2], strict=True)
        start = float(self.time[0])
        return tuple(
            (start + period * a, start + period * b) for a, b in pairs if b - a > 2
        )

    @property
    def highest(self) -> float:
        """The greatest height of the foot above the ground in m."""
        return float(self.clearance.max())


def machine(experiment: Experiment) -> Machine:
    """Return the machine of an experiment."""
    chosen = CHOSEN.values_by_name()
    # The creep holds for a force; a step turns it into one for its impulse.
    step = 1 / (CONTROL.values_by_name()["sampling"] * chosen["substeps"])
    hung = Counterweight(
        mass=experiment.counterweight,
        stiffness=chosen["rope_stiffness"],
        damping=chosen["rope_damping"],
    )
    return Machine(
        leg=leg(),
        worms=(experiment.worm, experiment.worm),
        ground=Ground(friction=chosen["mu_ground"], creep=1 / (chosen["creep"] * step)),
        counterweight=hung if experiment.counterweight else None,
    )


def run(experiment: Experiment) -> JumpRecord:
    """Return the record of an experiment that starts standing at the landing angles."""
    values = CONTROL.values_by_name()
    body = machine(experiment)
    plan = experiment.plan
    now = body.standing(plan.hip_landing, plan.knee_landing)
    first = body.energy(now)
    brain = _Brain(experiment, values)
    period = 1 / values["sampling"]
    step = period / experiment.substeps
    rows: list[tuple[Condition, tuple[Motion, Motion], tuple[float, float], Phase]] = []
    for sample in range(round(experiment.duration / period)):
        currents = brain.command(now, sample)
        rows.append((now, brain.references, currents, brain.planner.phase))
        torques = (brain.torque * currents[0], brain.torque * currents[1])
        for _ in range(experiment.substeps):
            now = body.advance(now, torques, step)
    return _record(body, rows, now, first)


class _Brain:
    """The control program: everything that is known to it, and its states."""

    def __init__(self, experiment: Experiment, values: Mapping[str, float]) -> None:
        chapter_3, chosen = CHAPTER_3.values_by_name(), CHOSEN.values_by_name()
        rate = values["sampling"]
        self._period = 1 / rate
        self._encoder = Encoder(
            step=chapter_3["encoder_step"], noise=chapter_3["encoder_noise"]
        )
        cutoff = 2 * math.pi * chapter_3["f_filter"]
        plan = experiment.plan
        self._filters = [
            encoder_filter(cutoff, rate, start)
            for start in (plan.hip_landing, plan.knee_landing - plan.hip_landing)
        ]
        self._laws = [
            JointController(
                controller(f"{link}_flight", experiment.version),
                controller(f"{link}_stance", experiment.version),
                rate,
            )
            for link in ("upperleg", "lowerleg")
        ]
        weighed = bool(experiment.counterweight)
        self._feed: dict[bool, FeedForward] = {
            False: printed_feed_forward("flight"),
            True: printed_feed_forward("counterweight" if weighed else "stance"),
        }
        self._limit = values["driver_current"]
        self._band, self._noise = chosen["torque_band"], chosen["torque_noise"]
        self._generator = np.random.default_rng(experiment.seed)
        self.torque = DATASHEETS.values_by_name()["K_m"] * experiment.worm.ratio
        self.planner = Planner.starting(experiment.plan)
        self.references = self.planner.reference(0.0)
        self._grounded = True

    def command(self, now: Condition, sample: int) -> tuple[float, float]:
        """Return the two currents in A for the next sampling period."""
        time = sample * self._period
        hip = self._filters[0](self._encoder.read(float(now.q[1]), sample))
        bend = self._filters[1](self._encoder.read(float(now.q[2] - now.q[1]), sample))
        measured = (hip, hip + bend)
        if sample:
            self._feel(now, measured)
            self.planner = self.planner.stepped(
                time, grounded=self._grounded, angles=measured
            )
        self.references = self.planner.reference(time)
        carried = self._feed[self._grounded].torques(*measured)
        currents = [
            law.command(wanted.angle - angle, grounded=self._grounded)
            + torque / self.torque
            for law, wanted, angle, torque in zip(
                self._laws, self.references, measured, carried, strict=True
            )
        ]
        hip_current, knee_current = (
            min(max(current, -self._limit), self._limit) for current in currents
        )
        return hip_current, knee_current

    def _feel(self, now: Condition, measured: tuple[float, float]) -> None:
        """Decide by the knee torque whether the foot is on the ground.

        On the ground the knee carries the leg against its own unloaded torque. Felt
        lost where it falls to the unloaded one, felt again beyond the band: two
        thresholds, so that noise does not switch.
        """
        torque = float(now.meshes[1]) + self._noise * self._generator.normal()
        unloaded = self._feed[False].torques(*measured)[1]
        load = -math.copysign(1.0, measured[1]) * (torque - unloaded)
        if self._grounded and load < 0.0:
            self._grounded = False
        elif not self._grounded and load > self._band:
            self._grounded = True


def _record(
    body: Machine,
    rows: list[tuple[Condition, tuple[Motion, Motion], tuple[float, float], Phase]],
    last: Condition,
    first: float,
) -> JumpRecord:
    start = float(rows[0][0].q[0])
    return JumpRecord(
        time=np.array([c.time for c, *_ in rows]),
        angles=np.array([c.q[1:3] for c, *_ in rows]),
        references=np.array([[m.angle for m in motions] for _, motions, *_ in rows]),
        currents=np.array([currents for _, _, currents, _ in rows]),
        meshes=np.array([c.meshes for c, *_ in rows]),
        height=np.array([c.q[0] - start for c, *_ in rows]),
        clearance=np.array(
            [0.0 if c.down else max(body.clearance(c), 0.0) for c, *_ in rows]
        ),
        push=np.array([c.push for c, *_ in rows]),
        phases=tuple(phase for *_, phase in rows),
        events=last.events,
        ledger=last.ledger,
        energy_error=body.energy(last) - first - last.ledger.balance,
    )
