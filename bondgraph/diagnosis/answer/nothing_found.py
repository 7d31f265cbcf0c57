"""The verdict where nothing was found: nothing is missing, or nobody can tell.

What a model leaves may be noise, white or coloured; a trace of physics, too little to
matter; more than noise, with laws that would help or with none that does.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bondgraph.diagnosis.adequacy.records import Adequacy, AdequacyStatus
from bondgraph.diagnosis.evidence.judged import Judged, Rule, is_by_itself
from bondgraph.diagnosis.evidence.leftover import (
    ADEQUATE_RATIO,
    residual_over_noise,
    residual_over_spread,
    too_large,
)
from bondgraph.diagnosis.records import Support, Verdict
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.estimate import FittedModel

NOTHING = (AdequacyStatus.ADEQUATE, AdequacyStatus.COLOURED)
"""What a model leaves that no physics of the machine explains."""

TRACE = 0.05
"""A smaller share of what a model leaves does not matter, however sure it is."""

HARDLY = 0.15
"""A smaller share leaves open what the rest is: of coloured noise some 8 % follow
something slow by chance, of what machines outside the library leave 29 % and more.
"""

DOUBTFUL = 0.05
"""Where noise would follow the machine no less so seldom, it may not be noise."""

MANY = 1000
"""Beyond it, how many times the noise says more of the noise than of the model."""


def without_findings(
    base: FittedModel,
    floor: Mapping[str, float],
    first: Round,
    checked: Adequacy | None,
    rule: Rule,
) -> tuple[Verdict, str]:
    """Return the verdict and the statement where no law was accepted.

    Parameters
    ----------
    first
        The round that found nothing.
    checked
        Whether what the base model leaves follows what the machine does, where known.
    rule
        By which candidates were judged.
    """
    alone = [j for j in first.judged if is_by_itself(j, rule)]
    if alone:
        return Verdict.CANNOT_TELL, _too_few(alone, first.independent)
    noise = _as_noise(base, floor, first, checked)
    if noise is not None:
        return noise
    worst = max(residual_over_noise(base, floor).values(), default=float("nan"))
    # What no candidate was tried on is no more than noise excuses.
    follows = None if first.tried == 0 else _followed(checked)
    undecided = [j for j in first.judged if j.support is Support.UNDECIDED]
    if undecided and (follows or not worst <= ADEQUATE_RATIO):
        return Verdict.CANNOT_TELL, (
            f"These recordings do not decide: {_names(undecided)} would help, but not "
            "reliably on data that were left out."
        )
    hardly = checked is not None and _follows_at_most(checked, HARDLY)
    if worst > ADEQUATE_RATIO and follows and hardly:
        return Verdict.CANNOT_TELL, (
            f"The residual is {_times(worst)} the white part of the noise, and little "
            f"of it follows what the machine does: at most {follows}. None of the "
            f"{first.tried} candidates explains it on data that were left out. It may "
            "be coloured noise, an input that was not recorded, or physics with a "
            "memory that these channels do not show."
        )
    if worst > ADEQUATE_RATIO:
        return Verdict.UNEXPLAINED, (
            f"The residual is {_times(worst)} the measurement noise, and none of the "
            f"{first.tried} candidates explains it on data that were left out."
        )
    if follows:
        return Verdict.CANNOT_TELL, (
            f"What the model leaves follows {follows}, and none of the {first.tried} "
            "candidates explains that reliably on data that were left out: physics "
            "that no law tried here describes, or noise that a closed loop feeds back."
        )
    return Verdict.ADEQUATE, (
        "As far as these recordings could show, "
        f"{_residual_words(worst)}{_tried_words(first.tried)}."
    )


def _too_few(alone: Sequence[Judged], tried: float) -> str:
    """Return what to say of laws that would be supported, had each been tried alone."""
    best, *others = sorted(alone, key=lambda judged: -judged.gain.value)
    return (
        f"These recordings are too few to decide: {_names([best, *others])} would "
        f"help, the first by {best.gain} of the error on data that were left out, but "
        f"one of the {tried:.0f} that were tried may do so by chance."
    )


def _names(judged: Sequence[Judged]) -> str:
    """Return the first three laws with their places."""
    names = dict.fromkeys(f"{j.name} at {j.place}" for j in judged)
    return ", ".join(list(names)[:3])


def _as_noise(
    base: FittedModel,
    floor: Mapping[str, float],
    first: Round,
    checked: Adequacy | None,
) -> tuple[Verdict, str] | None:
    """Return what to say of a residual that is noise, or too large for what it is."""
    if checked is not None and checked.status is AdequacyStatus.COLOURED:
        doubt = _large_and_slow(base, floor) or _seldom(base, floor, checked.p_value)
        if doubt is not None:
            return Verdict.CANNOT_TELL, doubt
    if checked is not None and checked.status in NOTHING:
        chance = f"{100 * checked.p_value:.0f} of 100 recordings"
        return Verdict.ADEQUATE, (
            f"{checked.status} By chance it would follow the machine no less in "
            f"{chance}{_tried_words(first.tried)}."
        )
    if checked is not None and _follows_at_most(checked, TRACE):
        most = max(checked.dependences, key=lambda one: one.share)
        return Verdict.ADEQUATE, (
            f"What the model leaves is coloured noise. A trace of it, "
            f"{100 * most.share:.2g} %, follows {most.variable} at {most.place}: too "
            f"little to matter{_tried_words(first.tried)}."
        )
    return None


def _followed(checked: Adequacy | None) -> str | None:
    """Return what the residual follows, and by how much; None where nothing surely."""
    if checked is None or checked.status is not AdequacyStatus.STRUCTURE:
        return None
    most = max(checked.dependences, key=lambda one: one.share)
    return f"{most.variable} at {most.place} ({100 * most.share:.2g} % of it)"


def _large_and_slow(base: FittedModel, floor: Mapping[str, float]) -> str | None:
    """Return what to say of a residual too large for noise that follows nothing."""
    worst = too_large(base, floor)
    if worst is None:
        return None
    share = residual_over_spread(base)[worst]
    ratio = residual_over_noise(base, floor)[worst]
    return (
        f"The residual of {worst} is {100 * share:.0f} % of what it varies by "
        f"and {_times(ratio)} its noise, yet it follows nothing that the "
        "machine is seen to do: an input that was not recorded, or physics with a "
        "memory that these channels do not show."
    )


def _seldom(
    base: FittedModel, floor: Mapping[str, float], p_value: float
) -> str | None:
    """Return what to say of a residual such as coloured noise makes now and then."""
    worst = too_large(base, floor, share=0.0)
    if worst is None or p_value > DOUBTFUL:
        return None
    return (
        f"The residual of {worst} is {_times(residual_over_noise(base, floor)[worst])} "
        "the white part of its noise, and coloured noise would follow the machine no "
        f"less in {100 * p_value:.0f} of 100 recordings only: it may be that, an input "
        "that was not recorded, or something that changes with time."
    )


def _follows_at_most(checked: Adequacy, share: float) -> bool:
    """Return whether what the model leaves follows the machine so little, if surely."""
    surely = checked.status is AdequacyStatus.STRUCTURE
    return surely and all(one.share < share for one in checked.dependences)


def _residual_words(ratio: float) -> str:
    if np.isnan(ratio):
        return "the noise of a steady table is not known"
    return f"the residual is {_times(ratio)} the measurement noise"


def _times(ratio: float) -> str:
    return f"{ratio:.1f} times" if ratio < MANY else f"more than {MANY} times"


def _tried_words(tried: int) -> str:
    if not tried:
        return ", and no more than noise is left to explain"
    return (
        f", and none of {tried} candidates improves the prediction of data that were "
        "left out"
    )
