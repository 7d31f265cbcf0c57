"""One short step of the leg: who sticks, who slips, who is in touch.

Over a step of h seconds (or in an instant, h = 0, for an impact) the unknowns are the
new speeds, the impulses T of the worm wheels on the joints and those of the ground on
the foot. Every dry thing is a choice between a few linear laws:

- a worm turns one way or the other, under either sign of T (`flegx_models.jump.worm`),
  or is held, its motor side's impulse anywhere between the limits;
- the foot, where it is down, pushes and does not sink, or rises and does not push;
  along the ground it grips (with a small creep, the only smoothed law, because two
  held worms and a gripping foot would leave the forces undetermined), or slips either
  way at the limit of Coulomb's friction.
A choice makes the step a linear system; its solution must agree with the choice. They
are tried from the last one outwards, so that nothing is smoothed and nothing guessed.
"""

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bondgraph import BondGraphError
from flegx_models.jump.mechanics import Posture
from flegx_models.jump.worm import WormGear

Array = NDArray[np.float64]

HELD = (0, 0)
_WORMS = (HELD, *product((1, -1), (1, -1)))  # (way of turning, sign of T)
OPEN, GRIPS, SLIPS_BACK, SLIPS_FORTH = "open", "grips", "slips back", "slips forth"
_SLIP = {SLIPS_BACK: -1.0, SLIPS_FORTH: 1.0}
_TOLERANCE = 1e-10


