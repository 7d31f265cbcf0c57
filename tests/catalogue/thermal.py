"""Heat and reactions: temperatures over heat flows, potentials over molar flows."""

import itertools

import sympy

from bondgraph import BondGraph, C, I, R, Se, Sf, effort, f, flow, q
from catalogue.cases import case

HEAT = "KMR, ch. 12, pseudo bond graphs of heat conduction"
REACTIONS = "Oster, Perelson, Katchalsky 1973, network thermodynamics"


@case(
    source=HEAT + "; two rooms, a wall between, both against the outside",
    states=("q_room1", "q_room2"),
    rates={
        "q_room1": "heater - (q_room1/room1 - q_room2/room2)/wall"
        " - (q_room1/room1 - outside)/r1",
        "q_room2": "(q_room1/room1 - q_room2/room2)/wall"
        " - (q_room2/room2 - outside)/r2",
    },
)
def two_rooms(g: BondGraph) -> None:
    g.zero("air1", Sf("heater"), C("room1"), domain="thermal")
    g.zero("air2", C("room2"), domain="thermal")
    g.zero("weather", Se("outside"), domain="thermal")
    g.one("between", R("wall"), domain="thermal")
    g.one("window1", R("r1"), domain="thermal")
    g.one("window2", R("r2"), domain="thermal")
    for path in (
        ("air1", "between", "air2"),
        ("air1", "window1", "weather"),
        ("air2", "window2", "weather"),
    ):
        for tail, head in itertools.pairwise(path):
            g.join(tail, head)


@case(
    source=HEAT + "; a wall as two resistances around its heat capacity",
    states=("q_wall", "q_room"),
    rates={
        "q_wall": "(outside - q_wall/wall)/ra - (q_wall/wall - q_room/room)/rb",
        "q_room": "(q_wall/wall - q_room/room)/rb + heater",
    },
    transfers={
        ("temperature", "outside"): "1/((ra*wall*s + 1)*(rb*room*s + 1) + ra*room*s)"
    },
)
def wall_with_mass(g: BondGraph) -> None:
    g.one("outer", Se("outside"), R("ra"), domain="thermal")
    g.zero("brick", C("wall"), domain="thermal")
    g.one("inner", R("rb"), domain="thermal")
    g.zero("air", C("room"), Sf("heater"), domain="thermal")
    for tail, head in (("outer", "brick"), ("brick", "inner"), ("inner", "air")):
        g.join(tail, head)
    for name in ("wall", "room"):
        g.parameter(name, unit="J/K")
    for name in ("ra", "rb"):
        g.parameter(name, unit="K/W")
    g.measure("temperature", effort="air")


@case(
    source="Stefan and Boltzmann: radiation goes with the fourth power",
    states=("q_body",),
    rates={"q_body": "heater - sigma*((q_body/body)**4 - sky**4)"},
)
def radiating_body(g: BondGraph) -> None:
    sigma = sympy.Symbol("sigma")
    g.zero("surface", Sf("heater"), C("body"))
    g.zero("dark", Se("sky"))
    radiated = sigma * (effort("body") ** 4 - effort("sky") ** 4)
    g.one("radiation", Sf("exchange", value=radiated))
    g.join("surface", "radiation")
    g.join("radiation", "dark")


@case(
    source="self-heating resistance: heat i² r, r = r0 (1 + alpha T)",
    states=("p_l", "q_body"),
    rates={
        "p_l": "u - r0*(1 + alpha*q_body/body)*p_l/l",
        "q_body": "r0*(1 + alpha*q_body/body)*(p_l/l)**2 - q_body/(body*rth)",
    },
)
def self_heating_coil(g: BondGraph) -> None:
    r0, alpha = sympy.symbols("r0 alpha")
    copper = R("copper", law=r0 * (1 + alpha * effort("body")) * f)
    g.one("circuit", Se("u"), I("l"), copper)
    heat = Sf("heat", value=effort("copper") * flow("copper"))
    g.zero("winding", heat, C("body"), R("rth"))


@case(
    source=REACTIONS + ": a <-> b by mass action, potentials rt log(k q)",
    states=("q_a", "q_b"),
    rates={
        "q_a": "-kappa*(ka*q_a - kb*q_b)",
        "q_b": "kappa*(ka*q_a - kb*q_b)",
    },
)
def reaction(g: BondGraph) -> None:
    rt, kappa, ka, kb = sympy.symbols("rt kappa ka kb")
    g.zero("pool_a", C("a", law=rt * sympy.log(ka * q)))
    g.zero("pool_b", C("b", law=rt * sympy.log(kb * q)))
    rate = kappa * (sympy.exp(effort("a") / rt) - sympy.exp(effort("b") / rt))
    g.one("conversion", Sf("rate", value=rate))
    g.join("pool_a", "conversion")
    g.join("conversion", "pool_b")


@case(
    source=REACTIONS + ": a + b <-> c with an open supply of a",
    states=("q_a", "q_b", "q_c"),
    rates={
        "q_a": "feed - kappa*(ka*q_a*kb*q_b - kc*q_c)",
        "q_b": "-kappa*(ka*q_a*kb*q_b - kc*q_c)",
        "q_c": "kappa*(ka*q_a*kb*q_b - kc*q_c)",
    },
)
def binding(g: BondGraph) -> None:
    rt, kappa, ka, kb, kc = sympy.symbols("rt kappa ka kb kc")
    for name, k in (("a", ka), ("b", kb), ("c", kc)):
        g.zero(f"pool_{name}", C(name, law=rt * sympy.log(k * q)))
    forward = sympy.exp((effort("a") + effort("b")) / rt)
    rate = kappa * (forward - sympy.exp(effort("c") / rt))
    g.one("complex", Sf("rate", value=rate))
    g.join("pool_a", "complex")
    g.join("pool_b", "complex")
    g.join("complex", "pool_c")
    g.put(Sf("feed"), on="pool_a")
