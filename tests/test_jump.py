"""The jump of chapter 6: splines, planning, worms, contacts; what leaves the ground.

The mechanics are checked against Lagrange's equations written here by hand; friction
and contact against the definitions of their laws; the whole against its energy.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy
from scipy.signal import bilinear, lfilter

from bondgraph import BondGraphError
from flegx_models.controllers import controller
from flegx_models.jump import simulation
from flegx_models.jump.condition import EventKind
from flegx_models.jump.instant import GRIPS, HELD, OPEN, Choice, Ground, Problem, solve
from flegx_models.jump.leg_graph import leg_parameters
from flegx_models.jump.machine import Machine
from flegx_models.jump.mechanics import leg
from flegx_models.jump.sampled import DifferenceEquation, Encoder, encoder_filter
from flegx_models.jump.simulation import Experiment, machine, run
from flegx_models.jump.tuning_run import run_test
from flegx_models.jump.worm import irreversible_worm
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CHOSEN, CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.planning import Phase, Planner, printed_plan
from flegx_models.splines import Motion, QuinticSpline
from flegx_models.tuned_zeros import (
    friction_per_load,
    identified_friction,
    tuning_tests,
)

VALUES = CONTROL.values_by_name()
WORM = irreversible_worm()
IDEAL = WORM.with_friction(0.0)
POSTURES = ((0.4, -0.5, 0.6), (0.5, 0.3, -1.1), (0.6, -math.pi / 6, math.pi / 6))
SPEEDS = ((0.1, 0.7, -0.4), (-0.5, -2.0, 1.3))


@cache
def record(friction, counterweight, substeps=5, duration=1.2):
    worm = WORM.with_friction(friction)
    return run(
        Experiment(
            worm=worm,
            counterweight=counterweight,
            duration=duration,
            substeps=substeps,
        )
    )


# Splines and planning ----------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_a_spline_meets_its_six_conditions_and_is_of_fifth_order(seed):
    numbers = np.random.default_rng(seed).normal(size=6)
    start, end = Motion(*numbers[:3]), Motion(*numbers[3:])
    spline = QuinticSpline(start, end, 0.37)
    assert len(spline.coefficients) == 6
    for time, wanted in ((0.0, start), (0.37, end)):
        found = spline.at(time)
        assert found.angle == pytest.approx(wanted.angle)
        assert found.speed == pytest.approx(wanted.speed)
        assert found.acceleration == pytest.approx(wanted.acceleration, abs=1e-9)
    near, h = spline.at(0.2), 1e-6
    slope = (spline.at(0.2 + h).angle - spline.at(0.2 - h).angle) / (2 * h)
    assert near.speed == pytest.approx(slope, rel=1e-6)


def test_a_spline_without_duration_is_refused():
    with pytest.raises(BondGraphError, match="no motion"):
        QuinticSpline(Motion(0.0), Motion(1.0), 0.0)


def test_the_squat_of_the_plan_keeps_the_foot_below_the_hip():
    hip, knee = printed_plan().squat()
    for time in np.linspace(0, 0.4, 9):
        assert hip.at(time).angle == pytest.approx(-knee.at(time).angle)  # eq. 4.16
        assert hip.at(time).speed == pytest.approx(-knee.at(time).speed)  # eq. 4.18
    assert hip.at(0.2).angle < hip.at(0.0).angle  # it bends first
    assert hip.at(0.4).speed == pytest.approx(VALUES["hip_speed"])


def test_the_planner_walks_the_flow_chart():
    planner = Planner.starting(printed_plan())

    def go(time, grounded, angles=(-0.6, 0.6)):
        nonlocal planner
        planner = planner.stepped(time, grounded=grounded, angles=angles)
        return planner.phase, planner.since

    assert go(0.2, True) == (Phase.SQUATTING, 0.0)
    assert go(0.4, True) == (Phase.SQUATTING, 0.4)  # still down: once more
    assert go(0.7, False, (-0.4, 0.5)) == (Phase.RETRACTING, 0.7)
    hip, knee = planner.reference(0.7)
    assert (hip.angle, knee.angle) == (-0.4, 0.5)
    assert hip.speed == knee.speed == 0.0
    assert go(0.8, False) == (Phase.RETRACTING, 0.7)
    assert go(0.91, False) == (Phase.WAITING, 0.7)
    landing = planner.reference(1.5)
    assert landing[0].angle == pytest.approx(VALUES["hip_landing"])
    assert go(1.6, True) == (Phase.SQUATTING, 1.6)
    go(1.7, False)
    assert go(1.75, True) == (Phase.SQUATTING, 1.75)  # landed before the spline ended


# Sampled control ---------------------------------------------------------------------


def test_a_difference_equation_is_tustins_rule():
    top, bottom = (2.0, 3.0), (0.1, 1.0)
    signal = np.random.default_rng(2).normal(size=60)
    equation = DifferenceEquation(top, bottom, 400.0)
    b, a = bilinear(top, bottom, fs=400.0)
    assert [equation(x) for x in signal] == pytest.approx(lfilter(b, a, signal))


def test_the_filter_starts_settled_and_removes_the_printed_noise():
    chapter_3 = CHAPTER_3.values_by_name()
    encoder = Encoder(step=chapter_3["encoder_step"], noise=chapter_3["encoder_noise"])
    still = encoder_filter(2 * math.pi * 25, 400.0, 0.5)
    assert still(0.5) == pytest.approx(0.5)
    readings = np.array([encoder.read(0.5, k) for k in range(300)])
    assert np.ptp(readings) == pytest.approx(
        chapter_3["encoder_noise"], abs=chapter_3["encoder_step"]
    )
    filtered = np.array([still(x) for x in readings])[-90:]
    assert np.ptp(filtered) < np.ptp(readings) / 10 ** (55 / 20)
    assert filtered.mean() == pytest.approx(0.5, abs=chapter_3["encoder_step"])


# Mechanics ---------------------------------------------------------------------------


@cache
def lagrange():
    """Return M and b of the leg by Lagrange's equations, energies written by hand."""
    t = sympy.Symbol("t")
    y, a, c = (sympy.Function(name)(t) for name in "yac")
    n = leg_parameters().values_by_name()
    L, g = n["L"], n["g"]
    kinetic = n["m_motors_support"] * y.diff(t) ** 2 / 2
    potential = n["m_motors_support"] * g * y
    upper = (n["m_upperleg"], n["l_cm_upperleg"], 0.0)
    lower = (n["m_lowerleg_link"], L, n["l_cm_lowerleg"])
    for mass, along, beyond in (upper, lower):
        x = along * sympy.sin(a) + beyond * sympy.sin(c)
        z = y - along * sympy.cos(a) - beyond * sympy.cos(c)
        kinetic += mass * (x.diff(t) ** 2 + z.diff(t) ** 2) / 2
        potential += mass * g * z
    about_hip = n["I_upperleg_link"] - n["m_upperleg"] * n["l_cm_upperleg"] ** 2
    about_knee = n["I_lowerleg"] - n["m_lowerleg_link"] * n["l_cm_lowerleg"] ** 2
    kinetic += (about_hip + n["I_gear"]) * a.diff(t) ** 2 / 2
    kinetic += (about_knee + n["I_gear_tendons"]) * c.diff(t) ** 2 / 2
    function = kinetic - potential
    accelerations = sympy.symbols("A B C")
    rows = []
    for q in (y, a, c):
        row = function.diff(q.diff(t)).diff(t) - function.diff(q)
        for k, other in enumerate((y, a, c)):
            row = row.subs(other.diff(t, 2), accelerations[k])
        rows.append(row)
    flat = sympy.symbols("vy va vc qy qa qc")
    put = [(x.diff(t), v) for x, v in zip((y, a, c), flat[:3], strict=True)]
    put += list(zip((y, a, c), flat[3:], strict=True))
    balance = sympy.Matrix(rows).subs(put[:3]).subs(put[3:])
    mass = balance.jacobian(accelerations)
    rest = -balance.subs(dict.fromkeys(accelerations, 0))
    return sympy.lambdify(flat, (mass, rest))


