"""What the sensors could tell apart at all, said beside each finding.

A free signal is the least that can be claimed to be missing at a place. Where free
signals at two places do the same to the sensors, only the law that was found speaks for
one of them.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.answer.untried import unread_inputs
from bondgraph.diagnosis.answer.wording import listed
from bondgraph.diagnosis.records import Finding
from bondgraph.diagnosis.separability.records import SensorProposal, Separability
from bondgraph.diagnosis.separability.separability import separability
from bondgraph.errors import BondGraphError
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording


def look_alikes(
    findings: Sequence[Finding],
    base: FittedModel,
    recordings: Sequence[BoundRecording],
) -> tuple[str, ...]:
    """Return a note per class of places that a finding lies in, and on unseen places.

    Nothing where nothing was found; where the places cannot be compared, why not.

    Parameters
    ----------
    base
        The model before anything was added.
    """
    if not findings:
        return ()
    try:
        told = separability(base, recordings)
    except (BondGraphError, np.linalg.LinAlgError, FloatingPointError) as error:
        return (f"Which places these sensors can tell apart is not known: {error}",)
    notes = [
        _alike(told, told.class_of(finding.place))
        for finding in findings
        if finding.place in told.places and len(told.class_of(finding.place)) > 1
    ]
    idle = {
        name
        for source in unread_inputs(base.graph)
        for name in (source, base.graph.bonds_at(source)[0].other(source))
    }
    undetectable = [place for place in told.undetectable if place not in idle]
    if undetectable:
        unseen = listed(undetectable, "and")
        notes.append(
            f"No sensor would show what is missing at {unseen}: a "
            "free signal there disturbs nothing that these sensors check."
        )
    return tuple(dict.fromkeys(notes))


def _alike(told: Separability, members: Sequence[str]) -> str:
    best = next((p for p in told.proposals if p.splits == members), None)
    sensor = (
        "no one further effort or flow sensor at a junction would tell them apart."
        if best is None
        else _sensor_words(best)
    )
    places = listed(members, "and")
    return (
        f"Before any law: free signals at {places} look alike to these "
        f"sensors; {sensor}"
    )


def _sensor_words(best: SensorProposal) -> str:
    parts = " from ".join(listed(part) for part in best.into)
    return f"measuring the {best.quantity} at {best.place} would tell {parts}."
