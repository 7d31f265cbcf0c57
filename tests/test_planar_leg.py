"""The planar leg against Lagrange's equations, made by sympy from energies alone.

The bond graph knows masses, levers and weights; Lagrange's method knows kinetic and
potential energy and, for the foot, holonomic constraints with multipliers. Parameters,
postures, speeds and torques are arbitrary.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
import pytest
import sympy
from catalogue.evaluation import observed
from sympy import cos, sin
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

from bondgraph import BondGraph, FinishedGraph, derive, linearise, state_space
from flegx_models import models
from flegx_models.equation_of_motion import Leg
from flegx_models.parameters import RECONCILED
from flegx_models.planar_leg import (
    flying_leg,
    hanging_leg,
    locked,
    rigid_leg,
    sliding_leg,
    standing_leg,
)

COORDINATES = ("hip", "knee", "support")
MOVING = {name: dynamicsymbols(name) for name in COORDINATES}
TIME = dynamicsymbols._t


def symbol(name: str) -> sympy.Symbol:
    return sympy.Symbol(name, real=True)


def place(along_upper: sympy.Expr, along_lower: sympy.Expr) -> tuple[sympy.Expr, ...]:
    """Return x and y of a point of the leg (eq. 4.13, 4.15: angles from below)."""
    hip, knee, height = MOVING.values()
    return (
        along_upper * sin(hip) + along_lower * sin(knee),
        height - along_upper * cos(hip) - along_lower * cos(knee),
    )


def constraints(name: str) -> list[sympy.Expr]:
    foot_x, foot_y = place(symbol("L"), symbol("L"))
    return {
        "flying_leg": [],
        "hanging_leg": [MOVING["support"]],
        "sliding_leg": [foot_y],
        "standing_leg": [foot_x, foot_y],
    }[name]


@cache
def lagrange(name: str) -> tuple[Callable[..., object], Callable[..., object]]:
    """Return functions of numbers for the full mass matrix and forcing."""
    v = {p: symbol(p) for p in RECONCILED}
    hip, knee, height = MOVING.values()
    ratio = v["K_gearbox"] * v["K_worm_gear"]
    drive = (v["I_motor"] + v["I_gearbox"]) * ratio**2
    drive += v["I_worm"] * v["K_worm_gear"] ** 2
    links = (
        (v["m_upperleg"], place(v["l_cm_upperleg"], sympy.S.Zero)),
        (v["m_lowerleg_link"], place(v["L"], v["l_cm_lowerleg"])),
        (v["m_motors_support"], (sympy.S.Zero, height)),
    )
    kinetic = sum(
        m * (x.diff(TIME) ** 2 + y.diff(TIME) ** 2) / 2 for m, (x, y) in links
    )
    centred_upper = v["I_upperleg_link"] - v["m_upperleg"] * v["l_cm_upperleg"] ** 2
    centred_lower = v["I_lowerleg"] - v["m_lowerleg_link"] * v["l_cm_lowerleg"] ** 2
    kinetic += (drive + v["I_gear"] + centred_upper) * hip.diff(TIME) ** 2 / 2
    kinetic += (drive + v["I_gear_tendons"] + centred_lower) * knee.diff(TIME) ** 2 / 2
    potential = sum(m * v["g"] * y for m, (_, y) in links)
    held = constraints(name)
    method = LagrangesMethod(kinetic - potential, [*MOVING.values()], hol_coneqs=held)
    method.form_lagranges_equations()
    at = [x.diff(TIME) for x in MOVING.values()] + list(MOVING.values())
    plain = [symbol(f"speed_{c}") for c in COORDINATES]
    plain += [symbol(f"at_{c}") for c in COORDINATES]
    put = dict(zip(at, plain, strict=True))
    arguments = (*plain, *v.values())
    return tuple(
        sympy.lambdify(arguments, m.subs(dict(list(put.items())[:3])).subs(put))
        for m in (method.mass_matrix_full, method.forcing_full)
    )


def expected(name: str, number: Mapping[str, float]) -> np.ndarray:
    """Return the accelerations of hip, knee and support, then the multipliers."""
    arguments = [number[f"speed_{c}"] for c in COORDINATES]
    arguments += [number[f"at_{c}"] for c in COORDINATES]
    arguments += [number[p] for p in RECONCILED]
    matrix, forcing = (np.array(f(*arguments), float) for f in lagrange(name))
    ratio = number["K_gearbox"] * number["K_worm_gear"]
    relative = number["speed_knee"] - number["speed_hip"]
    bearings = number["c_friction_lowerleg"] * relative
    friction = number["c_friction_upperleg"] * number["speed_hip"]
    forcing[3, 0] += ratio * number["T_hip"] - friction + bearings
    forcing[4, 0] += ratio * number["T_knee"] - bearings
    return np.linalg.solve(matrix, forcing).ravel()[3:]


LEGS = {f.__name__: f for f in (flying_leg, hanging_leg, sliding_leg, standing_leg)}


def somewhere(name: str, seed: int) -> dict[str, float]:
    """Return arbitrary parameters, posture, torques and speeds the feet allow."""
    generator = np.random.default_rng(seed)
    number = {p.name: p.value * generator.uniform(0.6, 1.6) for p in RECONCILED.members}
    # A link turns about its centre of mass as well as with it.
    number["I_upperleg_link"] += number["m_upperleg"] * number["l_cm_upperleg"] ** 2
    number["I_lowerleg"] += number["m_lowerleg_link"] * number["l_cm_lowerleg"] ** 2
    number["at_hip"], number["at_knee"] = generator.uniform(-1.2, 1.2, 2)
    number["at_support"] = 0.0
    number["T_hip"], number["T_knee"] = generator.uniform(-0.4, 0.4, 2)
    hip, knee, height = generator.uniform(-6.0, 6.0, 3)
    if name == "standing_leg":
        knee = -hip * math.cos(number["at_hip"]) / math.cos(number["at_knee"])
    if name == "hanging_leg":
        height = 0.0
    elif name != "flying_leg":
        height = -number["L"] * (
            hip * math.sin(number["at_hip"]) + knee * math.sin(number["at_knee"])
        )
    number |= {"speed_hip": hip, "speed_knee": knee, "speed_support": height}
    return number


def seen(name: str, number: dict[str, float]) -> tuple[dict[str, float], ...]:
    """Return the bond graph's rates and outputs there."""
    graph = LEGS[name]().finish()
    values = {p: number[p] for p in RECONCILED} | {
        "q_hip": number["at_hip"],
        "q_knee": number["at_knee"],
        "p_I_gear": number["I_gear"] * number["speed_hip"],
        "p_I_gear_tendons": number["I_gear_tendons"] * number["speed_knee"],
        "p_m_motors_support": number["m_motors_support"] * number["speed_support"],
        "T_hip": number["T_hip"],
        "T_knee": number["T_knee"],
    }
    found = observed(graph, values)
    return found.rates, found.outputs


