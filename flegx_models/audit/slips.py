"""Slips in letters, signs and names: no printed number depends on them."""

from collections.abc import Iterator

from flegx_models.audit.records import Remark

_SLIPS = (
    ("eq. 3.27", "It is headed T/θ; the expression is θ/T."),
    (
        "section 3.3.3",
        "L_cm is written I/m (and T/m in section 3.3.4); the numbers are T/(m g).",
    ),
    (
        "eq. 4.12",
        "It names the friction of the knee for the hip's joint; eq. 4.35 names the "
        "hip's.",
    ),
    (
        "eq. 4.23",
        "The left-hand side F cos(π/2 - 2θ0) lacks the lever L; with it, and F = m a / "
        "cos θ0, the right-hand side 2 L sin θ0 m a follows.",
    ),
    (
        "eq. 4.31",
        "It divides by I_lowerleg in the upper leg's model; and the list of component "
        "equations below it leaves out the friction e9 that eq. 4.33 contains.",
    ),
    ("eq. 5.6", "The second line lacks a bracket; eq. 5.7 has it."),
    (
        "section 5.2",
        "The gain crossover is called ω_cp there and the phase crossover ω_cg, the "
        "other way round than usual.",
    ),
    (
        "eq. 6.2 to 6.4",
        "All are called G_c,ll,f; they are those of the upper leg in flight and of "
        "both legs in stance.",
    ),
    (
        "section 6.2",
        "The hip's landing angle is printed π/6; the squat that follows starts at "
        "-π/6, which eq. 4.16 asks for with a knee at π/3.",
    ),
)


def remarks() -> Iterator[Remark]:
    """Yield the slips in the order of the thesis."""
    for where, statement in _SLIPS:
        yield Remark(where=where, statement=statement)