@pytest.mark.parametrize("v", SPEEDS)
@pytest.mark.parametrize("q", POSTURES)
def test_mechanics_from_the_graph_are_lagranges(q, v):
    mass, bias = lagrange()(*v, *q)
    found = leg().at(np.array(q), np.array(v))
    assert found.mass == pytest.approx(np.asarray(mass, float), abs=1e-12)
    assert found.bias == pytest.approx(np.asarray(bias, float).ravel(), abs=1e-11)


def test_the_foots_place_and_the_potential_are_integrals_of_what_the_graph_says():
    body, h = leg(), 1e-6
    for q in map(np.array, POSTURES):
        at = body.at(q, np.zeros(3))
        for k in range(3):
            step = h * np.eye(3)[k]
            up = body.foot_height(q + step) - body.foot_height(q - step)
            work = body.potential(q + step) - body.potential(q - step)
            assert at.foot[1, k] == pytest.approx(up / (2 * h), abs=1e-8)
            assert at.bias[k] == pytest.approx(-work / (2 * h), abs=1e-6)


# The worm ----------------------------------------------------------------------------


def test_irreversibility_and_the_lead_angle_bound_the_efficiency():
    lead = DATASHEETS.values_by_name()["worm_lead_angle"]
    assert WORM.friction == pytest.approx(math.tan(lead))
    assert WORM.self_locking
    assert WORM.backdriving == pytest.approx(0.0, abs=1e-15)
    assert WORM.efficiency == pytest.approx((1 - math.tan(lead) ** 2) / 2)
    assert not WORM.with_friction(0.99 * WORM.friction).self_locking
    assert (IDEAL.driving, IDEAL.backdriving) == (1.0, 1.0)


