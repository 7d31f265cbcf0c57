"""At jumps: what an input did between two samples is not recorded.

An input that was read, not commanded, is joined from sample to sample by straight
lines. Where it jumps these are wrong, and so is the simulation for the next sample or
two, whatever the machine. A law that explains little elsewhere may only mend that.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.answer.doubt import less_probable
from bondgraph.diagnosis.evidence.explained import share_explained
from bondgraph.diagnosis.records import Finding
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.estimate import FittedModel
from bondgraph.simulation.shots import Shots
from bondgraph.simulation.solvers import Hold

JUMP = 0.1
"""From one sample to the next, of all that an input goes through."""

RARE = 0.2
"""An input that jumps in more of the samples does not jump, it goes fast."""

MOSTLY = 0.6
"""A law that explains so much of what it explains there may only mend what is there."""

LEFT = 0.5
"""What is left of its probability: a judgement, from recordings of strangers."""

TIMING = frozenset({"delay", "lag"})
"""Laws that say themselves that something comes late."""


def doubted_at_jumps(
    findings: Sequence[Finding], made: Sequence[Round]
) -> list[Finding]:
    """Return the findings, less probable where they explain what follows jumps alone.

    Each for itself, or all of them together.

    Parameters
    ----------
    made
        The rounds that have found them, one each.
    """
    if not made:
        return list(findings)
    steps = [(one.base, _after(one)) for one in made]
    together = explained_at_jumps(steps[0][0], steps[-1][1])
    shares = [max(explained_at_jumps(*step), together) for step in steps]
    return [_told(*both) for both in zip(findings, shares, strict=True)]


def _told(finding: Finding, share: float) -> Finding:
    if finding.physics in TIMING or share < MOSTLY:
        return finding
    why = (
        f" {100 * share:.0f} % of what is explained lies within a sample of where an "
        "input jumps: what that did between two samples was not recorded, and may be "
        "all there is. Sample faster, or record the command and hold it."
    )
    return less_probable(finding, LEFT, why)


def explained_at_jumps(before: FittedModel, after: FittedModel) -> float:
    """Return the share of what one model explains beyond another at jumps of inputs.

    0 where inputs are held, or jump so often that the rest is no measure.
    """
    shots = before.problem.shots
    held = before.problem.hold is Hold.ZERO
    if held or not np.array_equal(shots.time, after.problem.shots.time):
        return 0.0
    near = after_jumps(shots)
    if not 0.0 < near.mean() < RARE:
        return 0.0
    return share_explained(before, after, near)


def _after(found: Round) -> FittedModel:
    assert found.chosen is not None
    return found.chosen.candidate.fitted


def after_jumps(shots: Shots) -> NDArray[np.bool_]:
    """Return which samples an input jumps to, or are the next after these, (n,)."""
    inside = np.ones(len(shots.time), dtype=bool)
    inside[shots.edge_array[:-1]] = False
    jumped = inside & jumps_in(shots.inputs)
    following = np.concatenate([[False], jumped[:-1]])
    near: NDArray[np.bool_] = jumped | (following & inside)
    return near


def jumps_in(inputs: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which samples an input jumps to, (n,)."""
    moved = np.abs(np.diff(inputs, axis=0, prepend=inputs[:1]))
    through = np.ptp(inputs, axis=0)
    far = JUMP * np.where(through > 0.0, through, np.inf)
    jumped: NDArray[np.bool_] = np.any(moved > far, axis=1)
    return jumped
