"""Curves of relations that no law describes: the true one, and the error of others.

The base model's own parameters may take a part of a relation: a free resistance takes
what is proportional to the flow. That part is left out of both curves where the truth
says so, since it is in the fitted parameter and not missing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.concealed.effects import Effect, hung, kind_of_place, law_of
from benchmarks.concealed.laws import smooth_effort
from benchmarks.concealed.machine import Array
from benchmarks.concealed.recording import simulate
from benchmarks.concealed.strength import Absorbed, Truth

POINTS = 61
WITHIN = 0.1
"""Error at which a curve is called right."""
COVERED = 0.9
"""Share of the visited range that a curve has to cover."""
VISITED = (0.01, 0.99)
"""Quantiles of the motion that bound the visited range."""

ARGUMENT = {"tabulated_law": "flow", "periodic_and_quadratic": "displacement"}
UNITS = {
    "flow": ("rad/s", "m/s", "A", "m^3/s"),
    "displacement": ("rad", "m"),
    "effort": ("Pa", "K", "V"),
}


def true_curve(
    truth: Truth, effects: Sequence[Effect], absorbed: Absorbed
) -> dict[str, Any] | None:
    """Return the missing relation over the range visited, if it is a curve.

    Effort against the motion at a junction with a common flow; flow that is lost, over
    the effort, at one that stores.
    """
    curved = [e for e in effects if law_of(e.site) in ARGUMENT]
    if len(effects) != 1 or not curved:
        return None
    effect, machine = curved[0], truth.machine
    name = effect.site.place
    if kind_of_place(machine, name) != "place":
        return None
    place, kind, numbers = hung(machine, effect, truth.scales[name])
    argument = "effort" if place.cell >= 0 else ARGUMENT[law_of(effect.site)]
    visited = np.concatenate(
        [
            simulate(
                machine, one, effects, values=truth.values, scales=truth.scales,
                watch=True, exact=True,
            ).motion[name][0 if argument == "displacement" else 1]
            for one in truth.plans
        ]
    )  # fmt: skip
    x = np.linspace(*np.quantile(visited, VISITED), POINTS)
    still = np.zeros(1)
    given = np.array(numbers, dtype=float)
    y = [
        smooth_effort(kind, given, at, at, still)  # each law reads one of the two
        for at in x
    ]
    return {
        "argument": argument,
        "x": x.tolist(),
        "y": [float(value) for value in y],
        "linear_part_is_absorbed": _absorbs_linear(truth, effect, absorbed),
    }


def _absorbs_linear(truth: Truth, effect: Effect, absorbed: Absorbed) -> bool:
    """Return whether a free parameter takes what is proportional to the argument."""
    stores = truth.machine.place(effect.site.place).cell >= 0
    if not stores and law_of(effect.site) != "tabulated_law":
        return False
    word = "leak" if stores else "viscous_friction"
    site = replace(effect.site, word=word, law="")
    dry = replace(effect.site, word="tabulated_law", law="")
    small = 1e-5  # What is absorbed is, to first order: the rest grows as its square.
    linear = absorbed.strength([Effect(site, small)]).max()
    return bool(linear < 0.1 * absorbed.strength([Effect(dry, small)]).max())


def curve_error(
    effects: Sequence[Mapping[str, Any]], answer: Mapping[str, Any] | None
) -> float | None:
    """Return rms difference over rms of the true curve, over the range visited.

    None where the truth is no curve, where the answer shows none over the same
    argument, and infinite where it covers less than nine tenths of the range.
    """
    curve = next((e["curve"] for e in effects if e.get("curve")), None)
    if curve is None or answer is None or len(effects) != 1:
        return None
    accepted = {place for one in effects[0]["accepted"] for place in one["places"]}
    shown = [
        law
        for law in answer.get("recovered", ())
        if law["place"] in accepted
        and law["argument"]["unit"] in UNITS[curve["argument"]]
        and len(law["curve"][0]) > 1
    ]
    if not shown:
        return None
    x, y = np.array(curve["x"]), np.array(curve["y"])
    at, value = (np.array(part, dtype=float) for part in shown[0]["curve"])
    order = np.argsort(at)
    inside = (x >= at.min()) & (x <= at.max())
    if inside.mean() < COVERED:
        return float("inf")
    x, y = x[inside], y[inside]
    guess = np.interp(x, at[order], value[order])
    if curve["linear_part_is_absorbed"]:
        y, guess = _without_linear(x, y), _without_linear(x, guess)
    return float(np.sqrt(np.mean((guess - y) ** 2) / np.mean(y**2)))


def _without_linear(x: Array, y: Array) -> Array:
    return np.asarray(y - x * (x @ y) / (x @ x))