def test_a_friction_with_which_nothing_turns_is_refused():
    with pytest.raises(BondGraphError, match="cannot turn"):
        WORM.with_friction(5.0)


def problem(**changes):
    q = np.array([0.0, -math.pi / 6, math.pi / 6])
    plain = Problem(
        posture=leg().at(q, np.zeros(3)),
        speeds=np.zeros(3),
        torques=(0.0, 0.0),
        worms=(WORM, WORM),
        ground=Ground(friction=0.8, creep=0.02),
        pull=0.0,
        down=True,
    )
    return replace(plain, **changes)


def test_without_current_a_self_locking_leg_stands_and_a_free_one_sinks():
    h = 1e-3
    held = solve(problem(), h, Choice(foot=GRIPS))
    assert held.choice.worms == (HELD, HELD)
    assert held.speeds == pytest.approx(np.zeros(3), abs=1e-12)
    weight = -float(problem().posture.bias[0])
    assert held.push / h == pytest.approx(weight)
    free = solve(problem(worms=(IDEAL, IDEAL)), h, Choice(foot=GRIPS))
    assert free.speeds[0] < 0


@pytest.mark.parametrize("friction", [0.05, 0.15, WORM.friction])
def test_lifting_takes_the_driving_factor_and_lowering_the_backdriving_one(friction):
    worm, h = WORM.with_friction(friction), 1e-3
    for way, factor in ((1.0, worm.driving), (-1.0, worm.backdriving)):
        # Both joints turn steadily; the speeds are those of a foot that stays below.
        speeds = np.array([0.3, way, -way])
        speeds[0] = -problem().posture.foot[1, 1:] @ speeds[1:]
        step = solve(
            problem(worms=(worm, worm), speeds=speeds, torques=(20.0, -20.0)),
            h,
            Choice(foot=GRIPS),
        )
        change = worm.inertia * (step.speeds[1] - speeds[1])
        assert h * 20.0 - change == pytest.approx(factor * float(step.meshes[0]))