REACTIONS = {
    "flying_leg": [],
    "hanging_leg": ["force_holder"],
    "sliding_leg": ["ground_y"],
    "standing_leg": ["ground_x", "ground_y"],
}


@pytest.mark.parametrize("name", LEGS)
def test_the_leg_accelerates_and_pushes_as_lagrange_says(name: str) -> None:
    number = somewhere(name, 11)
    wanted = expected(name, number)
    rates, outputs = seen(name, number)
    carriers = ("I_gear", "I_gear_tendons", "m_motors_support")
    states = [i for i, c in enumerate(carriers) if f"p_{c}" in rates]
    assert len(states) == 3 - len(constraints(name))
    for i in states:
        found = rates[f"p_{carriers[i]}"] / number[carriers[i]]
        assert found == pytest.approx(wanted[i], rel=1e-8)
    for output, multiplier in zip(REACTIONS[name], wanted[3:], strict=True):
        assert outputs[output] == pytest.approx(multiplier, rel=1e-8)


def leg_at(name: str, number: dict[str, float]) -> Leg:
    graph = LEGS[name]().finish()
    return Leg(graph.with_parameters({p: number[p] for p in graph.parameters}))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", LEGS)
def test_the_equation_of_motion_is_the_one_of_lagrange(name: str, seed: int) -> None:
    number = somewhere(name, seed)
    # A rising support does not matter to a flying leg, but its momentum is not zero.
    number["speed_support"] -= number["speed_support"] * (name == "flying_leg")
    leg = leg_at(name, number)
    motion = leg.equation_of_motion(
        {"hip": number["at_hip"], "knee": number["at_knee"]},
        {"hip": number["speed_hip"], "knee": number["speed_knee"]},
    )
    torques = np.array([leg.ratio * number[f"T_{joint}"] for joint in leg.joints])
    if name == "standing_leg":  # one joint is left, which both motors drive
        at = (number["at_hip"], number["at_knee"])
        torques -= leg.ratio * number["T_knee"] * math.cos(at[0]) / math.cos(at[1])
    wanted = expected(name, number)[: len(leg.joints)]
    assert motion.acceleration(torques) == pytest.approx(wanted, rel=1e-8)
    assert motion.mass == pytest.approx(motion.mass.T, rel=1e-8)
    assert np.all(np.linalg.eigvalsh(motion.mass) > 0)


# -- eq. 4.1 written out --------------------------------------------------------------


