"""The scoreboard: every number of the page, from scored cases."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from benchmarks.concealed.accepted import WORDS
from benchmarks.concealed.curves import WITHIN
from benchmarks.concealed.scoring import CONFIDENTLY_WRONG, Outcome, Scored
from benchmarks.concealed.shares import counts, quantile, share

STRONG = 5.0
"""Effects of at least this residual over noise are held to the stated rates."""

Holds = Callable[[Scored], bool]


def _is(*outcomes: Outcome) -> Holds:
    return lambda s: s.outcome in outcomes


ROWS: dict[str, Holds] = {
    "place": lambda s: s.place_right,
    "physics": lambda s: s.physics_right,
    "both": _is(Outcome.RIGHT),
    "both, and said first": lambda s: s.outcome is Outcome.RIGHT and s.said_first,
    "both, and nothing else said": lambda s: (
        s.outcome is Outcome.RIGHT and s.spurious == 0
    ),
    "both, laws called hardly supported counted": lambda s: (
        s.outcome is Outcome.RIGHT or (s.lenient and s.verdict == "physics_missing")
    ),
    "one of two": _is(Outcome.PARTLY),
    "confidently wrong": _is(*CONFIDENTLY_WRONG),
    "cannot tell": _is(Outcome.CANNOT_TELL),
    "unexplained": _is(Outcome.UNEXPLAINED),
    "missed": _is(Outcome.MISSED),
    "no answer": _is(Outcome.NO_ANSWER),
    "with a spurious finding": lambda s: s.spurious > 0,
}
"""What is counted of the effects that are held to the stated rates."""


def board(scored: Sequence[Scored]) -> dict[str, Any]:
    """Return all numbers of the scoreboard."""
    full = [s for s in scored if s.strength > 0.0]
    empty = [s for s in scored if s.strength == 0.0]
    inside = [s for s in full if not s.outside]
    outside = [s for s in full if s.outside]
    strong = [s for s in inside if s.strength >= STRONG]
    odd = [s for s in outside if s.strength >= STRONG]
    curved = [s.curve_error for s in odd if s.curve_error is not None]
    reached = sorted(s.achieved for s in strong if s.achieved is not None)
    seconds = [s.seconds for s in scored]
    breadth = [s.breadth for s in strong if s.breadth]
    return {
        "cases": len(scored),
        "empty": len(empty),
        "strong": {
            "what": f"effects of the vocabulary, residual at least {STRONG:g} x noise",
            **{name: share(map(holds, strong)) for name, holds in ROWS.items()},
        },
        "weak": {
            "what": f"effects below {STRONG:g} x noise",
            "outcomes": _outcomes([s for s in inside if s.strength < STRONG]),
        },
        "outside": {
            "what": f"effects that no law describes, at least {STRONG:g} x noise",
            "right": share(s.outcome is Outcome.RIGHT for s in odd),
            "curve_within": share(error <= WITHIN for error in curved),
            "curve_errors": sorted(curved),
            "outcomes": _outcomes(odd),
            "weak_outcomes": _outcomes([s for s in outside if s.strength < STRONG]),
        },
        "empty_cases": {
            "false alarms": share(
                s.outcome is Outcome.FALSE_ALARM
                for s in empty
                if s.outcome is not Outcome.NO_ANSWER
            ),
            "cannot tell": share(s.outcome is Outcome.UNSURE for s in empty),
            "no answer": share(s.outcome is Outcome.NO_ANSWER for s in empty),
        },
        "achieved_held_out_improvement": {
            "cases": len(reached),
            "median": quantile(reached, 0.5),
            "worst_decile": quantile(reached, 0.1),
        },
        "named_pairs": {
            "median": quantile(breadth, 0.5),
            "largest": max(breadth, default=None),
        },
        "power": power(inside),
        "calibration": calibration(scored),
        "seconds": {
            "median": quantile(seconds, 0.5),
            "largest": max(seconds, default=None),
            "sum": sum(seconds),
        },
        "confusion": confusion(full),
        "accepted_words": {law: words for law, (words, _) in WORDS.items()},
        "by_machine": {
            name: _outcomes([s for s in scored if s.machine == name])
            for name in sorted({s.machine for s in scored})
        },
        "outcomes": _outcomes(scored),
    }


def _outcomes(scored: Sequence[Scored]) -> dict[str, int]:
    return counts(s.outcome.value for s in scored)


BINS = (0.0, 1.0, 3.0, 5.0, 10.0, 20.0, math.inf)


def power(scored: Sequence[Scored]) -> list[dict[str, Any]]:
    """Return detection and right answers against residual over noise."""
    rows = []
    for low, high in pairwise(BINS):
        inside = [s for s in scored if low <= s.strength < high]
        rows.append(
            {
                "from": low,
                "to": high if math.isfinite(high) else None,
                "detected": share(
                    s.verdict in ("physics_missing", "unexplained") for s in inside
                ),
                "right": share(s.outcome is Outcome.RIGHT for s in inside),
                "confidently_wrong": share(
                    s.outcome in CONFIDENTLY_WRONG for s in inside
                ),
            }
        )
    return rows


PROBABILITIES = (0.0, 0.5, 0.8, 0.95, 1.0 + 1e-12)


def calibration(scored: Sequence[Scored]) -> dict[str, Any]:
    """Return how often a named finding is right against its stated probability.

    Right is what is said first, at its place or at one that is called the same. All
    named findings count, those of empty cases and beside the right one too.
    """
    stated = [pair for s in scored for pair in s.stated]
    rows = []
    for low, high in pairwise(PROBABILITIES):
        inside = [(p, right) for p, right in stated if low <= p < high]
        mean = sum(p for p, _ in inside) / len(inside) if inside else None
        rows.append(
            {
                "from": low,
                "to": min(high, 1.0),
                "stated": mean,
                "right": share(right for _, right in inside),
            }
        )
    brier = sum((p - right) ** 2 for p, right in stated)
    return {
        "findings": len(stated),
        "brier": brier / len(stated) if stated else None,
        "rows": rows,
    }


def confusion(scored: Sequence[Scored]) -> dict[str, dict[str, int]]:
    """Return how often each concealed law was called what, for single effects."""
    said: dict[str, list[str]] = {}
    for s in scored:
        if len(s.concealed) == 1:
            law = s.concealed[0].split(" at ")[0]
            word = s.said[0].split(" at ")[0] if s.said else s.verdict
            said.setdefault(law, []).append(word)
    return {law: counts(words) for law, words in sorted(said.items())}
