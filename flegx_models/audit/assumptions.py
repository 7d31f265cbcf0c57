"""What the assumptions of chapter 4 cost, and what is left of the loops in stance.

The costs are those of `flegx_models.decoupling` and `flegx_models.neglected`: two
graphs that differ in one assumption. They contradict no printed number; they say how
far the printed models are from the leg that they are to stand for.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

from flegx_models.audit.records import Remark
from flegx_models.controllers import printed_loop
from flegx_models.decoupling import Assumption, assumptions
from flegx_models.neglected import bending, neglected
from flegx_models.published import PUBLISHED

_WORTH_SAYING = 1e-2  # relative change of the gain
_ALONE = "the other motor gives no torque"
_EQUATIONS = {entry.model: entry.gain_equation for entry in PUBLISHED}


def remarks() -> Iterator[Remark]:
    """Yield the costs above one per cent, per model, and what stance loops become."""
    costs = assumptions()
    for model, equation in _EQUATIONS.items():
        own = [cost for cost in costs if cost.model == model]
        large = [cost for cost in own if _largest(cost) > _WORTH_SAYING]
        said = ", ".join(f"'{cost.statement}' {_change(cost)}" for cost in large)
        rest = len(own) - len(large)
        few = f"{'the other' if large else 'all'} {rest} less than 1 %"
        parts = [part for part, there in ((said, large), (few, rest)) if there]
        yield Remark(
            where=equation,
            statement="What giving up one assumption more does to the gain at θ0 (over "
            f"the working range): {'; '.join(parts)}.",
        )
    yield from _stance_loops([cost for cost in costs if _ALONE in cost.statement])
    shares = {
        term: max(row.share for row in neglected() if row.term == term)
        for term in ("h", "G")
    }
    yield Remark(
        where="eq. 4.1",
        statement=f"At the squat's speed h(q, q̇) makes at most "
        f"{100 * shares['h']:.0f} % of the acceleration that the motor's nominal "
        f"torque makes; G(q), uncompensated, "
        f"{100 * shares['G']:.0f} %.",
    )
    knee, hip = bending()
    yield Remark(
        where="chapter 4",
        statement="'Both the links are rigid': on the ground the lower one bends "
        f"against the drives at {knee.resonance:.1f} rad/s and changes the gain at the "
        f"crossover by {100 * knee.alone:+.0f} % (knee) and {100 * hip.alone:+.0f} % "
        f"(hip) for a motor alone, by {100 * knee.opposed:+.0f} % and "
        f"{100 * hip.opposed:+.0f} % for motors that oppose each other.",
    )


def _largest(cost: Assumption) -> float:
    return max(abs(cost.lowest), abs(cost.highest), abs(cost.gain_change))


def _change(cost: Assumption) -> str:
    at, low, high = (
        f"{round(100 * x, 1) + 0.0:+.1f} %"
        for x in (cost.gain_change, cost.lowest, cost.highest)
    )
    return f"{at} ({low} to {high})"


def _stance_loops(costs: list[Assumption]) -> Iterator[Remark]:
    """Say what the printed stance controllers make of the whole leg's gains."""
    for cost in costs:
        loop = printed_loop(cost.model)
        printed = next(e.gain for e in PUBLISHED if e.model == cost.model)
        words = []
        for gain in (cost.gain, cost.gain_without):
            found = replace(loop, numerator=loop.numerator * gain / printed).figures
            words.append(
                f"{gain:.2f}, crossover {found.crossover:.2f} rad/s and margin "
                f"{math.degrees(found.phase_margin):.1f}°"
            )
        yield Remark(
            where=_EQUATIONS[cost.model],
            statement=f"Both motors turn in stance. Instead of {printed:g} the joint "
            f"has, its motor alone, a gain of {words[0]} with the designed controller; "
            f"with the other motor opposing it {words[1]}.",
        )
