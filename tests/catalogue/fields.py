"""Multiport fields: coupled coils, mass matrices, movable plates, reactions."""

import sympy

from bondgraph import GY, TF, BondGraph, C, I, R, Se, Sf, p, q
from bondgraph.structure.fields import CField, ICField, IField, RField
from bondgraph.structure.signals import port, ports
from catalogue.cases import Case, adder

FIELDS: list[Case] = []

FIELD = "KMR, ch. 7, multiport fields"
TRANSDUCER = "KMR, ch. 8, energy-storing transducers"


@adder(
    FIELDS,
    source=FIELD + ", a mass matrix: M (v1', v2') = forces - dampers",
    states=("p_M_1", "p_M_2"),
    rates={
        "p_M_1": "f1 - b1*(m22*p_M_1 - m12*p_M_2)/(m11*m22 - m12**2)",
        "p_M_2": "f2 - b2*(m11*p_M_2 - m12*p_M_1)/(m11*m22 - m12**2)",
    },
    transfers={
        ("v", "f1"): "(m22*s + b2)/((m11*s + b1)*(m22*s + b2) - (m12*s)**2)",
    },
)
def mass_matrix(g: BondGraph) -> None:
    m11, m12, m22 = sympy.symbols("m11 m12 m22")
    g.one("first", Se("f1"), R("b1"))
    g.one("second", Se("f2"), R("b2"))
    g.put(IField.from_matrix("M", [[m11, m12], [m12, m22]]), on=("first", "second"))
    g.measure("v", flow="first")


@adder(
    FIELDS,
    source=FIELD + ", a mass matrix one side of which is moved by a source",
    states=("p_M_1",),
    derivative=("M[2]",),
    transfers={("force", "v"): "(m22 - m12**2/m11)*s", ("speed", "v"): "-m12/m11"},
)
def moved_mass_matrix(g: BondGraph) -> None:
    m11, m12, m22 = sympy.symbols("m11 m12 m22")
    g.one("free", Se("f1"))
    g.one("moved", Sf("v"))
    g.put(IField.from_matrix("M", [[m11, m12], [m12, m22]]), on=("free", "moved"))
    g.measure("force", effort="v")
    g.measure("speed", flow="free")


@adder(
    FIELDS,
    source=FIELD + ", mutual inductance",
    states=("p_coils_1", "p_coils_2"),
    transfers={
        ("i1", "u"): "(l2*s + r2)/((l1*s + r1)*(l2*s + r2) - (m*s)**2)",
        ("i2", "u"): "-m*s/((l1*s + r1)*(l2*s + r2) - (m*s)**2)",
    },
)
def coupled_coils(g: BondGraph) -> None:
    l1, l2, m = sympy.symbols("l1 l2 m")
    g.one("primary", Se("u"), R("r1"))
    g.one("secondary", R("r2"))
    coils = IField.from_matrix("coils", [[l1, m], [m, l2]])
    g.put(coils, on=("primary", "secondary"))
    g.measure("i1", flow="primary")
    g.measure("i2", flow="secondary")


@adder(
    FIELDS,
    source=FIELD + ", a beam by its stiffnesses at two masses",
    states=("q_beam_1", "q_beam_2", "p_m1", "p_m2"),
    rates={
        "q_beam_1": "p_m1/m1",
        "q_beam_2": "p_m2/m2",
        "p_m1": "force - k11*q_beam_1 - k12*q_beam_2",
        "p_m2": "-k12*q_beam_1 - k22*q_beam_2 - b*p_m2/m2",
    },
)
def beam_by_stiffness(g: BondGraph) -> None:
    k11, k12, k22 = sympy.symbols("k11 k12 k22")
    g.one("middle", Se("force"), I("m1"))
    g.one("tip", I("m2"), R("b"))
    beam = CField.from_stiffness("beam", [[k11, k12], [k12, k22]])
    g.put(beam, on=("middle", "tip"))


@adder(
    FIELDS,
    source=FIELD + ", a beam by its influence coefficients, x = A F",
    states=("q_beam_1", "q_beam_2", "p_m1", "p_m2"),
    rates={
        "q_beam_1": "p_m1/m1",
        "q_beam_2": "p_m2/m2",
        "p_m1": "force - (a22*q_beam_1 - a12*q_beam_2)/(a11*a22 - a12**2)",
        "p_m2": "-(a11*q_beam_2 - a12*q_beam_1)/(a11*a22 - a12**2)",
    },
)
def beam_by_flexibility(g: BondGraph) -> None:
    a11, a12, a22 = sympy.symbols("a11 a12 a22")
    g.one("middle", Se("force"), I("m1"))
    g.one("tip", I("m2"))
    beam = CField.from_matrix("beam", [[a11, a12], [a12, a22]])
    g.put(beam, on=("middle", "tip"))


