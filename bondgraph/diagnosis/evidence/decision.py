"""Which candidate to believe, if any; calibrated rather than impressive.

Among those supported that are not clearly worse than the best the simplest wins; the
others stay on record as alternatives.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.judged import Judged, Rule, is_by_itself
from bondgraph.diagnosis.evidence.leads import alike, clearly_better
from bondgraph.diagnosis.records import Support

TIE = 1e-6
"""Left-out errors closer than this share differ by rounding."""

NEARLY_AS_GOOD = "hardly less than a supported law with more parameters"

NAMED_SHARE = 0.8
"""A named law must give this share of what a free curve gives, or the curve is told."""

HALF = 0.5
"""A law that leaves less than this share of an output than a curve does explains it."""


def with_plainer(judged: Sequence[Judged], rule: Rule) -> tuple[Judged, ...]:
    """Return candidates, a simpler one in place of a wider one that hardly beats it.

    How many were tried is held against the first that is accepted. Once something is
    known to be missing, a simpler law that is there by itself, and that predicts nearly
    as well, is the likelier one, though it has come short of that level. Where what the
    simpler one takes away is too little to matter, so is the little more of a wider
    one: that takes it from a zero a little off across the line.
    """
    judged = [_held_back(j, judged, rule) for j in judged]
    supported = [j for j in judged if j.support is Support.SUPPORTED]
    return tuple(
        replace(
            j,
            support=Support.SUPPORTED,
            reason=f"reduces the left-out error by {j.gain}, {NEARLY_AS_GOOD}",
        )
        if is_by_itself(j, rule)
        and any(_hardly_beaten(j, other, rule) for other in supported)
        else j
        for j in judged
    )


def _held_back(wider: Judged, judged: Sequence[Judged], rule: Rule) -> Judged:
    """Return a candidate, refuted where a simpler one does as much, too little."""
    if wider.support is not Support.SUPPORTED:
        return wider
    little = [
        j
        for j in judged
        if j.gain.p_value <= rule.false_alarm_probability
        and j.gain.value < rule.materiality
        and _hardly_beaten(j, wider, rule)
    ]
    if not little:
        return wider
    simplest = min(little, key=lambda j: j.candidate.complexity)
    reason = (
        f"{wider.gain} is hardly more than {simplest.name} takes away, "
        "which is too little to matter"
    )
    return replace(wider, support=Support.REFUTED, reason=reason)


def _hardly_beaten(plainer: Judged, other: Judged, rule: Rule) -> bool:
    """Return whether a law gives most of what a wider one gives, or a curve."""
    most = plainer.gain.value >= NAMED_SHARE * other.gain.value
    if plainer.physics == CURVE or not most:
        return False
    more = other.candidate.complexity > plainer.candidate.complexity
    close = more and not clearly_better(other, plainer, rule)
    return close or other.physics == CURVE


_Pick = Callable[[Sequence[Judged], Rule], Judged]
"""How to choose among laws as simple."""


def best_supported(judged: Sequence[Judged], rule: Rule) -> Judged | None:
    """Return the supported candidate to believe, or None.

    A law with more parameters must beat the simpler one materially; among laws as
    simple the better predictor wins, and of those that predict alike the plainest. A
    curve without a name is chosen only where no named law gives most of what it gives,
    and one that multiplies what depends on something else only where no curve alone
    does. A law that explains an output which the curve leaves is chosen before it.
    """
    return _simplest(judged, rule, _plainest)


def best_as_simple(judged: Sequence[Judged], rule: Rule) -> list[Judged]:
    """Return the same whatever is plain: of laws as simple the best, and its ties."""
    best = _simplest(judged, rule, _leading)
    if best is None:
        return []
    width, named = best.candidate.complexity, best.physics != CURVE
    return best_predictors(
        [
            j
            for j in judged
            if j.candidate.complexity == width and (j.physics != CURVE) is named
        ]
    )


def best_predictors(judged: Sequence[Judged]) -> list[Judged]:
    """Return the supported candidates that leave least, which but for rounding tie."""
    supported = [j for j in judged if j.support is Support.SUPPORTED]
    left = [float(j.errors.chunks.sum()) for j in supported]
    most = (1.0 + TIE) * min(left, default=0.0)
    return [j for j, own in zip(supported, left, strict=True) if own <= most]


def _simplest(
    judged: Sequence[Judged],
    rule: Rule,
    pick: Callable[[Sequence[Judged], Rule], Judged],
) -> Judged | None:
    """Return what is picked of the simplest that nothing wider clearly beats."""
    supported = [j for j in judged if j.support is Support.SUPPORTED]
    if not supported:
        return None
    named = [j for j in supported if j.physics != CURVE]
    alone = [j for j in supported if j.candidate.hypothesis.factor == 1]
    best = max(supported, key=_gained)
    for fewer in filter(None, (named, alone)):
        leading = max(fewer, key=_gained)
        if leading.gain.value >= NAMED_SHARE * best.gain.value:
            supported, best = fewer, leading
            break
    if best.physics == CURVE:
        others = [j for j in named if _is_of_another_output(j, best, rule)]
        supported = others or supported
        best = max(supported, key=_gained)
    chosen = pick(_simplest_near(best, supported, rule), rule)
    while True:
        plainer = pick(_simplest_near(chosen, supported, rule), rule)
        if plainer.candidate.complexity >= chosen.candidate.complexity:
            return chosen
        chosen = plainer


def _is_of_another_output(named: Judged, curve: Judged, rule: Rule) -> bool:
    """Return whether a law explains, of one output, what a curve leaves there.

    A curve gives more of all outputs together where it has one of them to itself. It is
    no rival of what the others tell, and is drawn better once that is known.
    """
    left, own = curve.candidate.left_by_output, named.candidate.left_by_output
    matters = left - own > rule.materiality * left.sum()
    return bool(np.any(matters & (own < HALF * left)))


def _simplest_near(
    best: Judged, supported: Sequence[Judged], rule: Rule
) -> list[Judged]:
    """Return the simplest candidates that `best` does not clearly beat."""
    close = [j for j in supported if not clearly_better(best, j, rule)]
    fewest = min(j.candidate.complexity for j in close)
    return [j for j in close if j.candidate.complexity == fewest]


def _leading(simplest: Sequence[Judged], rule: Rule) -> Judged:
    """Return the best predictor, whatever the rule."""
    del rule
    return max(simplest, key=_gained)


def _plainest(simplest: Sequence[Judged], rule: Rule) -> Judged:
    """Return, of laws that predict alike, the plainest; of places, the best."""
    leading = _leading(simplest, rule)
    plainest = min((j for j in simplest if alike(leading, j)), key=rule.plainness)
    same = [j for j in simplest if j.physics == plainest.physics]
    fewest = min(map(_variables, same))
    return max((j for j in same if _variables(j) == fewest), key=_gained)


def _gained(judged: Judged) -> float:
    return judged.gain.value


def _variables(judged: Judged) -> int:
    """Return how many local variables a law depends on."""
    return len(judged.candidate.hypothesis.depends_on)
