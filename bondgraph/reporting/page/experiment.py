"""The next experiment on the page: the signal to play, and what else was considered."""

from dataclasses import dataclass

import numpy as np

from bondgraph.diagnosis.experiment.records import Experiment
from bondgraph.reporting.charts import Chart, Curve, chart
from bondgraph.reporting.wording import number_words, unit_words, with_unit

DIGITS = 3
MOST_INPUTS = 6
"""Signals considered that are worth a row: the best."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExperimentPicture:
    """A designed experiment: charts of the inputs that move, tables, CSV to copy.

    Parameters
    ----------
    resting
        Inputs that do not move, each with its value.
    inputs, sensors
        Rows of what was considered with the sigmas expected of it.
    """

    experiment: Experiment
    charts: tuple[Chart, ...]
    resting: tuple[str, ...]
    inputs: tuple[tuple[str, str], ...]
    sensors: tuple[tuple[str, str], ...]


def experiment_picture(experiment: Experiment | None) -> ExperimentPicture | None:
    """Return everything the page shows of a designed experiment; None without one."""
    if experiment is None:
        return None
    played = experiment.input
    still = [c for c in played.channels if not np.ptp(c.values) > 0.0]
    return ExperimentPicture(
        experiment=experiment,
        charts=tuple(
            chart(
                [Curve(c.name, "after", played.time, c.values)],
                title=f"{c.name} to play",
                description=(
                    f"{played.name}: {c.name} from {number_words(c.values.min())} to "
                    f"{number_words(c.values.max())} {unit_words(c.unit)}"
                ),
                x_label="time [s]",
                y_label=f"{c.name} [{unit_words(c.unit)}]",
                frame=(c.name,),
            )
            for c in played.channels
            if np.ptp(c.values) > 0.0
        ),
        resting=tuple(
            f"{c.name} at {with_unit(number_words(float(c.values[0])), c.unit)}"
            for c in still
        ),
        inputs=tuple(
            (one.name, number_words(one.sigmas, DIGITS))
            for one in experiment.inputs[:MOST_INPUTS]
        ),
        sensors=tuple(
            (f"{one.quantity} at {one.place}", number_words(one.sigmas, DIGITS))
            for one in experiment.sensors
        ),
    )
