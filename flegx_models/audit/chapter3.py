"""Chapter 3: the results of its own data, and those whose data are not all printed."""

import math
from collections.abc import Iterator

from flegx_models.audit.records import Remark, Row, Verdict
from flegx_models.characterisation.added_mass import (
    equivalent_mass,
    tip_mass_between,
)
from flegx_models.characterisation.beam_modes import wave_numbers
from flegx_models.characterisation.recomputed import Recomputed, recomputed
from flegx_models.characterisation.tendons import spacing_for
from flegx_models.parameters_audit import AUDITED
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_datasheets import DATASHEETS

_V = {p.name: p.value for p in CHAPTER_3.members if p.value is not None}


def rows() -> Iterator[Row]:
    """Yield the rows of chapter 3."""
    results = recomputed()
    for name in dict.fromkeys(r.quantity for r in results):
        yield _row([r for r in results if r.quantity == name])
    yield from _link_rows()


def _row(readings: list[Recomputed]) -> Row:
    """Return the row of one result, of which there may be a second reading."""
    first, last = readings[0], readings[-1]
    cause = last.cause
    if first.agrees and len(readings) > 1:
        # The formula as printed gives the printed number; the formula is wrong.
        verdict = Verdict.REPRODUCED
        cause = f"as printed; but {cause}"
    elif first.agrees:
        verdict = Verdict.REPRODUCED
    elif len(readings) > 1 and last.agrees:
        verdict = Verdict.CORRECTED
    else:
        verdict = Verdict.NOT_REPRODUCIBLE
    return Row(
        chapter=3,
        where=first.equation,
        quantity=first.quantity,
        printed=first.printed,
        unit=first.unit,
        derived=first.derived,
        corrected=last.derived if len(readings) > 1 else None,
        verdict=verdict,
        cause=cause,
    )


def _link_rows() -> Iterator[Row]:
    """Yield results of which a datum is missing, with the one that they would need."""
    stiffness = _V["m_eq"] * (2 * math.pi * _V["f_1"]) ** 2
    moving = equivalent_mass(stiffness, frequency=_V["f_1_expected"])
    share = AUDITED.values_by_name()["share_moving"]
    tip = tip_mass_between(
        _V["m_eq"],
        unloaded_frequency=_V["f_1"],
        loaded_frequency=_V["f_1_corrected"],
    )
    spacing = spacing_for(
        _V["T_knee_max"], force=_V["F_tendon_max"], angle=_V["theta_knee_max"]
    )
    for where, quantity, cause in (
        (
            "eq. 3.2",
            "F_tendon_max",
            f"the tendons' distance b is not printed; {1e3 * spacing:.0f} mm would do",
        ),
        (
            "eq. 3.20",
            "f_1_expected",
            f"the link's mass is not printed; with k = {stiffness:.0f} N/m, from 35 Hz "
            f"and 0.13 kg, {moving / share:.2f} kg would do",
        ),
        (
            "eq. 3.21",
            "f_1_corrected",
            f"the accelerometer's mass is not printed; {tip:.3f} kg would do",
        ),
    ):
        yield Row(
            chapter=3,
            where=where,
            quantity=quantity,
            printed=_V[quantity],
            unit=CHAPTER_3[quantity].unit,
            derived=None,
            verdict=Verdict.NOT_REPRODUCIBLE,
            cause=cause,
        )


def remarks() -> Iterator[Remark]:
    """Yield what chapter 3's numbers say beside its results."""
    bare = wave_numbers(3) ** 2
    exact = " : ".join(f"{x / bare[0]:.2f}" for x in bare)
    seen = [
        " : ".join(f"{_V[f'f_{k}{kind}'] / _V[f'f_1{kind}']:.2f}" for k in (1, 2, 3))
        for kind in ("_fem", "", "_accelerometer")
    ]
    yield Remark(
        where="tables 3.1 to 3.3",
        statement=f"A uniform clamped strip has frequencies as {exact}; FEM prints "
        f"{seen[0]}, the measurements {seen[1]}, with accelerometer {seen[2]}.",
    )
    delta = _V["I_lowerleg_total"] - _V["I_lowerleg"]
    tendons = _V["m_lowerleg_total"] - _V["m_lowerleg"]
    tendons -= (_V["m_upperleg_total"] - _V["m_upperleg"]) / 2
    rest = delta - (DATASHEETS["I_gear"].value or 0.0)
    yield Remark(
        where="section 3.3.4",
        statement=f"ΔI = {delta:.1e} kg·m² is written I_gear + 2 m r, which is not an "
        f"inertia. With r² the tendons' {tendons:.2f} kg turn at r = "
        f"{1e3 * math.sqrt(rest / tendons):.0f} mm, as written at "
        f"{1e3 * rest / tendons:.1f} mm. Eq. 3.33, a sum of first moments, is right.",
    )
    bits = math.degrees(2 * math.pi / 2**12), math.degrees(2 * math.pi / 2**14)
    yield Remark(
        where="section 3.4",
        statement=f"One PWM clock is 0.088°, a turn over 2^12 ({bits[0]:.4f}°); "
        f"section 2.1.3 says 14 bit ({bits[1]:.4f}°).",
    )
