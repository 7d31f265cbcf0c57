"""What `adequacy` answers: numbers per output, what residuals follow, and a status."""

from dataclasses import dataclass
from enum import StrEnum


class AdequacyStatus(StrEnum):
    """The answer; the value is the sentence to show."""

    ADEQUATE = "What the model leaves looks like measurement noise."
    COLOURED = (
        "What the model leaves is not white, but follows nothing that the model knows: "
        "coloured noise of the sensors and a stationary disturbance of the machine "
        "look alike here."
    )
    STRUCTURE = (
        "What the model leaves follows what the machine does: structure is missing."
    )
    NOT_CONVERGED = (
        "The fit is not at its optimum: parameters can still remove what is left, so "
        "that nothing can be said of structure."
    )
    TOO_FEW_SAMPLES = "There are too few samples to say anything of what is left."


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputCheck:
    """One output: its noise and what is left of it.

    Parameters
    ----------
    noise
        Standard deviation of the white measurement noise estimated from the recordings
        alone; None for a steady table.
    noise_is_white
        Whether it is seen to be; if not, `noise` is a lower bound.
    quantisation
        Step of the channel's grid, None where there is none.
    residual
        Root mean square residual of the fit.
    white_p_value
        Of a portmanteau test of the residual against white noise, calibrated by
        simulation; None for a steady table.
    noise_order
        Order of the autoregression that describes the residual.
    correlation
        Autocorrelation of the residual from one sample to the next.
    """

    name: str
    unit: str
    noise: float | None
    noise_is_white: bool
    quantisation: float | None
    residual: float
    white_p_value: float | None
    noise_order: int
    correlation: float

    @property
    def ratio(self) -> float | None:
        """Residual over noise."""
        if self.noise is None or not self.noise > 0.0:
            return None
        return self.residual / self.noise


@dataclass(frozen=True, slots=True, kw_only=True)
class Dependence:
    """How far the residual follows one family of functions of one signal.

    Parameters
    ----------
    place
        Junction, input or output at which the functions act, through the model.
    form, variable
        ``form variable`` reads as the function.
    share
        Of the residual that they explain, parameters and initial states allowed for.
    p_value
        By itself, of the F test of the whitened residual for white noise;
        `Adequacy.p_value` allows for the number of families and for the noise.
    """

    place: str
    form: str
    variable: str
    share: float
    p_value: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Adequacy:
    """Whether a fitted model leaves more than noise.

    Parameters
    ----------
    p_value
        Chance that noise like the residual's own (coloured, quantised) would follow
        some family as closely as the residual does, by simulation.
    level
        The false-alarm probability asked for: structure is claimed at or below it.
    draws
        How many simulations p_value comes from.
    dependences
        The families tried, the strongest first; the first one decided.
    unconverged
        Share of the squared residual that a further step of the fit promises to remove.
    reasons
        Sentences: which statistic decided, and what cannot be told.
    """

    status: AdequacyStatus
    p_value: float
    level: float
    draws: int
    outputs: tuple[OutputCheck, ...]
    dependences: tuple[Dependence, ...]
    unconverged: float
    reasons: tuple[str, ...]

    @property
    def deciding(self) -> Dependence | None:
        """The family that the residual follows most surely."""
        return self.dependences[0] if self.dependences else None

    def output(self, name: str) -> OutputCheck:
        """Return the check of the output called `name`."""
        return next(one for one in self.outputs if one.name == name)
