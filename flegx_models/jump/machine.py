"""The leg moving: flight and stance as one hybrid system, with an energy ledger.

Between events the motion is stepped by the midpoint rule: half a step of the positions,
the new speeds from `flegx_models.jump.instant` there, the other half. Events are

- touch-down, located where the foot meets the ground, with an impulse there: the foot
  does not bounce, the worms rub or lock under the impulse like under any other load;
- lift-off, where the ground would have to pull.

The counterweight hangs on a rope over a pulley: a stiff spring with some damping that
can only pull. A rigid one would pass the touch-down on to the counterweight as a second
impact, and the foot and the rope would throw each other back and forth.

The energy ledger adds what the motors put in and what friction and impacts take, each
impulse with the mean of the speeds before and after. The difference to the energy that
the leg really has is the integration's error and must vanish with the step.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flegx_models.jump.condition import (
    Condition,
    Counterweight,
    Event,
    EventKind,
    Ledger,
)
from flegx_models.jump.instant import GRIPS, OPEN, Choice, Ground, Problem, Step, solve
from flegx_models.jump.mechanics import Leg
from flegx_models.jump.worm import WormGear

Array = NDArray[np.float64]


_HITS = 20
_NEAR = 1e-12  # m: a gap that counts as closed


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A leg with its two drives, on its ground, with or without counterweight.

    Parameters
    ----------
    counterweight
        None for the leg alone.
    """

    leg: Leg
    worms: tuple[WormGear, WormGear]
    ground: Ground
    counterweight: Counterweight | None = None

    @property
    def gravity(self) -> float:
        """Weight per mass in m/s²."""
        return self.leg.parameters.values_by_name()["g"]

    def standing(self, hip: float, knee: float) -> Condition:
        """Return the machine at rest on the ground at these absolute angles."""
        posture = np.array([0.0, hip, knee, 0.0])
        posture[0] = -self.leg.foot_height(posture)
        posture[3] = -posture[0]
        if self.counterweight is not None:
            hung = self.counterweight.mass * self.gravity
            posture[3] -= hung / self.counterweight.stiffness
        return Condition(
            time=0.0, q=posture, v=np.zeros(4), down=True, choice=Choice(foot=GRIPS)
        )

    def energy(self, condition: Condition) -> float:
        """Return kinetic and potential energy of everything that moves, in J."""
        q, v = condition.q, condition.v
        mass = self.leg.at(q, v[:3]).mass
        kinetic = v[:3] @ mass @ v[:3]
        for worm, speed in zip(self.worms, v[1:3], strict=True):
            kinetic += worm.inertia * speed**2
        whole = kinetic / 2 + self.leg.potential(q)
        weight = self.counterweight
        if weight is not None:
            whole += weight.mass * (v[3] ** 2 / 2 + self.gravity * q[3])
            whole += weight.stiffness * weight.stretch(q) ** 2 / 2
        return float(whole)

    def clearance(self, condition: Condition) -> float:
        """Return the height of the foot above the ground in m."""
        return self.leg.foot_height(condition.q)

    def advance(
        self, condition: Condition, torques: tuple[float, float], duration: float
    ) -> Condition:
        """Return the condition `duration` seconds later under constant motor torques.

        Parameters
        ----------
        torques
            N T_motor of hip and knee in N·m.
        """
        left = duration
        for _ in range(_HITS):
            after = self._stepped(condition, torques, left)
            lapse = self._hit(condition, after, torques, left)
            if lapse is None:
                return after
            condition = self._struck(self._stepped(condition, torques, lapse))
            left -= lapse
        return self._stepped(condition, torques, left)

    def _hit(
        self,
        before: Condition,
        after: Condition,
        torques: tuple[float, float],
        duration: float,
    ) -> float | None:
        """Return when the foot meets the ground during the step, if it does."""
        if before.down or after.down:
            return None
        start = self.clearance(before)
        if self.clearance(after) >= min(start, 0.0) - _NEAR:
            return None

        def remaining(lapse: float) -> float:
            return self.clearance(self._stepped(before, torques, lapse))

        return _crossing(remaining, duration, start)

    def _stepped(
        self, before: Condition, torques: tuple[float, float], h: float
    ) -> Condition:
        """Return the condition after a step in which the foot does not land."""
        if h == 0.0:
            return before
        middle = before.q + h / 2 * before.v
        force, damping, fall = self._rope(middle, before.v, h)
        step, problem = self._solved(before, middle, torques, h, force)
        v = np.append(step.speeds, fall)
        ledger = _entered(before.ledger, problem, step, h)
        stretching = -(before.v[0] + before.v[3] + v[0] + v[3]) / 2
        after = replace(
            before,
            time=before.time + h,
            q=middle + h / 2 * v,
            v=v,
            meshes=step.meshes / h,
            push=step.push / h,
            pull=force,
            ledger=replace(ledger, rope=ledger.rope + float(h * damping * stretching)),
        )
        return self._held_down(self._parted(after, step))

    def _rope(self, q: Array, v: Array, h: float) -> tuple[float, float, float]:
        """Return force, its damping part, and the counterweight's new speed."""
        if self.counterweight is None:
            return 0.0, 0.0, 0.0
        force, damping = self.counterweight.pull(q, v)
        rise = force / self.counterweight.mass - self.gravity
        return force, damping, float(v[3]) + h * rise

    def _struck(self, before: Condition) -> Condition:
        """Return the condition after the foot has met the ground."""
        # Tried as gripping first: what lands without impulse must not part again.
        landing = replace(before, down=True, choice=replace(before.choice, foot=GRIPS))
        step, problem = self._solved(landing, landing.q, (0.0, 0.0), 0.0, 0.0)
        struck = replace(
            landing,
            v=np.append(step.speeds, before.v[3]),
            ledger=_entered(before.ledger, problem, step, 0.0),
            events=(
                *before.events,
                Event(EventKind.TOUCH_DOWN, before.time, step.push),
            ),
        )
        return self._parted(struck, step)

    def _solved(
        self,
        condition: Condition,
        q: Array,
        torques: tuple[float, float],
        h: float,
        pull: float,
    ) -> tuple[Step, Problem]:
        problem = Problem(
            posture=self.leg.at(q, condition.v[:3]),
            speeds=condition.v[:3],
            torques=torques,
            worms=self.worms,
            ground=self.ground,
            pull=pull,
            down=condition.down,
        )
        return solve(problem, h, condition.choice), problem

    def _parted(self, condition: Condition, step: Step) -> Condition:
        """Return the condition with the foot marked as off where it has left."""
        down, events = step.choice.foot != OPEN, condition.events
        if condition.down and not down:
            events = (*events, Event(EventKind.LIFT_OFF, condition.time))
        return replace(condition, down=down, choice=step.choice, events=events)

    def _held_down(self, condition: Condition) -> Condition:
        """Return the condition without the foot's drift on the ground, of order h²."""
        if not condition.down:
            return condition
        q = condition.q.copy()
        q[0] -= self.leg.foot_height(q)
        return replace(condition, q=q)


