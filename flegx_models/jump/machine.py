"""The leg moving: flight and stance as one hybrid system, with an energy ledger.

Between events the motion is stepped by the midpoint rule: half a step of the positions,
the new speeds from `flegx_models.jump.instant` there, the other half. Events are

- touch-down, located where the foot meets the ground, with an impulse there: the foot
  does not bounce, the worms rub or lock under the impulse like under any other load;
- lift-off, where the ground would have to pull;
- the rope going slack and taut again, of the same kind.

The energy ledger adds what the motors put in and what friction and impacts take, each
impulse with the mean of the speeds before and after. The difference to the energy that
the leg really has is the integration's error and must vanish with the step.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from flegx_models.jump.instant import GRIPS, OPEN, Choice, Ground, Problem, Step, solve
from flegx_models.jump.mechanics import Leg
from flegx_models.jump.worm import WormGear

Array = NDArray[np.float64]


class EventKind(StrEnum):
    """What happened at an instant; the value is the word to show."""

    TOUCH_DOWN = "touch-down"
    LIFT_OFF = "lift-off"
    ROPE_TAUT = "rope taut"
    ROPE_SLACK = "rope slack"


@dataclass(frozen=True, slots=True)
class Event:
    """An event, its time in s and its impulse in N·s (zero for a separation)."""

    kind: EventKind
    time: float
    impulse: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Ledger:
    """Where the energy went since the start, in J.

    ``motors`` is what the motors put in (before the worms), the others are losses.
    """

    motors: float = 0.0
    worms: float = 0.0
    sliding: float = 0.0
    impacts: float = 0.0

    @property
    def balance(self) -> float:
        """What the leg's own energy should have gained."""
        return self.motors - self.worms - self.sliding - self.impacts


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """The whole state of the machine.

    Parameters
    ----------
    q, v
        Support height, hip and knee angle, counterweight height; and their rates.
    down, taut
        Whether foot and rope are in touch.
    meshes
        Torques that the worm wheels pass on to hip and knee, N·m, over the last step.
    push, pull
        Forces of the ground up on the foot and of the rope, N, over the last step.
    """

    time: float
    q: Array
    v: Array
    down: bool
    taut: bool
    choice: Choice
    meshes: Array = field(default_factory=lambda: np.zeros(2))
    push: float = 0.0
    pull: float = 0.0
    ledger: Ledger = field(default_factory=Ledger)
    events: tuple[Event, ...] = ()


