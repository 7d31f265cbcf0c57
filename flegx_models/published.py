"""The transfer functions as the thesis prints them, kept beside the derived ones.

Gains stand in eq. 4.7, 4.12, 4.30 and 4.35, poles in eq. 5.9, 5.13, 5.17 and 5.21.

The printed gains are N / J and are explained by `flegx_models.parameters.RECONCILED`.

The printed friction poles do not follow from the thesis's own component equations. On
the way to eq. 4.4 the friction torque c f11 is written (c / I_load) ∫e11, which takes
e11, the torque on the load inertia alone, for the torque on everything that turns; the
friction's share is also not divided by 1 + K_eq. So the printed pole is c / I_load. The
component equations give J dω/dt = N T - c ω with J the whole reflected inertia, and the
pole c / J, 26 to 190 times slower. The same step is in eq. 4.10, 4.27 and 4.33.

The upper leg's 0.28 is c / 0.0593, the inertia of the upper leg alone (section 3.3.3);
its own eq. 4.12 and 4.35 divide by 0.143, which is 0.117.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedTransferFunction:
    """theta / T_motor = gain / (s (s + pole)), as printed.

    Parameters
    ----------
    model
        Name of the factory in `flegx_models.models`.
    gain, gain_decimals, gain_equation
        rad/s² per N·m, the decimals it is printed with, and where.
    friction_pole, pole_decimals, pole_equation
        Magnitude of the friction pole in rad/s, its decimals, and where.
    """

    model: str
    gain: float
    gain_decimals: int
    gain_equation: str
    friction_pole: float
    pole_decimals: int
    pole_equation: str


def _printed(
    model: str, gain: float, gain_equation: str, pole: float, pole_equation: str
) -> PublishedTransferFunction:
    return PublishedTransferFunction(
        model=model,
        gain=gain,
        gain_decimals=2,
        gain_equation=gain_equation,
        friction_pole=pole,
        pole_decimals=2,
        pole_equation=pole_equation,
    )


PUBLISHED = (
    _printed("lowerleg_flight", 176.76, "eq. 4.7", 0.17, "eq. 5.9"),
    _printed("upperleg_flight", 162.12, "eq. 4.12", 0.28, "eq. 5.13"),
    _printed("lowerleg_stance", 108.36, "eq. 4.30", 0.17, "eq. 5.17"),
    _printed("upperleg_stance", 106.24, "eq. 4.35", 0.28, "eq. 5.21"),
)
"""The four printed transfer functions."""
