"""The choices of a diagnosis."""

from dataclasses import dataclass, field
from pathlib import Path

from bondgraph.choices import refuse_other
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.work.workers import Here, Where
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import FitSettings
from bondgraph.physics.hypothesis import AbstractPhysics
from bondgraph.physics.library import LIBRARY
from bondgraph.simulation.solvers import Hold


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """Choices of a diagnosis.

    Parameters
    ----------
    settings
        Of the fits.
    rule
        When a candidate counts.
    library
        The physics considered.
    fitted, judged
        How many hypotheses per round are fitted, and judged on left-out data, at most.
    most_findings
        Stop after so many.
    where
        Where hypotheses are tried: here, in processes, on an executor.
    resume
        A directory for the journal of what has been worked out: a diagnosis that was
        interrupted goes on from there. None for no journal.
    either_hold
        Whether inputs may behave between samples as suits the base model better; False
        for as `settings` say. None for False where these say that inputs are held, and
        True where they say nothing: what is held but taken for joined looks like a
        delay.
    seconds
        After so many the search ends: what stands by then is the answer, and says that
        it was cut short. None for as long as it takes.

    Raises
    ------
    FitError
        If one of the objects is none of its family, such as a word.
    """

    settings: FitSettings = field(default_factory=FitSettings)
    rule: Rule = field(default_factory=Rule)
    library: tuple[AbstractPhysics, ...] = LIBRARY
    fitted: int = 40
    judged: int = 10
    most_findings: int = 5
    where: Where = field(default_factory=Here)
    resume: Path | None = None
    either_hold: bool | None = None
    seconds: float | None = None

    @property
    def recordings_decide_hold(self) -> bool:
        """Whether inputs may behave between samples as suits the base model better."""
        if self.either_hold is None:
            return self.settings.hold is Hold.FIRST
        return self.either_hold

    def __post_init__(self) -> None:
        refuse_other(self.settings, FitSettings, "What is to set the fits", FitError)
        refuse_other(self.where, Where, "Where a diagnosis is to work", FitError)
        refuse_other(self.rule, Rule, "The rule of a diagnosis", FitError)