@pytest.mark.parametrize("seed", range(40))
def test_every_step_obeys_the_laws_it_was_not_told(seed):
    random = np.random.default_rng(seed)
    worm = WORM.with_friction(
        random.uniform(0, WORM.friction), random.choice([0.0, 2.0])
    )
    speeds = random.normal(size=3) * random.choice([0.0, 1e-3, 1.0])
    if random.random() < 0.5:
        speeds[1 + random.integers(2)] = 0.0
    given = problem(
        worms=(worm, worm), speeds=speeds, torques=tuple(random.normal(size=2) * 30)
    )
    h = random.choice([0.0, 1e-4, 1e-3])
    step = solve(given, h, Choice())
    along, up = given.posture.foot @ step.speeds
    # The ground pushes or the foot rises, never both; friction stays in its cone.
    assert step.push >= -1e-9
    assert up >= -1e-9
    assert step.push * up == pytest.approx(0.0, abs=1e-9)
    assert abs(step.grip) <= given.ground.friction * step.push + 1e-9
    assert step.grip * along <= 1e-9
    # Momentum: what changes comes from the listed impulses and no others.
    impulses = h * given.posture.bias + given.posture.foot.T @ (step.grip, step.push)
    impulses[1:] += step.meshes
    assert given.posture.mass @ (step.speeds - speeds) == pytest.approx(impulses)
    # Dry friction takes energy, whichever way its worm ends up turning.
    for k in (0, 1):
        change = worm.inertia * (step.speeds[1 + k] - speeds[1 + k])
        rubbed = h * given.torques[k] - change - step.meshes[k]
        assert rubbed * step.speeds[1 + k] >= -1e-9


# The whole ---------------------------------------------------------------------------


def dropped(height, friction):
    body = Machine(
        leg=leg(),
        worms=(WORM.with_friction(friction),) * 2,
        ground=Ground(friction=0.8, creep=0.02),
    )
    start = body.standing(-math.pi / 6, math.pi / 6)
    lifted = start.q + np.array([height, 0.0, 0.0, 0.0])
    return body, replace(start, q=lifted, down=False, choice=Choice(foot=OPEN))


def test_a_fall_ends_where_and_when_galilei_says_with_the_right_impulse():
    height = 0.02
    body, now = dropped(height, WORM.friction)
    for _ in range(100):
        now = body.advance(now, (0.0, 0.0), 1e-3)
    (event, *_) = now.events
    g = leg_parameters().values_by_name()["g"]
    assert event.kind is EventKind.TOUCH_DOWN
    # Nothing turns in free fall: no weight, no torque.
    assert event.time == pytest.approx(math.sqrt(2 * height / g), rel=1e-9)
    assert body.clearance(now) == pytest.approx(0.0, abs=1e-12)
    # The worms lock under the impact: the whole mass stops at once.
    mass = float(leg().at(now.q, np.zeros(3)).mass[0, 0])
    assert event.impulse == pytest.approx(mass * math.sqrt(2 * g * height), rel=1e-3)
    assert now.ledger.impacts == pytest.approx(mass * g * height, rel=1e-3)


@pytest.mark.parametrize("friction", [0.0, 0.12, WORM.friction])
def test_energy_is_accounted_for_and_its_error_goes_with_the_step(friction):
    errors = []
    for steps in (50, 200):
        body, now = dropped(0.02, friction)
        first = body.energy(now)
        for k in range(steps):
            push = 10 + 12 * math.sin(20 * (k + 0.5) * 0.15 / steps)
            now = body.advance(now, (push, -push), 0.15 / steps)
        turned_over = abs(now.ledger.motors) + now.ledger.worms + now.ledger.impacts
        errors.append(abs(body.energy(now) - first - now.ledger.balance) / turned_over)
        assert now.ledger.impacts > 0
        assert now.ledger.worms >= -1e-12
    assert errors[0] < 5e-3
    assert errors[1] < errors[0] / 2


