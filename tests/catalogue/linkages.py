"""Mechanisms whose geometry moves: transformers modulated by positions.

The answers are Lagrange's equations; those of the pendulums without closed form are
made with sympy.physics.mechanics in test_mechanics.py.
"""

import sympy
from sympy import cos, sin

from bondgraph import (
    TF,
    BondGraph,
    C,
    I,
    R,
    Se,
    displacement,
    effort,
    f,
    flow,
    momentum,
    p,
    q,
)
from catalogue.cases import case

GEOMETRY = "KMR, ch. 9, mechanical systems with nonlinear geometry"


@case(
    source=GEOMETRY + "; T = (j + m l² sin²θ) θ'²/2 and p = j θ'",
    states=("p_j", "q_crank"),
    derivative=("m",),
    rates={
        "p_j": "j*(torque - m*l**2*sin(q_crank)*cos(q_crank)*(p_j/j)**2)"
        "/(j + m*l**2*sin(q_crank)**2)",
        "q_crank": "p_j/j",
    },
)
def crank_and_slider(g: BondGraph) -> None:
    length = sympy.Symbol("l")
    g.one("crank", Se("torque"), I("j"))
    g.one("slider", I("m"))
    g.join("slider", TF("arm", law=length * sin(displacement("crank"))), "crank")
    g.measure("theta", displacement="crank")
    g.measure("push", effort="m")


ROD = "q_crank"
SLIDE = f"r*sin({ROD})*(1 + r*cos({ROD})/sqrt((r + l)**2 - r**2*sin({ROD})**2))"
CURVE = (
    f"r*cos({ROD}) + r**2*(cos({ROD})**2 - sin({ROD})**2)"
    f"/sqrt((r + l)**2 - r**2*sin({ROD})**2)"
    f" + r**4*sin({ROD})**2*cos({ROD})**2/sqrt((r + l)**2 - r**2*sin({ROD})**2)**3"
)


@case(
    source=GEOMETRY + "; slider-crank with connecting rod r + l, h = -dx/dθ:"
    " (j + m h²) θ'' + m h h' θ'² = torque - h gas",
    states=("p_j", "q_crank"),
    derivative=("m",),
    rates={
        "p_j": f"j*(torque - ({SLIDE})*gas - m*({SLIDE})*({CURVE})*(p_j/j)**2)"
        f"/(j + m*({SLIDE})**2)",
        "q_crank": "p_j/j",
    },
)
def slider_crank_with_rod(g: BondGraph) -> None:
    r, length = sympy.symbols("r l")
    angle = displacement("crank")
    rod = sympy.sqrt((r + length) ** 2 - r**2 * sin(angle) ** 2)
    g.one("crank", Se("torque"), I("j"))
    g.one("piston", I("m"), Se("gas_force", value=-sympy.Symbol("gas")))
    arm = r * sin(angle) * (1 + r * cos(angle) / rod)
    g.join("piston", TF("linkage", law=arm), "crank")


@case(
    source=GEOMETRY + "; cam lift y = ecc (1 - cos θ) against a spring",
    states=("p_j", "q_cam", "q_spring"),
    derivative=("m",),
    rates={
        "p_j": "j*(torque - ecc*sin(q_cam)*(k*q_spring"
        " + m*ecc*cos(q_cam)*(p_j/j)**2))/(j + m*ecc**2*sin(q_cam)**2)",
        "q_cam": "p_j/j",
        "q_spring": "ecc*sin(q_cam)*p_j/j",
    },
)
def cam_and_follower(g: BondGraph) -> None:
    ecc, k = sympy.symbols("ecc k")
    g.one("cam", Se("torque"), I("j"))
    g.one("follower", I("m"), C("spring", law=k * q))
    g.join("follower", TF("lift", law=ecc * sin(displacement("cam"))), "cam")


