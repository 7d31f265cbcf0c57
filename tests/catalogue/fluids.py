"""Hydraulic machines: pressure is the effort, volume flow the flow."""

import sympy

from bondgraph import (
    TF,
    BondGraph,
    C,
    I,
    R,
    Se,
    Sf,
    displacement,
    e,
    effort,
    f,
    q,
)
from catalogue.cases import case

CIRCUITS = "KMR, ch. 4, fluid circuits"
CONVERTERS = "KMR, ch. 4, transducers between fluid and mechanical power"
LINES = "KMR, ch. 10, lumped fluid lines"


def orifice(gain: sympy.Expr) -> sympy.Expr:
    """Return Torricelli's flow for the pressure e."""
    return gain * sympy.sign(e) * sympy.sqrt(sympy.Abs(e))


@case(
    source=CIRCUITS,
    states=("q_a1", "q_a2"),
    rates={
        "q_a1": "inflow - (q_a1/a1 - q_a2/a2)/rp",
        "q_a2": "(q_a1/a1 - q_a2/a2)/rp - q_a2/(a2*ro)",
    },
    transfers={
        ("pressure", "inflow"): "ro/((a1*s)*(rp*(a2*s*ro + 1) + ro) + a2*s*ro + 1)"
    },
)
def coupled_tanks(g: BondGraph) -> None:
    g.zero("first", Sf("inflow"), C("a1"))
    g.one("pipe", R("rp"))
    g.zero("second", C("a2"), R("ro"))
    g.join("first", "pipe")
    g.join("pipe", "second")
    g.measure("pressure", effort="second")


@case(
    source=CIRCUITS + "; Torricelli's outflow",
    states=("q_a",),
    rates={"q_a": "inflow - kv*sign(q_a/a)*sqrt(Abs(q_a/a))"},
)
def tank_with_orifice(g: BondGraph) -> None:
    law = orifice(sympy.Symbol("kv"))
    g.zero("tank", Sf("inflow"), C("a"), R("orifice", law=law))
    g.measure("volume", displacement("a"))


@case(
    source=CIRCUITS + "; two tanks joined and drained by orifices",
    states=("q_a1", "q_a2"),
    rates={
        "q_a1": "inflow - k1*sign(q_a1/a1 - q_a2/a2)*sqrt(Abs(q_a1/a1 - q_a2/a2))",
        "q_a2": "k1*sign(q_a1/a1 - q_a2/a2)*sqrt(Abs(q_a1/a1 - q_a2/a2))"
        " - k2*sqrt(Abs(q_a2/a2))*sign(q_a2)",
    },
)
def coupled_tanks_with_orifices(g: BondGraph) -> None:
    k1, k2 = sympy.symbols("k1 k2")
    g.zero("first", Sf("inflow"), C("a1"))
    g.one("pipe", R("between", law=orifice(k1)))
    g.zero("second", C("a2"), R("outlet", law=orifice(k2)))
    g.join("first", "pipe")
    g.join("pipe", "second")


@case(
    source=CONVERTERS + "; oil incompressible",
    states=("p_m",),
    rates={"p_m": "area*(supply - rh*area*p_m/m) - b*p_m/m"},
    transfers={("v", "supply"): "area/(m*s + b + area**2*rh)"},
)
def hydraulic_cylinder(g: BondGraph) -> None:
    area = sympy.Symbol("area")
    g.one("line", Se("supply"), R("rh"), domain="hydraulic")
    g.one("rod", I("m"), R("b"), domain="translation")
    g.join("line", TF("piston", law=area), "rod")
    g.parameter("rh", unit="Pa*s/m^3")
    g.parameter("m", unit="kg")
    g.parameter("b", unit="N*s/m")
    g.parameter("area", unit="m^2")
    g.measure("v", flow="rod")