def inertias(v: Mapping[str, float]) -> tuple[float, float, float]:
    """Return the drive's reflected inertia, and J of hip and knee with it."""
    drive = (v["I_motor"] + v["I_gearbox"]) * (v["K_gearbox"] * v["K_worm_gear"]) ** 2
    drive += v["I_worm"] * v["K_worm_gear"] ** 2
    hip = (
        drive + v["I_gear"] + v["I_upperleg_link"] + v["m_lowerleg_link"] * v["L"] ** 2
    )
    return drive, hip, drive + v["I_gear_tendons"] + v["I_lowerleg"]


def test_m_h_and_g_of_the_hanging_leg() -> None:
    number = somewhere("hanging_leg", 5)
    quiet = number | {"c_friction_upperleg": 0.0, "c_friction_lowerleg": 0.0}
    hip, knee = number["at_hip"], number["at_knee"]
    speeds = {"hip": number["speed_hip"], "knee": number["speed_knee"]}
    motion = leg_at("hanging_leg", quiet).equation_of_motion(
        {"hip": hip, "knee": knee}, speeds
    )
    _, J_hip, J_knee = inertias(number)
    coupling = number["m_lowerleg_link"] * number["L"] * number["l_cm_lowerleg"]
    M = [[J_hip, coupling * math.cos(knee - hip)]]
    M.append([M[0][1], J_knee])
    turning = coupling * math.sin(knee - hip)
    h = [-turning * speeds["knee"] ** 2, turning * speeds["hip"] ** 2]
    upper = number["m_upperleg"] * number["l_cm_upperleg"]
    lower = number["m_lowerleg_link"] * number["l_cm_lowerleg"]
    G = [
        (upper + number["m_lowerleg_link"] * number["L"]) * number["g"] * math.sin(hip),
        lower * number["g"] * math.sin(knee),
    ]
    assert motion.mass == pytest.approx(np.array(M), rel=1e-9)
    assert motion.velocity == pytest.approx(h, rel=1e-8)
    assert motion.gravity == pytest.approx(G, rel=1e-9)


def test_the_thesis_gravity_terms_hang_and_do_not_fly() -> None:
    """Eq. 5.5 holds the leg on the bench; in free fall nothing needs holding."""
    posture = {"hip": 0.7, "knee": 0.4}
    printed = RECONCILED.with_values({"L": 0.30})
    hanging = Leg(hanging_leg(printed).finish()).equation_of_motion(posture)
    terms = hanging.gravity / np.sin([posture["hip"], posture["knee"]])
    assert [round(term, 2) for term in terms] == [4.26, 0.60]
    flying = Leg(flying_leg(printed).finish()).equation_of_motion(posture)
    assert flying.gravity == pytest.approx([0.0, 0.0], abs=1e-12)


def test_the_standing_leg_has_one_inertia() -> None:
    """Both drives, and the masses at the speeds that the foot leaves them."""
    number = somewhere("standing_leg", 8)
    angle = 0.6
    motion = leg_at("standing_leg", number).equation_of_motion(
        {"hip": -angle, "knee": angle}
    )
    drive, _, J_knee = inertias(number)
    L, upper = number["L"], number["l_cm_upperleg"]
    height, forward = math.sin(angle) ** 2, math.cos(angle) ** 2
    J = J_knee + drive + number["I_gear"] + number["I_upperleg_link"]
    J += number["m_motors_support"] * 4 * L**2 * height
    J += number["m_upperleg"] * (
        (2 * L - upper) ** 2 * height + upper**2 * forward - upper**2
    )
    J += number["m_lowerleg_link"] * (L**2 - 2 * L * number["l_cm_lowerleg"])
    assert motion.joints == ("hip",)
    assert motion.mass[0, 0] == pytest.approx(J, rel=1e-9)


def test_relative_angles_couple_the_joints_by_a_drive() -> None:
    v = RECONCILED.values_by_name()
    motion = Leg(hanging_leg().finish()).equation_of_motion({"hip": -0.5, "knee": 0.5})
    _, J_hip, J_knee = inertias(v)
    off = motion.mass[0, 1]
    assert motion.relative_mass == pytest.approx(
        np.array([[J_hip + 2 * off + J_knee, off + J_knee], [off + J_knee, J_knee]])
    )
    absolute = off / math.sqrt(J_hip * J_knee)
    relative = motion.relative_mass
    assert abs(absolute) < 0.01
    assert relative[0, 1] / math.sqrt(relative[0, 0] * relative[1, 1]) > 0.6


# -- the models of one joint follow under the thesis's assumptions --------------------


def transfer(graph: FinishedGraph, joint: str) -> sympy.Expr:
    found = linearise(derive(graph)).transfer_function(f"theta_{joint}", f"T_{joint}")
    return found.expression