@case(
    source=GEOMETRY
    + "; a wheel with an off-centre weight, by its height l (1 - cos θ)",
    states=("p_j", "q_wheel"),
    rates={"p_j": "torque - m*g*l*sin(q_wheel) - b*p_j/j", "q_wheel": "p_j/j"},
)
def unbalanced_wheel(g: BondGraph) -> None:
    m, gravity, length = sympy.symbols("m g l")
    g.one("wheel", Se("torque"), I("j"), R("b"))
    g.one("height", Se("weight", value=-m * gravity))
    g.join("height", TF("arm", law=length * sin(displacement("wheel"))), "wheel")


@case(
    source=GEOMETRY + "; plane pendulum of one mass: m l² θ'' = -m g l sin θ - b θ',"
    " written in the momentum p = m l cos θ θ' along x",
    states=("p_mx", "q_joint"),
    derivative=("my",),
    relations=(
        "dq_joint - w",
        "p_mx - m*l*cos(q_joint)*w",
        "dw*m*l**2 + m*g*l*sin(q_joint) + b*w",
        "dp_mx - m*l*(cos(q_joint)*dw - sin(q_joint)*w**2)",
    ),
)
def pendulum(g: BondGraph) -> None:
    m, gravity, length = sympy.symbols("m g l")
    angle = displacement("joint")
    g.one("joint", R("b"))
    g.one("along_x", I("mx", law=p / m))
    g.one("along_y", I("my", law=p / m), Se("weight", value=-m * gravity))
    # x' = l cos θ θ', y' = l sin θ θ' (y up, θ from the lowest point).
    g.join("along_x", TF("by_x", law=length * cos(angle)), "joint")
    g.join("along_y", TF("by_y", law=length * sin(angle)), "joint")
    g.measure("w", flow("joint"))
    force_x = effort("mx") / m
    force_y = effort("my") / m
    g.measure("dw", (cos(angle) * force_x + sin(angle) * force_y) / length)


@case(
    source=GEOMETRY
    + "; pendulum with inertia j: (j + m l²) θ'' = torque - m g l sin θ",
    states=("p_j", "q_joint"),
    derivative=("mx", "my"),
    rates={
        "p_j": "j*(torque - m*g*l*sin(q_joint))/(j + m*l**2)",
        "q_joint": "p_j/j",
    },
)
def physical_pendulum(g: BondGraph) -> None:
    m, gravity, length = sympy.symbols("m g l")
    angle = displacement("joint")
    g.one("joint", Se("torque"), I("j"))
    g.one("along_x", I("mx", law=p / m))
    g.one("along_y", I("my", law=p / m), Se("weight", value=-m * gravity))
    g.join("along_x", TF("by_x", law=length * cos(angle)), "joint")
    g.join("along_y", TF("by_y", law=length * sin(angle)), "joint")
    g.measure("theta", displacement="joint")


@case(
    source=GEOMETRY + "; cart and pole, θ from the top: (M + m) x'' + m l (cos θ θ''"
    " - sin θ θ'²) = force, (j + m l²) θ'' + m l cos θ x'' = m g l sin θ",
    states=("p_M", "p_j", "q_hinge"),
    derivative=("mx", "my"),
    relations=(
        "(M + m)*dp_M/M + m*l*(cos(q_hinge)*dp_j/j - sin(q_hinge)*(p_j/j)**2)"
        " + b*p_M/M - force",
        "(j + m*l**2)*dp_j/j + m*l*cos(q_hinge)*dp_M/M - m*g*l*sin(q_hinge)",
        "dq_hinge - p_j/j",
    ),
)
def cart_and_pole(g: BondGraph) -> None:
    m, gravity, length = sympy.symbols("m g l")
    angle = displacement("hinge")
    g.one("cart", Se("force"), I("M"), R("b"))
    g.one("hinge", I("j"))
    g.one("along_x", I("mx", law=p / m))
    g.one("along_y", I("my", law=p / m), Se("weight", value=-m * gravity))
    g.zero("pin")
    g.join("cart", "pin")
    g.join("hinge", TF("by_x", law=1 / (length * cos(angle))), "pin")
    g.join("pin", "along_x")
    g.join("along_y", TF("by_y", law=-length * sin(angle)), "hinge")
    g.measure("theta", displacement="hinge")


