"""The flexible link as a bond graph: an oscillator per bending mode, a mass on the tip.

A mode of the clamped strip is a 1-junction with its modal mass (I), compliance (C) and
damping (R). A force at x acts on it through a transformer with modulus φ_r(x), and the
same transformer gives the mode's share of the velocity at x, so a *place* on the strip
is a 0-junction: one force, velocities that add up. A mass hangs on the 0-junction of
its place; its velocity follows from the modes, so the engine finds it in derivative
causality and forms the mass matrix m δ_rs + M φ_r(x) φ_s(x) by itself.

With N modes the frequencies are upper bounds that fall to those of the exact equation
(`flegx_models.characterisation.beam_modes`), with an error like N⁻³. `StaticCorrection`
puts the compliance of the left-out modes there: the static stiffness is then
exact, the error falls like N⁻⁷, and no storage is dependent any more, at the price of
one more, fast, oscillator between the mass and that compliance.
"""

from dataclasses import dataclass

import sympy

from bondgraph import (
    TF,
    BondGraph,
    C,
    I,
    Parameter,
    ParameterSet,
    R,
    Se,
    displacement,
    effort,
)
from flegx_models.characterisation.beam_modes import UniformBeam
from flegx_models.characterisation.errors import CharacterisationError


@dataclass(frozen=True, slots=True)
class Truncated:
    """The modes above the last are left out: they count as rigid."""


@dataclass(frozen=True, slots=True)
class StaticCorrection:
    """The modes above the last keep their static compliance, seen from the load."""


@dataclass(frozen=True, slots=True)
class Unloaded:
    """Nothing hangs on the strip; displacements are read at the tip."""


@dataclass(frozen=True, slots=True)
class PointMass:
    """A mass, kg, at the tip or `at` m from the clamp."""

    mass: float
    at: float | None = None


@dataclass(frozen=True, slots=True)
class OpenPort:
    """The junction ``load``, at the tip, waits to be joined to another graph.

    Power is positive out of it, into the link.
    """


Truncation = Truncated | StaticCorrection
Load = Unloaded | PointMass | OpenPort


def flexible_link(
    beam: UniformBeam,
    *,
    modes: int,
    force_at: float,
    gauge_at: float = 0.0,
    load: Load | None = None,
    damping: float = 0.0,
    truncation: Truncation | None = None,
) -> BondGraph:
    """Return the link with its modes, driven by ``force`` and read by its sensors.

    Input ``force`` in N at `force_at`. Outputs: ``strain`` at the gauge,
    ``displacement`` in m at the load (or the tip) and, with a mass, its
    ``acceleration`` in m/s², all positive in the direction of the force.

    Parameters
    ----------
    modes
        Number of bending modes N.
    force_at, gauge_at
        Places on the strip, m from the clamp.
    load
        `Unloaded` (default), `PointMass` or `OpenPort`.
    damping
        Damping factor ζ of every mode.
    truncation
        `Truncated` (default) or `StaticCorrection`; without load nothing is corrected.

    Raises
    ------
    CharacterisationError
        If there is no mode, or a place is not on the strip.
    """
    at = beam.length
    if isinstance(load, PointMass) and load.at is not None:
        at = load.at
    _refuse_outside(beam, force_at=force_at, gauge_at=gauge_at, mass_at=at)
    omega = beam.frequencies(modes)
    numbers = range(1, modes + 1)
    link = BondGraph(f"flexible link, {modes} modes", domain="translation")
    loaded = not (load is None or isinstance(load, Unloaded))
    if loaded:
        link.zero("load")
    link.zero("hit", Se("force"))
    for r in numbers:
        link.one(f"mode_{r}", I(f"m_mode_{r}"), C(f"C_mode_{r}"), R(f"c_mode_{r}"))
        if loaded:
            link.join("load", TF(f"phi_load_{r}"), f"mode_{r}")
        link.join("hit", TF(f"phi_hit_{r}"), f"mode_{r}")
    values: list[tuple[str, float, str]] = []
    for r, w in zip(numbers, omega.tolist(), strict=True):
        values += [
            (f"m_mode_{r}", beam.mass, "kg"),
            (f"C_mode_{r}", 1 / (beam.mass * w**2), "m/N"),
            (f"c_mode_{r}", 2 * damping * w * beam.mass, "N*s/m"),
            (f"phi_load_{r}", float(beam.shape(r, at)), "1"),
            (f"phi_hit_{r}", float(beam.shape(r, force_at)), "1"),
            (f"strain_{r}", float(beam.surface_strain(r, gauge_at)), "1/m"),
        ]
    reading = _sum("phi_load", numbers)
    if isinstance(truncation, StaticCorrection) and loaded:
        link.put(C("C_residual"), on="load")
        values.append(("C_residual", residual_compliance(beam, modes, at=at), "m/N"))
        reading += displacement("C_residual")
    if isinstance(load, PointMass):
        link.put(I("m_load"), on="load")
        values.append(("m_load", load.mass, "kg"))
        # The flows at a 0-junction balance: what goes into the modes comes from the
        # mass, so its port sees the negative of the strip's velocity.
        acceleration = -effort("m_load") / sympy.Symbol("m_load")
        link.measure("acceleration", acceleration, unit="m/s^2")
    link.measure("strain", _sum("strain", numbers), unit="1")
    link.measure("displacement", reading, unit="m")
    link.take(
        ParameterSet(
            tuple(Parameter(name=n, value=v, unit=unit) for n, v, unit in values)
        )
    )
    return link


def residual_compliance(beam: UniformBeam, modes: int, *, at: float) -> float:
    """Return the compliance at a place that the first modes leave out, m/N.

    x³/(3 E I) - Σ φ_r(x)²/(m ω_r²), positive: the modes' sum converges from below.
    """
    omega = beam.frequencies(modes)
    kept = sum(
        float(beam.shape(r + 1, at)) ** 2 / (beam.mass * w**2)
        for r, w in enumerate(omega.tolist())
    )
    return float(at**3 / (3 * beam.bending_stiffness) - kept)


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
