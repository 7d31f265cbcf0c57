"""The tuning tests of section 6.1: one joint follows splines to and fro.

One drive, its worm and one load, at the loop's own inertia (eq. 4.7 to 4.35) and under
gravity's torque in the middle of the test, which the feed-forward carries as far as an
ideal worm would. The step is that of the jump (`flegx_models.jump.instant`) with a leg
of one joint that touches nothing; sensors and controller are those of the jump too.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph import Lead
from flegx_models.jump.instant import Choice, Ground, Problem, solve
from flegx_models.jump.mechanics import Posture
from flegx_models.jump.sampled import Encoder, encoder_filter, sampled_lead
from flegx_models.jump.worm import WormGear
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CHOSEN, CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.splines import Motion, QuinticSpline
from flegx_models.tuned_zeros import TuningTest

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class TuningRecord:
    """A tuning test: ``time`` in s, ``reference`` and ``angle`` in rad."""

    time: Array
    reference: Array
    angle: Array

    def distance(self, other: "TuningRecord") -> float:
        """Return the root mean square difference of the angles in rad."""
        return float(np.sqrt(np.mean((self.angle - other.angle) ** 2)))


def run_test(
    test: TuningTest, worm: WormGear, law: Lead, duration: float
) -> TuningRecord:
    """Return how a joint with this worm follows the splines of its tuning test.

    Parameters
    ----------
    test
        One of `flegx_models.tuned_zeros.tuning_tests`.
    law
        The controller, such as `flegx_models.controllers.controller` returns.
    duration
        s.
    """
    values = CONTROL.values_by_name()
    rate, substeps = values["sampling"], int(CHOSEN.values_by_name()["substeps"])
    loop = _Loop(test, law, rate)
    step = 1 / (rate * substeps)
    torque = DATASHEETS.values_by_name()["K_m"] * worm.ratio
    limit = values["driver_current"]
    joint, angle, choice = _joint(test, worm), 0.0, Choice()
    speeds = np.zeros(3)
    wanted, angles = [], []
    for sample in range(round(duration * rate)):
        reference = loop.reference(sample / rate)
        wanted.append(reference)
        angles.append(angle)
        current = loop.command(reference, angle, sample) + test.load / torque
        put = torque * min(max(current, -limit), limit)
        for _ in range(substeps):
            found = solve(_moved(joint, speeds, put), step, choice)
            angle += step * float(speeds[1] + found.speeds[1]) / 2
            speeds, choice = found.speeds, found.choice
    return TuningRecord(
        time=np.arange(len(wanted)) / rate,
        reference=np.array(wanted),
        angle=np.array(angles),
    )


class _Loop:
    """Reference, encoder, filter and lead of one joint."""

    def __init__(self, test: TuningTest, law: Lead, rate: float) -> None:
        values, chapter_3 = CONTROL.values_by_name(), CHAPTER_3.values_by_name()
        self._law = sampled_lead(law, rate)
        self._filter = encoder_filter(2 * math.pi * chapter_3["f_filter"], rate, 0.0)
        self._encoder = Encoder(
            step=chapter_3["encoder_step"], noise=chapter_3["encoder_noise"]
        )
        swing = values[f"swing_{test.model.split('_')[0]}"]
        self._half = values["period_test"] / 2
        self._there = QuinticSpline(Motion(0.0), Motion(swing), self._half)
        self._back = QuinticSpline(Motion(swing), Motion(0.0), self._half)

    def reference(self, time: float) -> float:
        """Return the wanted angle at `time`, splines to and fro without end."""
        halves, inside = divmod(time, self._half)
        return (self._back if halves % 2 else self._there).at(inside).angle

    def command(self, reference: float, angle: float, sample: int) -> float:
        """Return the current in A for the next sample."""
        measured = self._filter(self._encoder.read(angle, sample))
        return self._law(reference - measured)


def _joint(test: TuningTest, worm: WormGear) -> Problem:
    """Return a leg of one joint: the hip's place carries it, the others are idle."""
    after = test.inertia - worm.inertia
    posture = Posture(
        mass=np.diag([1.0, after, after]),
        bias=np.array([0.0, -test.load, 0.0]),
        foot=np.zeros((2, 3)),
    )
    return Problem(
        posture=posture,
        speeds=np.zeros(3),
        torques=(0.0, 0.0),
        worms=(worm, worm.with_friction(0.0)),
        ground=Ground(friction=0.0, creep=0.0),
        pull=0.0,
        down=False,
    )


def _moved(joint: Problem, speeds: Array, torque: float) -> Problem:
    return Problem(
        posture=joint.posture,
        speeds=speeds,
        torques=(torque, 0.0),
        worms=joint.worms,
        ground=joint.ground,
        pull=0.0,
        down=False,
    )
