"""What an answer has right about a drive, piece by piece.

Written down before the diagnoses of the four drives were run; one of them, of the
worm's friction alone, had been seen. Places are names of the printed models. Motor,
worm, joint and support turn together there, so that only what lies between them can
tell one from the other.

As in the proof, a place that the answer calls not told from the one it names counts as
named; a finding of which no number is known counts as nothing. These two rules were
added with the first answers that needed them, and on 2026-11-30 two more: a compliance
that is not of the concealed size, to a factor of three, is another one; and how fast
something swings is no number of it, where its inertia is none; and on 2026-12-01 a
fifth: a spring against the ground gives way nowhere between motor and load.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from benchmarks.flegx_story.leg import JOINTS, LINK, TENDON
from benchmarks.flegx_story.train import RATIO, WORM

TRAIN = ("motor", "worm", "joint", "support")

RIGHT: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "worm": (("load_dependent_friction", "coulomb_friction"), TRAIN),
    "tendons": (("compliance", "added_compliance"), TRAIN),
    "link": (("compliance", "added_compliance"), TRAIN),
    "filter": (("lag", "delay"), ("theta", "T_motor")),
}
"""Words and places of each piece: friction of the mesh has a part of either law, two
second-order filters are lag and delay, and one signal path has them at either end."""

COMPLIANCES = {"tendons": 1.0 / TENDON, "link": 1.0 / LINK}
"""In rad/(N·m) at the joint."""

SCALES = (1.0, 1.0 / WORM**2, 1.0 / RATIO**2)
"""Of a compliance at the joint, at the worm and at the motor, seen from the joint."""

OFF = 3.0
"""A compliance so many times larger or smaller is another one."""

FORMS = ("mode_frequency_", "mode_damping_")
"""How numbers begin that say how something swings, and not that anything does."""

FAMILY = {
    "worm": ("friction", "drag", "hysteresis"),
    "tendons": ("compliance", "backlash"),
    "link": ("compliance", "backlash"),
    "filter": ("lag", "delay"),
}
"""What other words would be the same sort of thing."""


class Told(StrEnum):
    """What came of one concealed piece."""

    RIGHT = "found and named"
    KIND = "found, called another of its kind"
    SILENT = "not found"


@dataclass(frozen=True, slots=True, kw_only=True)
class Telling:
    """A case: what was concealed and came of it, and what else was said.

    ``before`` and ``after`` are held-out errors of the angle in rad.
    """

    name: str
    verdict: str
    pieces: Mapping[str, Told]
    beside: tuple[str, ...]
    before: float
    after: float


def model_and_concealed(name: str) -> tuple[str, str]:
    """Return the printed model of a case and what it conceals: a piece, or ``all``.

    Whatever sensors it was recorded with.
    """
    limb, phase, which = name.removesuffix("_gauged").split("_", 2)
    return f"{limb}_{phase}", which


def concealed_in(name: str) -> tuple[str, ...]:
    """Return the pieces that a case's name stands for."""
    model, which = model_and_concealed(name)
    (joint,) = (one for one in JOINTS if one.model == model)
    pieces = RIGHT if which == "all" else (which,)
    return tuple(one for one in pieces if joint.tendons or one != "tendons")


def _named(finding: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the place of a finding, and the others that it names where it has a size.

    Some number of it has to be told from none by two standard errors.
    """
    sized = any(
        one["std"] is not None and abs(one["value"]) > 2.0 * one["std"]
        for name, one in finding["parameters"].items()
        if not name.startswith(FORMS)
    )
    others = finding["indistinguishable_places"]
    return (finding["place"], *others) if sized else (f"{finding['place']} (no size)",)


def _of_its_size(piece: str, finding: Mapping[str, Any]) -> bool:
    """Return whether a compliance that was found is as large as the concealed one."""
    concealed = COMPLIANCES.get(piece)
    if concealed is None:
        return True
    sizes = _compliances(finding["parameters"])
    return not sizes or any(
        1.0 / OFF < scale * size / concealed < OFF for size in sizes for scale in SCALES
    )


def _compliances(parameters: Mapping[str, Mapping[str, float]]) -> list[float]:
    """Return those that a finding's numbers say: of a spring, or of what swings on one.

    A mode of inertia I and rate w hangs on a compliance of 1 / (I w^2).
    """
    value = {name: one["value"] for name, one in parameters.items()}
    springs = [
        size
        for name, size in value.items()
        if name.startswith("compliance_") and "damping" not in name
    ]
    modes = [
        1.0 / stiffness
        for name, inertia in value.items()
        if name.startswith("mode_inertia_")
        and (stiffness := inertia * value[name.replace("inertia", "frequency")] ** 2)
    ]
    return springs + modes


def telling(answer: Path) -> Telling:
    """Return what an answer has right; a finding stands for one piece at most."""
    told: dict[str, Any] = json.loads(answer.read_text("utf-8"))
    left = [(one["physics"], _named(one), one) for one in told["findings"]]
    pieces = dict.fromkeys(concealed_in(answer.stem), Told.SILENT)
    for wanted in (Told.RIGHT, Told.KIND):
        for piece, found in pieces.items():
            words, places = RIGHT[piece]
            for physics, named, one in left if found is Told.SILENT else ():
                exact = physics in words
                alike = any(word in physics for word in FAMILY[piece])
                there = not set(named).isdisjoint(places)
                fits = there and _of_its_size(piece, one)
                if fits and (exact if wanted is Told.RIGHT else alike):
                    pieces[piece] = wanted
                    left.remove((physics, named, one))
                    break
    errors = told["fit"]["held_out"]
    return Telling(
        name=answer.stem,
        verdict=told["verdict"],
        pieces=pieces,
        beside=tuple(f"{physics} at {named[0]}" for physics, named, _ in left),
        before=errors["before"]["rmse"]["theta"],
        after=errors["after"]["rmse"]["theta"],
    )


def tellings(answers: Path) -> list[Telling]:
    """Return those of all answers in a folder."""
    found = sorted(answers.glob("*.json"))
    return [telling(one) for one in found if not one.name.endswith(".run.json")]
