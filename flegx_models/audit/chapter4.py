"""Chapter 4: gains and friction poles, from the graphs, and which numbers disagree.

Gains and poles are the symbolic ones of the engine; nothing is written here as a
formula except what the thesis itself wrote down wrongly.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import sympy

from bondgraph import Parameter, ParameterSet, derive, linearise, reconcile
from flegx_models import models
from flegx_models.audit.records import (
    Correction,
    Question,
    Remark,
    Row,
    named,
    published,
    row_of,
)
from flegx_models.gains import derived
from flegx_models.parameters import PRINTED, RECONCILED
from flegx_models.parameters_audit import STEEL, WORM_SLIP
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.published import PUBLISHED, PublishedTransferFunction

_LINK = {"lowerleg": "I_lowerleg", "upperleg": "I_upperleg"}
_RATIOS = ("K_gearbox", "K_worm_gear")

_CHANGES = (
    "RECONCILED: I_motor 2.1348e-5, I_upperleg 0.1406, in stance also the tendons' "
    "mass on the lower leg's branch and L = 0.30922 m, which is not printed"
)
_POLE = (
    "printed as c / I_load, on the way to eq. {step}; the component equations give "
    "c / J with J the whole reflected inertia"
)

_OWN_FORMULA = (
    "; and I_load = 0.143 of eq. 4.12 gives 0.117, which the zero 0.12 of eq. 5.16 "
    "fits, only 0.0593 gives 0.28"
)


@cache
def transfer(model: str) -> tuple[sympy.Expr, sympy.Expr]:
    """Return gain and friction pole (its magnitude) of one model as formulas."""
    graph = getattr(models, model)().finish()
    found = linearise(derive(graph)).transfer_function("theta", "T_motor")
    poles = [root for f in found.pole_zero_gain.poles for root in f.roots]
    (pole,) = (root for root in poles if root != 0)
    return found.gain, -pole


def rows() -> Iterator[Row]:
    """Yield the rows of chapter 4, with the poles that chapter 5 prints."""
    for entry in PUBLISHED:
        yield _gain_row(entry)
    for entry, step in zip(PUBLISHED, ("4.4", "4.10", "4.27", "4.33"), strict=True):
        yield _pole_row(entry, step)


def gain_of(entry: PublishedTransferFunction) -> Parameter:
    """Return a printed gain with its rounding."""
    return _printed(f"gain_{entry.model}", entry.gain, entry.gain_decimals)


def _printed(name: str, value: float, decimals: int) -> Parameter:
    return Parameter(name=name, value=value, rounding=0.5 * 10.0**-decimals)


def _gain_row(entry: PublishedTransferFunction) -> Row:
    return row_of(
        gain_of(entry),
        transfer(entry.model)[0],
        PRINTED,
        place=(4, entry.gain_equation),
        quantity=f"gain, {_words(entry.model)}",
        unit=("rad/s²/(N·m)", 1.0),
        correction=Correction(cause=_CHANGES, data=RECONCILED),
    )


def _pole_row(entry: PublishedTransferFunction, step: str) -> Row:
    limb = entry.model.partition("_")[0]
    friction = sympy.Symbol(f"c_friction_{limb}", real=True)
    load = sympy.Symbol(_LINK[limb], real=True)
    _, right = derived(getattr(models, entry.model)(RECONCILED))
    cause, data = _POLE.format(step=step), RECONCILED
    cause += f", {entry.friction_pole / right:.0f} times slower"
    if limb == "upperleg":
        cause += _OWN_FORMULA
        data = RECONCILED.merged([_renamed("I_upperleg_link", "I_upperleg")])
    return row_of(
        _printed(f"pole_{entry.model}", entry.friction_pole, entry.pole_decimals),
        transfer(entry.model)[1],
        RECONCILED,
        place=(5, entry.pole_equation),
        quantity=f"friction pole, {_words(entry.model)}",
        unit=("rad/s", 1.0),
        correction=Correction(cause=cause, formula=friction / load, data=data),
    )


def _renamed(name: str, to: str) -> Parameter:
    return replace(PRINTED[name], name=to)


def questions() -> Iterator[Question]:
    """Yield what would have to change for the gains to come out."""
    results = [
        published(gain_of(entry), transfer(entry.model)[0], entry.model)
        for entry in PUBLISHED
    ]
    yield Question(
        title="flight gains, any two inertias (eq. 4.7, 4.12)",
        comment="No single inertia explains both; these pairs do. The first is the one "
        "in RECONCILED.",
        answer=reconcile(results[:2], PRINTED),
    )
    yield Question(
        title="flight gains, a slip in a ratio",
        comment="26:1 and 9.67:1 are exact by their tooth counts; a slip in either "
        "when the gains were computed would explain both.",
        answer=reconcile(results[:2], PRINTED, suspects=_RATIOS),
    )
    yield Question(
        title="stance gains, one length L (eq. 4.30, 4.35)",
        comment="With the flight gains' corrections made. No L gives both gains with "
        "the printed masses; the tendons' 0.25 kg on the lower leg's branch lie in the "
        "range that does.",
        answer=reconcile(results[2:], _stance_data(), suspects=_MASSES),
    )


_MASSES = ("m_lowerleg", "m_upperleg", "m_motors_support")


def _stance_data() -> ParameterSet:
    return PRINTED.merged(named(RECONCILED, ("I_motor", "I_upperleg")).members)


def remarks() -> Iterator[Remark]:
    """Yield what the printed gains need."""
    v = {p.name: p.value for p in PRINTED.members if p.value is not None}
    N = v["K_gearbox"] * v["K_worm_gear"]
    needed = {entry.model: N / entry.gain for entry in PUBLISHED}
    own = {
        entry.model: N / derived(getattr(models, entry.model)(PRINTED))[0]
        for entry in PUBLISHED[:2]
    }
    missing = ", ".join(
        f"{_words(model)} {needed[model]:.5f} of which {needed[model] - J:.4f} are "
        f"missing"
        for model, J in own.items()
    )
    yield Remark(
        where="eq. 4.7, 4.12",
        statement=f"N / gain, the reflected inertia in kg·m²: {missing}.",
    )
    support = {
        limb: needed[f"{limb}_stance"] - needed[f"{limb}_flight"] for limb in _LINK
    }
    lever = 2 * math.sin(v["theta_0"])
    masses = {
        limb: v["m_motors_support"] + (RECONCILED[f"m_{limb}"].value or 0.0)
        for limb in _LINK
    }
    lengths = {limb: math.sqrt(support[limb] / masses[limb]) / lever for limb in _LINK}
    yield Remark(
        where="eq. 4.30, 4.35",
        statement="N / gain is "
        + " and ".join(f"{needed[f'{x}_stance']:.5f} kg·m² ({x})" for x in _LINK)
        + ", and stance minus flight "
        + " and ".join(f"{support[x]:.5f} kg·m² ({x})" for x in _LINK)
        + "; with "
        + " and ".join(f"{masses[x]:.2f} kg" for x in _LINK)
        + " that is L = "
        + " and ".join(f"{lengths[x]:.4f} m" for x in _LINK)
        + ".",
    )
    slipped = PRINTED.with_values({"I_worm": 10 * v["I_worm"]})
    gains = [
        derived(getattr(models, entry.model)(slipped))[0] for entry in PUBLISHED[:2]
    ]
    yield Remark(
        where="Table 2.3",
        statement=f"A worm inertia of 3.00e-4 instead of 3.00e-5 kg·m² gives "
        f"{gains[0]:.2f} and {gains[1]:.2f}, nearly the printed flight gains; the "
        f"lower leg's then needs another number as well.",
    )
    supposed = RECONCILED.merged(WORM_SLIP.members)
    all_four = [
        derived(getattr(models, entry.model)(supposed))[0] for entry in PUBLISHED
    ]
    yield Remark(
        where="Table 2.3",
        statement="With I_worm = 3.0008e-4, I_gear,tendons = 3.146e-3 (6e-4 is "
        "measured), L = 0.30923 m and the rest inside its rounding all four gains are "
        + ", ".join(f"{gain:.2f}" for gain in all_four)
        + ": a larger change than RECONCILED's, and a steel worm of 31 mm has about "
        "3e-5, the table's value.",
    )
    yield _length_of_the_inertia(v)
    yield _mass_of_the_tendons()


def _length_of_the_inertia(v: dict[str, float]) -> Remark:
    """Say which L makes 0.143 of 0.0593 and the lower leg as a point mass."""
    rest = (v["I_upperleg"] - v["I_upperleg_link"]) / v["m_lowerleg_link"]
    l_cm, cos = v["l_cm_lowerleg"], math.cos(v["theta_knee"])
    # rest = L² + l² + 2 L l cos θ, the square of the point's distance from the hip
    L = -l_cm * cos + math.sqrt((l_cm * cos) ** 2 - l_cm**2 + rest)
    return Remark(
        where="eq. 4.12",
        statement=f"I_upperleg = 0.143 from 0.0593 and a point mass of 0.61 kg, 0.10 m "
        f"behind a knee bent by π/4, needs L = {L:.3f} m; the stance gains need 0.309 "
        f"m, the gravity terms 0.300 m. Eq. 4.14 states that both links have length L.",
    )


def _mass_of_the_tendons() -> Remark:
    """Say what two steel bars weigh, beside what the masses leave for them."""
    c = CHAPTER_3.values_by_name()
    gear = (c["m_upperleg_total"] - c["m_upperleg"]) / 2
    left = c["m_lowerleg_total"] - c["m_lowerleg"] - gear
    density = STEEL.value or 0.0
    bars = 2 * math.pi * c["r_tendon"] ** 2 * c["L_tendon"] * density
    return Remark(
        where="section 3.3.4",
        statement=f"The masses leave {gear:.2f} kg for one gear and {left:.2f} kg for "
        f"the tendons; two 8 mm steel bars of 300 mm weigh {bars:.2f} kg. This is the "
        f"mass that the lower leg's stance gain needs.",
    )


def _words(model: str) -> str:
    limb, _, phase = model.partition("_")
    return f"{limb}, {phase}"
