"""Robust shaping: one controller for the whole family, and proof by fresh draws.

Scenario optimisation: the controller is designed for the nominal plants, the corners
and some draws; then it is measured, exactly, on many further draws, and the plants that
it serves worst join the scenarios until none is served badly. The report comes from
draws that the design has never seen, so that the bound on the share of plants that
violate a requirement is the exact binomial one (Clopper and Pearson, 1934).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import beta

from bondgraph.loopshaping.requirements import AbstractRequirement, Assessment
from bondgraph.loopshaping.synthesis.answer import OptimisedController
from bondgraph.loopshaping.synthesis.excess import with_controller
from bondgraph.loopshaping.synthesis.family import Member, PlantFamily
from bondgraph.loopshaping.synthesis.objectives import AbstractObjective
from bondgraph.loopshaping.synthesis.optimise import optimise_controller
from bondgraph.loopshaping.synthesis.structure import ControllerStructure
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

QUANTILES = (0.01, 0.05, 0.5, 0.95, 0.99)
_JOINING = 4  # plants that join the scenarios in a round
_DESIGN, _SEARCH, _REPORT = 1, 2, 3  # which draws; the report's are never designed with


@dataclass(frozen=True, slots=True, kw_only=True)
class RequirementReport:
    """One requirement over many plants.

    Parameters
    ----------
    quantiles
        Of what is achieved, by probability.
    worst, worst_member
        What the worst plant achieves, and which one that is.
    violations
        Number of plants that violate it or are not stable.
    """

    name: str
    wanted: str
    unit: str
    quantiles: dict[float, float]
    worst: float
    worst_member: Member
    violations: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessReport:
    """What a controller does for plants drawn from a family.

    Parameters
    ----------
    samples, violations, unstable
        How many plants were drawn, violate any requirement, and are unstable.
    violated_at_most
        With this `confidence`, the share of all plants that violate any requirement
        is not above this.
    """

    controller: ZeroPoleGain
    samples: int
    violations: int
    unstable: int
    confidence: float
    violated_at_most: float
    requirements: tuple[RequirementReport, ...]
    seed: int

    def __str__(self) -> str:
        lines = [
            f"{self.samples} plants: {self.violations} violate a requirement, "
            f"{self.unstable} are unstable; with {100 * self.confidence:g} % "
            f"confidence at most {100 * self.violated_at_most:.3g} % of all plants do."
        ]
        for r in self.requirements:
            spread = ", ".join(
                f"{100 * p:g} %: {value:.4g}" for p, value in r.quantiles.items()
            )
            lines.append(f"  {r.name} ({r.unit or '1'}), {r.wanted}: {spread}")
            lines.append(f"    worst {r.worst:.4g} for {r.worst_member}")
        return "\n".join(lines)


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustController:
    """A design for a family, with its report on plants it was not designed with."""

    design: OptimisedController
    scenarios: tuple[Member, ...]
    report: RobustnessReport
    rounds: int

    @property
    def controller(self) -> ZeroPoleGain:
        """The controller."""
        return self.design.controller


def robust_controller(
    family: PlantFamily,
    structure: ControllerStructure,
    requirements: Sequence[AbstractRequirement],
    *,
    objective: AbstractObjective | None = None,
    crossover: tuple[float, float] | None = None,
    scenarios: int = 6,
    samples: int = 200,
    rounds: int = 4,
    starts: int = 3,
    confidence: float = 0.95,
    seed: int = 0,
) -> RobustController:
    """Return one controller that keeps requirements for all plants of a family.

    Parameters
    ----------
    objective, crossover, starts
        As in `optimise_controller`; the objective is that of the worst scenario.
    scenarios
        Plants drawn for the design beside nominal ones and corners.
    samples
        Plants drawn anew in each round to look for worse ones, and for the report.
    rounds
        How often worse plants may join the scenarios.
    """
    chosen = family.corners() + family.draw(scenarios, [seed, _DESIGN])
    begin: list[ZeroPoleGain] = []
    used = 0
    while True:
        used += 1
        design = optimise_controller(
            [m.loop for m in chosen],
            structure,
            requirements,
            objective=objective,
            crossover=crossover,
            begin=begin,
            starts=starts,
            seed=seed,
        )
        if used > rounds or not design.met:
            break
        fresh = family.draw(samples, [seed, _SEARCH, used])
        worse = _worse(design.controller, fresh, requirements)
        if not worse:
            break
        chosen += worse[:_JOINING]
    report = robustness(
        design.controller,
        family,
        requirements,
        samples=samples,
        confidence=confidence,
        seed=seed,
    )
    return RobustController(
        design=design, scenarios=tuple(chosen), report=report, rounds=used
    )


def _worse(
    controller: ZeroPoleGain,
    members: Sequence[Member],
    requirements: Sequence[AbstractRequirement],
) -> list[Member]:
    """Return the plants that violate a requirement, the worst first."""
    loops = with_controller([m.loop for m in members], controller)
    found = []
    for member, loop in zip(members, loops, strict=True):
        one = Assessment(loop)
        met = one.stable and all(r.verdict(one).met for r in requirements)
        if not met:
            most = max((r.violation(one) for r in requirements), default=0.0)
            found.append((most if one.stable else np.inf, member))
    return [member for _, member in sorted(found, key=lambda pair: -pair[0])]


def robustness(
    controller: ZeroPoleGain,
    family: PlantFamily,
    requirements: Sequence[AbstractRequirement],
    *,
    samples: int = 500,
    confidence: float = 0.95,
    seed: int = 0,
) -> RobustnessReport:
    """Return how a controller does for plants drawn from a family, each exactly."""
    members = family.draw(samples, [seed, _REPORT])
    loops = with_controller([m.loop for m in members], controller)
    assessed = [Assessment(loop) for loop in loops]
    stable = np.array([one.stable for one in assessed])
    verdicts = [[r.verdict(one) for r in requirements] for one in assessed]
    met = np.array([[v.met for v in row] for row in verdicts]).reshape(samples, -1)
    met &= stable[:, None]
    bad = int((~(met.all(axis=1) & stable)).sum())
    reports = []
    for k, requirement in enumerate(requirements):
        values = np.array([row[k].achieved for row in verdicts])
        violation = np.array([requirement.violation(one) for one in assessed])
        worst = int(np.where(stable, violation, np.inf).argmax())
        reports.append(
            RequirementReport(
                name=requirement.name,
                wanted=verdicts[0][k].wanted,
                unit=requirement.unit,
                quantiles=_quantiles(values),
                worst=float(values[worst]),
                worst_member=members[worst],
                violations=int((~met[:, k]).sum()),
            )
        )
    return RobustnessReport(
        controller=controller,
        samples=samples,
        violations=bad,
        unstable=int((~stable).sum()),
        confidence=confidence,
        violated_at_most=violated_at_most(bad, samples, confidence),
        requirements=tuple(reports),
        seed=seed,
    )


def _quantiles(values: FloatArray) -> dict[float, float]:
    found = np.quantile(values, QUANTILES, method="inverted_cdf")
    return dict(zip(QUANTILES, map(float, found), strict=True))


def violated_at_most(violations: int, samples: int, confidence: float) -> float:
    """Return the upper end of Clopper and Pearson's one-sided interval."""
    if violations >= samples:
        return 1.0
    return float(beta.ppf(confidence, violations + 1, samples - violations))