@case(
    source=CONVERTERS + "; compressible oil, two chambers of different area",
    states=("q_ca", "q_cb", "p_m"),
    rates={
        "q_ca": "qa - aa*p_m/m",
        "q_cb": "ab*p_m/m - q_cb/(cb*rb)",
        "p_m": "aa*q_ca/ca - ab*q_cb/cb - b*p_m/m",
    },
)
def differential_cylinder(g: BondGraph) -> None:
    aa, ab = sympy.symbols("aa ab")
    g.zero("chamber_a", Sf("qa"), C("ca"))
    g.zero("chamber_b", C("cb"), R("rb"))
    g.one("rod", I("m"), R("b"))
    g.join("chamber_a", TF("piston_a", law=aa), "rod")
    g.join("rod", TF("piston_b", law=1 / ab), "chamber_b")


@case(
    source="servo valve: the spool's opening sets the orifice, after KMR, ch. 8;"
    " flow kv x sqrt(pressure drop)",
    states=("q_oil", "p_m"),
    rates={
        "q_oil": "kv*opening*sign(supply - q_oil/oil)*sqrt(Abs(supply - q_oil/oil))"
        " - area*p_m/m",
        "p_m": "area*q_oil/oil - b*p_m/m",
    },
)
def servo_valve_and_cylinder(g: BondGraph) -> None:
    kv, area = sympy.symbols("kv area")
    g.zero("command", Se("opening"))
    g.one("valve", Se("supply"), R("edge", law=orifice(kv * effort("command"))))
    g.zero("chamber", C("oil"))
    g.one("rod", I("m"), R("b"))
    g.join("valve", "chamber")
    g.join("chamber", TF("piston", law=area), "rod")


@case(
    source="pump, leaking line, motor: hydrostatic transmission, after KMR, ch. 4",
    states=("q_line", "p_j"),
    rates={
        "q_line": "dp*w - q_line/(line*leak) - dm*p_j/j",
        "p_j": "dm*q_line/line - b*p_j/j",
    },
    transfers={("speed", "w"): "dp*dm*leak/((line*leak*s + 1)*(j*s + b) + dm**2*leak)"},
)
def hydrostatic_transmission(g: BondGraph) -> None:
    dp, dm = sympy.symbols("dp dm")
    g.one("drive", Sf("w"), domain="rotation")
    g.zero("oil", C("line"), R("leak"), domain="hydraulic")
    g.one("load", I("j"), R("b"), domain="rotation")
    g.join("drive", TF("pump", law=1 / dp), "oil")
    g.join("oil", TF("motor", law=dm), "load")
    units = {"dp": "m^3", "dm": "m^3", "line": "m^3/Pa", "leak": "Pa*s/m^3"}
    for name, unit in (units | {"j": "kg*m^2", "b": "N*m*s"}).items():
        g.parameter(name, unit=unit)
    g.measure("speed", flow="load")


@case(
    source=CIRCUITS + "; accumulator at the end of a line with inertia",
    states=("p_line", "q_accumulator"),
    rates={
        "p_line": "supply - r*p_line/line - q_accumulator/accumulator",
        "q_accumulator": "p_line/line - draw",
    },
    transfers={
        ("pressure", "supply"): "1/(line*accumulator*s**2 + r*accumulator*s + 1)",
        ("pressure", "draw"): "-(line*s + r)"
        "/(line*accumulator*s**2 + r*accumulator*s + 1)",
    },
)
def accumulator_on_a_line(g: BondGraph) -> None:
    g.one("pipe", Se("supply"), R("r"), I("line"), domain="hydraulic")
    g.zero("end", C("accumulator"), domain="hydraulic")
    g.one("consumer", Sf("draw"), domain="hydraulic")
    g.join("pipe", "end")
    g.join("end", "consumer")
    g.measure("pressure", effort="end")


