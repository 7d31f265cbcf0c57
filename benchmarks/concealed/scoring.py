"""Scoring: answers are compared with the truth, which is opened only here.

An answer *names* pairs of physics and place: the finding at its place and at those that
it calls indistinguishable, and every alternative that it does not refute, where that
would sit. An effect is found where one of the named pairs is an accepted one. How many
pairs an answer names is counted, so that a long list is seen for what it is.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import permutations
from pathlib import Path
from typing import Any

from benchmarks.concealed.accepted import UNKNOWN
from benchmarks.concealed.curves import curve_error

Finding = Mapping[str, Any]
Effect = Mapping[str, Any]


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


CONFIDENTLY_WRONG = (Outcome.PLACE_ONLY, Outcome.PHYSICS_ONLY, Outcome.WRONG)


@dataclass(frozen=True, slots=True, order=True)
class Match:
    """What a finding has right about an effect.

    ``first`` is that what it says first is right; ``lenient`` that it is right if laws
    count that it calls hardly supported.
    """

    both: bool = False
    place: bool = False
    physics: bool = False
    first: bool = False
    lenient: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Scored:
    """One case with what was concealed and what was said.

    Parameters
    ----------
    place_right, physics_right
        Of every effect, among what the answer names.
    said_first
        Whether what is said first is right, in place and physics.
    lenient
        Whether it is right if laws count that the answer calls hardly supported.
    spurious
        Findings that match no effect.
    breadth
        Pairs of physics and place that the answer names.
    achieved
        Share of the achievable held-out improvement; None where there is none.
    stated
        Stated probability of every named finding, and whether it is right as said.
    curve_error
        Of the curve of an unknown relation, see `benchmarks.concealed.curves`.
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
    said_first: bool
    lenient: bool
    spurious: int
    breadth: int
    achieved: float | None
    stated: tuple[tuple[float, bool], ...]
    curve_error: float | None
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
    best = _best(findings, effects)
    verdict = answer["verdict"] if answer else "none"
    found = bool(effects)
    return Scored(
        case=truth["case"],
        machine=truth["machine"],
        concealed=tuple(f"{e['law']} at {e['place']}" for e in truth["effects"]),
        said=tuple(f"{f['physics']} at {f['place']}" for f in findings),
        verdict=verdict,
        outcome=_outcome(verdict, effects, best, findings),
        strength=float(truth["effect_over_noise"]) if effects else 0.0,
        outside=any(e["outside"] for e in effects),
        place_right=found and all(m.place for m in best),
        physics_right=found and all(m.physics for m in best),
        said_first=found and all(m.first for m in best),
        lenient=found and all(m.lenient for m in best),
        spurious=sum(not any(match(f, e).both for e in effects) for f in findings),
        breadth=sum(len(where) for f in findings for _, where in named(f)),
        achieved=achieved(truth, answer) if effects and answer else None,
        stated=tuple(
            (float(f["probability"]), any(match(f, e).first for e in effects))
            for f in findings
            if f.get("probability") is not None and f["physics"] != UNKNOWN
        ),
        curve_error=curve_error(effects, answer),
        seconds=seconds,
    )


def named(finding: Finding, *, lenient: bool = False) -> list[tuple[str, set[str]]]:
    """Return the physics that a finding names, each with its places.

    Alternatives that the answer refutes are not named, unless `lenient`.
    """
    said = {finding["place"], *finding["indistinguishable_places"]}
    pairs = [(finding["physics"], said)]
    for other in finding["alternatives"]:
        if other.get("support") == "refuted" and not lenient:
            continue
        where = other.get("place", finding["place"])
        pairs.append((other["physics"], said if where in said else {where}))
    return pairs


def match(finding: Finding, effect: Effect) -> Match:
    """Return what a finding has right about an effect."""
    accepted = [(set(one["words"]), set(one["places"])) for one in effect["accepted"]]
    pairs = named(finding)

    def right(named_pairs: Sequence[tuple[str, set[str]]]) -> bool:
        return any(
            physics in words and places & wanted
            for physics, places in named_pairs
            for words, wanted in accepted
        )

    return Match(
        both=right(pairs),
        place=any(places & wanted for _, places in pairs for _, wanted in accepted),
        physics=any(physics in words for physics, _ in pairs for words, _ in accepted),
        first=right(pairs[:1]),
        lenient=right(named(finding, lenient=True)),
    )


def _best(findings: Sequence[Finding], effects: Sequence[Effect]) -> list[Match]:
    """Return the match of every effect where each has a finding of its own."""
    if not effects:
        return []
    table = [[match(f, e) for f in findings] + [Match()] for e in effects]
    nothing = len(findings)
    choices = permutations([*range(len(findings)), *[nothing] * len(effects)],
                           len(effects))  # fmt: skip
    matched = (
        [row[i] for row, i in zip(table, choice, strict=True)] for choice in choices
    )
    return max(matched, key=lambda row: (sum(m.both for m in row), sorted(row)))


def _outcome(
    verdict: str,
    effects: Sequence[Effect],
    best: Sequence[Match],
    findings: Sequence[Finding],
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
    right = [m.both for m in best]
    if all(right):
        return Outcome.RIGHT
    names = any(f["physics"] != UNKNOWN for f in findings)
    if verdict == "unexplained" or not names:
        outside = all(e["outside"] for e in effects)
        located = all(m.place for m in best)
        return Outcome.RIGHT if outside and located else Outcome.UNEXPLAINED
    if any(right):
        return Outcome.PARTLY
    if any(m.place for m in best):
        return Outcome.PLACE_ONLY
    if any(m.physics for m in best):
        return Outcome.PHYSICS_ONLY
    return Outcome.WRONG


def achieved(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> float | None:
    """Return the share of the achievable reduction of held-out error that was reached.

    Achievable is the machine's own structure, fitted to the training recordings, by the
    independent simulator; where a truth does not tell that, with its own numbers, which
    is harder. Errors per output are weighed by what is achievable, so that every sensor
    counts.
    """
    before = answer["fit"]["held_out"]["before"]["rmse"]
    after = answer["fit"]["held_out"]["after"]["rmse"]
    ideal = truth.get("fitted_held_out_rmse") or truth["achievable_held_out_rmse"]
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
