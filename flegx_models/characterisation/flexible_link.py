"""The flexible link as a bond graph: an oscillator per bending mode, a mass at the tip.

A mode of the clamped strip is a 1-junction with its modal mass (I), compliance (C) and
damping (R). A force at x acts on it through a transformer with modulus φ_r(x), and the
same transformer gives the mode's share of the velocity at x, so a *place* on the strip
is a 0-junction: one force, velocities that add up. The tip mass hangs on the tip's
0-junction; its velocity follows from the modes, so the engine finds it in derivative
causality and forms the mass matrix m δ_rs + M φ_r(L) φ_s(L) by itself.

With N modes the frequencies are upper bounds that fall to those of the exact equation
(`flegx_models.characterisation.beam_modes`), with an error like N⁻³. `StaticCorrection`
puts the compliance of the left-out modes on the tip: the static stiffness is then
exact, the error falls like N⁻⁷, and no storage is dependent any more, at the price of
one more, fast, oscillator between the tip mass and that compliance.
"""

from dataclasses import dataclass

import sympy

from bondgraph import TF, BondGraph, C, I, Parameter, ParameterSet, R, Se, displacement
from bondgraph import effort as effort_of
from flegx_models.characterisation.beam_modes import UniformBeam
from flegx_models.characterisation.errors import CharacterisationError


@dataclass(frozen=True, slots=True)
class Truncated:
    """The modes above the last are left out: they count as rigid."""


@dataclass(frozen=True, slots=True)
class StaticCorrection:
    """The modes above the last keep their static compliance, seen from the tip."""


@dataclass(frozen=True, slots=True)
class FreeTip:
    """Nothing hangs at the tip."""


@dataclass(frozen=True, slots=True)
class TipMass:
    """A point mass at the tip, kg."""

    mass: float


@dataclass(frozen=True, slots=True)
class OpenTip:
    """The junction ``tip`` waits for another graph; power is positive into the link."""


Truncation = Truncated | StaticCorrection
Tip = FreeTip | TipMass | OpenTip


def flexible_link(
    beam: UniformBeam,
    *,
    modes: int,
    force_at: float,
    gauge_at: float = 0.0,
    tip: Tip | None = None,
    damping: float = 0.0,
    truncation: Truncation | None = None,
) -> BondGraph:
    """Return the link with its modes, driven by ``force`` and read by its sensors.

    Input ``force`` in N at `force_at`. Outputs: ``strain`` at the gauge,
    ``tip_displacement`` in m and, with a tip mass, ``tip_acceleration`` in m/s², all
    positive in the direction of the force.

    Parameters
    ----------
    modes
        Number of bending modes N.
    force_at, gauge_at
        Places on the strip, m from the clamp.
    tip
        `FreeTip` (default), `TipMass` or `OpenTip`.
    damping
        Damping factor ζ of every mode.
    truncation
        `Truncated` (default) or `StaticCorrection`; a free tip has nothing to correct.

    Raises
    ------
    CharacterisationError
        If there is no mode, or a place is not on the strip.
    """
    _refuse_outside(beam, force_at=force_at, gauge_at=gauge_at)
    omega = beam.frequencies(modes)
    numbers = range(1, modes + 1)
    link = BondGraph(f"flexible link, {modes} modes", domain="translation")
    free = tip is None or isinstance(tip, FreeTip)
    if not free:
        link.zero("tip")
    link.zero("hit", Se("force"))
    for r in numbers:
        link.one(f"mode_{r}", I(f"m_mode_{r}"), C(f"C_mode_{r}"), R(f"c_mode_{r}"))
        if not free:
            link.join("tip", TF(f"phi_tip_{r}"), f"mode_{r}")
        link.join("hit", TF(f"phi_hit_{r}"), f"mode_{r}")
    values: list[tuple[str, float, str]] = []
    for r, w in zip(numbers, omega.tolist(), strict=True):
        values += [
            (f"m_mode_{r}", beam.mass, "kg"),
            (f"C_mode_{r}", 1 / (beam.mass * w**2), "m/N"),
            (f"c_mode_{r}", 2 * damping * w * beam.mass, "N*s/m"),
            (f"phi_tip_{r}", float(beam.shape(r, beam.length)), "1"),
            (f"phi_hit_{r}", float(beam.shape(r, force_at)), "1"),
            (f"strain_{r}", float(beam.surface_strain(r, gauge_at)), "1/m"),
        ]
    reading = _sum("phi_tip", numbers)
    if isinstance(truncation, StaticCorrection) and not free:
        link.put(C("C_residual"), on="tip")
        values.append(("C_residual", residual_compliance(beam, modes), "m/N"))
        reading += displacement("C_residual")
    if isinstance(tip, TipMass):
        link.put(I("m_tip"), on="tip")
        values.append(("m_tip", tip.mass, "kg"))
        # The flows at a 0-junction balance: what goes into the modes comes from the
        # mass, so its port sees the negative of the tip's velocity.
        acceleration = -effort_of("m_tip") / sympy.Symbol("m_tip")
        link.measure("tip_acceleration", acceleration, unit="m/s^2")
    link.measure("strain", _sum("strain", numbers), unit="1")
    link.measure("tip_displacement", reading, unit="m")
    link.take(
        ParameterSet(
            tuple(Parameter(name=n, value=v, unit=unit) for n, v, unit in values)
        )
    )
    return link


def residual_compliance(beam: UniformBeam, modes: int) -> float:
    """Return the tip compliance that the first modes leave out, m/N.

    L³/(3 E I) - Σ φ_r(L)²/(m ω_r²), positive: the modes' sum converges from below.
    """
    omega = beam.frequencies(modes)
    kept = sum(
        float(beam.shape(r + 1, beam.length)) ** 2 / (beam.mass * w**2)
        for r, w in enumerate(omega.tolist())
    )
    return float(beam.length**3 / (3 * beam.bending_stiffness) - kept)


def _sum(name: str, numbers: range) -> sympy.Expr:
    """Return Σ name_r q_r over the modal coordinates."""
    return sum(
        (sympy.Symbol(f"{name}_{r}") * displacement(f"C_mode_{r}") for r in numbers),
        start=sympy.Integer(0),
    )


def _refuse_outside(beam: UniformBeam, **places: float) -> None:
    for name, x in places.items():
        if not 0 <= x <= beam.length:
            raise CharacterisationError(
                f"{name} = {x:g} m is not on the strip of {beam.length:g} m.",
                (name,),
                "Give a distance from the clamp between 0 and the length.",
            )
