"""A catalogue of graphs with hand-derived answers, for laws that hold on every graph.

Each answer was derived by hand from Newton's, Kirchhoff's or Lagrange's equations, not
from the bond graph.
"""

import random
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy

from bondgraph import GY, TF, BondGraph, C, FinishedGraph, I, R, Se, Sf
from bondgraph.structure.signals import (
    displacement,
    e,
    effort,
    f,
    flow,
    momentum,
    p,
    q,
    t,
)


@dataclass(frozen=True)
class Case:
    """One graph and what is known of it.

    ``rates`` are ẋ by state, ``transfers`` transfer functions by (output, input),
    ``outputs`` static outputs, all as text in terms of parameter names.
    """

    name: str
    make: Callable[[], BondGraph]
    states: tuple[str, ...]
    derivative: tuple[str, ...] = ()
    loops: int = 0
    rates: Mapping[str, str] = field(default_factory=dict)
    transfers: Mapping[tuple[str, str], str] = field(default_factory=dict)
    outputs: Mapping[str, str] = field(default_factory=dict)

    @property
    def linear(self) -> bool:
        return bool(self.transfers)

    def graph(self) -> FinishedGraph:
        return self.make().finish()


CASES: list[Case] = []


def case(**known: object) -> Callable[[Callable[[BondGraph], None]], None]:
    """Add the decorated writer of a graph to the catalogue."""

    def add(write: Callable[[BondGraph], None]) -> None:
        def make() -> BondGraph:
            graph = BondGraph(write.__name__)
            write(graph)
            return graph

        CASES.append(Case(name=write.__name__, make=make, **known))  # type: ignore[arg-type]

    return add


