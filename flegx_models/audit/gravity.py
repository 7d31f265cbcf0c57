"""Sections 5.1 and 6.2: the torques that carry the leg, with and without counterweight.

The formulas are those that `flegx_models.gravity` derives from the leg's bond graph.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import sympy

from bondgraph import reconcile
from flegx_models.audit.records import (
    Correction,
    Question,
    Remark,
    Row,
    published,
    row_of,
)
from flegx_models.gravity import CASES, derived_feed_forward
from flegx_models.parameters import PRINTED
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CONTROL

JOINTS = ("hip", "knee")
_GRAVITY = PRINTED.merged(CONTROL.members)
_LENGTH = "L is not printed; 0.30 m is inferred"
_MASS = "with L = 0.30 m and a support of 7.6 kg, where section 3.3.1 weighs 6.6 kg"
_CASES = {
    "flight": ("eq. 5.5", "flight", _LENGTH),
    "stance": ("eq. 5.8", "stance", _MASS),
    "counterweight": ("eq. 6.5", "stance with counterweight", _MASS),
}


@cache
def formulas() -> dict[tuple[str, str], sympy.Expr]:
    """Return the factor of each torque by case and joint (eq. 5.3, 5.6, 6.5)."""
    found = {}
    for case in CASES:
        torques = derived_feed_forward(case)
        for joint, torque in zip(JOINTS, torques, strict=True):
            factor = torque / sympy.sin(sympy.Symbol(f"q_{joint}"))
            named = {
                s: sympy.Symbol(s.name, real=True)
                for s in factor.free_symbols
                if isinstance(s, sympy.Symbol)
            }
            found[case, joint] = sympy.expand(factor.xreplace(named))
    return found


def rows() -> Iterator[Row]:
    """Yield the six torques of eq. 5.5, 5.8 and 6.5."""
    inferred = _GRAVITY.merged(
        (
            replace(CONTROL["L_gravity"], name="L"),
            replace(CONTROL["m_support_gravity"], name="m_motors_support"),
        )
    )
    for (case, joint), formula in formulas().items():
        where, words, cause = _CASES[case]
        yield row_of(
            CONTROL[f"gravity_{joint}_{case}"],
            formula,
            _GRAVITY,
            place=(6 if case == "counterweight" else 5, where),
            quantity=f"gravity torque, {joint}, {words}",
            unit=("N·m", 1.0),
            correction=Correction(cause=cause, data=inferred),
        )


def questions() -> Iterator[Question]:
    """Yield what would have to change for the gravity torques to come out."""
    yield Question(
        title="gravity torques, one length L (eq. 5.5, 5.8, 6.5)",
        comment="L is inferred. With all else exactly as printed the six torques need "
        "L = 0.30 m and a support of 7.6 kg, where section 3.3.1 weighs about 6.6 kg; "
        "rounding lets one smaller change do.",
        answer=reconcile(
            [
                published(CONTROL[f"gravity_{joint}_{case}"], formula)
                for (case, joint), formula in formulas().items()
            ],
            _GRAVITY,
            suspects=(
                *("m_motors_support", "m_upperleg", "m_lowerleg_link"),
                *("l_cm_upperleg", "l_cm_lowerleg", "m_counterweight"),
            ),
        ),
    )


def remarks() -> Iterator[Remark]:
    """Yield where 7.6 kg may come from, and what the counterweight takes away."""
    v, c = CONTROL.values_by_name(), CHAPTER_3.values_by_name()
    wheels = c["m_upperleg_total"] - c["m_upperleg"]
    weighed = _GRAVITY["m_motors_support"].value or 0.0
    yield Remark(
        where="eq. 5.7",
        statement=f"The support's 7.6 kg are the weighed {weighed:g} kg and the two "
        f"worm wheels, {wheels:.2f} kg by section 3.3.3, which hang on the hip's axis "
        f"and belong to neither link: {weighed + wheels:.2f} kg. The stance gains come "
        f"out with {weighed:g} kg.",
    )
    lifted = v["m_counterweight"] * (_GRAVITY["g"].value or 0.0) * v["L_gravity"]
    less = [v[f"gravity_{j}_counterweight"] - v[f"gravity_{j}_stance"] for j in JOINTS]
    yield Remark(
        where="eq. 6.5",
        statement=f"5 kg on the rope take 5 g L = {lifted:.2f} N·m off either joint; "
        f"printed are {less[0]:.2f} (hip) and {less[1]:.2f} (knee).",
    )
