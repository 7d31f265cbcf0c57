"""What a diagnosis answers: frozen records, ranked evidence, and the verdict.

The JSON form of these records is a contract; see `Diagnosis.to_dict`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.experiment.records import Experiment
from bondgraph.fitting.result import Estimate, FitResult, Score
from bondgraph.physics.names import name_of, name_with
from bondgraph.structure.graph import FinishedGraph

SCHEMA = 1


class Verdict(StrEnum):
    """The four answers of a diagnosis."""

    ADEQUATE = "adequate"
    PHYSICS_MISSING = "physics_missing"
    UNEXPLAINED = "unexplained"
    CANNOT_TELL = "cannot_tell"


class Support(StrEnum):
    """What the left-out training blocks say of one candidate."""

    SUPPORTED = "supported"
    UNDECIDED = "undecided"
    REFUTED = "refuted"


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """One candidate (physics at a place), refitted and judged on left-out blocks.

    Parameters
    ----------
    gain, gain_std
        Mean relative reduction of the squared error on left-out training blocks
        against the model without the candidate, and its standard error.
    train_nrmse, held_out_nrmse
        Simulation error; the held-out one is filled in once, at the end, to show.
    reason
        Why it was chosen or not, in one sentence.
    domain
        The name of the domain there, whose words tell it.
    """

    physics: str
    place: str
    law: str
    support: Support
    gain: float
    gain_std: float
    train_nrmse: float
    reason: str
    held_out_nrmse: float | None = None
    estimates: tuple[Estimate, ...] = ()
    domain: str = ""

    @property
    def name(self) -> str:
        """How a sentence calls the physics."""
        return name_of(self.physics, self.domain)


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """A piece of physics that was left out, with what it could be confused with.

    Parameters
    ----------
    probability
        That it is this physics, here or at a place that is not told from it: the share
        of resamples of the left-out chunks in which it predicts best, less the doubt
        that no resampling sees (0.85 at most); None where it was not judged.
    in_proportion
        Those of its numbers that are known only in proportion to the model's own
        parameters, of which the recordings leave a scale open.
    domain
        The name of the domain there, whose words tell it.
    other_end
        The second junction of what joins two; empty for what sits at one place.
    """

    physics: str
    place: str
    element: str
    statement: str
    law: str
    indistinguishable_places: tuple[str, ...] = ()
    alternatives: tuple[Evidence, ...] = ()
    estimates: tuple[Estimate, ...] = ()
    in_proportion: tuple[str, ...] = ()
    probability: float | None = None
    domain: str = ""
    other_end: str = ""

    @property
    def name(self) -> str:
        """How a sentence calls the physics, as its numbers have it."""
        numbers = {estimate.name: estimate.value for estimate in self.estimates}
        return name_with(numbers, self.physics, self.domain)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Simulation error before and after the findings were inserted."""

    before: Score
    after: Score


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """One output channel of one held-out recording: measured, before and after.

    Of a `steady` one, a table of operating points, the time merely counts the rows.
    """

    recording: str
    channel: str
    unit: str
    time: NDArray[np.float64]
    measured: NDArray[np.float64]
    before: NDArray[np.float64]
    after: NDArray[np.float64]
    steady: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LawCurve:
    """Another law that was judged at the same place, as it was fitted there."""

    physics: str
    argument: NDArray[np.float64]
    value: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecoveredLaw:
    """The missing effort (or flow) recovered at a place, against a local variable.

    ``argument`` and ``value`` are the data cloud (one point per knot of the recovered
    signal, none where a curve changes a law); ``curve_argument`` and ``curve_value``
    the law of the finding over the range visited, empty when no law was found.
    ``others`` are the curves of other laws judged there, best first.
    """

    place: str
    argument_name: str
    argument_unit: str
    value_name: str
    value_unit: str
    argument: NDArray[np.float64]
    value: NDArray[np.float64]
    curve_argument: NDArray[np.float64]
    curve_value: NDArray[np.float64]
    others: tuple[LawCurve, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """The ranked answer.

    Parameters
    ----------
    statement
        The verdict as one sentence or two a person can read.
    noise_floor
        Estimated measurement noise per output channel, in its unit.
    false_alarm_probability
        The chance of reporting a finding when nothing is missing, as used.
    blame
        For each junction, the share of the base model's error that a missing effort
        (or flow) there could explain; 0 to 1.
    fit_before, fit_after
        The base model and the improved one, fitted to the training recordings.
    fit_all
        The improved model refitted on all recordings once everything was chosen and
        shown; the one to use from here. None where time ran out, or where a note says
        that it could not be fitted so.
    next_experiment
        In words, what would separate what could not be told apart; empty where
        everything was.
    experiment
        The input to play for that, designed by simulating what is left close; None
        where nothing is, or where there is no time or no input to design.
    model_before, model
        The fitted base model and the improved one (the same when adequate).
    complete
        Whether all was tried; False where a time limit ended the search before.
    provenance
        Versions, seeds, data hashes, settings.
    """

    verdict: Verdict
    statement: str
    findings: tuple[Finding, ...]
    train: Comparison
    held_out: Comparison
    noise_floor: Mapping[str, float]
    false_alarm_probability: float
    next_experiment: str
    candidates: tuple[Evidence, ...]
    blame: Mapping[str, float]
    fit_before: FitResult
    fit_after: FitResult
    fit_all: FitResult | None = None
    traces: tuple[Trace, ...] = ()
    recovered: tuple[RecoveredLaw, ...] = ()
    notes: tuple[str, ...] = ()
    experiment: Experiment | None = None
    complete: bool = True
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def model_before(self) -> FinishedGraph:
        """The base model, fitted."""
        return self.fit_before.model

    @property
    def model(self) -> FinishedGraph:
        """The improved model, fitted."""
        return self.fit_after.model