@adder(
    FIELDS,
    source=TRANSDUCER + ", condenser microphone: H = q² (d - x)/(2 eps) + k x²/2",
    states=("q_plates_1", "q_plates_2", "p_m"),
    rates={
        "q_plates_1": "(u - q_plates_1*(d - q_plates_2)/eps)/r",
        "q_plates_2": "p_m/m",
        "p_m": "sound + q_plates_1**2/(2*eps) - k*q_plates_2 - b*p_m/m",
    },
)
def condenser_microphone(g: BondGraph) -> None:
    charge, x = ports("q", 2)
    d, eps, k = sympy.symbols("d eps k")
    g.one("circuit", Se("u"), R("r"))
    g.one("membrane", Se("sound"), I("m"), R("b"))
    energy = charge**2 * (d - x) / (2 * eps) + k * x**2 / 2
    g.put(CField.from_energy("plates", energy), on=("circuit", "membrane"))


@adder(
    FIELDS,
    source=TRANSDUCER + ", solenoid: H = flux² (1 + x/d)/(2 l0), pull flux²/(2 l0 d)",
    states=("p_coil_1", "q_coil_2", "p_m", "q_k"),
    rates={
        "p_coil_1": "u - r*p_coil_1*(1 + q_coil_2/d)/l0",
        "q_coil_2": "p_m/m",
        "p_m": "-p_coil_1**2/(2*l0*d) - q_k/k - b*p_m/m",
        "q_k": "p_m/m",
    },
)
def relay(g: BondGraph) -> None:
    l0, d = sympy.symbols("l0 d")
    energy = port("p", 1) ** 2 * (1 + port("q", 2) / d) / (2 * l0)
    g.one("circuit", Se("u"), R("r"))
    g.one("armature", I("m"), C("k"), R("b"))
    g.put(ICField.from_energy("coil", energy), on=("circuit", "armature"))


@adder(
    FIELDS,
    source="central motion in polar coordinates: r'' = L²/(m² r³) - ..., L' = torque",
    states=("p_orbit_1", "q_orbit_2", "p_m"),
    rates={
        "p_orbit_1": "torque",
        "q_orbit_2": "p_m/m",
        "p_m": "p_orbit_1**2/(m*(l0 + q_orbit_2)**3) - k*q_orbit_2",
    },
)
def central_motion(g: BondGraph) -> None:
    m, l0, k = sympy.symbols("m l0 k")
    spin, stretch = port("p", 1), port("q", 2)
    energy = spin**2 / (2 * m * (l0 + stretch) ** 2) + k * stretch**2 / 2
    g.one("turning", Se("torque"))
    g.one("radial", I("m"))
    g.put(ICField.from_energy("orbit", energy), on=("turning", "radial"))


@adder(
    FIELDS,
    source=FIELD + ", resistances in a tee between two coils",
    states=("p_l1", "p_l2"),
    rates={
        "p_l1": "u - (r1 + r3)*p_l1/l1 - r3*p_l2/l2",
        "p_l2": "-r3*p_l1/l1 - (r2 + r3)*p_l2/l2",
    },
)
def resistive_tee(g: BondGraph) -> None:
    r1, r2, r3 = sympy.symbols("r1 r2 r3")
    g.one("left", Se("u"), I("l1"))
    g.one("right", I("l2"))
    tee = RField.from_matrix("tee", [[r1 + r3, r3], [r3, r2 + r3]])
    g.put(tee, on=("left", "right"))


@adder(
    FIELDS,
    source=FIELD + ", the tee again, between capacitors: its matrix is inverted",
    states=("q_c1", "q_c2"),
    rates={
        "q_c1": "i - ((r2 + r3)*q_c1/c1 - r3*q_c2/c2)/(r1*r2 + r1*r3 + r2*r3)",
        "q_c2": "-((r1 + r3)*q_c2/c2 - r3*q_c1/c1)/(r1*r2 + r1*r3 + r2*r3)",
    },
)
def resistive_tee_between_capacitors(g: BondGraph) -> None:
    r1, r2, r3 = sympy.symbols("r1 r2 r3")
    g.zero("left", Sf("i"), C("c1"))
    g.zero("right", C("c2"))
    tee = RField.from_matrix("tee", [[r1 + r3, r3], [r3, r2 + r3]])
    g.put(tee, on=("left", "right"))


