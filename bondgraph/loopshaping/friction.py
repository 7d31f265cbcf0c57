"""How a lead's zero and gain must move as friction grows, so that the loop stays.

A plant ``1 / (s (s + b))`` with friction pole b and a controller ``K (s + z)`` appear
in the loop only as ``K (s + z) / (s + b)``. Asking that a grown friction b leaves the
loop's value at the crossover ω unchanged,

    ``K (jω + z) = (jω + b) R``,   ``R = K₀ (jω + z₀) / (jω + b₀) = α + jβ``,

is one complex, that is two real equations for K and z, and their solution is

    ``K = α + β b / ω``,   ``z = (α b - β ω) / K``.

Crossover and phase margin then stay exactly what they were, for any b. Three limits:

- ``z₀ = b₀``: R is real, K = K₀ and z = b for every b. The zero rides on the friction
  pole and the whole loop, not only its crossover, is unchanged.
- ``b, z₀, b₀ ≪ ω``: ``z ≈ b + (z₀ - b₀)``. The *distance* from zero to pole stays, not
  their ratio. Raising the zero in proportion, ``z = z₀ b / b₀``, as the FlegX thesis
  does (section 5.2.1), agrees only as far as z₀ is b₀.
- Read backwards, ``b = (z α + β ω) / (α - z β / ω)``: a zero that was tuned on the
  machine measures its friction.
"""

from dataclasses import dataclass

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.controllers import Lead
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionRule:
    """The lead that keeps a loop's crossover and phase margin as friction grows.

    Parameters
    ----------
    lead, friction_pole
        The controller and the friction pole b₀ (rad/s) it was designed for.
    crossover
        ω of the designed loop, in rad/s.
    """

    lead: Lead
    friction_pole: float
    crossover: float

    def __post_init__(self) -> None:
        if not (self.crossover > 0 and self.friction_pole >= 0):
            raise LoopShapingError(
                f"A crossover of {self.crossover} rad/s and a friction pole of "
                f"{self.friction_pole} rad/s make no rule.",
                remedy="Give a positive crossover, and the pole's distance from zero.",
            )

    @property
    def _ratio(self) -> complex:
        w = 1j * self.crossover
        return self.lead.gain * (w + self.lead.zero) / (w + self.friction_pole)

    def at(self, friction_pole: float) -> Lead:
        """Return the lead for a friction pole of `friction_pole` rad/s.

        Raises
        ------
        LoopShapingError
            If no positive gain keeps the loop there (the zero lies so far below the
            pole that the loop would need more phase than a zero gives).
        """
        ratio, w = self._ratio, self.crossover
        gain = ratio.real + ratio.imag * friction_pole / w
        if gain <= 0:
            raise LoopShapingError(
                f"No lead keeps the loop for a friction of {friction_pole:g} rad/s.",
                remedy="Design the loop anew for this friction.",
            )
        zero = (ratio.real * friction_pole - ratio.imag * w) / gain
        return Lead(gain, zero, self.lead.pole)

    def friction_pole_of(self, zero: float) -> float:
        """Return the friction pole (rad/s) for which `zero` is the right one.

        The inverse of `at`: what a zero that was tuned on the machine says about the
        machine's friction.
        """
        ratio, w = self._ratio, self.crossover
        # zero (α + β b/ω) = α b - β ω, linear in b
        return (zero * ratio.real + ratio.imag * w) / (
            ratio.real - zero * ratio.imag / w
        )


def with_friction_pole(plant: ZeroPoleGain, old: float, new: float) -> ZeroPoleGain:
    """Return the plant with the real pole nearest to -`old` moved to -`new` (rad/s).

    Raises
    ------
    LoopShapingError
        If there is no real pole within 1 % of it.
    """
    real = [p for p in plant.poles if p.imag == 0]
    nearest = min(real, key=lambda p: abs(p.real + old), default=None)
    if nearest is None or abs(nearest.real + old) > 0.01 * abs(old):
        raise LoopShapingError(
            f"The plant has no pole at {-old:g} rad/s.",
            remedy=f"Its poles are {', '.join(f'{p:.4g}' for p in plant.poles)}.",
        )
    poles = list(plant.poles)
    poles[poles.index(nearest)] = complex(-new)
    return ZeroPoleGain(
        zeros=plant.zeros,
        poles=tuple(poles),
        gain=plant.gain,
        delay=plant.delay,
        period=plant.period,
    )
