"""Two open tanks above each other: pump, upper tank, lower tank, linear outlets.

    bondgraph diagnose examples/recordings/tanks.py:tanks \
        ../shared/recordings/tanks/estimation.csv --split 0.6 --window whole \
        --map pump_voltage=pump_voltage[m^3/s] --map level_sensor=level_sensor[Pa]

Only the level of the lower tank is measured, in volts of its sensor, and the pump's
flow in volts: the mapping takes both for SI units. The scale of the upper level, which
nothing reads, is fixed by its capacity. Water falls from one tank into the next, so
that the lower level does not push back. What it leaves out: outflow with the root of
the level, and the overflow of the upper tank (Schoukens, Mattsson, Wigren and Noël,
2016).
"""

from bondgraph import BondGraph, C, R, Sf, effort, flow


def tanks() -> BondGraph:
    """Return the pump, both tanks with linear outlets, and the sensor."""
    plant = BondGraph("cascaded tanks", domain="hydraulic")
    plant.zero("upper", Sf("pump_voltage"), C("upper_area"), R("upper_outlet"))
    plant.zero(
        "lower",
        Sf("inflow", value=flow("upper_outlet")),
        C("lower_area"),
        R("lower_outlet"),
    )
    plant.measure("level_sensor", effort("lower"))
    plant.parameter("upper_area", 100.0, "m^3/Pa", std=0.0)
    plant.parameter("upper_outlet", 1.0, "Pa*s/m^3", bounds=(0, 1e6))
    plant.parameter("lower_area", 100.0, "m^3/Pa", bounds=(1, 1e6))
    plant.parameter("lower_outlet", 1.5, "Pa*s/m^3", bounds=(0, 1e6))
    return plant
