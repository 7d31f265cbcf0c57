"""Two gauges on opposite faces in half a Wheatstone bridge: strain becomes voltage.

Bending stretches one gauge and compresses the other, so their changes add up and the
output is exactly linear in the strain. A strain common to both, from an axial force or
from temperature, cancels to first order only: it scales the output by 1/(1 + K_s ε_a).
"""

from dataclasses import dataclass


def bridge_output(
    r1: float, r2: float, r3: float, r4: float, *, excitation: float
) -> float:
    """Return e0 = (R1 R4 - R2 R3) / ((R1 + R3)(R2 + R4)) E, V (eq. 3.15).

    Parameters
    ----------
    r1, r3
        The fixed resistors, Ω, one divider of the bridge.
    r2, r4
        The gauges, Ω, the other divider; R4 is the stretched one.
    excitation
        Supply E, V.
    """
    return (r1 * r4 - r2 * r3) / ((r1 + r3) * (r2 + r4)) * excitation


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfBridge:
    """Two gauges in one divider of a bridge.

    Parameters
    ----------
    gauge_factor
        K_s = (ΔR/R)/ε (eq. 3.14).
    resistance
        R of gauges and resistors without strain, Ω.
    excitation
        Supply voltage E, V.
    mismatch
        (R4 - R2)/(R4 + R2) without strain: the gauges' tolerance, before trimming.
    """

    gauge_factor: float
    resistance: float
    excitation: float
    mismatch: float = 0.0

    def output(self, strain: float, *, axial_strain: float = 0.0) -> float:
        """Return the output voltage, V, by eq. 3.15 and 3.16 without approximation.

        Without mismatch and axial strain it is ½ K_s ε E, eq. 3.17, exactly. Eq. 3.16
        omits the axial strain; with it the voltage is ½ K_s ε E / (1 + K_s ε_axial).

        Parameters
        ----------
        strain
            Bending strain ε at the gauges.
        axial_strain
            Strain common to both gauges.
        """
        common = 1 + self.gauge_factor * axial_strain
        change = self.gauge_factor * strain
        r4 = self.resistance * (1 + self.mismatch) * (common + change)
        r2 = self.resistance * (1 - self.mismatch) * (common - change)
        return bridge_output(
            self.resistance, r2, self.resistance, r4, excitation=self.excitation
        )

    @property
    def volts_per_strain(self) -> float:
        """½ K_s E, V (eq. 3.17)."""
        return self.gauge_factor * self.excitation / 2

    @property
    def strain_of_mismatch(self) -> float:
        """The bending strain that gives the same voltage as the mismatch: about μ/K_s.

        With gauges of ±0.3 % it is larger than any strain of the link, which is why
        the conditioner has trimmers.
        """
        return self.output(0.0) / self.volts_per_strain


def quarter_bridge_output(
    strain: float, *, gauge_factor: float, excitation: float
) -> float:
    """Return the output with one gauge only, V: ¼ K_s ε E / (1 + K_s ε/2).

    Half the signal of the half bridge, and not linear; for comparison.
    """
    r4 = 1 + gauge_factor * strain
    return bridge_output(1.0, 1.0, 1.0, r4, excitation=excitation)
