"""Electrical circuits with passive parts, each answer from Kirchhoff's laws."""

import itertools

import sympy

from bondgraph import TF, BondGraph, C, I, R, Se, Sf, e, f, p, q
from catalogue.cases import case

SERIES = "KMR, ch. 4, electrical circuits, and ch. 5, state equations"
DEPENDENT = "KMR, ch. 5, systems with derivative causality"
LOOPS = "KMR, ch. 5, algebraic loops"


@case(
    source=SERIES,
    states=("q_c",),
    rates={"q_c": "(u - q_c/c)/r"},
    transfers={("v", "u"): "1/(r*c*s + 1)", ("i", "u"): "c*s/(r*c*s + 1)"},
)
def rc(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"), C("c"))
    g.measure("v", effort="c")
    g.measure("i", flow="loop")


@case(
    source=SERIES,
    states=("p_l", "q_c"),
    rates={"p_l": "u - r*p_l/l - q_c/c", "q_c": "p_l/l"},
    transfers={("v", "u"): "1/(l*c*s**2 + r*c*s + 1)"},
)
def rlc_series(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"), I("l"), C("c"))
    g.measure("v", effort="c")


@case(
    source=SERIES,
    states=("p_l", "q_c"),
    rates={"p_l": "q_c/c", "q_c": "i - q_c/(r*c) - p_l/l"},
    transfers={("v", "i"): "l*r*s/(l*r*c*s**2 + l*s + r)"},
)
def rlc_parallel(g: BondGraph) -> None:
    g.zero("node", Sf("i"), R("r"), I("l"), C("c"))
    g.measure("v", effort="node")


@case(
    source=DEPENDENT,
    states=("q_c1",),
    derivative=("c2",),
    transfers={("v", "u"): "1/(r*(c1 + c2)*s + 1)"},
)
def two_compliances_in_parallel(g: BondGraph) -> None:
    g.one("series", Se("u"), R("r"))
    g.zero("node", C("c1"), C("c2"))
    g.join("series", "node")
    g.measure("v", effort="node")


@case(
    source=LOOPS,
    states=("q_c",),
    loops=1,
    transfers={("v", "u"): "r2/(((r1 + r2)*r3 + r1*r2)*c*s + r1 + r2)"},
)
def resistive_loop_with_c(g: BondGraph) -> None:
    g.one("source", Se("u"), R("r1"))
    g.zero("middle", R("r2"))
    g.one("branch", R("r3"), C("c"))
    g.join("source", "middle")
    g.join("middle", "branch")
    g.measure("v", effort="c")


@case(
    source=LOOPS,
    states=(),
    loops=1,
    transfers={("v", "u"): "r2/(r1 + r2)", ("i", "u"): "1/(r1 + r2)"},
)
def divider(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r1"), R("r2"))
    g.measure("v", effort="r2")
    g.measure("i", flow="u")


@case(source="Ohm's law", states=(), transfers={("v", "i"): "r"})
def flow_source_on_resistance(g: BondGraph) -> None:
    g.zero("node", Sf("i"), R("r"))
    g.measure("v", effort="node")


@case(
    source=DEPENDENT + " forced by a source",
    states=(),
    derivative=("c",),
    transfers={("i", "u"): "c*s + 1/r"},
)
def source_forced_compliance(g: BondGraph) -> None:
    g.zero("node", Se("u"), C("c"), R("r"))
    g.measure("i", flow="u")


@case(
    source=DEPENDENT + " forced by a source",
    states=("q_c",),
    derivative=("l",),
    rates={"q_c": "i - q_c/(r*c)"},
    transfers={("v", "i"): "l*s + r/(r*c*s + 1)"},
)
def source_forced_inductance(g: BondGraph) -> None:
    g.one("loop", Sf("i"), I("l"))
    g.zero("node", C("c"), R("r"))
    g.join("loop", "node")
    g.measure("v", effort="i")


@case(
    source=DEPENDENT + "; the divider passes fast signals by its capacitances",
    states=("p_m", "q_c1"),
    derivative=("c2",),
    transfers={("v", "u"): "m*s*(c1*s + g)/((c1 + c2)*m*s**2 + g*m*s + 1)"},
)
def driven_capacitor_divider(g: BondGraph) -> None:
    g.one("bridge", Se("u"))
    g.zero("upper", C("c1"), R("leak", law=sympy.Symbol("g") * e))
    g.zero("lower", C("c2"), I("m"))
    g.join("bridge", "upper")
    g.join("bridge", "lower")
    g.measure("v", effort="lower")


@case(
    source=SERIES + "; two capacitors in series hold one charge and a constant",
    states=("q_c1", "q_c2"),
    rates={
        "q_c1": "(u - q_c1/c1 - q_c2/c2)/r",
        "q_c2": "(u - q_c1/c1 - q_c2/c2)/r",
    },
    transfers={("i", "u"): "c1*c2*s/(r*c1*c2*s + c1 + c2)"},
)
def capacitors_in_series(g: BondGraph) -> None:
    g.one("loop", Se("u"), C("c1"), C("c2"), R("r"))
    g.measure("i", flow="loop")


@case(
    source=DEPENDENT + " forced by a source",
    states=("q_c1",),
    derivative=("c2",),
    transfers={
        ("v", "u"): "c1/(c1 + c2)",
        ("i", "u"): "c1*c2*s/(c1 + c2)",
    },
)
def capacitive_divider(g: BondGraph) -> None:
    g.one("loop", Se("u"), C("c1"), C("c2"))
    g.measure("v", effort="c2")
    g.measure("i", flow="loop")


@case(
    source=DEPENDENT + "; a star of three inductances has two independent currents",
    states=("p_la", "p_lb"),
    derivative=("lc",),
    transfers={
        ("ia", "ua"): "2/(3*(l*s + r))",
        ("ia", "ub"): "-1/(3*(l*s + r))",
        ("vn", "uc"): "1/3",
    },
)
def three_phase_star(g: BondGraph) -> None:
    inductance, resistance = sympy.symbols("l r")
    g.zero("star")
    for phase in "abc":
        g.one(
            f"phase_{phase}",
            Se(f"u{phase}"),
            I(f"l{phase}", law=p / inductance),
            R(f"r{phase}", law=resistance * f),
        )
        g.join(f"phase_{phase}", "star")
    g.measure("ia", flow="phase_a")
    g.measure("vn", effort="star")


@case(
    source="Wheatstone 1843; Thevenin's theorem at the detector",
    states=(),
    loops=2,
    transfers={
        ("ig", "u"): "(r2*r3 - r1*r4)"
        "/(rg*(r1 + r2)*(r3 + r4) + r1*r2*(r3 + r4) + r3*r4*(r1 + r2))"
    },
)
def wheatstone_bridge(g: BondGraph) -> None:
    g.zero("top", Se("u"))
    g.zero("left", R("r2"))
    g.zero("right", R("r4"))
    g.one("upper_left", R("r1"))
    g.one("upper_right", R("r3"))
    g.one("detector", R("rg"))
    g.join("top", "upper_left")
    g.join("upper_left", "left")
    g.join("top", "upper_right")
    g.join("upper_right", "right")
    g.join("left", "detector")
    g.join("detector", "right")
    g.measure("ig", flow="detector")


@case(
    source="Maxwell's inductance bridge, balanced where r2 r3 = r1 r4 at rest",
    states=("p_lx",),
    loops=2,
    transfers={
        ("ig", "u"): "(r2*r3 - r1*(r4 + lx*s))"
        "/(rg*(r1 + r2)*(r3 + r4 + lx*s) + r1*r2*(r3 + r4 + lx*s)"
        " + r3*(r4 + lx*s)*(r1 + r2))"
    },
)
def inductance_bridge(g: BondGraph) -> None:
    g.zero("top", Se("u"))
    g.zero("left", R("r2"))
    g.zero("right")
    g.one("unknown", R("r4"), I("lx"))
    g.one("upper_left", R("r1"))
    g.one("upper_right", R("r3"))
    g.one("detector", R("rg"))
    for tail, head in (
        ("top", "upper_left"),
        ("upper_left", "left"),
        ("top", "upper_right"),
        ("upper_right", "right"),
        ("right", "unknown"),
        ("left", "detector"),
        ("detector", "right"),
    ):
        g.join(tail, head)
    g.measure("ig", flow="detector")


@case(
    source="twin-T notch filter, unloaded, by node analysis",
    states=("q_ca", "q_cb", "q_cm"),
    transfers={("v", "u"): "(1 + (r*c*s)**2)/(1 + 4*r*c*s + (r*c*s)**2)"},
)
def twin_t(g: BondGraph) -> None:
    r, c = sympy.symbols("r c")
    g.zero("inlet", Se("u"))
    g.zero("middle_r", C("cm", law=q / (2 * c)))
    g.zero("middle_c", R("rm", law=2 * e / r))
    g.zero("outlet")
    g.one("r_in", R("ra", law=r * f))
    g.one("r_out", R("rb", law=r * f))
    g.one("c_in", C("ca", law=q / c))
    g.one("c_out", C("cb", law=q / c))
    for path in (
        ("inlet", "r_in", "middle_r", "r_out", "outlet"),
        ("inlet", "c_in", "middle_c", "c_out", "outlet"),
    ):
        for tail, head in itertools.pairwise(path):
            g.join(tail, head)
    g.measure("v", effort="outlet")


@case(
    source="continued fraction of a ladder, after KMR, ch. 10, lumped lines",
    states=("p_l1", "q_c1", "p_l2", "q_c2"),
    transfers={
        ("v", "u"): "r/(l1*s*((c1*s)*(l2*s*(c2*r*s + 1) + r) + c2*r*s + 1)"
        " + l2*s*(c2*r*s + 1) + r)"
    },
)
def lc_ladder(g: BondGraph) -> None:
    g.one("first", Se("u"), I("l1"))
    g.zero("node1", C("c1"))
    g.one("second", I("l2"))
    g.zero("node2", C("c2"), R("r"))
    for tail, head in (("first", "node1"), ("node1", "second"), ("second", "node2")):
        g.join(tail, head)
    g.measure("v", effort="node2")


@case(
    source="KMR, ch. 4, transformers: impedances are seen over the ratio squared",
    states=("p_l",),
    loops=1,
    transfers={("i", "u"): "(r2 + l*k**2*s)/(r1*r2 + (r1*k**2 + r2)*l*s)"},
)
def magnetising_inductance(g: BondGraph) -> None:
    g.one("primary", Se("u"), R("r1"))
    g.zero("core", I("l"))
    g.zero("secondary", R("r2"))
    g.join("primary", "core")
    g.join("core", TF("k"), "secondary")
    g.measure("i", flow="primary")


@case(
    source="coupled coils as a T of their leakages, after KMR, ch. 7, inertial fields",
    states=("p_la", "p_lb"),
    derivative=("m",),
    transfers={
        # (l1 s + r1) i1 + m s i2 = u, m s i1 + (l2 s + r2) i2 = 0; l1 = la + m, …
        (
            "i1",
            "u",
        ): "((lb + m)*s + r2)/(((la + m)*s + r1)*((lb + m)*s + r2) - (m*s)**2)",
        ("i2", "u"): "-m*s/(((la + m)*s + r1)*((lb + m)*s + r2) - (m*s)**2)",
    },
)
def coupled_coils_as_a_tee(g: BondGraph) -> None:
    g.one("primary", Se("u"), R("r1"), I("la"))
    g.one("secondary", R("r2"), I("lb"))
    g.zero("core")
    g.one("mutual", I("m"))
    g.join("primary", "core")
    g.join("secondary", "core")
    g.join("core", "mutual")
    g.measure("i1", flow="primary")
    g.measure("i2", flow="secondary")


@case(
    source="KMR, ch. 5, nonlinear algebraic loops; Shockley's diode",
    states=("q_c",),
    loops=1,
    relations=("i - i0*(exp((u - q_c/c - r*i)/vt) - 1)", "dq_c - i"),
)
def diode_and_resistance(g: BondGraph) -> None:
    i0, vt = sympy.symbols("i0 vt")
    g.one("loop", Se("u"), R("diode", law=i0 * (sympy.exp(e / vt) - 1)), R("r"), C("c"))
    g.measure("i", flow="loop")


@case(
    source="half-wave rectifier with a diode that conducts one way",
    states=("q_c",),
    rates={"q_c": "Max(u - q_c/c, 0)/ron - q_c/(r*c)"},
)
def rectifier(g: BondGraph) -> None:
    ron = sympy.Symbol("ron")
    g.one("inlet", Se("u"), R("diode", law=sympy.Max(e, 0) / ron))
    g.zero("store", C("c"), R("r"))
    g.join("inlet", "store")
    g.measure("v", effort="store")


@case(
    source="Graetz's bridge of four Shockley diodes; currents balance at a and b",
    states=("q_c",),
    loops=3,
    relations=(
        "dq_c + v/r - i0*(exp((va - v)/vt) - 1) - i0*(exp((vb - v)/vt) - 1)",
        "v - q_c/c",
        "(u - va + vb)/rs + i0*(exp(-va/vt) - 1) - i0*(exp((va - v)/vt) - 1)",
        "-(u - va + vb)/rs + i0*(exp(-vb/vt) - 1) - i0*(exp((vb - v)/vt) - 1)",
    ),
)
def diode_bridge(g: BondGraph) -> None:
    i0, vt = sympy.symbols("i0 vt")
    conduct = i0 * (sympy.exp(e / vt) - 1)
    g.parameter("i0", 0.8)
    g.parameter("vt", 1.2)
    blocked = conduct.xreplace({e: -e})
    g.zero("a", R("from_ground_to_a", law=-blocked))
    g.zero("b", R("from_ground_to_b", law=-blocked))
    g.zero("load", C("c"), R("r"))
    g.one("supply", Se("u"), R("rs"))
    g.one("through_a", R("a_to_load", law=conduct))
    g.one("through_b", R("b_to_load", law=conduct))
    for tail, head in (
        ("b", "supply"),
        ("supply", "a"),
        ("a", "through_a"),
        ("through_a", "load"),
        ("b", "through_b"),
        ("through_b", "load"),
    ):
        g.join(tail, head)
    g.measure("v", effort="load")
    g.measure("va", effort="a")
    g.measure("vb", effort="b")


@case(
    source="two resistances, one square, in series: r1 i + k i|i| = u by the quadratic",
    states=(),
    loops=1,
    relations=("r1*i + k*i*Abs(i) - u", "2*k*i + r1 - sqrt(r1**2 + 4*k*u)"),
)
def square_law_divider(g: BondGraph) -> None:
    k = sympy.Symbol("k")
    g.one("loop", Se("u"), R("r1"), R("lamp", law=k * f * sympy.Abs(f)))
    g.measure("i", flow="loop")


@case(
    source=DEPENDENT + " with a nonlinear store, v = q_c/c = k q³",
    states=("q_cubic",),
    derivative=("c",),
    rates={"q_cubic": "i/(1 + 3*c*k*q_cubic**2)"},
)
def cubic_beside_linear_compliance(g: BondGraph) -> None:
    k = sympy.Symbol("k")
    g.zero("node", Sf("i"), C("c"), C("cubic", law=k * q**3))
    g.measure("v", effort="node")


@case(
    source="a saturating choke, flux = phi tanh(i/is), forced by a current source",
    states=(),
    derivative=("choke",),
    relations=("v - phi/ia*(1 - tanh(i/ia)**2)*di - r*i",),
)
def choke_on_a_current_source(g: BondGraph) -> None:
    phi, ia = sympy.symbols("phi ia")
    g.one("loop", Sf("i"), I("choke", law=phi * sympy.tanh(f / ia)), R("r"))
    g.measure("v", effort="i")


@case(
    source="Chua 1983; a cubic negative conductance: c1 v1' = (v2 - v1)/r - g(v1)",
    states=("q_c1", "q_c2", "p_l"),
    rates={
        "q_c1": "(q_c2/c2 - q_c1/c1)/r + ga*q_c1/c1 - gb*(q_c1/c1)**3",
        "q_c2": "(q_c1/c1 - q_c2/c2)/r - p_l/l",
        "p_l": "q_c2/c2",
    },
)
def chua(g: BondGraph) -> None:
    ga, gb = sympy.symbols("ga gb")
    g.zero("active", C("c1"), R("diode", law=-ga * e + gb * e**3))
    g.one("between", R("r"))
    g.zero("tank", C("c2"), I("l"))
    g.join("tank", "between")
    g.join("between", "active")


@case(
    source="van der Pol 1926: a tank with conductance -a v + b v³",
    states=("p_l", "q_c"),
    rates={"q_c": "a*q_c/c - b*(q_c/c)**3 - p_l/l", "p_l": "q_c/c"},
)
def van_der_pol(g: BondGraph) -> None:
    a, b = sympy.symbols("a b")
    g.zero("tank", I("l"), C("c"), R("triode", law=-a * e + b * e**3))
    g.measure("v", effort="tank")
