"""Electromechanical machines: Kirchhoff on one side, Newton on the other."""

import sympy

from bondgraph import (
    GY,
    TF,
    BondGraph,
    C,
    I,
    R,
    Se,
    Sf,
    displacement,
    effort,
    f,
    flow,
    momentum,
    p,
)
from catalogue.cases import case

MOTOR = "KMR, ch. 4, direct-current motor as a gyrator"
TRANSDUCER = "KMR, ch. 8, transducers"


@case(
    source=MOTOR,
    states=("p_la", "p_j"),
    rates={"p_la": "u - ra*p_la/la - k*p_j/j", "p_j": "k*p_la/la - b*p_j/j"},
    transfers={("w", "u"): "k/((la*s + ra)*(j*s + b) + k**2)"},
)
def dc_motor(g: BondGraph) -> None:
    g.one("armature", Se("u"), R("ra"), I("la"), domain="electrical")
    g.one("shaft", I("j"), R("b"), domain="rotation")
    g.join("armature", GY("k"), "shaft")
    g.measure("w", flow="shaft")


@case(
    source=MOTOR + ", inductance neglected",
    states=("p_j",),
    rates={"p_j": "k*(u - k*p_j/j)/ra - b*p_j/j"},
    transfers={
        ("w", "u"): "k/(ra*(j*s + b) + k**2)",
        ("i", "u"): "(j*s + b)/(ra*(j*s + b) + k**2)",
    },
)
def dc_motor_without_inductance(g: BondGraph) -> None:
    g.one("armature", Se("u"), R("ra"), domain="electrical")
    g.one("shaft", I("j"), R("b"), domain="rotation")
    g.join("armature", GY("k"), "shaft")
    for name, unit in (("ra", "ohm"), ("j", "kg*m^2"), ("b", "N*m*s"), ("k", "N*m/A")):
        g.parameter(name, unit=unit)
    g.measure("w", flow="shaft")
    g.measure("i", flow="armature")


@case(
    source=MOTOR + " with gearbox and flexible shaft",
    states=("p_la", "p_jm", "q_c", "p_jl"),
    rates={
        "p_la": "u - ra*p_la/la - k*p_jm/jm",
        "p_jm": "k*p_la/la - (q_c/c + d*(p_jm/(n*jm) - p_jl/jl))/n",
        "q_c": "p_jm/(n*jm) - p_jl/jl",
        "p_jl": "q_c/c + d*(p_jm/(n*jm) - p_jl/jl) - load",
    },
)
def geared_motor_with_flexible_shaft(g: BondGraph) -> None:
    g.one("armature", Se("u"), R("ra"), I("la"))
    g.one("rotor", I("jm"))
    g.zero("gear")
    g.one("twist", C("c"), R("d"))
    g.one("output", I("jl"))
    g.put(Se("brake", value=-effort("load")), on="output")
    g.zero("command", Se("load"))
    g.join("armature", GY("k"), "rotor")
    g.join("rotor", TF("n"), "gear")
    g.join("gear", "twist")
    g.join("gear", "output")
    g.measure("w", flow="output")


@case(
    source="Ward Leonard set: a generator on a driven shaft feeds a motor",
    states=("p_l", "p_j"),
    rates={"p_l": "kg*w - (rg + rm)*p_l/l - km*p_j/j", "p_j": "km*p_l/l - b*p_j/j"},
    transfers={("speed", "w"): "kg*km/((l*s + rg + rm)*(j*s + b) + km**2)"},
)
def ward_leonard_set(g: BondGraph) -> None:
    g.one("drive", Sf("w"), domain="rotation")
    g.one("circuit", R("rg"), R("rm"), I("l"), domain="electrical")
    g.one("shaft", I("j"), R("b"), domain="rotation")
    g.join("drive", GY("kg"), "circuit")
    g.join("circuit", GY("km"), "shaft")
    g.measure("speed", flow="shaft")


@case(
    source="series-wound motor: the field is the armature's current, torque k i²",
    states=("p_l", "p_j"),
    rates={
        "p_l": "u - r*p_l/l - k*(p_l/l)*p_j/j",
        "p_j": "k*(p_l/l)**2 - b*p_j/j",
    },
)
def series_wound_motor(g: BondGraph) -> None:
    k = sympy.Symbol("k")
    g.one("circuit", Se("u"), R("r"), I("l"))
    g.one("shaft", I("j"), R("b"))
    g.join("circuit", GY("machine", law=k * flow("circuit")), "shaft")
    g.measure("w", flow="shaft")


