"""Scoring: answers are compared with the truth, which is opened only here.

Per case one outcome, and per board shares with Wilson's 95 % intervals.
"""

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.concealed.accepted import UNKNOWN

STRONG = 5.0
"""Effects of at least this residual over noise are held to the stated rates."""


class Outcome(StrEnum):
    """What came of one case."""

    RIGHT = "right"
    PLACE_ONLY = "right place, wrong physics"
    PHYSICS_ONLY = "right physics, wrong place"
    WRONG = "wrong place and physics"
    PARTLY = "one of two effects right"
    CANNOT_TELL = "cannot tell"
    UNEXPLAINED = "unexplained"
    MISSED = "missed"
    QUIET = "rightly nothing"
    FALSE_ALARM = "false alarm"
    UNSURE = "cannot tell on an empty case"
    NO_ANSWER = "no answer"


@dataclass(frozen=True, slots=True, kw_only=True)
class Scored:
    """One case with what was concealed and what was said.

    Parameters
    ----------
    place_right, physics_right
        Of every effect; the physics counts where it is said or a stated alternative.
    spurious
        Findings that match no effect.
    achieved
        Share of the achievable held-out improvement; None where there is none.
    """

    case: str
    machine: str
    concealed: tuple[str, ...]
    said: tuple[str, ...]
    verdict: str
    outcome: Outcome
    strength: float
    outside: bool
    place_right: bool
    physics_right: bool
    physics_named_first: bool
    spurious: int
    achieved: float | None
    seconds: float


def score(answers: Path, sealed: Path) -> list[Scored]:
    """Return every case that was run, scored."""
    scored = []
    for path in sorted(answers.glob("*.run.json")):
        name = path.name.removesuffix(".run.json")
        truth_file, answer_file = sealed / f"{name}.json", answers / f"{name}.json"
        if not truth_file.exists():
            continue
        truth, run = _read(truth_file), _read(path)
        answered = run["status"] == "answered"
        answer = _read(answer_file) if answered else None
        scored.append(score_case(truth, answer, float(run["seconds"])))
    return scored


def _read(path: Path) -> Any:
    return json.loads(path.read_text("utf-8"))


def score_case(
    truth: Mapping[str, Any], answer: Mapping[str, Any] | None, seconds: float
) -> Scored:
    """Return the score of one case."""
    effects = [e for e in truth["effects"] if not e["silent"]]
    findings = list(answer["findings"]) if answer else []
    matches = [[_match(f, e) for f in findings] for e in effects]
    best = [max(row, key=sum, default=(False, False, False)) for row in matches]
    spurious = sum(
        not any(row[i][0] and row[i][1] for row in matches)
        for i in range(len(findings))
    )
    verdict = answer["verdict"] if answer else "none"
    return Scored(
        case=truth["case"],
        machine=truth["machine"],
        concealed=tuple(f"{e['law']} at {e['place']}" for e in truth["effects"]),
        said=tuple(f"{f['physics']} at {f['place']}" for f in findings),
        verdict=verdict,
        outcome=_outcome(verdict, effects, best, findings),
        strength=float(truth["effect_over_noise"]) if effects else 0.0,
        outside=any(e["outside"] for e in effects),
        place_right=bool(effects) and all(b[0] for b in best),
        physics_right=bool(effects) and all(b[1] for b in best),
        physics_named_first=bool(effects) and all(b[2] for b in best),
        spurious=spurious,
        achieved=_achieved(truth, answer) if effects and answer else None,
        seconds=seconds,
    )


def _match(
    finding: Mapping[str, Any], effect: Mapping[str, Any]
) -> tuple[bool, bool, bool]:
    """Return whether place, physics (said or alternative) and first word are right."""
    said_places = {finding["place"], *finding["indistinguishable_places"]}
    others = {a["physics"] for a in finding["alternatives"]}
    best = (False, False, False)
    for one in effect["accepted"]:
        place = bool(said_places & set(one["places"]))
        first = finding["physics"] in one["words"]
        physics = first or bool(others & set(one["words"]))
        best = max(best, (place, physics, first), key=sum)
    return best


def _outcome(
    verdict: str,
    effects: Sequence[Mapping[str, Any]],
    best: Sequence[tuple[bool, bool, bool]],
    findings: Sequence[Mapping[str, Any]],
) -> Outcome:
    if verdict == "none":
        return Outcome.NO_ANSWER
    if not effects:
        return {
            "adequate": Outcome.QUIET,
            "cannot_tell": Outcome.UNSURE,
        }.get(verdict, Outcome.FALSE_ALARM)
    if verdict == "adequate":
        return Outcome.MISSED
    if verdict == "cannot_tell":
        return Outcome.CANNOT_TELL
    right = [place and physics for place, physics, _ in best]
    if all(right):
        return Outcome.RIGHT
    named = any(f["physics"] != UNKNOWN for f in findings)
    if verdict == "unexplained" or not named:
        outside = all(e["outside"] for e in effects)
        located = all(place for place, _, _ in best)
        return Outcome.RIGHT if outside and located else Outcome.UNEXPLAINED
    if any(right):
        return Outcome.PARTLY
    if any(place for place, _, _ in best):
        return Outcome.PLACE_ONLY
    if any(physics for _, physics, _ in best):
        return Outcome.PHYSICS_ONLY
    return Outcome.WRONG


CONFIDENTLY_WRONG = (Outcome.PLACE_ONLY, Outcome.PHYSICS_ONLY, Outcome.WRONG)


