"""Mechanical machines that move along one line or about one axis, after Newton."""

import itertools

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
    effort,
    f,
    flow,
    momentum,
    p,
    q,
    t,
)
from catalogue.cases import case

TRANSLATION = "KMR, ch. 4, mechanical translation"
ROTATION = "KMR, ch. 4, fixed-axis rotation"
DEPENDENT = "KMR, ch. 5, systems with derivative causality"
RHEOLOGY = "springs and dampers in series and parallel, after Gawthrop & Smith"
VIBRATION = "Den Hartog, Mechanical Vibrations"


@case(
    source=TRANSLATION,
    states=("p_m", "q_c"),
    rates={"p_m": "force - q_c/c - b*p_m/m", "q_c": "p_m/m"},
    transfers={("x", "force"): "c/(m*c*s**2 + b*c*s + 1)"},
)
def spring_mass_damper(g: BondGraph) -> None:
    g.one("mass", Se("force"), I("m"), C("c"), R("b"))
    g.measure("x", displacement="mass")


@case(
    source=DEPENDENT,
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
    source=DEPENDENT + "; reflected inertia",
    states=("p_j1",),
    derivative=("j2",),
    rates={"p_j1": "j1*(torque - b*p_j1/(j1*n**2))/(j1 + j2/n**2)"},
    transfers={("w", "torque"): "n/((j1*n**2 + j2)*s + b)"},
)
def inertias_across_a_transformer(g: BondGraph) -> None:
    g.one("fast", Se("torque"), I("j1"))
    g.one("slow", I("j2"), R("b"))
    g.join("fast", TF("n"), "slow")
    g.measure("w", flow="slow")


@case(
    source="thesis on FlegX, lower leg in flight, equation of its bond graph",
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
    source=DEPENDENT + " forced by a source",
    states=(),
    derivative=("m",),
    transfers={("force", "v"): "m*s + b"},
)
def moved_mass(g: BondGraph) -> None:
    g.one("mass", Sf("v"), I("m"), R("b"))
    g.measure("force", effort="v")


@case(
    source=TRANSLATION + " with square-law drag",
    states=("p_m",),
    rates={"p_m": "force - b*(p_m/m)*Abs(p_m/m)"},
)
def quadratic_drag(g: BondGraph) -> None:
    b = sympy.Symbol("b")
    g.one("mass", Se("force"), I("m"), R("drag", law=b * f * sympy.Abs(f)))
    g.measure("v", flow="mass")


@case(
    source=TRANSLATION + " with weight and Coulomb's friction",
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
    source="Duffing 1918; " + TRANSLATION,
    states=("p_m", "q_spring"),
    rates={"p_m": "force - k*q_spring - k3*q_spring**3", "q_spring": "p_m/m"},
)
def hardening_spring(g: BondGraph) -> None:
    k, k3 = sympy.symbols("k k3")
    g.one("mass", Se("force"), I("m"), C("spring", law=k * q + k3 * q**3))
    g.measure("x", displacement="mass")


@case(
    source=TRANSLATION + "; the integral of a damper's force",
    states=("p_m", "p_b"),
    transfers={("impulse", "force"): "b/(s*(m*s + b))"},
)
def impulse_of_a_damper(g: BondGraph) -> None:
    g.one("mass", Se("force"), I("m"), R("b"))
    g.measure("impulse", momentum("b"))


@case(
    source=ROTATION + "; two inertias and a shaft that twists",
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
    source=TRANSLATION + "; a source that reads a position is a spring",
    states=("p_m", "q_mass"),
    rates={"p_m": "-k*q_mass + a*sin(w*t)", "q_mass": "p_m/m"},
)
def modulated_sources(g: BondGraph) -> None:
    k, a, w = sympy.symbols("k a w")
    pull = Se("pull", value=-k * displacement("mass"))
    g.one("mass", pull, Se("shaker", value=a * sympy.sin(w * t)), I("m"))
    g.measure("x", displacement="mass")


@case(
    source="Coulomb's friction under the load that a spring carries",
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
    source="special relativity: v = p/sqrt(m² + (p/c)²); after KMR, ch. 3, inertances",
    states=("p_inertia",),
    rates={"p_inertia": "force - b*p_inertia/sqrt(m**2 + (p_inertia/c)**2)"},
)
def relativistic_mass(g: BondGraph) -> None:
    m, c = sympy.symbols("m c")
    g.one("mass", Se("force"), I("inertia", law=p / sympy.sqrt(m**2 + (p / c) ** 2)))
    g.put(R("b"), on="mass")
    g.measure("v", flow="mass")


