"""Small machines on which every entry of the physics library can sit; their runs."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph import GY, TF, BondGraph, C, FinishedGraph, I, MSe, R, Se, Sf, derive
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.physics.places.everywhere import machine_junctions
from bondgraph.physics.places.scales import Scales
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk2
from bondgraph.structure.elements import Compliance, OneJunction
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import Signal, displacement, effort, flow

Array = NDArray[np.float64]
SAMPLES = 400
STEP = 0.01


def known(graph: BondGraph, **values: tuple[float, str]) -> FinishedGraph:
    """Declare exact parameters, finish."""
    for name, (value, unit) in values.items():
        graph.parameter(name, value, unit, std=0.0)
    return graph.finish()


def slider() -> FinishedGraph:
    g = BondGraph("slider", domain="translation")
    g.one("carriage", Se("force"), I("mass"), C("spring"))
    g.measure("position", displacement="carriage")
    g.measure("speed", flow="carriage")
    return known(g, mass=(2.0, "kg"), spring=(0.02, "m/N"))


def geared_arm() -> FinishedGraph:
    g = BondGraph("geared arm", domain="rotation")
    g.one("motor", Se("torque"), I("rotor"))
    g.one("joint", I("arm"), C("twist"))
    g.join("motor", TF("gear"), "joint")
    g.measure("angle", displacement="joint")
    g.measure("motor_angle", displacement="motor")
    return known(
        g,
        rotor=(0.02, "kg*m^2"),
        arm=(0.5, "kg*m^2"),
        twist=(0.1, "rad/(N*m)"),
        gear=(4.0, "1"),
    )


def wheel() -> FinishedGraph:
    """A shaft that turns all around, with a bearing."""
    g = BondGraph("wheel", domain="rotation")
    g.one("shaft", Se("torque"), I("inertia"), R("bearing"))
    g.measure("angle", displacement="shaft")
    return known(g, inertia=(0.1, "kg*m^2"), bearing=(0.15, "N*m*s/rad"))


def _masses(name: str) -> BondGraph:
    g = BondGraph(name, domain="translation")
    g.one("first", Se("force"), I("mass_1"))
    g.one("second", I("mass_2"), R("damper"))
    g.measure("position", displacement="first")
    g.measure("speed", flow="second")
    return g


MASSES = {
    "mass_1": (1.0, "kg"),
    "mass_2": (1.5, "kg"),
    "spring": (0.02, "m/N"),
    "damper": (3.0, "N*s/m"),
}


def two_masses() -> FinishedGraph:
    """Two carts with a spring between, on a 0-junction."""
    g = _masses("two masses")
    g.zero("coupling", C("spring"))
    g.join("first", "coupling")
    g.join("coupling", "second")
    return known(g, **MASSES)


def soft_shaft() -> FinishedGraph:
    """Two masses with a spring and a damper between, which make one part."""
    g = _masses("soft shaft")
    g.zero("between")
    g.one("shaft", C("spring"), R("loss"))
    g.join("first", "between")
    g.join("between", "shaft")
    g.join("between", "second")
    return known(g, **MASSES, loss=(1.0, "N*s/m"))


def dc_drive() -> FinishedGraph:
    g = BondGraph("DC drive", domain="electrical")
    g.one("winding", Se("voltage"), I("inductance"), R("resistance"))
    g.zero("rail", Sf("charger"), C("capacitor"))
    g.one("cable", R("line"))
    g.one("shaft", I("rotor"), domain="rotation")
    g.join("rail", "cable")
    g.join("cable", "winding")
    g.join("winding", GY("k_m"), "shaft")
    g.measure("current", flow="winding")
    g.measure("speed", flow="shaft")
    g.measure("rail_voltage", effort="rail")
    return known(
        g,
        inductance=(0.05, "H"),
        resistance=(1.0, "ohm"),
        capacitor=(0.3, "F"),
        line=(0.4, "ohm"),
        k_m=(0.3, "V*s/rad"),
        rotor=(0.02, "kg*m^2"),
    )


def _two_tanks() -> BondGraph:
    g = BondGraph("two tanks", domain="hydraulic")
    g.zero("upper", Sf("pump"), C("area_1"))
    g.one("pipe", R("laminar"))
    g.zero("lower", C("area_2"), R("drain"))
    g.join("upper", "pipe")
    g.join("pipe", "lower")
    g.measure("pressure_1", effort="upper")
    g.measure("pressure_2", effort="lower")
    return g


TANKS = {
    "area_1": (0.5, "m^3/Pa"),
    "area_2": (0.5, "m^3/Pa"),
    "drain": (2.0, "Pa*s/m^3"),
}


def two_tanks() -> FinishedGraph:
    return known(_two_tanks(), **TANKS, laminar=(2.0, "Pa*s/m^3"))


def piped_tanks() -> FinishedGraph:
    """Two tanks with a pipe between them that is free to be fitted."""
    g = _two_tanks()
    g.parameter("laminar", 2.0, "Pa*s/m^3")
    return known(g, **TANKS)


def draining_tank() -> FinishedGraph:
    """A tank whose outlet, a resistance, is free to be fitted."""
    g = BondGraph("draining tank", domain="hydraulic")
    g.zero("tank", Sf("inflow"), C("area"), R("outlet"))
    g.measure("pressure", effort="tank")
    g.parameter("area", 0.5, "m^3/Pa", std=0.0)
    g.parameter("outlet", 2.0, "Pa*s/m^3")
    return g.finish()


def heaters() -> FinishedGraph:
    """Two blocks that lose heat to a room, counted from its temperature."""
    g = BondGraph("heaters", domain="thermal")
    for i in "12":
        g.zero(f"block{i}", Sf(f"heater{i}"), C(f"capacity{i}"), R(f"loss{i}"))
        g.measure(f"temperature{i}", effort=f"block{i}")
    return known(
        g,
        capacity1=(0.01, "J/K"),
        capacity2=(0.02, "J/K"),
        loss1=(60.0, "K/W"),
        loss2=(40.0, "K/W"),
    )


def two_axes() -> FinishedGraph:
    """Two axes that cables pull back, and that nothing joins."""
    g = BondGraph("two axes", domain="rotation")
    for axis in ("pan", "tilt"):
        g.one(axis, Se(f"{axis}_torque"), I(f"{axis}_mass"), C(f"{axis}_cable"))
        g.measure(f"{axis}_angle", displacement=axis)
    return known(
        g,
        pan_mass=(0.2, "kg*m^2"),
        tilt_mass=(0.1, "kg*m^2"),
        pan_cable=(0.3, "rad/(N*m)"),
        tilt_cable=(0.4, "rad/(N*m)"),
    )


def damper() -> FinishedGraph:
    """A damper whose motion is imposed and whose force is measured."""
    g = BondGraph("damper", domain="translation")
    g.one("rod", Sf("stroke"), R("oil"))
    g.measure("load", effort="stroke")
    return known(g, oil=(2.0, "N*s/m"))


def lamp() -> FinishedGraph:
    """A stock between two resistances, fed by a voltage on a 0-junction."""
    g = BondGraph("lamp", domain="electrical")
    g.zero("supply", Se("mains"))
    g.one("wire", R("series"))
    g.zero("node", C("store"), R("load"))
    g.join("supply", "wire")
    g.join("wire", "node")
    g.measure("voltage", effort="node")
    return known(g, series=(1.0, "ohm"), store=(0.3, "F"), load=(3.0, "ohm"))


def servo() -> FinishedGraph:
    """An arm that a position loop drives to its goal."""
    g = BondGraph("servo", domain="rotation")
    g.zero("command", Se("goal"), domain="analogue")
    missing = effort("command") - displacement("arm")
    loop = MSe("loop", value=sympy.Symbol("stiffness") * missing)
    g.one("arm", loop, I("inertia"), R("damping"))
    g.measure("angle", displacement="arm")
    return known(
        g,
        stiffness=(2.0, "N*m/rad"),
        inertia=(0.1, "kg*m^2"),
        damping=(0.3, "N*m*s/rad"),
    )


MACHINES = {
    make.__name__: make()
    for make in (
        slider,
        geared_arm,
        wheel,
        two_masses,
        soft_shaft,
        dc_drive,
        two_tanks,
        draining_tank,
        piped_tanks,
        heaters,
        two_axes,
        damper,
        lamp,
        servo,
    )
}


@cache
def numeric(graph: FinishedGraph) -> NumericModel:
    """Return the compiled model."""
    return compile_model(derive(graph))


def times(samples: int = SAMPLES) -> Array:
    """Return the sampling instants."""
    return STEP * np.arange(samples)


def inputs(graph: FinishedGraph, samples: int = SAMPLES, size: float = 1.3) -> Array:
    """Return inputs that make everything move; flows into stocks never turn back."""
    time = times(samples)
    columns = []
    for number, source in enumerate(graph.inputs):
        rates = np.array([1.0, 2.7, 6.1]) * (1.0 + 0.23 * number)
        wave = np.sin(np.outer(time, rates) + 0.3 * number).sum(axis=1) / 1.5
        fills = isinstance(source, Sf) and "heater" not in source.name
        heats = isinstance(source, Sf) and "heater" in source.name
        wave = 0.8 + 0.5 * wave if fills or heats else wave
        columns.append(size * wave)
    return np.column_stack(columns)


def outputs(
    graph: FinishedGraph,
    values: Mapping[str, float] | None = None,
    u: Array | None = None,
) -> Array:
    """Return the outputs from rest; `values` replaces some parameter values."""
    model = numeric(graph)
    every = {**graph.parameters.values_by_name(), **(values or {})}
    driven = inputs(graph) if u is None else u
    samples = len(driven)
    shot = shoot(
        model,
        Shots(times(samples), driven, np.zeros((samples, 1)), (0, samples)),
        parameters=np.array([every[n] for n in model.parameter_names]),
        initial=np.zeros((1, model.n_states)),
        directions=None,
        solver=Sdirk2(),
        hold=Hold.FIRST,
    )
    assert shot.completed.all()
    assert np.isfinite(shot.outputs).all()
    return shot.outputs


def scales_of(graph: FinishedGraph, u: Array | None = None) -> Scales:
    """Return sizes and ranges of what is at every place, in the graph's simulation."""
    probes: list[Signal] = []
    carried: dict[str, list[str]] = {}
    for junction in machine_junctions(graph):
        one = isinstance(junction, OneJunction)
        common, other = (flow, effort) if one else (effort, flow)
        probes.append(common(junction.name))
        bonds = [other(bond.name) for bond in graph.bonds_at(junction.name)]
        probes += bonds
        carried[other(junction.name).name] = [bond.name for bond in bonds]
    probes += [
        displacement(n.name) for n in graph.elements if isinstance(n, Compliance)
    ]
    read = [m.expression for m in graph.measurements]
    probes += [x for x in read if isinstance(x, Signal) and x not in probes]
    wanted = [(p.name, p) for p in dict.fromkeys(probes)]
    wanted += [(m.name, m.expression) for m in graph.measurements]
    probed = replace(
        graph, measurements=tuple(Measurement(name, x, "1") for name, x in wanted)
    )
    driven = inputs(graph) if u is None else u
    values = outputs(probed, u=driven)
    sizes = np.sqrt(np.mean(values**2, axis=0))
    found = {name: float(size) for (name, _), size in zip(wanted, sizes, strict=True)}
    ranges = {
        name: (float(column.min()), float(column.max()))
        for (name, _), column in zip(wanted, values.T, strict=True)
    }
    for i, source in enumerate(graph.inputs):
        quantity = effort if isinstance(source, Se) else flow
        ranges[quantity(source.name).name] = (
            float(driven[:, i].min()),
            float(driven[:, i].max()),
        )
    for name, bonds in carried.items():
        found[name] = max(found[bond] for bond in bonds)
    return Scales(found, ranges, STEP, STEP * len(driven))