def _crossing(gap: Callable[[float], float], end: float, start: float) -> float:
    """Return when a gap that is negative at `end` closes.

    One that has just opened is zero at the start, rises and falls again: its crossing
    is sought behind the top of the parabola through what is known of it.
    """
    from scipy.optimize import brentq  # noqa: PLC0415

    first = 0.0
    if start <= _NEAR:
        half, whole = gap(end / 2) - start, gap(end) - start
        rise, bend = 4 * half - whole, 2 * whole - 4 * half
        if rise <= 0.0 or bend >= 0.0:
            return 0.0
        first = -rise / (2 * bend) * end
        if gap(first) <= 0.0:
            return 0.0
    return float(brentq(gap, first, end, xtol=_NEAR * end))


def _entered(ledger: Ledger, problem: Problem, step: Step, h: float) -> Ledger:
    """Return the ledger after a step; every impulse works on the mean speed."""
    mean = (problem.speeds + step.speeds) / 2
    change = step.speeds - problem.speeds
    motors = worms = 0.0
    for k, worm in enumerate(problem.worms):
        put = h * problem.torques[k]
        rubbed = put - worm.inertia * change[1 + k] - step.meshes[k]
        motors += put * mean[1 + k]
        worms += rubbed * mean[1 + k]
    along, up = problem.posture.foot @ mean
    # Between impacts the foot does not move upwards, and the ground's push works not.
    struck = 0.0 if h else step.push * up
    return replace(
        ledger,
        motors=ledger.motors + float(motors),
        worms=ledger.worms + float(worms),
        sliding=ledger.sliding - float(step.grip * along),
        impacts=ledger.impacts - float(struck),
    )