@case(
    source=RHEOLOGY + ": Maxwell's element, v = c F' + F/b",
    states=("q_c",),
    rates={"q_c": "v - q_c/(c*b)"},
    transfers={("force", "v"): "b/(b*c*s + 1)"},
)
def maxwell_element(g: BondGraph) -> None:
    g.zero("pull", Sf("v"), C("c"), R("b"))
    g.measure("force", effort="pull")


@case(
    source=RHEOLOGY + ": Kelvin and Voigt's element, F = b x' + x/c",
    states=("q_c",),
    rates={"q_c": "(force - q_c/c)/b"},
    transfers={("x", "force"): "c/(b*c*s + 1)"},
)
def kelvin_voigt_element(g: BondGraph) -> None:
    g.one("pull", Se("force"), C("c"), R("b"))
    g.measure("x", displacement="pull")


@case(
    source=RHEOLOGY + ": Zener's solid, a spring beside a Maxwell element",
    states=("q_c1", "q_c2"),
    rates={"q_c1": "v", "q_c2": "v - q_c2/(c2*b)"},
    transfers={("force", "v"): "1/(c1*s) + b/(b*c2*s + 1)"},
)
def zener_solid(g: BondGraph) -> None:
    g.one("pull", Sf("v"), C("c1"))
    g.zero("branch", C("c2"), R("b"))
    g.join("pull", "branch")
    g.measure("force", effort="v")


@case(
    source="KMR, ch. 5, quarter-car model; velocity of the body over that of the road",
    states=("q_tyre", "p_mu", "q_strut", "p_ms"),
    rates={
        "q_tyre": "road - p_mu/mu",
        "p_mu": "kt*q_tyre - k*q_strut - b*(p_mu/mu - p_ms/ms)",
        "q_strut": "p_mu/mu - p_ms/ms",
        "p_ms": "k*q_strut + b*(p_mu/mu - p_ms/ms)",
    },
    transfers={
        ("v", "road"): "(b*s + k)*kt"
        "/((ms*s**2 + b*s + k)*(mu*s**2 + b*s + k + kt) - (b*s + k)**2)"
    },
)
def quarter_car(g: BondGraph) -> None:
    k, kt = sympy.symbols("k kt")
    g.zero("contact", Sf("road"), C("tyre", law=kt * q))
    g.one("axle", I("mu"))
    g.zero("travel")
    g.one("suspension", C("strut", law=k * q), R("b"))
    g.one("body", I("ms"))
    for tail, head in (
        ("contact", "axle"),
        ("axle", "travel"),
        ("travel", "suspension"),
        ("travel", "body"),
    ):
        g.join(tail, head)
    g.measure("v", flow="body")


@case(
    source="KMR, ch. 5, half-car in bounce and pitch; nose up is positive",
    states=("p_m", "p_j", "q_front", "q_rear"),
    rates={
        "p_m": "kf*q_front + kr*q_rear - m*g",
        "p_j": "a*kf*q_front - b*kr*q_rear",
        "q_front": "road_f - p_m/m - a*p_j/j",
        "q_rear": "road_r - p_m/m + b*p_j/j",
    },
)
def half_car(g: BondGraph) -> None:
    kf, kr, a, b, m, gravity = sympy.symbols("kf kr a b m g")
    g.one("bounce", I("m"), Se("weight", value=-m * gravity))
    g.one("pitch", I("j"))
    for end, arm, stiffness in (("front", a, kf), ("rear", -b, kr)):
        g.zero(f"{end}_wheel", Sf(f"road_{end[0]}"), C(end, law=stiffness * q))
        g.one(f"{end}_corner")
        g.zero(f"{end}_corner_force")
        g.join(f"{end}_wheel", f"{end}_corner")
        g.join(f"{end}_corner", f"{end}_corner_force")
        g.join(f"{end}_corner_force", "bounce")
        g.join(f"{end}_corner_force", TF(f"{end}_arm", law=arm), "pitch")