@case(
    source=TRANSDUCER + ", moving-coil loudspeaker",
    states=("p_l", "p_m", "q_c"),
    rates={
        "p_l": "u - r*p_l/l - bl*p_m/m",
        "p_m": "bl*p_l/l - b*p_m/m - q_c/c",
        "q_c": "p_m/m",
    },
    transfers={("v", "u"): "bl*c*s/((l*s + r)*(m*c*s**2 + b*c*s + 1) + bl**2*c*s)"},
)
def loudspeaker(g: BondGraph) -> None:
    g.one("coil", Se("u"), R("r"), I("l"), domain="electrical")
    g.one("cone", I("m"), R("b"), C("c"), domain="translation")
    g.join("coil", GY("bl"), "cone")
    g.measure("v", flow="cone")


@case(
    source=TRANSDUCER + ", piezoelectric: force alpha v, charge alpha x",
    states=("p_m", "q_k", "q_c0"),
    rates={
        "p_m": "alpha*q_c0/c0 - q_k/k - b*p_m/m",
        "q_k": "p_m/m",
        "q_c0": "(u - q_c0/c0)/r - alpha*p_m/m",
    },
    transfers={
        ("x", "u"): "alpha*k/((r*c0*s + 1)*(m*k*s**2 + b*k*s + 1) + r*alpha**2*k*s)"
    },
)
def piezoelectric_actuator(g: BondGraph) -> None:
    g.one("supply", Se("u"), R("r"), domain="electrical")
    g.zero("electrodes", C("c0"), domain="electrical")
    g.one("tip", I("m"), C("k"), R("b"), domain="translation")
    g.join("supply", "electrodes")
    g.join("electrodes", TF("alpha"), "tip")
    g.measure("x", displacement="tip")


@case(
    source="electrodynamic shaker on a table that itself moves",
    states=("p_l", "p_m1", "q_c", "p_m2"),
    rates={
        "p_l": "u - r*p_l/l - bl*(p_m1/m1 - p_m2/m2)",
        "p_m1": "bl*p_l/l - q_c/c",
        "q_c": "p_m1/m1 - p_m2/m2",
        "p_m2": "q_c/c - bl*p_l/l - d*p_m2/m2",
    },
)
def shaker_on_a_table(g: BondGraph) -> None:
    g.one("coil", Se("u"), R("r"), I("l"))
    g.one("armature", I("m1"))
    g.zero("force")
    g.one("stroke", C("c"))
    g.one("table", I("m2"), R("d"))
    g.join("coil", GY("bl"), "stroke")
    g.join("armature", "force")
    g.join("force", "stroke")
    g.join("force", "table")


@case(
    source="eddy-current brake: drag k v/(1 + (v/v0)²), largest at v0",
    states=("p_m",),
    rates={"p_m": "force - k*(p_m/m)/(1 + (p_m/(m*v0))**2)"},
)
def eddy_current_brake(g: BondGraph) -> None:
    k, v0 = sympy.symbols("k v0")
    g.one("rail", Se("force"), I("m"), R("brake", law=k * f / (1 + (f / v0) ** 2)))
    g.measure("v", flow="rail")


@case(
    source="Euler's equations of a free body as a ring of modulated gyrators;"
    " KMR, ch. 9, rigid bodies in space",
    states=("p_x", "p_y", "p_z"),
    rates={
        "p_x": "mx + p_y*p_z*(1/jz - 1/jy)",
        "p_y": "my + p_z*p_x*(1/jx - 1/jz)",
        "p_z": "mz + p_x*p_y*(1/jy - 1/jx)",
    },
)
def euler_gyrator_ring(g: BondGraph) -> None:
    for axis in "xyz":
        inertia = sympy.Symbol(f"j{axis}")
        g.one(f"about_{axis}", Se(f"m{axis}"), I(axis, law=p / inertia))
    for tail, head, third in ("xyz", "yzx", "zxy"):
        # The momentum about the third axis turns with the body.
        modulus = momentum(third)
        g.join(f"about_{tail}", GY(f"with_{third}", law=modulus), f"about_{head}")


@case(
    source="position-dependent inductance L(x) = l0/(1 + x/d), force flux²/(2 l0 d)",
    states=("p_flux", "p_m", "q_k"),
    rates={
        "p_flux": "u - r*p_flux*(1 + q_k/d)/l0",
        "p_m": "-p_flux**2/(2*l0*d) - q_k/k",
        "q_k": "p_m/m",
    },
)
def electromagnet_by_modulation(g: BondGraph) -> None:
    l0, d = sympy.symbols("l0 d")
    law = p * (1 + displacement("k") / d) / l0
    pull = Se("pull", value=-(momentum("flux") ** 2) / (2 * l0 * d))
    g.one("coil", Se("u"), R("r"), I("flux", law=law))
    g.one("armature", I("m"), C("k"), pull)
