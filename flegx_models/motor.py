"""Motor and driver: the black box of eq. 4.36 as a bond graph, and its identification.

The driver controls the current. A PI controller of a current is, in bond graph terms, a
source of the wanted current beside a resistance K_p and a capacitance 1/K_i in series:
what the winding does not take flows through these two, and their voltage drives the
winding. So no signal is needed::

    duty ─TF→ 0 driver ─┬→ 1 winding:  I L_motor, R R_motor
                        └→ 1 error:    R K_p,  C (e = K_i q)

From this follow one zero and two poles, as eq. 4.36 has them:

    i / duty = k (1 + s K_p/K_i) / (1 + s (R + K_p)/K_i + s² L/K_i)

A scale of all four impedances changes nothing, so one of them must be known: L is
(Table 2.1). Then p₁ p₂ = K_i/L, p₁ + p₂ = (R + K_p)/L and z = K_i/K_p.

What the printed numbers say about the machine: a zero beyond the slow pole, 4403
against 4201 rad/s, needs R/L = p₁ + p₂ - p₁ p₂/z = 7.8e4 rad/s, that is 11.7 Ω where
Table 2.1 has 0.336 Ω. With the table's winding the zero lies at 4196 rad/s, below the
pole. The black box is not the winding with a PI controller; and its fast pole, 0.6 µs,
is seen by no current recording at any usual rate.
"""

from collections.abc import Mapping

import sympy

from bondgraph import (
    TF,
    BondGraph,
    C,
    I,
    Parameter,
    ParameterSet,
    R,
    Reconciled,
    Sf,
    q,
)
from flegx_models.parameters_control import CONTROL
from flegx_models.parameters_datasheets import DATASHEETS

_K_I, _K_DRIVER = sympy.symbols("K_i k_driver")


def driven_motor(parameters: ParameterSet | None = None) -> BondGraph:
    """Return driver and motor, ``duty`` (% less its mean) to ``current`` (A)."""
    motor = BondGraph("motor with its current driver", domain="electrical")
    motor.one("command", Sf("duty"))
    motor.zero("driver")
    motor.join("command", TF("scaling", 1 / _K_DRIVER), "driver")
    motor.one("winding", I("L_motor"), R("R_motor"))
    motor.one("error", R("K_p"), C("integral", law=_K_I * q))
    motor.join("driver", "winding")
    motor.join("driver", "error")
    motor.measure("current", flow="winding")
    motor.take(printed_motor() if parameters is None else parameters)
    return motor


def printed_motor() -> ParameterSet:
    """Return the elements that give eq. 4.36 exactly, with L of Table 2.1."""
    v = CONTROL.values_by_name()
    return motor_with(
        {
            "k_driver": v["k_driver"],
            "zero": v["zero_driver"],
            "fast_pole": v["fast_pole_driver"],
            "slow_pole": v["slow_pole_driver"],
        }
    )


def motor_with(box: Mapping[str, float]) -> ParameterSet:
    """Return the elements of a black box.

    Parameters
    ----------
    box
        ``k_driver`` in A per %, ``zero``, ``fast_pole`` and ``slow_pole`` in rad/s.
    """
    L = DATASHEETS.values_by_name()["motor_inductance"]
    product = box["fast_pole"] * box["slow_pole"]
    total = box["fast_pole"] + box["slow_pole"]
    why = "eq. 4.36 by p₁ p₂ = K_i/L, p₁ + p₂ = (R + K_p)/L, z = K_i/K_p"
    found = {
        "K_p": (L * product / box["zero"], "ohm"),
        "K_i": (L * product, "ohm/s"),
        "R_motor": (L * (total - product / box["zero"]), "ohm"),
    }
    return ParameterSet(
        (
            Parameter(name="k_driver", value=box["k_driver"], source=Reconciled(why)),
            Parameter(name="L_motor", value=L, unit="H", std=0.0),
            *(
                Parameter(name=name, value=value, unit=unit, source=Reconciled(why))
                for name, (value, unit) in found.items()
            ),
        )
    )


def black_box(values: Mapping[str, float]) -> dict[str, float]:
    """Return gain, zero and poles of eq. 4.36 from the elements' values.

    Parameters
    ----------
    values
        ``k_driver``, ``K_p``, ``K_i``, ``R_motor`` and ``L_motor``, as estimated.
    """
    total = (values["R_motor"] + values["K_p"]) / values["L_motor"]
    product = values["K_i"] / values["L_motor"]
    # Both poles are real where the driver is faster than the winding's zero.
    root = complex(total**2 - 4 * product) ** (1 / 2)
    fast = (total + root.real) / 2
    return {
        "k_driver": values["k_driver"],
        "zero": values["K_i"] / values["K_p"],
        "fast_pole": fast,
        "slow_pole": product / fast,
    }