@case(
    source=VIBRATION + ", dynamic vibration absorber",
    states=("p_m1", "q_c1", "p_m2", "q_c2"),
    transfers={
        ("x", "force"): "(m2*s**2 + 1/c2)/((m1*s**2 + 1/c1 + 1/c2)*(m2*s**2 + 1/c2)"
        " - 1/c2**2)"
    },
)
def vibration_absorber(g: BondGraph) -> None:
    g.one("machine", Se("force"), I("m1"), C("c1"))
    g.zero("mount", C("c2"))
    g.one("absorber", I("m2"))
    g.join("machine", "mount")
    g.join("mount", "absorber")
    g.measure("x", displacement="machine")


@case(
    source=VIBRATION + ", seismic mass: z is the case's position less the mass's",
    states=("p_m", "q_c"),
    rates={"p_m": "q_c/c + b*(v - p_m/m)", "q_c": "v - p_m/m"},
    transfers={("z", "v"): "m*c*s/(m*c*s**2 + b*c*s + 1)"},
)
def accelerometer(g: BondGraph) -> None:
    g.zero("case", Sf("v"))
    g.one("relative", C("c"), R("b"))
    g.one("mass", I("m"))
    g.join("case", "relative")
    g.join("case", "mass")
    g.measure("z", displacement="relative")


@case(
    source=ROTATION + "; a rack is driven by a pinion of radius r",
    states=("p_j",),
    derivative=("m",),
    transfers={("v", "torque"): "r/((j + m*r**2)*s + b*r**2)"},
)
def rack_and_pinion(g: BondGraph) -> None:
    # The rack's speed is r times the pinion's, so the modulus from the pinion is 1/r.
    g.one("pinion", Se("torque"), I("j"), domain="rotation")
    g.one("rack", I("m"), R("b"), domain="translation")
    g.join("pinion", TF("mesh", law=1 / sympy.Symbol("r")), "rack")
    g.parameter("r", unit="m")
    g.parameter("j", unit="kg*m^2")
    g.parameter("m", unit="kg")
    g.parameter("b", unit="N*s/m")
    g.measure("v", flow="rack")


@case(
    source="block and tackle with n falls lifts m against its weight",
    states=("p_j",),
    derivative=("m",),
    rates={"p_j": "j*(torque - r*m*g/n)/(j + m*(r/n)**2)"},
)
def block_and_tackle(g: BondGraph) -> None:
    m, gravity, r, n = sympy.symbols("m g r n")
    g.one("drum", Se("torque"), I("j"))
    g.one("rope")
    g.one("hook", I("m"), Se("weight", value=-m * gravity))
    g.join("drum", TF("winding", law=1 / r), "rope")
    g.join("rope", TF("falls", law=n), "hook")
    g.measure("v", flow="hook")


@case(
    source="belt drive whose belt stretches: z' = r1 w1 - r2 w2, after KMR, ch. 4",
    states=("p_j1", "q_c", "p_j2"),
    rates={
        "p_j1": "torque - r1*q_c/c",
        "q_c": "r1*p_j1/j1 - r2*p_j2/j2",
        "p_j2": "r2*q_c/c - b*p_j2/j2",
    },
    transfers={
        ("w", "torque"): "r1*r2/(c*j1*s**2*(j2*s + b) + r1**2*(j2*s + b) + r2**2*j1*s)"
    },
)
def belt_drive(g: BondGraph) -> None:
    r1, r2 = sympy.symbols("r1 r2")
    g.one("driver", Se("torque"), I("j1"))
    g.zero("belt", C("c"))
    g.one("driven", I("j2"), R("b"))
    g.join("driver", TF("pulley1", law=1 / r1), "belt")
    g.join("belt", TF("pulley2", law=r2), "driven")
    g.measure("w", flow="driven")


@case(
    source="differential gear: the carrier runs at the mean of both wheels, each gets"
    " half the torque",
    states=("p_jc", "p_left"),
    derivative=("right",),
    transfers={
        ("left_speed", "torque"): "1/((2*j + jc)*s + 2*b)",
        ("right_speed", "torque"): "1/((2*j + jc)*s + 2*b)",
    },
)
def differential_gear(g: BondGraph) -> None:
    j, b = sympy.symbols("j b")
    g.one("carrier", Se("torque"), I("jc"))
    g.zero("bevel")
    g.join("carrier", TF("half", law=sympy.Rational(1, 2)), "bevel")
    for side in ("left", "right"):
        g.one(f"{side}_shaft", I(side, law=p / j), R(f"drag_{side}", law=b * f))
        g.join("bevel", f"{side}_shaft")
    g.measure("left_speed", flow="left_shaft")
    g.measure("right_speed", flow="right_shaft")