@adder(
    FIELDS,
    source="Gawthrop & Crampin 2017, energetics of reactions: a <-> b by mass action",
    states=("q_a", "q_b"),
    rates={
        "q_a": "-kappa*(ka*q_a - kb*q_b)",
        "q_b": "kappa*(ka*q_a - kb*q_b)",
    },
)
def reaction_as_a_two_port(g: BondGraph) -> None:
    rt, kappa, ka, kb = sympy.symbols("rt kappa ka kb")
    g.zero("pool_a", C("a", law=rt * sympy.log(ka * q)))
    g.zero("pool_b", C("b", law=rt * sympy.log(kb * q)))
    forward, backward = ports("e", 2)
    rate = kappa * (sympy.exp(forward / rt) - sympy.exp(backward / rt))
    g.put(RField("re", (rate, -rate)), on=("pool_a", "pool_b"))


@adder(
    FIELDS,
    source=FIELD + ", a saturating pair of coils, currents odd in the sum of fluxes",
    states=("p_core_1", "p_core_2"),
    rates={
        "p_core_1": "u - r1*(p_core_1/l + a*(p_core_1 + p_core_2)**3)",
        "p_core_2": "-r2*(p_core_2/l + a*(p_core_1 + p_core_2)**3)",
    },
)
def saturating_coils(g: BondGraph) -> None:
    inductance, a = sympy.symbols("l a")
    one, two = ports("p", 2)
    energy = (one**2 + two**2) / (2 * inductance) + a * (one + two) ** 4 / 4
    g.one("primary", Se("u"), R("r1"))
    g.one("secondary", R("r2"))
    g.put(IField.from_energy("core", energy), on=("primary", "secondary"))


@adder(
    FIELDS,
    source="two wheels on one hub by a mass matrix, geared: M in derivative causality",
    states=("p_j",),
    derivative=("M[1]", "M[2]"),
    transfers={("w", "torque"): "1/((j + m11 + 2*m12/n + m22/n**2)*s)"},
)
def geared_mass_matrix(g: BondGraph) -> None:
    m11, m12, m22 = sympy.symbols("m11 m12 m22")
    g.one("hub", Se("torque"), I("j"))
    g.one("geared")
    g.join("hub", TF("n"), "geared")
    g.put(IField.from_matrix("M", [[m11, m12], [m12, m22]]), on=("hub", "geared"))
    g.measure("w", flow="hub")


# Parts that are put together ------------------------------------------------------


@adder(
    FIELDS,
    source="KMR, ch. 10, lumped lines, as three equal parts in a chain",
    states=(
        "p_part1_l",
        "q_part1_c",
        "p_part2_l",
        "q_part2_c",
        "p_part3_l",
        "q_part3_c",
    ),
    rates={
        "p_part1_l": "supply - r*p_part1_l/l - q_part1_c/c",
        "q_part1_c": "p_part1_l/l - p_part2_l/l",
        "p_part2_l": "q_part1_c/c - r*p_part2_l/l - q_part2_c/c",
        "q_part2_c": "p_part2_l/l - p_part3_l/l",
        "p_part3_l": "q_part2_c/c - r*p_part3_l/l - q_part3_c/c",
        "q_part3_c": "p_part3_l/l",
    },
)
def line_of_equal_parts(g: BondGraph) -> None:
    part = BondGraph("part")
    part.one("flow", I("l"), R("r"))
    part.zero("node", C("c"))
    part.join("flow", "node")
    first, *_ = g.repeat(
        part, 3, "part", chain=("node", "flow"), shared=("l", "r", "c")
    )
    g.put(Se("supply"), on=first["flow"])


@adder(
    FIELDS,
    source="two motors of one kind on one shaft, after KMR, ch. 4",
    states=("p_left_la", "p_right_la", "p_j"),
    rates={
        "p_left_la": "left_u - left_ra*p_left_la/left_la - left_k*p_j/j",
        "p_right_la": "right_u - right_ra*p_right_la/right_la - right_k*p_j/j",
        "p_j": "left_k*p_left_la/left_la + right_k*p_right_la/right_la - b*p_j/j",
    },
)
def two_motors_on_a_shaft(g: BondGraph) -> None:
    motor = BondGraph("motor")
    motor.one("armature", Se("u"), R("ra"), I("la"))
    motor.one("rotor")
    motor.join("armature", GY("k"), "rotor")
    g.one("shaft", I("j"), R("b"))
    for side in ("left", "right"):
        g.join(g.include(motor, side)["rotor"], "shaft")


@adder(
    FIELDS,
    source="KMR, ch. 5: which of two masses on one shaft is the state is a choice",
    states=("p_m2",),
    derivative=("m1",),
    rates={"p_m2": "m2*(force - b*p_m2/m2)/(m1 + m2)"},
)
def preferred_state(g: BondGraph) -> None:
    g.one("shaft", Se("force"), I("m1", law=p / sympy.Symbol("m1")), I("m2"), R("b"))
    g.prefer("m1", "derivative")
