"""What `next_experiment` answers: an input to play, a sensor to add, their worth."""

from dataclasses import dataclass
from enum import StrEnum
from io import StringIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bondgraph.recordings.names import join_header
from bondgraph.recordings.recording import Recording

DIGITS = 9
"""Of a number to be played."""


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
    between
        The alternatives in words; empty where they have none.
    """

    status: ExperimentStatus
    statement: str
    sigmas: float
    recorded_sigmas: float
    input: Recording
    inputs: tuple[InputProposal, ...]
    sensors: tuple[SensorAddition, ...]
    between: tuple[str, ...] = ()

    @property
    def csv(self) -> str:
        """The input to play as CSV text, with names and units in its header."""
        columns = self.columns
        rows = np.column_stack(list(columns.values()))
        text = StringIO()
        np.savetxt(
            text,
            rows,
            delimiter=",",
            header=",".join(columns),
            comments="",
            fmt=f"%.{DIGITS}g",
        )
        return text.getvalue()

    @property
    def columns(self) -> dict[str, NDArray[np.float64]]:
        """The input to play: time, then each input, by name with unit."""
        played = self.input
        channels = {join_header(c.name, c.unit): c.values for c in played.channels}
        return {join_header("time", "s"): played.time, **channels}

    def write_csv(self, path: str | Path) -> None:
        """Write the input to play as CSV with names and units in its header."""
        Path(path).write_text(self.csv, encoding="utf-8")
