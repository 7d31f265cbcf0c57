"""Nine small cases with a floor: what a change to the toolkit must not lose.

Chosen by kind before any of them was diagnosed: three that conceal nothing, five plain
effects on different machines, and one outside of the library; friction of the worm is
the demo's own test. Recordings are short, so that all takes some two minutes of one
core; the effects are strong, so that a miss means something. It is a guard and no
measure: the full list is that. The floor is one below what was right when it was set:
one edge may fall to another processor's last digits, two do not.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from benchmarks.concealed.cases import Case
from benchmarks.concealed.machines import MACHINES
from benchmarks.concealed.making import make
from benchmarks.concealed.recording import Nuisance
from benchmarks.concealed.running import run_in_one_process
from benchmarks.concealed.scoring import Outcome, Scored, score

SAMPLES = 1000
STRENGTH = 25.0
SEED = 404
EMPTY = ("cart", "pendulum", "two_tanks")
CONCEALED = (
    ("cart", "coulomb_friction", "cart"),
    ("pendulum", "quadratic_drag", "pivot"),
    ("two_tanks", "square_root_orifice", "R_outlet"),
    ("dc_motor", "saturation", "voltage"),
    ("rlc_circuit", "voltage_drop", "loop"),
    ("cart", "tabulated_law", "cart"),
)
MINUTES = 1.0
"""The search for a case is ended after that; its answer is what was found by then."""

FLOOR = 5
"""Of the six effects as many must be right."""


@dataclass(frozen=True, slots=True)
class Reduced:
    """What came of the reduced run."""

    scored: tuple[Scored, ...]

    @property
    def right(self) -> int:
        """Effects with place and physics right."""
        return sum(s.outcome is Outcome.RIGHT for s in self.scored)

    @property
    def false_alarms(self) -> int:
        """Empty cases of which something was said."""
        return sum(s.outcome is Outcome.FALSE_ALARM for s in self.scored)

    @property
    def held(self) -> bool:
        """Whether the floor holds: enough right, no false alarm, all answered."""
        whole = len(self.scored) == len(EMPTY) + len(CONCEALED)
        answered = all(s.outcome is not Outcome.NO_ANSWER for s in self.scored)
        return whole and answered and self.right >= FLOOR and not self.false_alarms

    def __str__(self) -> str:
        lines = [
            f"{s.case:36s} {s.outcome.value:28s} {', '.join(s.said) or s.verdict:44s}"
            f"{s.seconds:6.1f} s"
            for s in self.scored
        ]
        lines.append(
            f"{self.right} of {len(CONCEALED)} effects right (floor {FLOOR}), "
            f"{self.false_alarms} false alarms of {len(EMPTY)} (floor 0): "
            f"the floor {'holds' if self.held else 'is BROKEN'}."
        )
        return "\n".join(lines)


def reduced_cases() -> list[Case]:
    """Return the nine cases."""
    listed: list[tuple[str, str, str]] = [(name, "", "") for name in EMPTY]
    return [_case(i, *which) for i, which in enumerate([*listed, *CONCEALED])]


def _case(index: int, name: str, word: str, place: str) -> Case:
    machine = replace(MACHINES[name], samples=SAMPLES)
    sites = [site for site in machine.sites if (site.word, site.place) == (word, place)]
    return Case(
        name=f"reduced_{index}_{name}_{word or 'nothing'}",
        machine=machine,
        sites=tuple(sites[:1]),
        strength=STRENGTH,
        seed=SEED + index,
        nuisance=Nuisance(),
    )


def run_reduced(folder: Path) -> Reduced:
    """Make the cases under `folder`, diagnose and score them."""
    public, sealed, answers = (folder / name for name in ("cases", "truth", "answers"))
    for case in reduced_cases():
        make(case, public, sealed)
    run_in_one_process(public, answers, MINUTES)
    return Reduced(tuple(score(answers, sealed)))
