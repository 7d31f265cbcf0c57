"""Design by optimisation: the best controller of a structure that keeps requirements.

The search runs on a grid (see `search`); its answer is then measured on the exact
response of every loop. What fails there by what the grid missed is asked for with that
much more, at the frequencies that were missed, and the search goes on. Nothing is
called met that the exact response does not meet.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import measure
from bondgraph.loopshaping.requirements import AbstractRequirement, Assessment
from bondgraph.loopshaping.synthesis.answer import OptimisedController, answer
from bondgraph.loopshaping.synthesis.gridded import family_grid
from bondgraph.loopshaping.synthesis.objectives import (
    AbstractObjective,
    FastestCrossover,
)
from bondgraph.loopshaping.synthesis.search import Search
from bondgraph.loopshaping.synthesis.structure import ControllerStructure
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

ROUNDS = 5  # of asking for more where the grid was too coarse
NEAR = 0.05  # an excess from which more rounds may still succeed
SAME = 1e-6  # an excess that is none
KEPT = 2  # solutions that are measured exactly


def optimise_controller(
    loops: Loop | Sequence[Loop],
    structure: ControllerStructure,
    requirements: Sequence[AbstractRequirement],
    *,
    objective: AbstractObjective | None = None,
    crossover: tuple[float, float] | None = None,
    begin: Sequence[ZeroPoleGain] = (),
    starts: int = 5,
    seed: int = 0,
) -> OptimisedController:
    """Return the best controller of a structure that keeps requirements.

    Parameters
    ----------
    loops
        One loop, or several that one controller must serve, the nominal one first.
        Their own controllers are left out.
    requirements
        Kept by every loop.
    objective
        The fastest crossover of the slowest loop, if not given.
    crossover
        Range (rad/s) in which the nominal crossover is searched; the structure's range
        otherwise.
    begin
        Controllers to start from beside the random ones.
    starts, seed
        How many random starts, and what they are drawn from.

    Raises
    ------
    LoopShapingError
        If there is no loop, or one is sampled (design in continuous time with the delay
        that sampling adds).
    """
    family = [loops] if isinstance(loops, Loop) else list(loops)
    _check(family)
    low, high = crossover or (structure.slowest, structure.fastest)
    search = Search(
        loops=family,
        grid=family_grid(family, structure, around=(low * high) ** 0.5),
        requirements=requirements,
        objective=objective or FastestCrossover(),
        bounds=((math.log(low), math.log(high)), *structure.bounds),
        slack=np.zeros(len(requirements)),
    )
    points = [_point(structure, family[0], one) for one in begin]
    points += search.starts(np.random.default_rng(seed), starts)
    candidates = [_exact(search, x) for x in _solved(search, points)]
    good = [c for c in candidates if c.met]
    best = min(candidates, key=lambda c: c.worst)
    for other in good:
        value, best_value = (c.value(search.objective) for c in (other, best))
        best = other if search.objective.better(value, best_value) else best
    return answer(
        best.controller,
        best.loops,
        requirements,
        search.objective,
        starts=starts,
        seed=seed,
    )


def _check(family: Sequence[Loop]) -> None:
    if not family:
        raise LoopShapingError("There is no plant.", remedy="Give at least one loop.")
    if any(one.period is not None for one in family):
        raise LoopShapingError(
            "A sampled loop cannot be optimised as it is.",
            remedy="Give the continuous plant with a delay of half a period plus the "
            "computing time, and discretise the controller.",
        )


def _point(
    structure: ControllerStructure, loop: Loop, controller: ZeroPoleGain
) -> FloatArray:
    """Return the numbers of a given controller in its loop."""
    measures = measure(replace(loop, controller=controller), step=False)
    first = max(measures.crossover, structure.slowest)
    return np.append(np.log(first), structure.numbers(controller))


def _solved(search: Search, points: Sequence[FloatArray]) -> list[FloatArray]:
    """Return the best local solutions."""
    found = [search.best(x) for x in points]
    return sorted(found, key=search.merit)[:KEPT]


@dataclass(frozen=True, slots=True, eq=False)
class _Candidate:
    """One controller in every loop; violations are ``[loop, requirement]``, exact."""

    controller: ZeroPoleGain
    loops: tuple[Loop, ...]
    assessments: tuple[Assessment, ...]
    violations: FloatArray
    stable: bool
    met: bool

    @property
    def worst(self) -> float:
        most = float(self.violations.max(initial=-math.inf))
        return most if self.stable else math.inf

    def value(self, objective: AbstractObjective) -> float:
        values = [objective.value(one) for one in self.assessments]
        worst = values[0]
        for other in values[1:]:
            worst = other if objective.better(worst, other) else worst
        return worst


def _measured(search: Search, x: FloatArray) -> _Candidate:
    controller = search.controller(x)
    loops = tuple(replace(one, controller=controller) for one in search.loops)
    assessed = tuple(Assessment(one) for one in loops)
    stable = all(one.stable for one in assessed)
    asked = search.requirements
    violations = np.array([[r.violation(one) for r in asked] for one in assessed])
    met = bool(violations.max(initial=-math.inf) <= SAME)
    return _Candidate(controller, loops, assessed, violations, stable, stable and met)


def _exact(search: Search, x: FloatArray) -> _Candidate:
    """Return a candidate measured, after asking for more where the grid missed."""
    candidate = _measured(search, x)
    for _ in range(ROUNDS):
        if candidate.met or not candidate.worst <= NEAR:
            break
        missed = candidate.violations.max(axis=0)
        around = math.exp(x[0])
        more = [
            omega
            for one in candidate.assessments
            for omega in (one.sensitivity.omega, one.complementary.omega, around)
            if 1e-3 * around < omega < 1e3 * around
        ]
        structure = search.grid.structure
        search = replace(
            search,
            grid=family_grid(search.loops, structure, around=around, more=more),
            slack=search.slack + np.where(missed > 0, 1.1 * missed + 1e-6, 0.0),
        )
        x = search.best(x)
        candidate = _measured(search, x)
    return candidate
