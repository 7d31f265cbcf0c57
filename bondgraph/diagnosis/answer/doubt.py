"""Doubt: what counts against findings that won every comparison.

What remains beside them may be the cause and have bent a law of the library to it, and
a law of which no number is told from none lends its form to something else.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt

from bondgraph.diagnosis.answer.wording import hedged
from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.numbers import none_told
from bondgraph.diagnosis.records import Finding

SHOWS = 0.01
"""More than this share of the squared error counts against what was found. Of 11 named
findings on concealed development cases that left more of it, 6 were right; of some 70
that left less, six of seven.
"""

COMES_NEAR = 0.7
"""Of a probability no more is left where a free curve leaves clearly less: a judgement.
"""

EVEN_CHANCE = 0.5
"""Of a probability no more is left where a free curve elsewhere does better: a
judgement. Of bent sensors told of recordings of strangers with 55 and more three of
four were wrong.
"""

EVEN = 0.5
"""What is less probable than not is told as what may be."""

HOLLOW = 0.5
"""What is left of a probability where nothing tells a number. A judgement: of 45 named
findings on concealed cases none was so; of those in recordings of strangers half were
wrong.
"""

NOT_CARRIED = 0.5
"""What is left of a probability where what was kept back is predicted no better: no
choice has seen it, but an answer that fails there is not told as sure. A judgement.
"""

STANDS_IN = 0.5
"""What is left of a probability where numbers of the model end at bounds that it
states, or an element does far more than stated only with what was found: they stand in
for something. A judgement: of 155 answers told with 55 and more, most of them of
strangers' recordings, one ended so at bounds, with three laws that were wrong.
"""


def doubted(
    findings: Sequence[Finding],
    left: float,
    *,
    carried: bool = True,
    within: bool = True,
) -> list[Finding]:
    """Return the findings, less probable where much remains beside them.

    What remains may be the cause, and have bent a law of the library to it. And a law
    of which no number is told from none lends its form to something else.

    Parameters
    ----------
    left
        The share of the squared error that the findings leave beyond noise.
    carried
        Whether what was kept back does not speak against them.
    within
        Whether the model's own numbers stay within the bounds that it states, and are
        not driven to do far more than as it states.
    """
    believed = 1.0 if left < SHOWS else 1.0 - sqrt(min(left, 1.0))
    if not carried:
        believed *= NOT_CARRIED
    if not within:
        believed *= STANDS_IN
    told = []
    for finding in findings:
        if is_hollow(finding):
            believed *= HOLLOW  # What is found later is built on it.
        told.append(less_probable(finding, min(believed, _beside_curves(finding))))
    return told


def _beside_curves(finding: Finding) -> float:
    """Return what free curves that do better leave of a law's probability."""
    curves = [one for one in finding.alternatives if one.physics == CURVE]
    if finding.physics == CURVE or not curves:
        return 1.0
    elsewhere = any(one.place != finding.place for one in curves)
    return EVEN_CHANCE if elsewhere else COMES_NEAR


def less_probable(finding: Finding, share: float, why: str = "") -> Finding:
    """Return a finding of which only that share of its probability is left, and why."""
    finding = replace(finding, statement=finding.statement + why)
    if finding.probability is None:
        return finding
    sure, said = share * finding.probability, finding.statement
    said = hedged(said) if sure < EVEN else said
    return replace(finding, probability=sure, statement=said)


def is_hollow(finding: Finding) -> bool:
    """Return whether nothing tells a single number of a law with a name from none."""
    numbers = [(one.name, one.value, one.std) for one in finding.estimates]
    named = finding.physics != CURVE
    return named and not finding.in_proportion and none_told(numbers)
