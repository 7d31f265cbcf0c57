"""Doubt: what counts against findings that won every comparison.

What remains beside them may be the cause and have bent a law of the library to it, and
a law of which no number is told from none lends its form to something else.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import sqrt

import numpy as np

from bondgraph.diagnosis.answer.wording import hedged
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Finding
from bondgraph.diagnosis.search.candidates import CURVE
from bondgraph.diagnosis.search.round_found import Round

MUCH_REMAINING = 0.1
"""More than this share of the error is worth saying that it remains."""

SHOWS = 0.01
"""More than this share of the squared error counts against what was found. Of 11 named
findings on concealed development cases that left more of it, 6 were right; of some 70
that left less, six of seven.
"""

ERRORS = 2.0
"""A number within so many standard errors of none is not told from it."""

COMES_NEAR = 0.7
"""Of a probability no more is left where a free curve leaves clearly less: a judgement.
"""

EVEN = 0.5
"""What is less probable than not is told as what may be."""

HOLLOW = 0.5
"""What is left of a probability where nothing tells a number. A judgement: of 45 named
findings on concealed cases none was so; of those in recordings of strangers half were
wrong.
"""


def remaining(rounds: Sequence[Round], floor: Mapping[str, float]) -> float:
    """Return the share of the left-out error that the findings leave beyond noise.

    From the first model to the last one: what was found on the way may have been taken
    out again, and its gain with it.
    """
    made = [found.chosen for found in rounds if found.chosen is not None]
    if not made:
        return 1.0
    whole = _per_sample(made[0].errors) / max(1.0 - made[0].gain.value, 1e-12)
    share = _per_sample(made[-1].errors) / whole if whole > 0.0 else 1.0
    base = rounds[0].base
    scale = base.problem.sigma
    power = np.nanmean((base.residuals() / scale) ** 2, axis=0)
    noise = (np.array([floor[name] for name in floor]) / scale) ** 2
    # The gains are of the errors of all outputs together, weighted by these scales.
    beyond = 1.0 - float(np.sum(np.minimum(noise, power)) / np.sum(power))
    return max(share - (1.0 - beyond), 0.0) / max(beyond, 1e-12)


def doubted(findings: Sequence[Finding], left: float) -> list[Finding]:
    """Return the findings, less probable where much remains beside them.

    What remains may be the cause, and have bent a law of the library to it. And a law
    of which no number is told from none lends its form to something else.

    Parameters
    ----------
    left
        The share of the squared error that the findings leave beyond noise.
    """
    believed = 1.0 if left < SHOWS else 1.0 - sqrt(min(left, 1.0))
    told = []
    for finding in findings:
        if is_hollow(finding):
            believed *= HOLLOW  # What is found later is built on it.
        near = finding.physics != CURVE and any(
            one.physics == CURVE for one in finding.alternatives
        )
        told.append(
            _less_probable(finding, min(believed, COMES_NEAR) if near else believed)
        )
    return told


def _less_probable(finding: Finding, share: float) -> Finding:
    """Return a finding of which only that share of its probability is left."""
    if finding.probability is None:
        return finding
    sure, said = share * finding.probability, finding.statement
    said = hedged(said) if sure < EVEN else said
    return replace(finding, probability=sure, statement=said)


def is_hollow(finding: Finding) -> bool:
    """Return whether nothing tells a single number of a law with a name from none."""
    numbers = [(one.value, one.std) for one in finding.estimates]
    return finding.physics != CURVE and none_told(numbers)


def none_told(numbers: Sequence[tuple[float, float | None]]) -> bool:
    """Return whether there are numbers, each with its error, and none is told from 0.

    An error that is not known, None or not a number, tells nothing.
    """
    return bool(numbers) and not any(
        std is not None and abs(value) > ERRORS * std for value, std in numbers
    )


def _per_sample(errors: LeftOutErrors) -> float:
    return float(errors.chunks.sum()) / max(errors.samples, 1)
