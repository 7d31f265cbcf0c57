"""What each assumption of chapter 4 costs: from the planar leg to the printed models.

Chapter 4 goes from eq. 4.1 to four models of one joint each: the other joint does not
move, the support is held, the lower leg is a point mass, both links move like the
support, the other motor has no inertia, the mass matrix is constant, the leg is slow,
gravity is compensated. `assumptions` takes them one at a time: two graphs that differ
in nothing else, and what that does to the gain (acceleration per motor torque), to the
friction pole and to the gain over the range in which the leg works
(`flegx_models.working_range`). What the last two leave out is `flegx_models.neglected`.

``python -m flegx_models.cost_tables`` prints both. Every number is derived from graphs.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from bondgraph import FinishedGraph, ParameterSet, state_space
from flegx_models import nonlinear_stance
from flegx_models.parameters import RECONCILED
from flegx_models.planar_leg import (
    JOINTS,
    flying_leg,
    hanging_leg,
    locked,
    rigid_leg,
    sliding_leg,
    standing_leg,
)
from flegx_models.working_range import (
    Posture,
    flight_postures,
    printed_posture,
    stance_postures,
)

_BOTH = {f"q_{joint}": joint for joint in JOINTS}


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumption:
    """One assumption, and the gain and friction pole with it and without it.

    Parameters
    ----------
    model
        The printed model that makes it.
    gain, gain_without
        rad/s² per N·m of motor torque at θ0 = π/6.
    pole, pole_without
        Friction pole at θ0, magnitude in rad/s: how fast a torque step's acceleration
        begins to fall, which is the pole itself where there is one.
    lowest, highest
        Least and greatest relative change of the gain over the working range.
    """

    model: str
    statement: str
    gain: float
    gain_without: float
    pole: float
    pole_without: float
    lowest: float
    highest: float

    @property
    def gain_change(self) -> float:
        """What giving the assumption up does to the gain, relative to it."""
        return self.gain_without / self.gain - 1

    @property
    def pole_change(self) -> float:
        """What giving the assumption up does to the friction pole, relative to it."""
        return self.pole_without / self.pole - 1


@dataclass(frozen=True, slots=True)
class _View:
    """A graph, the angle that is watched, and the motor torques that act, with sign.

    ``angles`` are the joints whose angles its states are.
    """

    graph: FinishedGraph
    output: str
    torques: Mapping[str, int]
    angles: Mapping[str, str] = field(default_factory=lambda: _BOTH)

    def gain_and_pole(self, posture: Posture) -> tuple[float, float]:
        at = {state: posture[joint] for state, joint in self.angles.items()}
        system = state_space(self.graph, at=at)
        B = np.sum(
            [
                sign * system.B[:, system.inputs.index(torque)]
                for torque, sign in self.torques.items()
            ],
            axis=0,
        )
        C = system.C[system.outputs.index(self.output)]
        # θ/T = gain / (s² + pole s + …): the first two terms for large s.
        gain, falling = C @ system.A @ B, C @ system.A @ system.A @ B
        return float(gain), float(-falling / gain)


def assumptions(parameters: ParameterSet = RECONCILED) -> tuple[Assumption, ...]:
    """Return the assumptions of the four printed models, one step after the other.

    Of each model the first rows lead from the printed form to the whole leg, each
    giving up one assumption more; the other rows vary the whole leg.
    """
    return (
        *_lowerleg_flight(parameters),
        *_upperleg_flight(parameters),
        *_stance("knee", parameters),
        *_stance("hip", parameters),
    )


def _lowerleg_flight(parameters: ParameterSet) -> Iterator[Assumption]:
    hanging = _seen(hanging_leg(parameters).finish(), "knee")
    flying = _seen(flying_leg(parameters).finish(), "knee")
    held = _seen(locked(hanging_leg(parameters), "hip"), "knee")
    steps = (
        ("the hip does not move", held, hanging),
        ("the support does not move", hanging, flying),
    )
    yield from _steps("lowerleg_flight", steps, flight_postures(), flying)


def _upperleg_flight(parameters: ParameterSet) -> Iterator[Assumption]:
    hanging = _seen(hanging_leg(parameters).finish(), "hip")
    flying = _seen(flying_leg(parameters).finish(), "hip")
    held = _seen(locked(hanging_leg(parameters), "knee"), "hip")
    fixed = _View(
        rigid_leg(parameters).finish().with_parameters({"g": 0.0}),
        "theta_hip",
        {"T_hip": 1},
        {"q_hip": "hip"},
    )
    steps = (
        ("the lower leg is a point mass fixed to the upper leg", fixed, held),
        ("the lower leg keeps its absolute angle", held, hanging),
        ("the support does not move", hanging, flying),
    )
    yield from _steps("upperleg_flight", steps, flight_postures(), flying)


def _stance(joint: str, parameters: ParameterSet) -> Iterator[Assumption]:
    model = {"knee": "lowerleg_stance", "hip": "upperleg_stance"}[joint]
    printed = getattr(nonlinear_stance, model)(parameters).finish()
    alone = standing_leg(parameters, drives=(joint,)).finish()
    standing = standing_leg(parameters).finish()
    other = next(j for j in JOINTS if j != joint)
    lone = _View(printed, "theta", {"T_motor": 1}, {"q_joint": joint})
    one, full = _seen(alone, joint), _seen(standing, joint)
    both = _seen(standing, joint, {f"T_{joint}": 1, f"T_{other}": -1})
    sliding = _seen(sliding_leg(parameters).finish(), joint)
    steps = (
        ("the links move as the support does and do not turn", lone, one),
        ("the other motor has no inertia", one, full),
        ("the other motor gives no torque (else: the opposite)", full, both),
        ("the foot does not slip (else: ground without friction)", full, sliding),
    )
    yield _constant(model, "the lever is 2 L sin θ0", lone, stance_postures())
    yield from _steps(model, steps, stance_postures(), full)


def _seen(
    graph: FinishedGraph, joint: str, torques: Mapping[str, int] | None = None
) -> _View:
    """Return the view of a planar leg that its own motor drives, weights left out."""
    weightless = graph.with_parameters({"g": 0.0})
    return _View(weightless, f"theta_{joint}", torques or {f"T_{joint}": 1})


def _steps(
    model: str,
    steps: tuple[tuple[str, _View, _View], ...],
    postures: tuple[Posture, ...],
    full: _View,
) -> Iterator[Assumption]:
    """Return the steps, and last that the whole leg is the same at every posture."""
    for statement, view, freer in steps:
        changes = [
            freer.gain_and_pole(there)[0] / view.gain_and_pole(there)[0] - 1
            for there in postures
        ]
        yield _assumption(model, statement, view, freer, changes)
    yield _constant(model, "the mass matrix is constant", full, postures)


def _constant(
    model: str, statement: str, view: _View, postures: tuple[Posture, ...]
) -> Assumption:
    """Return what it costs to take a view everywhere as it is at θ0."""
    gain, _ = view.gain_and_pole(printed_posture())
    changes = [view.gain_and_pole(there)[0] / gain - 1 for there in postures]
    return _assumption(model, statement, view, view, changes)


def _assumption(
    model: str, statement: str, view: _View, freer: _View, changes: list[float]
) -> Assumption:
    gain, pole = view.gain_and_pole(printed_posture())
    gain_without, pole_without = freer.gain_and_pole(printed_posture())
    return Assumption(
        model=model,
        statement=statement,
        gain=gain,
        gain_without=gain_without,
        pole=pole,
        pole_without=pole_without,
        lowest=min(changes),
        highest=max(changes),
    )