def _achieved(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> float | None:
    """Return the share of the achievable reduction of held-out error that was reached.

    Achievable is the machine's own structure with its own numbers, simulated by the
    independent simulator: what remains is noise and rounding. Errors per output are
    weighed by what is achievable, so that every sensor counts.
    """
    before = answer["fit"]["held_out"]["before"]["rmse"]
    after = answer["fit"]["held_out"]["after"]["rmse"]
    ideal = truth["achievable_held_out_rmse"]
    try:
        ratios = [
            (float(before[n]) / float(ideal[n]), float(after[n]) / float(ideal[n]))
            for n in ideal
        ]
    except (KeyError, TypeError, ZeroDivisionError):
        return None
    first, last = (math.sqrt(sum(r[i] ** 2 for r in ratios)) for i in (0, 1))
    best = math.sqrt(len(ratios))
    if first < 1.5 * best:
        return None
    return (first - last) / (first - best)


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a share."""
    if trials == 0:
        return 0.0, 1.0
    z = 1.959963984540054
    share, weight = successes / trials, z * z / trials
    centre = (share + weight / 2.0) / (1.0 + weight)
    half = z * math.sqrt(share * (1 - share) / trials + weight / (4 * trials))
    half /= 1.0 + weight
    return max(0.0, centre - half), min(1.0, centre + half)


@dataclass(frozen=True, slots=True)
class Share:
    """So many of so many, with Wilson's 95 % interval."""

    successes: int
    trials: int

    def as_dict(self) -> dict[str, Any]:
        """Return it for JSON."""
        low, high = wilson(self.successes, self.trials)
        share = self.successes / self.trials if self.trials else None
        return {**asdict(self), "share": share, "low": low, "high": high}


def share_of(
    scored: Iterable[Scored], holds: Callable[[Scored], bool]
) -> dict[str, Any]:
    """Return the share of cases for which `holds`."""
    cases = list(scored)
    return Share(sum(map(holds, cases)), len(cases)).as_dict()


def board(scored: Sequence[Scored]) -> dict[str, Any]:
    """Return all numbers of the scoreboard."""
    full = [s for s in scored if s.strength > 0.0]
    empty = [s for s in scored if s.strength == 0.0]
    inside = [s for s in full if not s.outside]
    strong = [s for s in inside if s.strength >= STRONG]
    achieved = sorted(s.achieved for s in strong if s.achieved is not None)
    seconds = [s.seconds for s in scored]
    return {
        "cases": len(scored),
        "empty": len(empty),
        "strong": {
            "what": f"effects of the vocabulary, residual at least {STRONG} x noise",
            "place": share_of(strong, lambda s: s.place_right),
            "physics": share_of(strong, lambda s: s.physics_right),
            "physics_said_first": share_of(strong, lambda s: s.physics_named_first),
            "both": share_of(strong, lambda s: s.outcome is Outcome.RIGHT),
            "confidently_wrong": share_of(
                strong, lambda s: s.outcome in CONFIDENTLY_WRONG
            ),
            "cannot_tell": share_of(strong, lambda s: s.outcome is Outcome.CANNOT_TELL),
            "unexplained": share_of(strong, lambda s: s.outcome is Outcome.UNEXPLAINED),
            "missed": share_of(strong, lambda s: s.outcome is Outcome.MISSED),
            "no_answer": share_of(strong, lambda s: s.outcome is Outcome.NO_ANSWER),
            "with_spurious_finding": share_of(strong, lambda s: s.spurious > 0),
        },
        "weak": {
            "what": f"effects below {STRONG} x noise",
            "outcomes": _counts([s for s in inside if s.strength < STRONG]),
        },
        "outside": {
            "what": "effects that no law of the library describes",
            "right": share_of(
                [s for s in full if s.outside], lambda s: s.outcome is Outcome.RIGHT
            ),
            "outcomes": _counts([s for s in full if s.outside]),
        },
        "empty_cases": {
            "false_alarms": share_of(
                [s for s in empty if s.outcome is not Outcome.NO_ANSWER],
                lambda s: s.outcome is Outcome.FALSE_ALARM,
            ),
            "cannot_tell": share_of(empty, lambda s: s.outcome is Outcome.UNSURE),
            "no_answer": share_of(empty, lambda s: s.outcome is Outcome.NO_ANSWER),
        },
        "achieved_held_out_improvement": {
            "cases": len(achieved),
            "median": _quantile(achieved, 0.5),
            "worst_decile": _quantile(achieved, 0.1),
        },
        "power": power(inside),
        "seconds": {
            "median": _quantile(seconds, 0.5),
            "largest": max(seconds, default=None),
            "sum": sum(seconds),
        },
        "confusion": confusion(full),
        "by_machine": {
            name: _counts([s for s in scored if s.machine == name])
            for name in sorted({s.machine for s in scored})
        },
        "outcomes": _counts(scored),
    }


def _counts(scored: Iterable[Scored]) -> dict[str, int]:
    counted = Counter(s.outcome.value for s in scored)
    return dict(counted.most_common())


def _quantile(values: Sequence[float], share: float) -> float | None:
    return float(np.quantile(values, share)) if len(values) else None


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
                "detected": share_of(
                    inside, lambda s: s.verdict in ("physics_missing", "unexplained")
                ),
                "right": share_of(inside, lambda s: s.outcome is Outcome.RIGHT),
                "confidently_wrong": share_of(
                    inside, lambda s: s.outcome in CONFIDENTLY_WRONG
                ),
            }
        )
    return rows


def confusion(scored: Sequence[Scored]) -> dict[str, dict[str, int]]:
    """Return how often each concealed law was called what, for single effects."""
    rows: dict[str, Counter[str]] = {}
    for s in scored:
        if len(s.concealed) != 1:
            continue
        law = s.concealed[0].split(" at ")[0]
        said = s.said[0].split(" at ")[0] if s.said else s.verdict
        rows.setdefault(law, Counter())[said] += 1
    return {law: dict(row.most_common()) for law, row in sorted(rows.items())}
