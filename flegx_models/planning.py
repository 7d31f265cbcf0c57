"""The planning of the jump: figure 6.7 as a state machine.

The figure is lost from the text; section 6.2 describes it. On the ground the leg squats
and stretches along one spline per joint, from the landing angles with a speed into the
squat back to the same angles with the opposite speed. If it is still on the ground at
the end it squats again. When the ground is lost, two new splines bring the joints from
where they are to the landing angles, at rest at both ends; there they wait for the
ground::

    SQUATTING --ground lost--> RETRACTING --spline ends--> WAITING
        ^  |                        |                         |
        +--+ spline ends            +------ ground felt ------+--> SQUATTING

Angles are absolute, as in `flegx_models.planar_leg`: the knee's is θ1 + θ2, for that is
what its motor turns (section 4.1).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

from flegx_models.parameters_control import CONTROL
from flegx_models.splines import Motion, QuinticSpline


class Phase(StrEnum):
    """What the leg is doing; the value is the word to show."""

    SQUATTING = "squatting"
    RETRACTING = "retracting"
    WAITING = "waiting"

    @property
    def grounded(self) -> bool:
        """Whether the foot is meant to be on the ground."""
        return self is Phase.SQUATTING


@dataclass(frozen=True, slots=True, kw_only=True)
class JumpPlan:
    """The numbers of section 6.2.

    Parameters
    ----------
    hip_landing, knee_landing
        Absolute angles in rad.
    hip_speed, knee_speed
        Absolute speeds in rad/s with which a squat ends; it starts with the opposite.
    squat_time, flight_time
        Durations of the splines in s.
    """

    hip_landing: float
    knee_landing: float
    hip_speed: float
    knee_speed: float
    squat_time: float
    flight_time: float

    def squat(self) -> tuple[QuinticSpline, QuinticSpline]:
        """Return the splines of hip and knee on the ground (figures 6.5 and 6.6)."""
        return (
            _there_and_back(self.hip_landing, self.hip_speed, self.squat_time),
            _there_and_back(self.knee_landing, self.knee_speed, self.squat_time),
        )

    def retraction(
        self, hip: float, knee: float
    ) -> tuple[QuinticSpline, QuinticSpline]:
        """Return the splines from these angles to the landing angles."""
        return (
            QuinticSpline(Motion(hip), Motion(self.hip_landing), self.flight_time),
            QuinticSpline(Motion(knee), Motion(self.knee_landing), self.flight_time),
        )


def _there_and_back(angle: float, speed: float, duration: float) -> QuinticSpline:
    return QuinticSpline(Motion(angle, -speed), Motion(angle, speed), duration)


def printed_plan(values: Mapping[str, float] | None = None) -> JumpPlan:
    """Return the plan of section 6.2, with the knee in absolute angles.

    The knee's printed angle π/3 and speed 1.5 rad/s are relative; added to the hip's
    -π/6 and 0.75 they give the mirror of the hip's, as eq. 4.16 and 4.18 want.
    """
    v = CONTROL.values_by_name() if values is None else values
    return JumpPlan(
        hip_landing=v["hip_landing"],
        knee_landing=v["hip_landing"] + v["knee_landing"],
        hip_speed=v["hip_speed"],
        knee_speed=v["hip_speed"] - v["knee_speed"],
        squat_time=v["squat_time"],
        flight_time=v["flight_time"],
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Planner:
    """The state machine; every step returns a new one.

    Parameters
    ----------
    since
        When the present splines started, s.
    """

    plan: JumpPlan
    phase: Phase
    since: float
    splines: tuple[QuinticSpline, QuinticSpline]

    @classmethod
    def starting(cls, plan: JumpPlan, time: float = 0.0) -> "Planner":
        """Return the planner at the start of a squat."""
        return cls(plan=plan, phase=Phase.SQUATTING, since=time, splines=plan.squat())

    def stepped(
        self, time: float, *, grounded: bool, angles: tuple[float, float]
    ) -> "Planner":
        """Return the planner after looking at the machine once.

        Parameters
        ----------
        grounded
            Whether the ground is felt.
        angles
            Measured absolute angles of hip and knee in rad.
        """
        ended = time - self.since >= self.splines[0].duration
        if self.phase.grounded and not grounded:
            return replace(
                self,
                phase=Phase.RETRACTING,
                since=time,
                splines=self.plan.retraction(*angles),
            )
        if not self.phase.grounded and grounded:
            return self.starting(self.plan, time)
        if self.phase is Phase.SQUATTING and ended:
            return self.starting(self.plan, time)
        if self.phase is Phase.RETRACTING and ended:
            return replace(self, phase=Phase.WAITING)
        return self

    def reference(self, time: float) -> tuple[Motion, Motion]:
        """Return the wanted motion of hip and knee at `time`."""
        hip, knee = (spline.at(time - self.since) for spline in self.splines)
        return hip, knee