@dataclass(frozen=True, slots=True)
class Choice:
    """Which law holds for the worms of hip and knee and for the foot."""

    hip: tuple[int, int] = HELD
    knee: tuple[int, int] = HELD
    foot: str = OPEN

    @property
    def worms(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """Those of hip and knee."""
        return self.hip, self.knee


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """The floor: Coulomb's coefficient, and the creep of a gripping foot.

    ``creep`` in m/s per N·s of impulse along the ground.
    """

    friction: float
    creep: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """The solution of one step.

    Parameters
    ----------
    speeds
        New v of support, hip and knee.
    meshes
        Impulses of the worm wheels on hip and knee, N·m·s.
    push, grip
        Impulses of the ground up and forward on the foot, N·s.
    """

    choice: Choice
    speeds: Array
    meshes: Array
    push: float
    grip: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """What a step needs to know: the leg there, the drives, what may touch.

    Parameters
    ----------
    speeds
        v before the step, (3,).
    torques
        N T_motor of hip and knee, N·m at the joint.
    pull
        Force of the rope on the support, N.
    down
        Whether the foot is on the ground.
    """

    posture: Posture
    speeds: Array
    torques: tuple[float, float]
    worms: tuple[WormGear, WormGear]
    ground: Ground
    pull: float
    down: bool


def solve(problem: Problem, duration: float, last: Choice) -> Step:
    """Return the step that agrees with its own choice.

    Parameters
    ----------
    duration
        h in s; 0 for an impact.
    last
        The choice of the step before, tried first.

    Raises
    ------
    BondGraphError
        If no choice agrees with its solution.
    """
    for choice in _ordered(last, problem.down):
        step = _solved(problem, duration, choice)
        if step is not None and _agrees(problem, duration, step):
            return step
    raise BondGraphError(
        "No choice of sticking, slipping and touching agrees with its own motion.",
        ("worm", "ground"),
        "Take a smaller friction: beyond self-locking a motion need not exist.",
    )


@cache
def _ordered(last: Choice, down: bool) -> tuple[Choice, ...]:
    """Return all choices, those that differ least from `last` first."""
    feet = (GRIPS, SLIPS_BACK, SLIPS_FORTH, OPEN) if down else (OPEN,)
    choices = [Choice(*c) for c in product(_WORMS, _WORMS, feet)]

    def differences(choice: Choice) -> int:
        return (
            (choice.hip != last.hip)
            + (choice.knee != last.knee)
            + (choice.foot != last.foot)
        )

    return tuple(sorted(choices, key=differences))


# Rows and columns: three coordinates, two meshes, push, grip.
_MESH, _PUSH, _GRIP, _SIZE = 3, 5, 6, 7


def _solved(problem: Problem, h: float, choice: Choice) -> Step | None:
    A, right = np.zeros((_SIZE, _SIZE)), np.zeros(_SIZE)
    mass, v = problem.posture.mass, problem.speeds
    A[:3, :3] = mass
    A[1, _MESH] = A[2, _MESH + 1] = -1.0
    A[:3, _PUSH], A[:3, _GRIP] = -problem.posture.foot[1], -problem.posture.foot[0]
    right[:3] = mass @ v + h * problem.posture.bias
    right[0] += h * problem.pull
    _worm_rows(problem, h, choice, A, right)
    _foot_rows(problem, choice, A)
    try:
        x = np.linalg.solve(A, right)
    except np.linalg.LinAlgError:
        return None  # a choice that fixes nothing cannot be the one
    return Step(
        choice=choice,
        speeds=np.asarray(x[:3], dtype=float),
        meshes=np.asarray(x[_MESH:_PUSH], dtype=float),
        push=float(x[_PUSH]),
        grip=float(x[_GRIP]),
    )


def _worm_rows(
    problem: Problem, h: float, choice: Choice, A: Array, right: Array
) -> None:
    for k, (worm, (way, sign)) in enumerate(
        zip(problem.worms, choice.worms, strict=True)
    ):
        row = _MESH + k
        A[row, 1 + k] = 1.0
        if way == 0:
            continue
        share = worm.driving if way == sign else worm.backdriving
        A[row, 1 + k] = worm.inertia
        A[row, row] = share
        right[row] = worm.inertia * problem.speeds[1 + k] + h * (
            problem.torques[k] - way * worm.constant
        )


def _foot_rows(problem: Problem, choice: Choice, A: Array) -> None:
    if choice.foot == OPEN:
        A[_PUSH, _PUSH] = A[_GRIP, _GRIP] = 1.0
        return
    A[_PUSH, :3] = problem.posture.foot[1]
    if choice.foot == GRIPS:
        A[_GRIP, :3] = problem.posture.foot[0]
        A[_GRIP, _GRIP] = problem.ground.creep
    else:
        A[_GRIP, _GRIP] = 1.0
        A[_GRIP, _PUSH] = _SLIP[choice.foot] * problem.ground.friction


def _agrees(problem: Problem, h: float, step: Step) -> bool:
    """Return whether the solution is of the kind that its choice says."""
    return _foot_agrees(problem, step) and all(
        _worm_agrees(problem, h, step, k) for k in (0, 1)
    )


def _worm_agrees(problem: Problem, h: float, step: Step, k: int) -> bool:
    worm, (way, sign) = problem.worms[k], step.choice.worms[k]
    mesh, speed = float(step.meshes[k]), float(step.speeds[1 + k])
    if way:
        return way * speed >= -_TOLERANCE and sign * mesh >= -_TOLERANCE
    # What arrives at the worm, seen with T positive, between the two limits.
    arriving = h * problem.torques[k] + worm.inertia * float(problem.speeds[1 + k])
    side = 1.0 if mesh >= 0 else -1.0
    slack = h * worm.constant + _TOLERANCE
    low = worm.backdriving * abs(mesh) - slack
    return low <= side * arriving <= worm.driving * abs(mesh) + slack


def _foot_agrees(problem: Problem, step: Step) -> bool:
    foot = step.choice.foot
    along, up = (float(x) for x in problem.posture.foot @ step.speeds)
    if foot == OPEN:
        return not problem.down or up >= -_TOLERANCE
    if step.push < -_TOLERANCE:
        return False
    if foot == GRIPS:
        return abs(step.grip) <= problem.ground.friction * step.push + _TOLERANCE
    return _SLIP[foot] * along >= -_TOLERANCE
