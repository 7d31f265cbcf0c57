"""Laws with a name, read off a curve without one: each begins where it draws the line.

A curve finds its way from anywhere and takes the model's own numbers along; a law with
a name may promise nothing from where the model began, or go astray on its way. Where a
curve leads, every law of the same one variable at its place is laid along it, and those
that come near are fitted from there.
"""

from collections.abc import Sequence
from operator import itemgetter

import numpy as np

from bondgraph.diagnosis.candidates import CURVE, Candidate, is_named, leading
from bondgraph.diagnosis.drawn_laws import curve_of, law_curve
from bondgraph.diagnosis.search.laws.laid_along import Line, laid_along
from bondgraph.diagnosis.search.trials.trying import Start, Trial
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.structure.edits import InsertElement, WrapInput

FAR = 1.25
"""A curve leads where all laws with a name leave so many times what it does."""

MOST = 3
"""Laws that are fitted."""

POINTS = 60
"""Of the line that laws are laid along."""


def curve_that_leads(candidates: Sequence[Candidate]) -> Candidate | None:
    """Return the curve beside which no law with a name comes near; None without one."""
    best = leading(candidates)
    if best is None or best.hypothesis.physics != CURVE:
        return None
    named = (one.cost for one in candidates if is_named(one.hypothesis))
    return best if all(cost > FAR * best.cost for cost in named) else None


def read_off(
    candidates: Sequence[Candidate], hypotheses: Sequence[Hypothesis]
) -> list[Trial]:
    """Return the fits of laws that draw nearly the line of a curve that leads.

    Parameters
    ----------
    hypotheses
        All that was proposed.
    """
    curve = curve_that_leads(candidates)
    line = None if curve is None else _line(curve)
    if curve is None or line is None:
        return []
    near: list[tuple[float, Trial]] = []
    for law in hypotheses:
        if law.place == curve.hypothesis.place and is_named(law):
            found = laid_along(law, curve.hypothesis, line)
            if found is not None:
                values = {**curve.fitted.values, **found[1]}
                near.append((found[0], Trial(law, (Start(values),))))
    return [trial for _, trial in sorted(near, key=itemgetter(0))[:MOST]]


def _line(curve: Candidate) -> Line | None:
    """Return the line of a curve of an input, or of what hangs at a junction."""
    law = curve.hypothesis
    if isinstance(law.edit, WrapInput) and law.shape is not None:
        x, y = curve_of(curve.fitted, law.shape.argument, law.shape.value)
    elif isinstance(law.edit, InsertElement) and law.factor == 1 and law.visited:
        (variable,) = law.depends_on
        x, y = law_curve(curve.fitted, curve, variable)
    else:
        return None
    told = np.isfinite(x) & np.isfinite(y)
    x, y = x[told], y[told]
    if len(x) < POINTS:
        return None
    at = np.linspace(0, len(x) - 1, POINTS).astype(np.int64)
    return x[at], y[at]