FRICTIONS = (0.0, WORM.friction / 2, WORM.friction)


@pytest.mark.parametrize("friction", FRICTIONS)
def test_without_the_counterweight_the_leg_stays_on_the_ground(friction):
    found = record(friction, 0.0)
    assert not found.flights
    assert found.highest == 0.0
    assert found.push.min() >= 0.0
    assert not found.events
    if not WORM.with_friction(friction).self_locking:
        # A locked hip can take the knee's load, and then the torque sensor is fooled.
        assert set(found.phases) == {Phase.SQUATTING}


@pytest.mark.parametrize("friction", FRICTIONS)
def test_with_the_counterweight_it_leaves_it(friction):
    found = record(friction, VALUES["m_counterweight"])
    assert found.flights
    assert found.highest > 0.0
    assert {e.kind for e in found.events} == set(EventKind)
    assert found.push.min() >= 0.0  # the ground never pulls
    assert found.ledger.impacts > 0


def test_at_twice_the_speed_it_is_the_worms_friction_that_holds_the_leg_down():
    plan = printed_plan()
    faster = replace(plan, hip_speed=2 * plan.hip_speed, knee_speed=2 * plan.knee_speed)
    plain = Experiment(plan=faster, duration=0.65, substeps=5)
    assert run(replace(plain, worm=IDEAL)).flights
    assert not run(replace(plain, worm=WORM)).flights


def test_the_higher_the_friction_the_lower_the_jump():
    heights = [record(f, VALUES["m_counterweight"]).highest for f in FRICTIONS]
    assert heights[0] > heights[1] > heights[2]
    # No higher than the support's wanted speed carries it against what is left of g.
    n, hung = leg_parameters().values_by_name(), VALUES["m_counterweight"]
    mass = n["m_motors_support"] + n["m_upperleg"] + n["m_lowerleg_link"]
    fall = n["g"] * (mass - hung) / (mass + hung)
    lift = 2 * n["L"] * math.sin(math.pi / 6) * VALUES["hip_speed"]
    assert heights[0] < 1.2 * lift**2 / (2 * fall)


@pytest.mark.parametrize("counterweight", [0.0, 5.0])
def test_the_energy_of_a_whole_run_is_accounted_for(counterweight):
    found = record(WORM.friction / 2, counterweight)
    turned_over = abs(found.ledger.motors) + found.ledger.worms
    assert abs(found.energy_error) < 2e-3 * turned_over


def test_finer_steps_jump_the_same():
    hung = VALUES["m_counterweight"]
    coarse = record(FRICTIONS[1], hung, duration=0.65)
    fine = record(FRICTIONS[1], hung, substeps=15, duration=0.65)
    assert fine.highest == pytest.approx(coarse.highest, rel=0.05)
    assert fine.flights[0] == pytest.approx(coarse.flights[0], abs=0.01)


def test_the_foot_does_not_slide_away():
    found = record(FRICTIONS[1], 0.0)
    along = [leg().foot_forward(np.array([0.0, *angles])) for angles in found.angles]
    assert np.ptp(along) < 0.01


def test_the_counterweight_hangs_still_at_the_start():
    body = machine(Experiment(counterweight=VALUES["m_counterweight"]))
    start = body.standing(-math.pi / 6, math.pi / 6)
    assert body.counterweight is not None
    force, damping = body.counterweight.pull(start.q, start.v)
    assert force == pytest.approx(VALUES["m_counterweight"] * body.gravity)
    assert damping == 0.0


# What the tuned zeros say ------------------------------------------------------------


