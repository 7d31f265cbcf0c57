"""A clamped strip bent by a force: force, tip displacement and strain are one thing.

All relations are linear, which is why one line calibrates the sensor. The thesis loads
and reads the tip; on the bench the load hangs at 243 mm and the laser reads at
238.5 mm, so here both places are arguments.
"""

from dataclasses import dataclass

from flegx_models.characterisation.errors import CharacterisationError


@dataclass(frozen=True, slots=True, kw_only=True)
class Cantilever:
    """A strip of rectangular section, clamped at x = 0, in Euler-Bernoulli bending.

    Parameters
    ----------
    length, width, thickness
        L, b, h in m; bending is about the width.
    youngs_modulus
        E in Pa.
    """

    length: float
    width: float
    thickness: float
    youngs_modulus: float

    def __post_init__(self) -> None:
        for name in ("length", "width", "thickness", "youngs_modulus"):
            if not getattr(self, name) > 0:
                raise CharacterisationError(
                    f"The cantilever's {name} is {getattr(self, name)}.",
                    (name,),
                    "Give a positive number in SI units.",
                )

    @property
    def second_moment(self) -> float:
        """I = b h³/12, m⁴ (eq. 3.8)."""
        return self.width * self.thickness**3 / 12

    @property
    def bending_stiffness(self) -> float:
        """E I, N·m²."""
        return self.youngs_modulus * self.second_moment

    @property
    def tip_stiffness(self) -> float:
        """Tip force over tip displacement, k = 3 E I / L³, N/m (eq. 3.7 and 3.19)."""
        return 3 * self.bending_stiffness / self.length**3

    def displacement(
        self, x: float, force: float, *, load_at: float | None = None
    ) -> float:
        """Return the displacement at `x`, m, in the direction of the force.

        Up to the load at a it is F x² (3a - x) / (6 E I), eq. 3.6 with L = a; beyond
        it the strip is straight: F a² (3x - a) / (6 E I).

        Parameters
        ----------
        x
            Distance from the clamp, m.
        force
            Transverse force, N.
        load_at
            Where the force acts, m from the clamp; the tip if not given.
        """
        a = self._inside(self.length if load_at is None else load_at, "load_at")
        near, far = sorted((self._inside(x, "x"), a))
        return force * near**2 * (3 * far - near) / (6 * self.bending_stiffness)

    def tip_displacement(self, force: float) -> float:
        """Return F L³/(3 E I) = 4 F L³/(b h³ E), m (eq. 3.7 and 3.9)."""
        return force / self.tip_stiffness

    def bending_moment(
        self, x: float, force: float, *, load_at: float | None = None
    ) -> float:
        """Return F (a - x), N·m, zero beyond the load; F L at the clamp (eq. 3.10)."""
        a = self._inside(self.length if load_at is None else load_at, "load_at")
        return force * max(a - self._inside(x, "x"), 0.0)

    def surface_stress(
        self, x: float, force: float, *, load_at: float | None = None
    ) -> float:
        """Return M h/(2 I), Pa; 6 F L/(b h²) at the clamp (eq. 3.11)."""
        moment = self.bending_moment(x, force, load_at=load_at)
        return moment * self.thickness / (2 * self.second_moment)

    def surface_strain(
        self, x: float, force: float, *, load_at: float | None = None
    ) -> float:
        """Return stress over E; 6 F L/(b h² E) at the clamp (eq. 3.12)."""
        return self.surface_stress(x, force, load_at=load_at) / self.youngs_modulus

    def tip_displacement_per_strain(self, gauge_at: float = 0.0) -> float:
        """Return the tip displacement over the strain at a gauge, m.

        2 L³ / (3 h (L - x)), which is (2/3) L²/h for a gauge at the clamp (eq. 3.13).
        The thesis's gauges sit next to the clamp; 1 % of L away costs 1 %.
        """
        arm = self.length - self._inside(gauge_at, "gauge_at")
        return 2 * self.length**3 / (3 * self.thickness * arm)

    def _inside(self, x: float, name: str) -> float:
        if not 0 <= x <= self.length:
            raise CharacterisationError(
                f"{name} = {x:g} m is not on the strip of {self.length:g} m.",
                (name,),
                "Give a distance from the clamp between 0 and the length.",
            )
        return x


def without_clamp_rotation(
    displacement: float, force: float, *, x: float, rotation_per_force: float
) -> float:
    """Return the strip's own displacement, m: the clamp's rotation taken away.

    A clamp that turns by κ F under the force carries the point at x along by κ F x
    (section 3.1.2, κ about 1.10e-4 rad/N).

    Parameters
    ----------
    displacement
        Measured at `x` in the direction of the force, m.
    force
        N.
    x
        Distance of the measured point from the clamp, m.
    rotation_per_force
        κ, rad/N.
    """
    return displacement - rotation_per_force * force * x
