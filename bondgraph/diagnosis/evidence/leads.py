"""Leads: when one judged candidate beats another, and when two are as good as one.

A lead has to be material, significant, and larger than what the better law may owe to
bending towards what is still missing.
"""

from bondgraph.diagnosis.evidence.gain import reduction
from bondgraph.diagnosis.evidence.judged import Judged, Rule
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors

ALIKE = 0.02
"""Predictions closer than this share of what is beyond noise are alike."""

BENT = 0.25
"""Of what a law leaves beyond the noise, so much it may owe to bending towards it."""

SHADE = 0.0025
"""A wider law that takes away no more than this share beyond the narrower one at the
same place (5 % of its size) is a shade of that, as any offset is: a judgement.
"""


def clearly_better(better: Judged, worse: Judged, rule: Rule) -> bool:
    """Return whether `better` beats `worse` by two standard errors and materially.

    Half the materiality of a finding separates two findings. And what even the better
    one leaves is physics that is still missing: a law with a freedom that suits it
    leads without being the cause, so that the lead must be large beside it. A wider law
    is not better for a shade; what else makes that is looked for beside the narrower.
    """
    if better is worse or _is_a_shade_of(better, worse):
        return False
    less, std = reduction(worse.errors, better.errors)
    return less > _lead(std, better.errors, worse.errors, rule)


def _is_a_shade_of(wider: Judged, narrower: Judged) -> bool:
    """Return whether a law contains another and takes away next to nothing more."""
    if wider.place != narrower.place or not extends(wider, narrower):
        return False
    more = wider.gain.value - narrower.gain.value
    return 0.0 <= more <= SHADE * narrower.gain.value


def _lead(std: float, better: LeftOutErrors, worse: LeftOutErrors, rule: Rule) -> float:
    """Return the share of the worse one's error by which a lead is clear.

    Parameters
    ----------
    std
        The standard error of the lead.
    """
    whole = max(float(worse.chunks.sum()), 1e-300)
    bent = BENT * better.beyond_noise / whole
    return max(2.0 * std, rule.materiality / 2, bent)


def alike(one: Judged, other: Judged) -> bool:
    """Return whether two candidates predict alike.

    To 2 % of what noise does not excuse of the left-out error, or to one standard error
    of the difference (Breiman, Friedman, Olshen and Stone, *Classification and
    Regression Trees*, 1984, 3.4.3). Where both leave little but noise, little tells.
    """
    less, std = reduction(other.errors, one.errors)
    whole = max(float(other.errors.chunks.sum()), 1e-300)
    beyond = other.errors.beyond_noise / whole
    return abs(less) <= max(ALIKE * beyond, std)


def extends(wider: Judged, narrower: Judged) -> bool:
    """Return whether the wider law contains the narrower one.

    With the same word it does at the same place only: elsewhere, also with more
    parameters, it is another place that the data do not tell from this one.
    """
    if wider.physics != narrower.physics:
        return narrower.physics in wider.candidate.hypothesis.extends
    more = wider.candidate.complexity > narrower.candidate.complexity
    return more and wider.place == narrower.place


def is_meant(other: Judged, chosen: Judged, rule: Rule) -> bool:
    """Return whether a law counts as the chosen one, or contains it.

    The same physics does where it sits there for all that one can tell.
    """
    if extends(other, chosen):
        return True
    near = other.place == chosen.place or not clearly_better(chosen, other, rule)
    return other.physics == chosen.physics and near
