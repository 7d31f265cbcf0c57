"""Every number of the FlegX models, with its unit, its uncertainty and its source.

Two sets. `PRINTED` is what the thesis prints and nothing inferred: the link length
``L`` has no value there. `RECONCILED` is the smallest change of `PRINTED` from which
the four printed gains (eq. 4.7, 4.12, 4.30, 4.35) come out to their two decimals.

How `RECONCILED` was found
--------------------------
A gain is N / J, with N = K_gearbox K_worm_gear and J the inertia reflected to the
joint, so for fixed ratios each printed gain is an interval for J, and J is linear in
the inertias. Which inertias must leave their rounding intervals is then a linear
programme per subset (``tests/test_flegx_models.py`` repeats it):

- Tooth counts, ratios and the angle θ0 are exact and were not moved.
- Flight: no single inertia is enough, thirteen of the 21 pairs are. Ranked by the
  total change |ln(new/printed)|: I_motor with I_upperleg 0.036; I_motor with
  I_lowerleg 0.16; I_gearbox with I_upperleg 0.38; I_gearbox with I_lowerleg 0.48; the
  others change something by more than a factor of two (I_worm must grow nine- to
  tenfold, I_gear_tendons more than fourfold).
- So the motor's rotor grows from 209 to 213.5 g·cm² (+2.1 %) and the upper leg shrinks
  from 0.143 to 0.1406 kg·m² (-1.7 %). Everything else keeps its printed value.
- Stance: the two gains need (m_motors_support + m) L² = 0.8978 and 0.8157 kg·m². With
  the printed masses no L gives both (0.3134 against 0.3092 m; rounding moves each by
  less than 0.002 m). With the tendons counted to the lower leg's branch, 0.25 kg by
  the thesis's own masses, both need L = 0.3092 m. L is inferred and the mass re-read.

This explains the gains, it does not prove the cause. A slip in an exact number would
explain the flight gains alone: a worm ratio between 9.844 and 9.896 (such as 9.87)
where Table 2.3 prints 9.67 and its teeth give 29/3.
"""

import math

from bondgraph import Assumed, Parameter, ParameterSet, Published, Reconciled

_THESIS = "FlegX thesis"
_ROTATIONAL_INERTIA = "kg*m^2"

# A value rounded to a half-width h is uniform on ±h: its standard deviation is h/√3.
_UNIFORM = 1 / math.sqrt(3)


def _read(name: str, value: float, unit: str, rounding: float, where: str) -> Parameter:
    """Return a parameter known to the digits it is printed with."""
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        bounds=(0.0, math.inf),
        std=rounding * _UNIFORM,
        rounding=rounding,
        source=Published(f"{_THESIS}, {where}"),
    )


def _exact(name: str, value: float, unit: str, where: str) -> Parameter:
    """Return a parameter that is exact: a ratio or a chosen operating point."""
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        std=0.0,
        rounding=0.0,
        source=Published(f"{_THESIS}, {where}"),
    )


def _inferred(name: str, value: float, unit: str, half: float, why: str) -> Parameter:
    """Return a parameter inferred to ± `half` from printed results."""
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        bounds=(0.0, math.inf),
        std=half * _UNIFORM,
        rounding=half,
        source=Reconciled(why),
    )


# Weighed masses that the models use only in sums (section 3.3).
_M_LOWERLEG_LINK = 0.61  # section 3.3.4
_M_UPPERLEG_LINK = 1.93  # section 3.3.3
_M_LOWERLEG_TOTAL = 1.38  # section 3.3.4: link, tendons and gear
_M_UPPERLEG_TOTAL = 2.97  # section 3.3.3: link and two gears
_M_GEAR = (_M_UPPERLEG_TOTAL - _M_UPPERLEG_LINK) / 2
_M_TENDONS = _M_LOWERLEG_TOTAL - _M_LOWERLEG_LINK - _M_GEAR
_HALF_GRAM_10 = 0.005  # the masses above are printed to 10 g

# Swinging inertias of the lower leg with and without gear and tendons (section 3.3.4).
_I_LOWERLEG = 1.20e-2
_I_LOWERLEG_TOTAL = 1.26e-2
_HALF_INERTIA = 0.005e-2

