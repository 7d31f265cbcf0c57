"""What `next_experiment` answers: an input to play, a sensor to add, their worth."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from bondgraph.recordings.names import join_header
from bondgraph.recordings.recording import Recording


class ExperimentStatus(StrEnum):
    """What the best experiment is worth; the value is the sentence to show."""

    DECISIVE = "This experiment tells the alternatives apart."
    WEAK = "The best experiment within these limits leaves the alternatives close."
    USELESS = "No input within these limits tells the alternatives apart."


@dataclass(frozen=True, slots=True, kw_only=True)
class InputProposal:
    """An input signal and by how much the alternatives would then differ.

    Parameters
    ----------
    name
        The kind of signal and the input that it drives.
    sigmas
        Root of the sum, over samples and outputs, of the squared difference over the
        noise, for the two alternatives that differ least, after each has adjusted its
        parameters (as far as the recordings leave them free) and its initial state.
    """

    name: str
    sigmas: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorAddition:
    """A further sensor with the recorded input, and the difference as for an input."""

    quantity: str
    place: str
    sigmas: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """The experiment that would separate alternatives best.

    Parameters
    ----------
    sigmas, recorded_sigmas
        Expected with `input`, and with the recording there is.
    input
        Time and inputs, to be played.
    inputs, sensors
        What was considered, the best first.
    """

    status: ExperimentStatus
    statement: str
    sigmas: float
    recorded_sigmas: float
    input: Recording
    inputs: tuple[InputProposal, ...]
    sensors: tuple[SensorAddition, ...]

    def write_csv(self, path: str | Path) -> None:
        """Write the input to play as CSV with names and units in its header."""
        played = self.input
        header = [join_header("time", "s")]
        header += [join_header(c.name, c.unit) for c in played.channels]
        rows = np.column_stack([played.time, *(c.values for c in played.channels)])
        np.savetxt(
            path, rows, delimiter=",", header=",".join(header), comments="", fmt="%.9g"
        )
