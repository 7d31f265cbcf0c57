"""The numerators of the loops, eq. 5.10 to 5.22, from motor, driver and train.

They need a number that is not printed. With controllers in ampere per radian and a
driver scaling that makes one ampere of command one ampere of current (5 % of duty per
ampere, 1/0.20), all four follow, to their three digits, from K_m = 0.042 N·m/A where
Table 2.1 prints 0.0427.
"""

from flegx_models.parameters_control import CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.published import PUBLISHED


def numerator(gain: float, torque_constant: float | None = None) -> float:
    """Return the numerator of eq. 5.10 to 5.22 that follows from eq. 4.36.

    K_m · p₁ p₂ / z · gain in 1/s³, for a command in ampere that the driver turns into
    as many ampere at rest.

    Parameters
    ----------
    gain
        Of the train, rad/s² per N·m (eq. 4.7, 4.12, 4.30, 4.35).
    torque_constant
        K_m in N·m/A; Table 2.1's by default.
    """
    values = CONTROL.values_by_name()
    K_m = DATASHEETS.values_by_name()["K_m"]
    poles = values["fast_pole_driver"] * values["slow_pole_driver"]
    chosen = K_m if torque_constant is None else torque_constant
    return chosen * poles / values["zero_driver"] * gain


def torque_constants_of_the_numerators() -> tuple[float, float]:
    """Return the least and greatest K_m (N·m/A) from which all four numerators follow.

    If no one K_m gave them all, the greatest would lie below the least.
    """
    lows, highs = [], []
    for entry in PUBLISHED:
        printed = CONTROL.find(f"numerator_{entry.model}")
        assert printed.value is not None
        assert printed.rounding is not None
        unit = numerator(entry.gain, 1.0)
        lows.append((printed.value - printed.rounding) / unit)
        highs.append((printed.value + printed.rounding) / unit)
    return max(lows), min(highs)
