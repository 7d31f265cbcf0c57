"""Inputs that were rounded as they were recorded: what they did within a step is lost.

A log with one decimal of the current is off by up to half of its last digit. A store
adds that up, and what bends the current by as little explains some of the sum.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.answer.doubt import less_probable
from bondgraph.diagnosis.probing import probe
from bondgraph.diagnosis.records import Finding
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.recordings.noise import quantisation
from bondgraph.structure.edits import WrapInput

LEFT = 0.25
"""What is left of the probability of a law that lies within the rounding."""

FINE = 0.005
"""Of all that an input goes through: a coarser step may be that of its commands."""


def doubted_within_rounding(
    findings: Sequence[Finding], made: Sequence[Round]
) -> list[Finding]:
    """Return the findings, less probable where they change an input by a digit only.

    Parameters
    ----------
    made
        The rounds that have found them, one each.
    """
    return [_told(*both) for both in zip(findings, made, strict=True)]


def _told(finding: Finding, found: Round) -> Finding:
    step = covering_step(found)
    if step is None:
        return finding
    why = (
        f" It changes {finding.place} by no more than the step of {step:.3g} to which "
        "that was rounded when it was recorded, and may be no more than that rounding. "
        "Record it with more digits."
    )
    return less_probable(finding, LEFT, why)


def covering_step(found: Round) -> float | None:
    """Return the step of a rounded input that covers what a law changes; None else.

    A law that remembers, such as a delay, is none of the kind: between samples it
    changes what jumps by whole jumps.
    """
    chosen = found.chosen
    assert chosen is not None
    fitted, edit = chosen.candidate.fitted, chosen.candidate.hypothesis.edit
    if not isinstance(edit, WrapInput) or edit.states:
        return None
    column = fitted.problem.model.input_names.index(edit.input)
    given = fitted.problem.shots.inputs[:, column]
    step = quantisation(given)
    if step is None or step > FINE * np.ptp(given[np.isfinite(given)]):
        return None
    change = probe(fitted, (edit.value,))[edit.value] - given
    return step if np.nanmax(np.abs(change)) <= step else None
