"""Active and nonreciprocal networks: amplifiers, gyrators, rings, converters."""

import sympy

from bondgraph import GY, TF, BondGraph, C, I, R, Se, Sf, effort, f, q
from catalogue.cases import case

AMPLIFIER = "KMR, ch. 8, amplifiers as modulated sources"
GYRATOR = "Tellegen 1948; KMR, ch. 4, gyrators"


@case(
    source=GYRATOR,
    states=("q_c",),
    transfers={("v", "i"): "r1**2*r/(r1**2*r*c*s + r2**2)"},
)
def gyrators_in_a_row(g: BondGraph) -> None:
    g.zero("left", Sf("i"), C("c"))
    g.zero("middle")
    g.zero("right", R("r"))
    g.join("left", GY("r1"), "middle")
    g.join("middle", GY("r2"), "right")
    g.measure("v", effort="left")


@case(
    source=GYRATOR + ": a capacitor behind a gyrator is an inductance k² c",
    states=("q_c",),
    rates={"q_c": "(u - r*q_c/(c*k))/k"},
    transfers={("i", "u"): "1/(k**2*c*s + r)"},
)
def gyrated_capacitor(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"))
    g.one("charge", C("c"))
    g.join("loop", GY("k"), "charge")
    g.measure("i", flow="loop")


@case(
    source=GYRATOR + "; three of them in a ring circulate, with k = r/r0:"
    " v3 - v1 + k v2 = 0, v1 - v2 + k v3 = 0, (v2 - v3)/r = (u - v1)/r0",
    states=(),
    loops=2,
    transfers={
        ("v2", "u"): "(1 + r/r0)/(3 + (r/r0)**2)",
        ("v3", "u"): "(1 - r/r0)/(3 + (r/r0)**2)",
    },
)
def circulator(g: BondGraph) -> None:
    r, r0 = sympy.symbols("r r0")
    g.zero("port1")
    g.zero("port2", R("load2", law=r0 * f))
    g.zero("port3", R("load3", law=r0 * f))
    g.one("feed", Se("u"), R("inner", law=r0 * f))
    g.join("feed", "port1")
    for tail, head in ((1, 2), (2, 3), (3, 1)):
        g.join(f"port{tail}", GY(f"k{tail}", law=r), f"port{head}")
    g.measure("v2", effort="port2")
    g.measure("v3", effort="port3")


@case(
    source="two transformers from a 0- to a 1-junction: the ratios add",
    states=("p_m",),
    transfers={("v", "u"): "(k1 + k2)/(m*s + b + (k1 + k2)**2*r)"},
)
def transformer_ring(g: BondGraph) -> None:
    g.one("feed", Se("u"), R("r"))
    g.zero("parallel")
    g.one("sum", I("m"), R("b"))
    g.join("feed", "parallel")
    g.join("parallel", TF("k1"), "sum")
    g.join("parallel", TF("k2"), "sum")
    g.measure("v", flow="sum")


@case(
    source="two transformers between 1-junctions lock both unless their ratios agree",
    states=(),
    derivative=("m",),
    loops=2,
    transfers={("v", "u"): "0"},
)
def locked_gearbox(g: BondGraph) -> None:
    g.one("left", Se("u"), I("m"))
    g.one("right", R("b"))
    g.join("left", TF("k1"), "right")
    g.join("left", TF("k2"), "right")
    g.measure("v", flow="right")


@case(
    source=AMPLIFIER + "; inverting amplifier of gain A, v_out = -A v",
    active=True,
    states=(),
    loops=1,
    transfers={("v", "u"): "-gain*r2/(r2 + (1 + gain)*r1)"},
)
def inverting_amplifier(g: BondGraph) -> None:
    g.one("inlet", Se("u"), R("r1"))
    g.zero("minus")
    g.one("feedback", R("r2"))
    amplifier = Se("amplifier", value=-sympy.Symbol("gain") * effort("minus"))
    g.zero("outlet", amplifier)
    g.join("inlet", "minus")
    g.join("minus", "feedback")
    g.join("feedback", "outlet")
    g.measure("v", effort="outlet")


@case(
    source=AMPLIFIER + "; integrator of gain A: v (1 + (1 + A) r c s) = u",
    active=True,
    states=("q_c",),
    loops=1,
    transfers={("v", "u"): "-gain/((1 + gain)*r*c*s + 1)"},
)
def integrating_amplifier(g: BondGraph) -> None:
    g.one("inlet", Se("u"), R("r"))
    g.zero("minus")
    g.one("feedback", C("c"))
    amplifier = Se("amplifier", value=-sympy.Symbol("gain") * effort("minus"))
    g.zero("outlet", amplifier)
    g.join("inlet", "minus")
    g.join("minus", "feedback")
    g.join("feedback", "outlet")
    g.measure("v", effort="outlet")


@case(
    source="Sallen and Key 1955, low pass of unity gain",
    active=True,
    states=("q_c1", "q_c2"),
    transfers={("v", "u"): "1/(r1*r2*c1*c2*s**2 + (r1 + r2)*c2*s + 1)"},
)
def sallen_key(g: BondGraph) -> None:
    g.one("inlet", Se("u"), R("r1"))
    g.zero("node")
    g.one("second", R("r2"))
    g.zero("plus", C("c2"))
    g.one("feedback", C("c1"))
    g.zero("outlet", Se("follower", value=effort("plus")))
    for tail, head in (
        ("inlet", "node"),
        ("node", "second"),
        ("second", "plus"),
        ("node", "feedback"),
        ("feedback", "outlet"),
    ):
        g.join(tail, head)
    g.measure("v", effort="outlet")


@case(
    source="averaged step-down converter: duty times supply, l i' = d u - v",
    states=("p_l", "q_c"),
    rates={"p_l": "duty*u - q_c/c", "q_c": "p_l/l - q_c/(r*c)"},
)
def step_down_converter(g: BondGraph) -> None:
    g.zero("command", Se("duty"))
    g.one("supply", Se("u"))
    g.one("choke", I("l"))
    g.zero("outlet", C("c"), R("r"))
    g.join("supply", TF("switch", law=effort("command")), "choke")
    g.join("choke", "outlet")
    g.measure("v", effort="outlet")


@case(
    source="averaged step-up converter: l i' = u - (1 - d) v, c v' = (1 - d) i - v/r",
    states=("p_l", "q_c"),
    rates={"p_l": "u - (1 - duty)*q_c/c", "q_c": "(1 - duty)*p_l/l - q_c/(r*c)"},
)
def step_up_converter(g: BondGraph) -> None:
    g.zero("command", Se("duty"))
    g.one("choke", Se("u"), I("l"))
    g.zero("outlet", C("c"), R("r"))
    g.join("choke", TF("switch", law=1 / (1 - effort("command"))), "outlet")
    g.measure("v", effort="outlet")


@case(
    source="KMR, ch. 11, magnetic circuits: n turns are a gyrator, a permeance is a C",
    states=("q_core", "q_gap"),
    rates={
        "q_core": "(u - r*(q_core/pc + q_gap/pg)/n)/n",
        "q_gap": "(u - r*(q_core/pc + q_gap/pg)/n)/n",
    },
    transfers={("i", "u"): "(pc + pg)/(n**2*pc*pg*s + r*(pc + pg))"},
)
def coil_with_air_gap(g: BondGraph) -> None:
    pc, pg = sympy.symbols("pc pg")
    g.one("coil", Se("u"), R("r"))
    g.one("flux", C("core", law=q / pc), C("gap", law=q / pg))
    g.join("coil", GY("n"), "flux")
    g.measure("i", flow="coil")


@case(
    source="KMR, ch. 11, magnetic circuits: two windings on one core",
    states=("q_core",),
    loops=1,
    transfers={
        # Core: n1 i1 - n2 i2 = flux/pc; u = r1 i1 + n1 flux', n2 flux' = r2 i2.
        ("v", "u"): "n1*n2*r2*pc*s/((n1**2*r2 + n2**2*r1)*pc*s + r1*r2)"
    },
)
def transformer_with_core(g: BondGraph) -> None:
    g.one("primary", Se("u"), R("r1"))
    g.one("flux", C("core", law=q / sympy.Symbol("pc")))
    g.one("secondary", R("r2"))
    g.join("primary", GY("n1"), "flux")
    g.join("flux", GY("n2"), "secondary")
    g.measure("v", effort="r2")