def printed_form(factory: Callable[[], BondGraph]) -> sympy.Expr:
    return linearise(derive(factory().finish())).transfer_function().expression


def test_the_lowerleg_in_flight_is_the_hanging_leg_with_its_hip_locked() -> None:
    """And gravity compensated: figure 4.2 in symbols."""
    leg = transfer(locked(hanging_leg(), "hip"), "knee")
    form = printed_form(models.lowerleg_flight)
    assert sympy.simplify(leg.subs(symbol("g"), 0) - form) == 0


def test_the_upperleg_in_flight_carries_the_lower_leg_at_the_knee() -> None:
    """With the knee held as the mechanism holds it, in its absolute angle."""
    leg = transfer(locked(hanging_leg(), "knee"), "hip")
    form = printed_form(models.upperleg_flight)
    at_knee = symbol("I_upperleg_link") + symbol("m_lowerleg_link") * symbol("L") ** 2
    bearings = symbol("c_friction_upperleg") + symbol("c_friction_lowerleg")
    form = form.subs(symbol("I_upperleg"), at_knee)
    form = form.subs(symbol("c_friction_upperleg"), bearings)
    assert sympy.simplify(leg.subs(symbol("g"), 0) - form) == 0


def test_the_upperleg_as_section_4_2_2_reads_it() -> None:
    """I_upperleg with the lower leg a point mass at a fixed angle θ_knee."""
    v = RECONCILED.values_by_name()
    L, along = v["L"], v["l_cm_lowerleg"]
    squared = L**2 + along**2 + 2 * L * along * math.cos(v["theta_knee"])
    J = inertias(v)[0] + v["I_gear"] + v["I_upperleg_link"]
    J += v["m_lowerleg_link"] * squared
    system = state_space(rigid_leg().finish().with_parameters({"g": 0.0}))
    gain = (system.C @ system.A @ system.B)[0, 0]
    assert gain == pytest.approx(v["K_gearbox"] * v["K_worm_gear"] / J, rel=1e-9)


@pytest.mark.parametrize(
    ("joint", "model", "mass", "unused"),
    [
        ("knee", "lowerleg_stance", "m_lowerleg", ("I_upperleg_link", "I_gear")),
        ("hip", "upperleg_stance", "m_upperleg", ("I_lowerleg", "I_gear_tendons")),
    ],
)
def test_the_stance_models_follow_from_the_standing_leg(
    joint: str, model: str, mass: str, unused: tuple[str, str]
) -> None:
    """One motor, links that move as the support does, the other link without inertia.

    The friction pole is four times the printed form's at the knee: its bearings turn
    with θ2, which is twice θ1 + θ2 in stance, and the form has them at the joint.
    """
    random = np.random.default_rng(5)
    odd = {
        p.name: p.value * random.uniform(0.7, 1.4)
        for p in RECONCILED.members
        if p.value
    }
    printed = getattr(models, model)(RECONCILED.with_values(odd)).finish()
    form = linearise(derive(printed)).transfer_function()
    v = printed.parameters.values_by_name()
    nearly_none = 1e-13
    friction = f"c_friction_{model.partition('_')[0]}"
    put = {name: v[name] for name in v if name in standing_leg().finish().parameters}
    put |= {
        "g": 0.0,
        "m_motors_support": v["m_motors_support"] + v[mass],
        "m_upperleg": nearly_none,
        "m_lowerleg_link": nearly_none,
        "I_upperleg_link": v.get("I_upperleg", nearly_none),
        **dict.fromkeys(unused, nearly_none),
        **{f"c_friction_{x}": 0.0 for x in ("lowerleg", "upperleg")},
        friction: v[friction],
    }
    leg = standing_leg(drives=(joint,)).finish().with_parameters(put)
    at = {"q_hip": -v["theta_0"], "q_knee": v["theta_0"]}
    system = state_space(leg, at=at)
    row = system.C[system.outputs.index(f"theta_{joint}")]
    column = system.B[:, system.inputs.index(f"T_{joint}")]
    gain = float(row @ system.A @ column)
    pole = -float(row @ system.A @ system.A @ column) / gain
    assert gain == pytest.approx(form.gain_at(v), rel=1e-8)
    times = 4 if joint == "knee" else 1
    wanted = max(abs(x) for x in form.poles(v))
    assert pole == pytest.approx(times * wanted, rel=1e-6)


def test_a_locked_graph_is_an_edit() -> None:
    leg = hanging_leg()
    before = len(leg.finish().nodes)
    assert len(locked(leg, "hip").nodes) == before + 1
    assert len(leg.finish().nodes) == before