def test_an_equivalent_viscous_friction_takes_the_energy_of_the_dry_one():
    test, dry = tuning_tests()[0], 3.0
    omega = 2 * math.pi / VALUES["period_test"]
    assert test.speed == pytest.approx(omega * VALUES["swing_lowerleg"] / 2, rel=0.1)
    viscous = test.zero(IDEAL.with_friction(0.0, dry)) * test.inertia - test.viscous
    time = np.linspace(0, VALUES["period_test"], 20001)
    speed = test.speed * np.sin(omega * time)
    rubbed = np.trapezoid(dry * np.sign(speed) * speed, time)
    assert np.trapezoid(viscous * speed**2, time) == pytest.approx(rubbed, rel=1e-4)


def test_load_dependent_friction_orders_the_zeros_as_they_were_tuned():
    tests = {test.model: test for test in tuning_tests()}
    for worm in (WORM, WORM.with_friction(WORM.friction / 2)):
        zeros = {model: test.zero(worm) for model, test in tests.items()}
        for link in ("lowerleg", "upperleg"):
            assert zeros[f"{link}_stance"] > zeros[f"{link}_flight"]
        for phase in ("flight", "stance"):
            assert zeros[f"upperleg_{phase}"] > zeros[f"lowerleg_{phase}"]
    # An irreversible worm asks for more in stance than was tuned, none for much less.
    for model in ("lowerleg_stance", "upperleg_stance"):
        assert tests[model].zero(IDEAL) < tests[model].tuned_zero
        assert tests[model].tuned_zero < tests[model].zero(WORM)


def test_two_frictions_explain_four_zeros_and_lie_within_the_data_sheets():
    found, tests = identified_friction(), tuning_tests()
    sheet = DATASHEETS.values_by_name()
    assert 0 < found.worm.friction < WORM.friction
    idle = sheet["K_m"] * sheet["motor_no_load_current"] * WORM.ratio
    assert 0 < found.worm.constant < idle
    assert friction_per_load(found.worm) > 0
    frictions = np.array([test.friction_of_the_zero for test in tests])
    # Two numbers leave less than a fifth of the four frictions' variance.
    assert found.residual**2 < np.var(frictions) / 5
    for test, zero in zip(tests, found.zeros, strict=True):
        assert zero / test.tuned_zero == pytest.approx(1.0, abs=0.7)


@pytest.mark.parametrize("number", range(4))
def test_tuned_zeros_bring_the_response_back_to_that_without_friction(number):
    test, worm = tuning_tests()[number], identified_friction().worm
    designed, final = (controller(test.model, v) for v in ("printed", "tuned"))
    ideal = run_test(test, IDEAL, designed, 1.05)
    printed, tuned = (run_test(test, worm, law, 1.05) for law in (designed, final))
    assert tuned.distance(ideal) < 0.35 * printed.distance(ideal)
    # "Comparable to the simulation", as section 6.1 says: within a tenth of the swing.
    assert tuned.distance(ideal) < np.ptp(ideal.reference) / 10
    assert np.ptp(printed.angle) < 0.9 * np.ptp(ideal.angle)


def test_a_worm_like_the_zeros_say_needs_the_counterweight():
    worm = identified_friction().worm
    flown = {
        hung: run(Experiment(worm=worm, counterweight=hung, duration=0.8, substeps=5))
        for hung in (0.0, VALUES["m_counterweight"])
    }
    assert not flown[0.0].flights
    assert flown[VALUES["m_counterweight"]].flights


@pytest.mark.parametrize(
    "other", [{"mu_ground": 0.5}, {"torque_band": 4.0}, {"rope_stiffness": 1e4}]
)
def test_who_jumps_does_not_hang_on_what_is_assumed(other, monkeypatch):
    monkeypatch.setattr(simulation, "CHOSEN", CHOSEN.with_values(other))
    test_a_worm_like_the_zeros_say_needs_the_counterweight()


def test_what_is_chosen_says_that_it_is():
    assert {p.name for p in CHOSEN.assumed()} == set(CHOSEN)
    assert not CONTROL.assumed()
