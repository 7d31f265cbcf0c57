"""What `locate` answers: places ranked by how lawful the missing signal is there."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.location.laws import Form
from bondgraph.diagnosis.virtual.sources import PlaceKind

Array = NDArray[np.float64]


class LocationStatus(StrEnum):
    """What the ranking says; the value is the sentence to show."""

    ONE_PLACE = "At one place the missing signal is a law of what is local there."
    SEVERAL_PLACES = (
        "At several places the missing signal is a law of what is local there, and "
        "these recordings do not tell them apart."
    )
    NO_LAW = (
        "At no place does the missing signal follow a law of what is local there, "
        "though something is missing."
    )
    NOTHING = "No law at any place predicts left-out samples better than the model."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Relation:
    """A family of laws at a place, judged on samples it was not fitted to.

    Parameters
    ----------
    form, variable, unit
        ``form variable`` reads as what the missing signal is.
    share
        Of the base model's squared error, on left-out chunks, that it removes together
        with the parameters refitted.
    left
        What is left, per chunk, in squares of the noise, divided by the samples.
    argument, curve
        The fitted curve over the range visited, in the units of its variable and of the
        place's signal (of its integral, for a rate). What free parameters of the model
        can give as well is not determined by it.
    odd
        Share of the curve that is odd in its variable; None where it keeps one sign.
    signal
        What the fitted law gives, one value per sample.
    """

    form: Form
    variable: str
    unit: str
    share: float
    left: Array
    argument: Array
    curve: Array
    odd: float | None
    signal: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlaceEvidence:
    """What is missing at one place, if it is missing there.

    Parameters
    ----------
    evidence
        Gain in log likelihood of a free signal there, in nats. Not a probability, and
        alike for places that these sensors cannot separate.
    signal, std
        The recovered signal (`unit`; positive into the junction), one value per sample
        in the order of the recordings, and its standard deviation.
    power
        Between -1 (the signal takes power out of the place throughout, as an R does)
        and 1; None at channels.
    relations
        Laws tried there, the best first.
    theta
        The free parameters as the smoothing has them, by name.
    """

    place: str
    kind: PlaceKind
    unit: str
    evidence: float
    signal: Array
    std: Array
    power: float | None
    relations: tuple[Relation, ...]
    theta: dict[str, float]

    @property
    def best(self) -> Relation:
        """The law that predicts best, or as well as the best and is plainer."""
        return self.relations[0]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Location:
    """Places ranked by how simply the missing signal depends on what is local.

    Parameters
    ----------
    places
        Best first.
    leading
        Names of the places that the first one does not beat by two standard errors.
    time
        Seconds of every sample of the signals, recordings one after the other.
    noise
        Noise per output that everything is measured in.
    reasons
        Sentences.
    """

    status: LocationStatus
    places: tuple[PlaceEvidence, ...]
    leading: tuple[str, ...]
    time: Array
    noise: dict[str, float]
    reasons: tuple[str, ...]

    def at(self, place: str) -> PlaceEvidence:
        """Return the evidence at the place called `place`."""
        return next(p for p in self.places if p.place == place)