@case(
    source="planetary gear, after Willis: ws + rho wr = (1 + rho) wc",
    states=("p_js", "p_jr"),
    derivative=("jc",),
    relations=(
        # Torques on sun, ring and carrier stand as 1 : rho : -(1 + rho).
        "(torque - dp_js)*rho - (-b*p_jr/jr - dp_jr)",
        "(torque - dp_js)*(1 + rho) + (-dwc*jc)",
        "wc*(1 + rho) - p_js/js - rho*p_jr/jr",
        "dwc*(1 + rho) - dp_js/js - rho*dp_jr/jr",
    ),
)
def planetary_gear(g: BondGraph) -> None:
    rho = sympy.Symbol("rho")
    g.one("sun", Se("torque"), I("js"))
    g.one("ring", I("jr"), R("b"))
    g.one("carrier", I("jc"))
    g.zero("mesh")
    g.join("sun", "mesh")
    g.join("ring", TF("ring_teeth", law=1 / rho), "mesh")
    g.join("mesh", TF("carrier_arm", law=1 + rho), "carrier")
    g.measure("wc", flow="carrier")
    g.measure("dwc", effort("jc") / sympy.Symbol("jc"))


@case(
    source="torsional chain of three discs, after KMR, ch. 6; first integral and all",
    states=("p_j1", "q_c1", "p_j2", "q_c2", "p_j3"),
    rates={
        "p_j1": "torque - q_c1/c1",
        "q_c1": "p_j1/j1 - p_j2/j2",
        "p_j2": "q_c1/c1 - q_c2/c2",
        "q_c2": "p_j2/j2 - p_j3/j3",
        "p_j3": "q_c2/c2",
    },
)
def three_discs(g: BondGraph) -> None:
    g.one("disc1", Se("torque"), I("j1"))
    g.zero("shaft1", C("c1"))
    g.one("disc2", I("j2"))
    g.zero("shaft2", C("c2"))
    g.one("disc3", I("j3"))
    path = ("disc1", "shaft1", "disc2", "shaft2", "disc3")
    for tail, head in itertools.pairwise(path):
        g.join(tail, head)


@case(
    source="ball on a floor that only pushes, damped as Hunt & Crossley 1975",
    states=("p_m", "q_floor"),
    rates={
        "p_m": "-m*g + k*Max(-q_floor, 0) - d*Max(-q_floor, 0)*p_m/m",
        "q_floor": "p_m/m",
    },
)
def bouncing_ball(g: BondGraph) -> None:
    m, gravity, k, d = sympy.symbols("m g k d")
    loss = R("loss", law=d * sympy.Max(-displacement("floor"), 0) * f)
    weight = Se("weight", value=-m * gravity)
    g.one("ball", I("m"), weight, C("floor", law=-k * sympy.Max(-q, 0)), loss)


@case(
    source="a clutch that slips: torque tau tanh(slip/w0) passes",
    states=("p_j1", "p_j2"),
    rates={
        "p_j1": "torque - tau*tanh((p_j1/j1 - p_j2/j2)/w0)",
        "p_j2": "tau*tanh((p_j1/j1 - p_j2/j2)/w0) - b*p_j2/j2",
    },
)
def slipping_clutch(g: BondGraph) -> None:
    tau, w0 = sympy.symbols("tau w0")
    g.one("engine", Se("torque"), I("j1"))
    g.zero("plates")
    g.one("slip", R("clutch", law=tau * sympy.tanh(f / w0)))
    g.one("wheels", I("j2"), R("b"))
    g.join("engine", "plates")
    g.join("plates", "slip")
    g.join("plates", "wheels")


@case(
    source="a fluid coupling, whose torque goes with the square of the slip",
    states=("p_j",),
    rates={"p_j": "k*(w - p_j/j)*Abs(w - p_j/j)"},
)
def fluid_coupling(g: BondGraph) -> None:
    k = sympy.Symbol("k")
    g.zero("pump", Sf("w"))
    g.one("slip", R("coupling", law=k * f * sympy.Abs(f)))
    g.one("turbine", I("j"))
    g.join("pump", "slip")
    g.join("pump", "turbine")
