"""Chapters 4.4 to 6 without gravity and margins: numerators, controllers, tests."""

import math
from collections.abc import Iterator
from dataclasses import replace

import sympy

from bondgraph import Parameter, ParameterSet, reconcile
from flegx_models.audit.chapter4 import gain_of
from flegx_models.audit.records import (
    Correction,
    Question,
    Remark,
    Row,
    published,
    row_of,
)
from flegx_models.parameters import PRINTED, RECONCILED
from flegx_models.parameters_audit import AUDITED
from flegx_models.parameters_control import CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.published import PUBLISHED

_INF = math.inf


def rows() -> Iterator[Row]:
    """Yield the rows of section 5.2, without margins, and of chapter 6."""
    yield from _numerator_rows()
    yield from _controller_rows()
    yield from _motion_rows()


_DRIVER = ("k_driver", "zero_driver", "fast_pole_driver", "slow_pole_driver")


def _numerator(gain: str) -> sympy.Expr:
    """Return K_m · 0.20 · ω_fast ω_slow / ω_zero · gain, the loop's numerator."""
    k, zero, fast, slow = sympy.symbols(_DRIVER, real=True)
    K_m, leg = sympy.symbols(f"K_m {gain}", real=True)
    return K_m * k * fast * slow / zero * leg


def _loop_data() -> ParameterSet:
    gains = [gain_of(entry) for entry in PUBLISHED]
    return CONTROL.merged([DATASHEETS["K_m"], *gains])


def _numerator_rows() -> Iterator[Row]:
    data = _loop_data()
    k = sympy.Symbol("k_scaling", real=True)
    scaling = _scaling()
    scaled = data.merged([scaling])
    for entry, where in zip(PUBLISHED, _NUMERATORS, strict=True):
        formula = _numerator(f"gain_{entry.model}")
        yield row_of(
            CONTROL[f"numerator_{entry.model}"],
            formula,
            data,
            place=(5, where),
            quantity=f"loop numerator, {entry.model.replace('_', ', ')}",
            unit=("1/s³", 1.0),
            correction=Correction(
                cause=f"times {scaling.value:.3f}, the same in all four: 1/0.20, the "
                f"driver's duty-% per ampere, which the block diagram does not show, "
                f"and a K_m of 0.042 instead of 0.0427 N·m/A",
                formula=k * formula,
                data=scaled,
            ),
        )


_NUMERATORS = ("eq. 5.10", "eq. 5.14", "eq. 5.18", "eq. 5.22")


def _scaling() -> Parameter:
    """Return the one factor that all four numerators share, found by reconciling."""
    k = sympy.Symbol("k_scaling", real=True)
    unknown = Parameter(name="k_scaling", bounds=(0.0, _INF))
    answer = reconcile(
        [
            published(
                CONTROL[f"numerator_{e.model}"], k * _numerator(f"gain_{e.model}")
            )
            for e in PUBLISHED
        ],
        _loop_data().merged([unknown]),
        most=0,
    )
    assert answer.best is not None, "the four numerators share no factor"
    return Parameter(
        name="k_scaling", value=answer.best.values["k_scaling"], rounding=0.0
    )


def _controller_rows() -> Iterator[Row]:
    zero, growth = sympy.symbols("zero friction_growth", real=True)
    for entry in PUBLISHED:
        modified = CONTROL[f"z_{entry.model}_modified"]
        chosen = replace(CONTROL[f"z_{entry.model}"], name="zero")
        yield row_of(
            modified,
            growth * zero,
            CONTROL.merged([chosen]),
            place=(5, "section 5.2"),
            quantity=f"zero for ten times the friction, "
            f"{entry.model.replace('_', ', ')}",
            unit=("rad/s", 1.0),
        )


def _motion_rows() -> Iterator[Row]:
    period, hip, squat = sympy.symbols("period_test hip_speed squat_time", real=True)
    exact = CONTROL.merged([replace(CONTROL["period_test"], rounding=0.0)])
    for parameter, formula, where, quantity in (
        (
            AUDITED["frequency_test"],
            1 / period,
            "section 6.1",
            "frequency of the test signal",
        ),
        (CONTROL["knee_speed"], 2 * hip, "section 6.2", "speed of the knee (eq. 4.18)"),
        (CONTROL["flight_time"], squat / 2, "section 6.2", "duration of the flight"),
    ):
        yield row_of(parameter, formula, exact, place=(6, where), quantity=quantity)


def questions() -> Iterator[Question]:
    """Yield what would have to change for the loops' numerators to come out."""
    yield Question(
        title="loop numerators with ampere commands (eq. 5.10 to 5.22)",
        comment="Where 1 A of command is 1 A of current the numerator is K_m ω_fast "
        "ω_slow / ω_zero times the gain.",
        answer=reconcile(
            [
                published(
                    CONTROL[f"numerator_{entry.model}"],
                    _numerator(f"gain_{entry.model}")
                    / sympy.Symbol("k_driver", real=True),
                )
                for entry in PUBLISHED
            ],
            _loop_data(),
            suspects=("K_m", *_DRIVER[1:]),
        ),
    )


def remarks() -> Iterator[Remark]:
    """Yield what the tuned zeros say about friction, and the test signal's speed."""
    inertia = {
        entry.model: (PRINTED["K_gearbox"].value or 0.0)
        * (PRINTED["K_worm_gear"].value or 0.0)
        / entry.gain
        for entry in PUBLISHED
    }
    bearing = {
        entry.model: RECONCILED[f"c_friction_{entry.model.partition('_')[0]}"].value
        or 0.0
        for entry in PUBLISHED
    }
    for entry in PUBLISHED:
        tuned = CONTROL[f"z_{entry.model}_tuned"].value or 0.0
        printed = CONTROL[f"z_{entry.model}"].value or 0.0
        friction = tuned * inertia[entry.model]
        yield Remark(
            where="chapter 6",
            statement=f"{entry.model.replace('_', ', ')}: tuning moves the zero from "
            f"{printed:g} to {tuned:g} rad/s. A zero on the friction pole c / J means "
            f"c = {friction:.2f} N·m·s at the joint, "
            f"{friction / bearing[entry.model]:.0f} times the bearings' "
            f"{bearing[entry.model]:g}: the worm gear's, which was not measured.",
        )
    slowest = min(
        CONTROL[f"crossover_{entry.model}"].value or 0.0 for entry in PUBLISHED
    )
    period = CONTROL["period_test"].value or math.nan
    yield Remark(
        where="section 6.1",
        statement=f"The test signal's {2 * math.pi / period:.2f} rad/s is "
        f"slightly below the slowest printed crossover, {slowest:g} rad/s, as stated.",
    )
