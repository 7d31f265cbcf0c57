"""Which candidate to believe, if any; calibrated rather than impressive.

A candidate is *supported* when its gain on left-out chunks is significant after the
number of candidates tried, and material. Among those not clearly worse than the best
the simplest wins; the others stay on record as alternatives.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.evidence.gain import Gain, compare, reduction
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.names import name_of

ALIKE = 0.02
BENT = 0.25
"""Of what a law leaves beyond the noise, so much it may owe to bending towards it."""
SHADE = 0.0025
"""A wider law that takes away no more than this share beyond the narrower one at the
same place (5 % of its size) is a shade of that, as any offset is: a judgement.
"""
TIE = 1e-6
"""Left-out errors closer than this share differ by rounding."""
NEARLY_AS_GOOD = "hardly less than a supported law with more parameters"
NAMED_SHARE = 0.8
"""A named law must give this share of what a free curve gives, or the curve is told."""


TYPICAL = {
    "hydraulic": frozenset({"square_root_orifice", "leak", "overflow"}),
    "electrical": frozenset({"voltage_drop", "saturating_inertia"}),
    "thermal": frozenset({"lag", "radiation", "leak"}),
    "rotation": frozenset({"coulomb_friction", "load_dependent_friction"}),
    "translation": frozenset({"coulomb_friction"}),
}
"""What models of each domain leave out most often, and so the first thing to say."""


@dataclass(frozen=True, slots=True)
class Rule:
    """The thresholds of a decision.

    Parameters
    ----------
    false_alarm_probability
        Chance, per round, of accepting anything when nothing is missing.
    materiality
        Least relative reduction of the squared error that is worth a finding.
    order
        Physics from plain to particular: of laws that predict alike, the first is told.
    """

    false_alarm_probability: float = 0.01
    materiality: float = 0.1
    order: tuple[str, ...] = tuple(physics.word for physics in LIBRARY)

    def plainness(self, judged: "Judged") -> tuple[bool, int]:
        """Return how far-fetched the physics is: what is typical of a domain comes
        first, then what comes first in the library.
        """  # noqa: D205  (one sentence)
        known = judged.physics in self.order
        place = self.order.index(judged.physics) if known else len(self.order)
        typical = TYPICAL.get(judged.domain, frozenset())
        return judged.physics not in typical, place


@dataclass(frozen=True, slots=True)
class Judged:
    """A candidate with its left-out errors and what follows from them.

    Parameters
    ----------
    open
        Whether the final fit does not tell what it adds to a plainer law that is told.
    """

    candidate: Candidate
    errors: LeftOutErrors
    gain: Gain
    support: Support
    reason: str
    open: bool = False

    @property
    def physics(self) -> str:
        """The word for the physics."""
        return self.candidate.hypothesis.physics

    @property
    def domain(self) -> str:
        """The name of the domain there; empty where the place has none."""
        domains = self.candidate.fitted.graph.domains_at(self.place)
        return domains[0].name if domains else ""

    @property
    def place(self) -> str:
        """The place."""
        return self.candidate.hypothesis.place


def judge(
    candidate: Candidate,
    base: LeftOutErrors,
    errors: LeftOutErrors,
    tried: float,
    rule: Rule,
) -> Judged:
    """Return what the left-out chunks say of one candidate among `tried`."""
    gain = compare(base, errors)
    corrected = gain.p_value * max(tried, 1.0)
    enough = gain.value >= rule.materiality
    sure = corrected <= rule.false_alarm_probability
    if enough and sure:
        support, reason = Support.SUPPORTED, f"reduces the left-out error by {gain}"
    elif gain.value <= 0.0 or gain.value + 2 * gain.std < rule.materiality:
        support = Support.REFUTED
        reason = f"changes the left-out error by {gain}, too little to matter"
    elif enough:
        support = Support.UNDECIDED
        reason = f"{gain} is not significant among {tried:.0f} candidates"
    elif sure:
        support = Support.UNDECIDED
        reason = f"{gain} may be too little to matter"
    else:
        support = Support.UNDECIDED
        reason = f"{gain} could be nothing"
    return Judged(candidate, errors, gain, support, reason)


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
        f"{wider.gain} is hardly more than {name_of(simplest.physics)} takes away, "
        "which is too little to matter"
    )
    return replace(wider, support=Support.REFUTED, reason=reason)


def is_by_itself(judged: Judged, rule: Rule) -> bool:
    """Return whether an undecided law would be supported, had it been tried alone."""
    gain = judged.gain
    enough = gain.value >= rule.materiality
    sure = gain.p_value <= rule.false_alarm_probability
    return judged.support is Support.UNDECIDED and enough and sure


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
    does.
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
    chosen = pick(_simplest_near(best, supported, rule), rule)
    while True:
        plainer = pick(_simplest_near(chosen, supported, rule), rule)
        if plainer.candidate.complexity >= chosen.candidate.complexity:
            return chosen
        chosen = plainer


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


def alternatives_to(
    chosen: Judged, judged: Sequence[Judged], rule: Rule
) -> tuple[Judged, ...]:
    """Return supported candidates that the data do not tell from the chosen one.

    A law that extends the chosen one without predicting better is no alternative: it
    contains the chosen one, and what it adds is not supported.
    """
    close = [
        j
        for j in judged
        if j is not chosen
        and j.support is Support.SUPPORTED
        and not clearly_better(chosen, j, rule)
        and j.physics != CURVE
        and not extends(j, chosen)
    ]
    return tuple(sorted(close, key=lambda j: -j.gain.value))


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