@case(
    source="gas accumulator, isothermal: (p0 + e)(v0 - q) = p0 v0",
    where={"v0": 2.3},
    states=("q_gas",),
    rates={"q_gas": "(supply - p0*q_gas/(v0 - q_gas))/r"},
)
def gas_accumulator(g: BondGraph) -> None:
    p0, v0 = sympy.symbols("p0 v0")
    g.one("neck", Se("supply"), R("r"), C("gas", law=p0 * q / (v0 - q)))


@case(
    source=LINES + ", three sections",
    states=("p_l1", "q_c1", "p_l2", "q_c2", "p_l3", "q_c3"),
    rates={
        "p_l1": "supply - r1*p_l1/l1 - q_c1/c1",
        "q_c1": "p_l1/l1 - p_l2/l2",
        "p_l2": "q_c1/c1 - r2*p_l2/l2 - q_c2/c2",
        "q_c2": "p_l2/l2 - p_l3/l3",
        "p_l3": "q_c2/c2 - r3*p_l3/l3 - q_c3/c3",
        "q_c3": "p_l3/l3 - q_c3/(c3*load)",
    },
)
def transmission_line(g: BondGraph) -> None:
    for k in (1, 2, 3):
        g.one(f"flow{k}", I(f"l{k}"), R(f"r{k}"))
        g.zero(f"node{k}", C(f"c{k}"))
        g.join(f"flow{k}", f"node{k}")
        if k > 1:
            g.join(f"node{k - 1}", f"flow{k}")
    g.put(Se("supply"), on="flow1")
    g.put(R("load"), on="node3")


@case(
    source="water hammer and surge tank: inertia, square-law friction, turbine draw",
    states=("p_tunnel", "q_tank"),
    rates={
        "p_tunnel": "head - k*(p_tunnel/tunnel)*Abs(p_tunnel/tunnel) - q_tank/tank",
        "q_tank": "p_tunnel/tunnel - turbine",
    },
)
def surge_tank(g: BondGraph) -> None:
    k = sympy.Symbol("k")
    wall = R("wall", law=k * f * sympy.Abs(f))
    g.one("penstock", Se("head"), I("tunnel"), wall)
    g.zero("shaft", C("tank"))
    g.one("gate", Sf("turbine"))
    g.join("penstock", "shaft")
    g.join("shaft", "gate")


@case(
    source="u-tube manometer: both columns store the level, l/g x'' + 2 x = 0",
    states=("q_left", "p_column", "q_right"),
    rates={
        "q_left": "-p_column/column",
        "p_column": "q_left/left - q_right/right - r*p_column/column",
        "q_right": "p_column/column",
    },
)
def u_tube(g: BondGraph) -> None:
    g.zero("left_level", C("left"), domain="hydraulic")
    g.one("tube", I("column"), R("r"), domain="hydraulic")
    g.zero("right_level", C("right"), domain="hydraulic")
    g.join("left_level", "tube")
    g.join("tube", "right_level")


@case(
    source=CONVERTERS + ", hydraulic press: two pistons on oil that does not yield",
    states=("p_m1",),
    derivative=("m2",),
    transfers={("v", "force"): "a1*a2/((m1*a2**2 + m2*a1**2)*s + b*a1**2)"},
)
def hydraulic_press(g: BondGraph) -> None:
    a1, a2 = sympy.symbols("a1 a2")
    g.one("small", Se("force"), I("m1"))
    g.zero("oil")
    g.one("large", I("m2"), R("b"))
    g.join("small", TF("piston1", law=1 / a1), "oil")
    g.join("oil", TF("piston2", law=a2), "large")
    g.measure("v", flow="large")


@case(
    source="float valve: the outflow's gain follows the level, after KMR, ch. 4",
    states=("q_a",),
    rates={"q_a": "inflow - k*q_a*q_a/a"},
)
def float_valve(g: BondGraph) -> None:
    k = sympy.Symbol("k")
    valve = R("valve", law=k * displacement("a") * e)
    g.zero("tank", Sf("inflow"), C("a"), valve)
