"""A candidate with what left-out data say of it, and the rule by which it is judged.

It is *supported* when its gain on left-out chunks is significant after the number of
candidates tried, and material.
"""

from dataclasses import dataclass

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.gain import Gain, compare
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.names import name_of

TYPICAL = {
    "hydraulic": frozenset({"square_root_orifice", "leak", "overflow"}),
    "electrical": frozenset({"voltage_drop", "saturating_inertia"}),
    "thermal": frozenset({"lag", "radiation", "leak"}),
    "rotation": frozenset({"coulomb_friction", "load_dependent_friction"}),
    "translation": frozenset({"coulomb_friction"}),
}
"""What models of each domain leave out most often, and so the first thing to say."""


@dataclass(frozen=True, slots=True)
class Rule:
    """The thresholds of a decision.

    Parameters
    ----------
    false_alarm_probability
        Chance, per round, of accepting anything when nothing is missing.
    materiality
        Least relative reduction of the squared error that is worth a finding.
    order
        Physics from plain to particular: of laws that predict alike, the first is told.
    """

    false_alarm_probability: float = 0.01
    materiality: float = 0.1
    order: tuple[str, ...] = tuple(physics.word for physics in LIBRARY)

    def plainness(self, judged: "Judged") -> tuple[bool, int]:
        """Return how far-fetched the physics is: what is typical of a domain comes
        first, then what comes first in the library.
        """  # noqa: D205  (one sentence)
        known = judged.physics in self.order
        place = self.order.index(judged.physics) if known else len(self.order)
        typical = TYPICAL.get(judged.domain, frozenset())
        return judged.physics not in typical, place


@dataclass(frozen=True, slots=True)
class Judged:
    """A candidate with its left-out errors and what follows from them.

    Parameters
    ----------
    open
        Whether the final fit does not tell what it adds to a plainer law that is told.
    """

    candidate: Candidate
    errors: LeftOutErrors
    gain: Gain
    support: Support
    reason: str
    open: bool = False

    @property
    def physics(self) -> str:
        """The word for the physics."""
        return self.candidate.told.physics

    @property
    def name(self) -> str:
        """How a sentence calls the physics."""
        return name_of(self.physics, self.domain)

    @property
    def domain(self) -> str:
        """The name of the domain there; empty where the place has none."""
        domains = self.candidate.fitted.graph.domains_at(self.place)
        return domains[0].name if domains else ""

    @property
    def place(self) -> str:
        """The place."""
        return self.candidate.hypothesis.place


def judge(
    candidate: Candidate,
    base: LeftOutErrors,
    errors: LeftOutErrors,
    tried: float,
    rule: Rule,
) -> Judged:
    """Return what the left-out chunks say of one candidate among `tried`."""
    gain = compare(base, errors)
    corrected = gain.p_value * max(tried, 1.0)
    enough = gain.value >= rule.materiality
    sure = corrected <= rule.false_alarm_probability
    if enough and sure:
        support, reason = Support.SUPPORTED, f"reduces the left-out error by {gain}"
    elif gain.value <= 0.0 or gain.value + 2 * gain.std < rule.materiality:
        support = Support.REFUTED
        reason = f"changes the left-out error by {gain}, too little to matter"
    elif enough:
        support = Support.UNDECIDED
        reason = f"{gain} is not significant among {tried:.0f} candidates"
    elif sure:
        support = Support.UNDECIDED
        reason = f"{gain} may be too little to matter"
    else:
        support = Support.UNDECIDED
        reason = f"{gain} could be nothing"
    return Judged(candidate, errors, gain, support, reason)


def is_by_itself(judged: Judged, rule: Rule) -> bool:
    """Return whether an undecided law would be supported, had it been tried alone."""
    gain = judged.gain
    enough = gain.value >= rule.materiality
    sure = gain.p_value <= rule.false_alarm_probability
    return judged.support is Support.UNDECIDED and enough and sure