_HITS = 50
_NEAR = 1e-12  # m: a gap that counts as closed


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A leg with its two drives, on its ground, with or without counterweight.

    Parameters
    ----------
    counterweight
        Mass on the rope in kg; 0 for none.
    """

    leg: Leg
    worms: tuple[WormGear, WormGear]
    ground: Ground
    counterweight: float = 0.0

    @property
    def gravity(self) -> float:
        """g in m/s²."""
        return self.leg.parameters.values_by_name()["g"]

    def standing(self, hip: float, knee: float) -> Condition:
        """Return the machine at rest on the ground at these absolute angles."""
        posture = np.array([0.0, hip, knee, 0.0])
        posture[0] = -self.leg.foot_height(posture)
        posture[3] = -posture[0]
        return Condition(
            time=0.0,
            q=posture,
            v=np.zeros(4),
            down=True,
            taut=bool(self.counterweight),
            choice=Choice(foot=GRIPS, taut=bool(self.counterweight)),
        )

    def energy(self, condition: Condition) -> float:
        """Return kinetic and potential energy of everything that moves, in J."""
        q, v = condition.q, condition.v
        mass = self.leg.at(q, v[:3]).mass
        kinetic = v[:3] @ mass @ v[:3] + self.counterweight * v[3] ** 2
        for worm, speed in zip(self.worms, v[1:3], strict=True):
            kinetic += worm.inertia * speed**2
        raised = self.counterweight * self.gravity * q[3]
        return float(kinetic / 2 + self.leg.potential(q) + raised)

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
            hit = self._first_hit(condition, after, torques, left)
            if hit is None:
                return after
            gap, lapse = hit
            condition = self._struck(self._stepped(condition, torques, lapse), gap)
            left -= lapse
        return self._stepped(condition, torques, left)

    def _gaps(self, condition: Condition) -> dict[str, float]:
        """Return the gaps that are open now and may close."""
        gaps = {}
        if not condition.down:
            gaps["foot"] = self.clearance(condition)
        if self.counterweight and not condition.taut:
            gaps["rope"] = float(condition.q[0] + condition.q[3])
        return gaps

    def _first_hit(
        self,
        before: Condition,
        after: Condition,
        torques: tuple[float, float],
        duration: float,
    ) -> tuple[str, float] | None:
        """Return which gap closes first during the step, and when."""
        ends = self._gaps(after)
        hits = []
        for gap, start in self._gaps(before).items():
            if ends.get(gap, 0.0) >= min(start, 0.0) - _NEAR:
                continue

            def remaining(lapse: float, gap: str = gap) -> float:
                return self._gaps(self._stepped(before, torques, lapse))[gap]

            hits.append((_crossing(remaining, duration, start), gap))
        if not hits:
            return None
        lapse, gap = min(hits)
        return gap, lapse

    def _stepped(
        self, before: Condition, torques: tuple[float, float], h: float
    ) -> Condition:
        """Return the condition after a step in which no gap closes."""
        if h == 0.0:
            return before
        middle = before.q + h / 2 * before.v
        step, problem = self._solved(before, middle, torques, h)
        q = middle + h / 2 * step.speeds
        after = replace(
            before,
            time=before.time + h,
            q=q,
            v=step.speeds,
            meshes=step.meshes / h,
            push=step.push / h,
            pull=step.pull / h,
            ledger=_entered(before.ledger, problem, step, h),
        )
        return self._held_together(self._parted(after, step))

    def _struck(self, before: Condition, gap: str) -> Condition:
        """Return the condition after the impact that closes `gap`."""
        # Tried as closed first: what closes without impulse must not part again.
        foot = GRIPS if gap == "foot" else before.choice.foot
        taut = before.taut or gap == "rope"
        closed = replace(
            before,
            down=before.down or gap == "foot",
            taut=taut,
            choice=replace(before.choice, foot=foot, taut=taut),
        )
        step, problem = self._solved(closed, closed.q, (0.0, 0.0), 0.0)
        kind = EventKind.TOUCH_DOWN if gap == "foot" else EventKind.ROPE_TAUT
        impulse = step.push if gap == "foot" else step.pull
        struck = replace(
            closed,
            v=step.speeds,
            ledger=_entered(before.ledger, problem, step, 0.0),
            events=(*before.events, Event(kind, before.time, impulse)),
        )
        return self._parted(struck, step)

    def _solved(
        self, condition: Condition, q: Array, torques: tuple[float, float], h: float
    ) -> tuple[Step, Problem]:
        problem = Problem(
            posture=self.leg.at(q[:3], condition.v[:3]),
            speeds=condition.v,
            torques=torques,
            worms=self.worms,
            ground=self.ground,
            down=condition.down,
            taut=condition.taut,
            counterweight=self.counterweight,
            gravity=self.gravity,
        )
        return solve(problem, h, condition.choice), problem

    def _parted(self, condition: Condition, step: Step) -> Condition:
        """Return the condition with what has separated marked as open."""
        events = list(condition.events)
        down, taut = step.choice.foot != OPEN, step.choice.taut
        if condition.down and not down:
            events.append(Event(EventKind.LIFT_OFF, condition.time))
        if condition.taut and not taut:
            events.append(Event(EventKind.ROPE_SLACK, condition.time))
        return replace(
            condition, down=down, taut=taut, choice=step.choice, events=tuple(events)
        )

    def _held_together(self, condition: Condition) -> Condition:
        """Return the condition without the drift of closed gaps, of order h²."""
        q = condition.q.copy()
        if condition.down:
            q[0] -= self.leg.foot_height(q)
        if condition.taut:
            q[3] = -q[0]
        return replace(condition, q=q)


def _crossing(gap: Callable[[float], float], end: float, start: float) -> float:
    """Return when a gap that is negative at `end` closes."""
    from scipy.optimize import brentq  # noqa: PLC0415

    if start <= 0.0:
        return 0.0
    return float(brentq(gap, 0.0, end, xtol=1e-3 * _NEAR))


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
    along, up = problem.posture.foot @ mean[:3]
    return Ledger(
        motors=ledger.motors + float(motors),
        worms=ledger.worms + float(worms),
        sliding=ledger.sliding - float(step.grip * along),
        impacts=ledger.impacts
        - float(step.push * up + step.pull * (mean[0] + mean[3])),
    )