@case(
    source=GEOMETRY + "; spring pendulum in polar coordinates, the turning by forces",
    states=("p_m", "q_k", "p_turn", "q_turning"),
    rates={
        "p_m": "p_turn**2/(m*(l0 + q_k)**3) + m*g*cos(q_turning) - k*q_k",
        "q_k": "p_m/m",
        "p_turn": "-m*g*(l0 + q_k)*sin(q_turning)",
        "q_turning": "p_turn/(m*(l0 + q_k)**2)",
    },
)
def spring_pendulum(g: BondGraph) -> None:
    # Angular momentum and radius share one energy, p²/(2 m r²): an I whose law reads
    # the radius, and the force that this gives along the radius.
    m, gravity, k, l0 = sympy.symbols("m g k l0")
    radius = l0 + displacement("k")
    angle = displacement("turning")
    fling = momentum("turn") ** 2 / (m * radius**3)
    g.one(
        "radial",
        I("m"),
        C("k", law=k * q),
        Se("centrifugal", value=fling),
        Se("weight_along", value=m * gravity * cos(angle)),
    )
    across = Se("weight_across", value=-m * gravity * radius * sin(angle))
    g.one("turning", I("turn", law=p / (m * radius**2)), across)


@case(
    source=GEOMETRY + "; Scotch yoke: x = r sin θ, so (j + m r² cos²θ) θ'' ="
    " torque + m r² sin θ cos θ θ'² - b r² cos²θ θ'",
    states=("p_j", "q_disc"),
    derivative=("m",),
    rates={
        "p_j": "j*(torque + m*r**2*sin(q_disc)*cos(q_disc)*(p_j/j)**2"
        " - b*r**2*cos(q_disc)**2*p_j/j)/(j + m*r**2*cos(q_disc)**2)",
        "q_disc": "p_j/j",
    },
)
def scotch_yoke(g: BondGraph) -> None:
    r = sympy.Symbol("r")
    g.one("disc", Se("torque"), I("j"))
    g.one("yoke", I("m"), R("b"))
    g.join("yoke", TF("slot", law=r * cos(displacement("disc"))), "disc")


@case(
    source="universal joint (Cardan): w2 = w1 cos β/(1 - sin²β cos²θ)",
    states=("p_j", "q_input"),
    derivative=("load",),
    relations=(
        "w - cos(beta)/(1 - sin(beta)**2*cos(q_input)**2)*p_j/j",
        "dq_input - p_j/j",
        # Power: what the input gives is what both inertias take.
        "torque*p_j/j - p_j*dp_j/j - load*w*dw - b*w**2",
        "dw - cos(beta)/(1 - sin(beta)**2*cos(q_input)**2)*dp_j/j"
        " + cos(beta)*2*sin(beta)**2*cos(q_input)*sin(q_input)"
        "/(1 - sin(beta)**2*cos(q_input)**2)**2*(p_j/j)**2",
    ),
)
def universal_joint(g: BondGraph) -> None:
    beta = sympy.Symbol("beta")
    ratio = cos(beta) / (1 - sin(beta) ** 2 * cos(displacement("input")) ** 2)
    g.one("input", Se("torque"), I("j"))
    g.one("output", I("load"), R("b"))
    g.join("output", TF("cross", law=ratio), "input")
    g.measure("w", flow("output"))
    g.measure("dw", effort("load") / sympy.Symbol("load"))


@case(
    source="centrifugal clutch law of a spinning arm: friction that grows with w²",
    states=("p_j",),
    rates={"p_j": "torque - mu*m*r**2*(p_j/j)**2*sign(p_j/j)"},
)
def centrifugal_brake(g: BondGraph) -> None:
    mu, m, r = sympy.symbols("mu m r")
    law = mu * m * r**2 * f**2 * sympy.sign(f)
    g.one("rotor", Se("torque"), I("j"), R("shoes", law=law))