PRINTED = ParameterSet(
    (
        _exact("K_gearbox", 26.0, "1", "Table 2.2: reduction 26:1"),
        _exact("K_worm_gear", 9.67, "1", "Table 2.3: reduction 9.67:1"),
        _exact("theta_0", math.pi / 6, "rad", "section 4.3.1: θ0 = π/6"),
        Parameter(
            name="L",
            unit="m",
            bounds=(0.0, math.inf),
            source=Published(f"{_THESIS}, eq. 4.13: named, never given as a number"),
        ),
        _read(
            "I_motor",
            2.09e-5,
            _ROTATIONAL_INERTIA,
            0.005e-5,
            "Table 2.1: rotor inertia 209 g·cm²",
        ),
        _read(
            "I_gearbox",
            9.1e-7,
            _ROTATIONAL_INERTIA,
            0.05e-7,
            "Table 2.2: mass inertia 9.1 g·cm²",
        ),
        _read("I_worm", 3.00e-5, _ROTATIONAL_INERTIA, 0.005e-5, "Table 2.3: worm"),
        _read("I_gear", 4.81e-4, _ROTATIONAL_INERTIA, 0.005e-4, "Table 2.3: gear"),
        # A difference of two printed values carries both roundings.
        _read(
            "I_gear_tendons",
            _I_LOWERLEG_TOTAL - _I_LOWERLEG,
            _ROTATIONAL_INERTIA,
            2 * _HALF_INERTIA,
            "section 3.3.4: ΔI = 1.26e-2 - 1.20e-2",
        ),
        _read(
            "I_lowerleg",
            _I_LOWERLEG,
            _ROTATIONAL_INERTIA,
            _HALF_INERTIA,
            "section 3.3.4 and eq. 4.7",
        ),
        _read("I_upperleg", 0.143, _ROTATIONAL_INERTIA, 0.0005, "eq. 4.12"),
        _read(
            "c_friction_lowerleg",
            2.08e-3,
            "N*m*s",
            0.005e-3,
            "section 3.3.4: c_tot, bearings of knee and gear",
        ),
        _read(
            "c_friction_upperleg",
            1.67e-2,
            "N*m*s",
            0.005e-2,
            "section 3.3.3: c_hip, hip shaft bearings",
        ),
        _read("m_motors_support", 6.6, "kg", 0.05, "section 3.3.1"),
        _read(
            "m_lowerleg",
            _M_LOWERLEG_LINK + _M_UPPERLEG_LINK,
            "kg",
            2 * _HALF_GRAM_10,
            "section 4.3.1: the sum of lowerleg and upperleg, 0.61 + 1.93",
        ),
        _read("m_upperleg", _M_UPPERLEG_LINK, "kg", _HALF_GRAM_10, "section 3.3.3"),
        # What the models of one joint have no use for and the planar leg needs.
        _read(
            "m_lowerleg_link",
            _M_LOWERLEG_LINK,
            "kg",
            _HALF_GRAM_10,
            "section 3.3.4: m_lowleg, the lower leg alone",
        ),
        _read(
            "I_upperleg_link",
            5.93e-2,
            _ROTATIONAL_INERTIA,
            0.005e-2,
            "section 3.3.3: the upper leg alone, about the hip",
        ),
        _read("l_cm_upperleg", 0.13, "m", 0.005, "section 3.3.3: from the hip"),
        _read("l_cm_lowerleg", 0.10, "m", 0.005, "section 3.3.4: from the knee"),
        _exact("theta_knee", math.pi / 4, "rad", "section 4.2.2: θ_knee = π/4"),
        Parameter(
            name="g",
            value=9.81,
            unit="m/s^2",
            std=0.0,
            rounding=0.0,
            source=Assumed("the thesis names g and prints no value"),
        ),
    )
)
"""The parameters as the thesis prints them."""

RECONCILED = PRINTED.merged(
    (
        _inferred(
            "I_motor",
            2.1348e-5,
            _ROTATIONAL_INERTIA,
            6e-10,
            "eq. 4.7 prints 176.76, which needs J = 1.4224 kg·m²; the table's "
            "2.09e-5 gives 1.3941. Least change together with I_upperleg.",
        ),
        _inferred(
            "I_upperleg",
            0.1406,
            _ROTATIONAL_INERTIA,
            5e-5,
            "eq. 4.12 prints 162.12, which needs J = 1.5508 kg·m² with the "
            "reconciled I_motor; eq. 4.12 itself prints 0.143.",
        ),
        _inferred(
            "m_lowerleg",
            _M_LOWERLEG_LINK + _M_UPPERLEG_LINK + _M_TENDONS,
            "kg",
            4 * _HALF_GRAM_10,
            "eq. 4.30 and 4.35 share one L only if this branch carries the tendons "
            "too: 1.38 - 0.61 - (2.97 - 1.93)/2 = 0.25 kg by sections 3.3.3, 3.3.4.",
        ),
        _inferred(
            "L",
            0.30922,
            "m",
            1.5e-5,
            "eq. 4.30 prints 108.36 and eq. 4.35 prints 106.24; both need this L.",
        ),
    )
)
"""`PRINTED` with the four changes that make the four printed gains come out."""