@case(
    states=("q_c",),
    rates={"q_c": "(u - q_c/c)/r"},
    transfers={("v", "u"): "1/(r*c*s + 1)", ("i", "u"): "c*s/(r*c*s + 1)"},
)
def rc(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"), C("c"))
    g.measure("v", effort="c")
    g.measure("i", flow="loop")


@case(
    states=("p_l", "q_c"),
    rates={"p_l": "u - r*p_l/l - q_c/c", "q_c": "p_l/l"},
    transfers={("v", "u"): "1/(l*c*s**2 + r*c*s + 1)"},
)
def rlc_series(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"), I("l"), C("c"))
    g.measure("v", effort="c")


@case(
    states=("p_l", "q_c"),
    transfers={("v", "i"): "l*r*s/(l*r*c*s**2 + l*s + r)"},
)
def rlc_parallel(g: BondGraph) -> None:
    g.zero("node", Sf("i"), R("r"), I("l"), C("c"))
    g.measure("v", effort="node")


@case(
    states=("p_m", "q_c"),
    transfers={("x", "force"): "c/(m*c*s**2 + b*c*s + 1)"},
)
def spring_mass_damper(g: BondGraph) -> None:
    g.one("mass", Se("force"), I("m"), C("c"), R("b"))
    g.measure("x", displacement="mass")


@case(
    states=("p_m1", "q_shaft"),
    derivative=("m2",),
    transfers={
        ("v", "force"): "1/((m1 + m2)*s + b)",
        ("x", "force"): "1/(s*((m1 + m2)*s + b))",
        ("inner", "force"): "m2*s/((m1 + m2)*s + b)",
    },
)
def two_masses_on_one_shaft(g: BondGraph) -> None:
    g.one("shaft", Se("force"), I("m1"), I("m2"), R("b"))
    g.measure("v", flow="shaft")
    g.measure("x", displacement="shaft")
    g.measure("inner", effort="m2")


@case(
    states=("p_j1",),
    derivative=("j2",),
    transfers={("w", "torque"): "n/((j1*n**2 + j2)*s + b)"},
)
def inertias_across_a_transformer(g: BondGraph) -> None:
    g.one("fast", Se("torque"), I("j1"))
    g.one("slow", I("j2"), R("b"))
    g.join("fast", TF("n"), "slow")
    g.measure("w", flow="slow")


@case(
    states=("p_jm", "q_joint"),
    derivative=("jg", "jw", "jt", "jl"),
    transfers={
        ("theta", "torque"): "kg*kw/(s*((jl + jt + jw*kw**2 + (jm + jg)*(kg*kw)**2)*s"
        " + c))"
    },
)
def lowerleg(g: BondGraph) -> None:
    g.one("motor", Se("torque"), I("jm"), I("jg"))
    g.one("worm", I("jw"))
    g.one("joint", R("c"), I("jt"), I("jl"))
    g.join("motor", TF("kg"), "worm")
    g.join("worm", TF("kw"), "joint")
    g.measure("theta", displacement="joint")


@case(
    states=("p_la", "p_j"),
    rates={"p_la": "u - ra*p_la/la - k*p_j/j", "p_j": "k*p_la/la - b*p_j/j"},
    transfers={("w", "u"): "k/((la*s + ra)*(j*s + b) + k**2)"},
)
def dc_motor(g: BondGraph) -> None:
    g.one("armature", Se("u"), R("ra"), I("la"))
    g.one("shaft", I("j"), R("b"))
    g.join("armature", GY("k"), "shaft")
    g.measure("w", flow="shaft")


@case(
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
    states=(),
    loops=1,
    transfers={("v", "u"): "r2/(r1 + r2)", ("power_flow", "u"): "1/(r1 + r2)"},
)
def divider(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r1"), R("r2"))
    g.measure("v", effort="r2")
    g.measure("power_flow", flow="u")


@case(states=(), transfers={("v", "i"): "r"}, outputs={"v": "r*i"})
def flow_source_on_resistance(g: BondGraph) -> None:
    g.zero("node", Sf("i"), R("r"))
    g.measure("v", effort="node")


@case(
    states=(),
    derivative=("c",),
    transfers={("i", "u"): "c*s + 1/r"},
)
def source_forced_compliance(g: BondGraph) -> None:
    g.zero("node", Se("u"), C("c"), R("r"))
    g.measure("i", flow="u")


@case(states=(), derivative=("m",), transfers={("force", "v"): "m*s + b"})
def moved_mass(g: BondGraph) -> None:
    g.one("mass", Sf("v"), I("m"), R("b"))
    g.measure("force", effort="v")


@case(
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
    states=("p_m",),
    rates={"p_m": "force - b*(p_m/m)*Abs(p_m/m)"},
)
def quadratic_drag(g: BondGraph) -> None:
    b = sympy.Symbol("b")
    g.one("mass", Se("force"), I("m"), R("drag", law=b * f * sympy.Abs(f)))
    g.measure("v", flow="mass")


@case(
    states=("p_m", "q_mass"),
    rates={"p_m": "force - m*g - fc*sign(p_m/m)", "q_mass": "p_m/m"},
)
def lifted_mass_with_friction(g: BondGraph) -> None:
    m, gravity, fc = sympy.symbols("m g fc")
    g.one(
        "mass",
        Se("force"),
        Se("weight", value=-m * gravity),
        I("m"),
        R("guide", law=fc * sympy.sign(f)),
    )
    g.measure("height", displacement="mass")


@case(
    states=("p_j", "q_crank"),
    derivative=("m",),
    rates={
        # Lagrange with T = (j + m l² sin²θ) θ'²/2 and p = j θ'.
        "p_j": "j*(torque - m*l**2*sin(q_crank)*cos(q_crank)*(p_j/j)**2)"
        "/(j + m*l**2*sin(q_crank)**2)",
        "q_crank": "p_j/j",
    },
)
def crank_and_slider(g: BondGraph) -> None:
    length = sympy.Symbol("l")
    g.one("crank", Se("torque"), I("j"))
    g.one("slider", I("m"))
    g.join("slider", TF("arm", law=length * sympy.sin(displacement("crank"))), "crank")
    g.measure("theta", displacement="crank")
    g.measure("push", effort="m")


@case(
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
    states=("q_a",),
    rates={"q_a": "inflow - kv*sign(q_a/a)*sqrt(Abs(q_a/a))"},
)
def tank_with_orifice(g: BondGraph) -> None:
    kv = sympy.Symbol("kv")
    law = kv * sympy.sign(e) * sympy.sqrt(sympy.Abs(e))
    g.zero("tank", Sf("inflow"), C("a"), R("orifice", law=law))
    g.measure("volume", displacement("a"))


@case(states=("q_c",), loops=1)
def diode_and_resistance(g: BondGraph) -> None:
    i0, vt = sympy.symbols("i0 vt")
    g.one("loop", Se("u"), R("diode", law=i0 * (sympy.exp(e / vt) - 1)), R("r"), C("c"))
    g.measure("v", effort="c")


@case(
    states=("p_m", "q_spring"),
    rates={"p_m": "force - k*q_spring - k3*q_spring**3", "q_spring": "p_m/m"},
)
def hardening_spring(g: BondGraph) -> None:
    k, k3 = sympy.symbols("k k3")
    g.one("mass", Se("force"), I("m"), C("spring", law=k * q + k3 * q**3))
    g.measure("x", displacement="mass")


@case(
    states=("q_cubic",),
    derivative=("c",),
    rates={"q_cubic": "i/(1 + 3*c*k*q_cubic**2)"},
)
def cubic_beside_linear_compliance(g: BondGraph) -> None:
    k = sympy.Symbol("k")
    g.zero("node", Sf("i"), C("c"), C("cubic", law=k * q**3))
    g.measure("v", effort="node")


@case(
    states=("p_m", "p_b"),
    transfers={("impulse", "force"): "b/(s*(m*s + b))"},
)
def impulse_of_a_damper(g: BondGraph) -> None:
    g.one("mass", Se("force"), I("m"), R("b"))
    g.measure("impulse", momentum("b"))


@case(
    states=("p_j1", "p_j2", "q_c"),
    transfers={
        ("w", "torque"): "(c*d*s + 1)/(j1*j2*c*s**3 + (j1 + j2)*c*d*s**2 + (j1 + j2)*s)"
    },
)
def two_mass_drive(g: BondGraph) -> None:
    g.one("motor", Se("torque"), I("j1"))
    g.zero("coupling")
    g.one("twist", C("c"), R("d"))
    g.one("load", I("j2"))
    g.join("motor", "coupling")
    g.join("coupling", "twist")
    g.join("coupling", "load")
    g.measure("w", flow="load")


@case(
    states=("p_m", "q_mass"),
    rates={"p_m": "-k*q_mass + a*sin(w*t)", "q_mass": "p_m/m"},
)
def modulated_sources(g: BondGraph) -> None:
    k, a, w = sympy.symbols("k a w")
    pull = Se("pull", value=-k * displacement("mass"))
    g.one("mass", pull, Se("shaker", value=a * sympy.sin(w * t)), I("m"))
    g.measure("x", displacement="mass")


@case(
    states=("p_m", "q_c"),
    rates={
        "p_m": "force - q_c/c - mu*Abs(q_c/c)*sign(p_m/m)",
        "q_c": "p_m/m",
    },
)
def load_dependent_friction(g: BondGraph) -> None:
    mu = sympy.Symbol("mu")
    law = mu * sympy.Abs(effort("c")) * sympy.sign(f)
    g.one("mass", Se("force"), I("m"), C("c"), R("rub", law=law))
    g.measure("v", flow("mass"))


@case(
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
    states=("p_m",),
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
    g.measure("v", flow="rod")


@case(
    states=("p_inertia",),
    rates={"p_inertia": "force - b*p_inertia/sqrt(m**2 + (p_inertia/c)**2)"},
)
def relativistic_mass(g: BondGraph) -> None:
    m, c = sympy.symbols("m c")
    g.one("mass", Se("force"), I("inertia", law=p / sympy.sqrt(m**2 + (p / c) ** 2)))
    g.put(R("b"), on="mass")
    g.measure("v", flow="mass")


def expression(text: str) -> sympy.Expr:
    """Return a catalogue answer with the symbols the library uses."""
    names = {str(x): sympy.Symbol(str(x), real=True) for x in _names(text)}
    return sympy.sympify(text, locals={**names, "s": sympy.Symbol("s")})


def _names(text: str) -> set[str]:
    known = {"sin", "cos", "sign", "sqrt", "Abs"}
    return set(re.findall(r"[A-Za-z_]\w*", text)) - known


def somewhere(symbols: set[sympy.Symbol], seed: int = 0) -> dict[sympy.Symbol, float]:
    """Return arbitrary values between 0.5 and 1.5, the same for the same names."""
    ordered = sorted(symbols, key=str)
    values = {}
    for x in ordered:
        code = sum((i + 1) * ord(c) for i, c in enumerate(str(x))) + 37 * seed
        values[x] = 0.5 + (code * 0.6180339887498949) % 1.0
    return values


def agree(one: sympy.Expr, other: sympy.Expr) -> bool:
    """Return whether two expressions have the same value at arbitrary numbers."""
    symbols = one.free_symbols | other.free_symbols
    for seed in range(3):
        put = somewhere(symbols, seed)
        a, b = (complex(x.subs(put)) for x in (one, other))
        if abs(a - b) > 1e-9 * max(1.0, abs(a), abs(b)):
            return False
    return True


def random_graph(seed: int) -> BondGraph:
    """Return a linear graph drawn at random: a tree of junctions, rings added.

    Nothing makes it well posed: many such graphs are causal conflicts.
    """
    draw = random.Random(seed)
    graph = BondGraph(f"random {seed}")
    size = draw.randint(1, 6)
    elements: list[str] = []
    for j in range(size):
        kinds = draw.choices([I, C, R, R, Se, Sf], k=draw.randint(0, 3))
        ports = [kind(f"x{j}_{k}") for k, kind in enumerate(kinds)]
        elements += [port.name for port in ports]
        (graph.one if draw.random() < 0.5 else graph.zero)(f"j{j}", *ports)
    pairs = [(draw.randrange(j), j) for j in range(1, size)]
    if size > 2:
        pairs += [tuple(draw.sample(range(size), 2)) for _ in range(draw.randint(0, 2))]
    for n, pair in enumerate(pairs):
        tail, head = (f"j{j}" for j in draw.sample(pair, 2))
        two_port = draw.choice([None, None, TF(f"k{n}"), GY(f"k{n}")])
        graph.join(tail, *(() if two_port is None else (two_port,)), head)
    for name in draw.sample(elements, min(2, len(elements))):
        graph.measure(f"effort_{name}", effort=name)
        graph.measure(f"flow_{name}", flow=name)
    return graph
