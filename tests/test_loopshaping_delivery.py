"""From controller to code: samples, rounding, limits, C that gives the same bits."""

import math
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import cont2discrete

from bondgraph import BondGraph, I, R, Se, derive, linearise
from bondgraph.errors import LoopShapingError, ParameterError
from bondgraph.loopshaping.delivery.anti_windup import (
    BackCalculation,
    Clamping,
    NoAntiWindup,
)
from bondgraph.loopshaping.delivery.arithmetic import Double, FixedPoint, Single
from bondgraph.loopshaping.delivery.c_code import FLAGS, controller_to_c99
from bondgraph.loopshaping.delivery.difference_equation import (
    controller_to_control,
    difference_equation,
    difference_equations,
)
from bondgraph.loopshaping.delivery.digital import digital_controller
from bondgraph.loopshaping.delivery.discretise import ExactHold, Matched, Tustin
from bondgraph.loopshaping.delivery.feedforward import gravity_feedforward
from bondgraph.loopshaping.delivery.sampled_loop import (
    AbstractPlant,
    Encoder,
    LinearPlant,
    sampled_loop,
    simulate_sampled,
)
from bondgraph.loopshaping.loop import Loop, zero_pole_gain
from bondgraph.loopshaping.measures import measure
from bondgraph.loopshaping.realisation import realise
from bondgraph.loopshaping.requirements import (
    Assessment,
    PeakSensitivity,
    PhaseMargin,
)
from bondgraph.loopshaping.step_response import step_response
from bondgraph.loopshaping.synthesis.limits import PeakNoiseGain
from bondgraph.loopshaping.synthesis.optimise import optimise_controller
from bondgraph.loopshaping.synthesis.structure import ControllerStructure
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain
from flegx_models import models
from flegx_models.concealed_drive import Drive, Motion, advance
from flegx_models.parameters_control import CONTROL
from flegx_models.planar_leg import flying_leg, hanging_leg, sliding_leg

PERIOD = 1 / CONTROL["sampling"].value
CORNER = 2 * math.pi * 25  # the audit: 25 Hz, not 25 rad/s
FILTER = ZeroPoleGain(
    poles=tuple(np.roots([1, 1.414 * CORNER, CORNER**2])) * 2, gain=CORNER**4
)
LEAD = ZeroPoleGain(zeros=(-1.8,), poles=(-50.0,), gain=70.0)
PLANT = ZeroPoleGain(poles=(0, -1.5), gain=8.0)

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not here")


# Discretisation


def random_system(seed):
    generator = np.random.default_rng(seed)
    n = int(generator.integers(1, 5))
    poles = list(-(10 ** generator.uniform(-0.5, 2, n)))
    if seed % 3 == 0:
        poles += [-8 + 20j, -8 - 20j]
    zeros = list(-(10 ** generator.uniform(-0.5, 2, int(generator.integers(0, n + 1)))))
    return ZeroPoleGain(zeros=tuple(zeros), poles=tuple(poles), gain=3.0)


@pytest.mark.parametrize("seed", range(20))
def test_tustin_and_hold_agree_with_scipy(seed):
    system = random_system(seed)
    omega = np.geomspace(0.1, 0.9 * math.pi / 0.01, 30)
    for method, word in ((Tustin(), "bilinear"), (ExactHold(), "zoh")):
        A, B, C, D, _ = cont2discrete(tuple(realise(system)), 0.01, method=word)
        inverse = [
            np.linalg.inv(z * np.eye(len(A)) - A) for z in np.exp(1j * omega * 0.01)
        ]
        expected = [(C @ one @ B + D)[0, 0] for one in inverse]
        found = method(system, 0.01).response(omega)
        assert found == pytest.approx(np.array(expected), rel=1e-7)


@given(st.floats(1.0, 1000.0), st.integers(0, 40))
@settings(max_examples=40, deadline=None)
def test_tustin_keeps_the_response_where_it_is_prewarped(omega, seed):
    system = random_system(seed)
    found = Tustin(prewarp=omega)(system, PERIOD)
    at = np.array([omega])
    assert found.response(at) == pytest.approx(system.response(at), rel=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_matched_keeps_roots_and_one_magnitude(seed):
    system = random_system(seed)
    found = Matched(at=5.0)(system, PERIOD)
    at = np.array([5.0])
    assert abs(found.response(at)) == pytest.approx(abs(system.response(at)))
    wanted = sorted(abs(np.exp(p * PERIOD)) for p in system.poles)
    assert sorted(map(abs, found.poles)) == pytest.approx(wanted)
    assert found.relative_degree == min(system.relative_degree, 1)


@pytest.mark.parametrize("delay", [0.0, 0.3, 1.0, 2.7])
def test_hold_is_exact_for_any_delay(delay):
    """Against the continuous step response, which a held step is from then on."""
    system = random_system(3)
    late = ZeroPoleGain(
        zeros=system.zeros, poles=system.poles, gain=system.gain, delay=delay * 0.01
    )
    found = ExactHold()(late, 0.01)
    _, output = control.step_response(
        control.StateSpace(*realise(found), 0.01), T=0.01 * np.arange(60)
    )
    moments = 0.01 * np.arange(60) - delay * 0.01
    plant = LinearPlant(system)
    for k, moment in enumerate(moments):
        if moment > 1e-12:
            plant = LinearPlant(system)
            plant.advance(1.0, float(moment))
            assert output[k] == pytest.approx(plant.output(), abs=1e-9)
        else:
            assert output[k] == pytest.approx(0.0, abs=1e-12)


def test_what_cannot_be_discretised_is_refused():
    with pytest.raises(LoopShapingError, match="sampled every"):
        Tustin()(Tustin()(LEAD, PERIOD), PERIOD)
    with pytest.raises(LoopShapingError, match="more zeros than poles"):
        Tustin()(ZeroPoleGain(zeros=(-1.0,)), PERIOD)
    with pytest.raises(LoopShapingError, match="half the sampling rate"):
        Tustin(prewarp=4000.0)(LEAD, PERIOD)
    with pytest.raises(LoopShapingError, match="delay"):
        Matched()(ZeroPoleGain(poles=(-1.0,), delay=0.1), PERIOD)


# The controller in its arithmetic


def delivered(**choices):
    return digital_controller(LEAD, PERIOD, filter=FILTER, **choices)


def test_linear_run_is_what_python_control_simulates():
    made = delivered()
    system = controller_to_control(made)
    generator = np.random.default_rng(1)
    r, y = generator.standard_normal((2, 300))
    _, expected = control.forced_response(system, inputs=np.array([r, y]))
    run = made.run()
    assert [run.step(a, b) for a, b in zip(r, y, strict=True)] == pytest.approx(
        expected.ravel()
    )


def test_difference_equation_computes_the_same():
    made = delivered()
    text = difference_equation(made.controller, source="e", result="v")
    generator = np.random.default_rng(2)
    e = list(generator.standard_normal(50))
    v = []
    body = text.split("=")[1]
    for k in range(50):
        line = (
            body.replace("v[k-1]", "v1").replace("e[k-1]", "e1").replace("e[k]", "e0")
        )
        for name in ("v1", "e1", "e0"):
            line = line.replace(f" {name}", f"*{name}")
        v1, e1 = (v[-1], e[k - 1]) if k else (0.0, 0.0)
        v.append(eval(line, {"v1": v1, "e1": e1, "e0": e[k]}))
    simple = digital_controller(LEAD, PERIOD)
    run = simple.run()
    assert [run.step(one, 0.0) for one in e] == pytest.approx(v)
    assert "min(max(" in difference_equations(delivered(limits=(-1.0, 1.0)))


def test_rounding_of_coefficients_moves_the_measured_margins():
    margins = {}
    for kind in (Double(), FixedPoint(fraction_bits=20), FixedPoint(fraction_bits=12)):
        loop = sampled_loop(PLANT, delivered(arithmetic=kind), computing_time=0.001)
        margins[kind] = measure(loop, step=False)
    exact, fine, coarse = margins.values()
    assert exact.stable
    assert fine.phase_margin == pytest.approx(exact.phase_margin, abs=0.5)
    moved = abs(coarse.phase_margin - exact.phase_margin)
    assert not coarse.stable or moved > abs(fine.phase_margin - exact.phase_margin)


def test_what_does_not_fit_is_refused():
    with pytest.raises(LoopShapingError, match="fraction bits"):
        delivered(arithmetic=FixedPoint(fraction_bits=28))
    with pytest.raises(LoopShapingError, match="cannot name"):
        delivered(name="two words")
    with pytest.raises(LoopShapingError, match="no limits"):
        delivered(limits=(1.0, -1.0))
    with pytest.raises(LoopShapingError, match="direct gain"):
        digital_controller(
            ZeroPoleGain(poles=(-3.0,), gain=1.0),
            PERIOD,
            method=ExactHold(),
            anti_windup=BackCalculation(),
        )


# C


def compiled(controller, folder):
    text = controller_to_c99(controller)
    for name, content in text.files().items():
        (folder / name).write_text(content)
    program = folder / "run"
    sources = [str(folder / n) for n in text.files() if n.endswith(".c")]
    subprocess.run(["gcc", *FLAGS, "-O2", *sources, "-o", str(program)], check=True)
    return program


def same_bits(controller, folder, rows):
    """Assert that the compiled program and our run give the same numbers."""
    program = compiled(controller, folder)
    lines = "\n".join(" ".join(float(v).hex() for v in row) for row in rows)
    answer = subprocess.run(
        [str(program)], input=lines, capture_output=True, text=True, check=True
    )
    run = controller.run()
    expected = [run.step(*row) for row in rows]
    assert [float(v) for v in answer.stdout.split()] == expected
    return np.array(expected)


@needs_gcc
@pytest.mark.parametrize(
    "kind", [Double(), Single(), FixedPoint(fraction_bits=18)], ids=repr
)
@pytest.mark.parametrize(
    "anti_windup", [NoAntiWindup(), Clamping(), BackCalculation(0.01)], ids=repr
)
@pytest.mark.parametrize("gain", [1.0, -1.0])
def test_compiled_controller_gives_the_same_bits(kind, anti_windup, gain, tmp_path):
    made = digital_controller(
        LEAD.times(gain),
        PERIOD,
        filter=FILTER,
        arithmetic=kind,
        limits=(-8.0, 6.5),
        anti_windup=anti_windup,
    )
    rows = np.random.default_rng(7).standard_normal((2000, 3)).cumsum(axis=0) * 0.05
    commands = same_bits(made, tmp_path, rows.tolist())
    assert commands.max() == pytest.approx(6.5, abs=1e-4)
    assert commands.min() == pytest.approx(-8.0, abs=1e-4)


@needs_gcc
def test_compiled_pure_gain_and_integrator(tmp_path):
    rows = np.random.default_rng(3).standard_normal((200, 3)).tolist()
    same_bits(digital_controller(ZeroPoleGain(gain=2.5), PERIOD), tmp_path, rows)
    pi = ZeroPoleGain(zeros=(-2.0,), poles=(0,), gain=3.0)
    same_bits(digital_controller(pi, PERIOD, limits=(-1.0, 1.0)), tmp_path, rows)


# The sampled loop


@pytest.mark.parametrize("late", [0.0, 0.0008, PERIOD, 1.6 * PERIOD])
def test_simulation_is_the_exact_sampled_loop(late):
    made = delivered()
    run = simulate_sampled(
        LinearPlant(PLANT), made, lambda t: 1.0, 1.0, computing_time=late
    )
    loop = sampled_loop(PLANT, made, computing_time=late)
    expected = step_response(loop, scale=10.0)
    assert run.output == pytest.approx(expected.output[: len(run.output)], abs=1e-9)


def test_sampling_costs_the_phase_that_a_delay_of_half_a_period_costs():
    continuous = measure(
        Loop(plant=PLANT, controller=LEAD, feedback=FILTER), step=False
    )
    w = continuous.crossover
    made = delivered(method=Tustin(prewarp=w))
    sampled = measure(sampled_loop(PLANT, made), step=False)
    lost = continuous.phase_margin - sampled.phase_margin
    assert lost == pytest.approx(math.degrees(w * PERIOD / 2), rel=0.03)


@pytest.mark.parametrize("late", [0.0, 0.5 * PERIOD, PERIOD])
def test_loop_that_is_measured_unstable_grows_and_stable_one_does_not(late):
    made = delivered()
    factor = measure(
        sampled_loop(PLANT, made, computing_time=late), step=False
    ).gain_margin
    for more, grows in ((0.97 * factor, False), (1.03 * factor, True)):
        run = simulate_sampled(
            LinearPlant(PLANT.times(more)),
            made,
            lambda t: 1.0,
            8.0,
            computing_time=late,
        )
        tail = np.abs(run.output[-200:] - 1).max()
        assert bool(tail > 1.0) is grows


def test_encoder_tells_whole_steps():
    run = simulate_sampled(
        LinearPlant(PLANT), delivered(), lambda t: 0.3, 0.5, encoder=Encoder(step=0.01)
    )
    told = run.measured / 0.01
    assert told == pytest.approx(np.round(told))
    assert np.abs(run.measured - run.output).max() <= 0.005 + 1e-12


def test_anti_windup_takes_the_overshoot_of_a_saturated_integrator():
    pi = ZeroPoleGain(zeros=(-2.0,), poles=(0,), gain=5.0)
    plant = ZeroPoleGain(poles=(-1.0, -10.0), gain=10.0)
    overshoot = {}
    for kind in (NoAntiWindup(), Clamping(), BackCalculation()):
        made = digital_controller(pi, PERIOD, limits=(-1.3, 1.3), anti_windup=kind)
        run = simulate_sampled(LinearPlant(plant), made, lambda t: 1.0, 8.0)
        overshoot[type(kind)] = run.output.max() - 1
    assert overshoot[NoAntiWindup] > 0.1
    assert overshoot[Clamping] < 0.3 * overshoot[NoAntiWindup]
    assert overshoot[BackCalculation] < 0.3 * overshoot[NoAntiWindup]


# Gravity


def test_gravity_of_the_hanging_leg_is_the_thesis_formula():
    """Eq. 5.3 and 5.5: each joint holds what hangs on it."""
    graph = hanging_leg().finish()
    found = gravity_feedforward(graph, ("hip", "knee"))
    v = graph.parameters.values_by_name()
    for hip, knee in ((0.4, 0.9), (-1.1, 0.2)):
        held = found.at(v, {"q_hip": hip, "q_knee": knee})
        lower = v["m_lowerleg_link"] * v["g"]
        upper = v["m_upperleg"] * v["g"] * v["l_cm_upperleg"]
        assert held["hip"] == pytest.approx((upper + lower * v["L"]) * math.sin(hip))
        assert held["knee"] == pytest.approx(
            lower * v["l_cm_lowerleg"] * math.sin(knee)
        )
    motors = gravity_feedforward(graph, ("T_hip", "T_knee"))
    ratio = v["K_gearbox"] * v["K_worm_gear"]
    at = {"q_hip": 0.4, "q_knee": 0.9}
    assert motors.at(v, at)["T_hip"] * ratio == pytest.approx(found.at(v, at)["hip"])


def test_gravity_of_the_standing_leg_is_the_thesis_formula():
    """Eq. 5.6 and 5.8: each joint lifts what is above it."""
    graph = sliding_leg().finish()
    v = graph.parameters.values_by_name()
    held = gravity_feedforward(graph, ("hip", "knee")).at(
        v, {"q_hip": 0.5, "q_knee": -0.6}
    )
    m, L, g = v["m_motors_support"], v["L"], v["g"]
    upper, lower = v["m_upperleg"], v["m_lowerleg_link"]
    hip = -(m * L + upper * (L - v["l_cm_upperleg"])) * g * math.sin(0.5)
    knee = -((m + upper) * L + lower * (L - v["l_cm_lowerleg"])) * g * math.sin(-0.6)
    assert held["hip"] == pytest.approx(hip)
    assert held["knee"] == pytest.approx(knee)


@needs_gcc
def test_gravity_in_c_is_the_same_number(tmp_path):
    graph = sliding_leg().finish()
    values = graph.parameters.values_by_name()
    found = gravity_feedforward(graph, ("T_hip", "T_knee"))
    main = (
        '#include <stdio.h>\n#include "gravity.c"\n'
        'int main(void) { printf("%.17g %.17g",'
        " gravity_T_hip(0.5, -0.6), gravity_T_knee(0.5, -0.6)); return 0; }\n"
    )
    (tmp_path / "gravity.c").write_text(found.c99(values))
    (tmp_path / "main.c").write_text(main)
    program = str(tmp_path / "run")
    subprocess.run(
        ["gcc", *FLAGS, str(tmp_path / "main.c"), "-o", program, "-lm"], check=True
    )
    said = subprocess.run([program], capture_output=True, text=True, check=True)
    expected = found.at(values, {"q_hip": 0.5, "q_knee": -0.6})
    assert [float(x) for x in said.stdout.split()] == pytest.approx(
        list(expected.values()), rel=1e-12
    )


def test_gravity_that_nobody_holds_is_refused():
    with pytest.raises(LoopShapingError, match="holds gravity"):
        gravity_feedforward(hanging_leg().finish(), ("hip",))
    weightless = BondGraph("cart", domain="translation")
    weightless.one("v", Se("F"), I("m"), R("b"))
    with pytest.raises(LoopShapingError, match="weight"):
        gravity_feedforward(weightless.finish(), ("F",))
    with pytest.raises(LoopShapingError, match="hips"):
        gravity_feedforward(hanging_leg().finish(), ("hips",))
    found = gravity_feedforward(hanging_leg().finish(), ("hip", "knee"))
    with pytest.raises(ParameterError, match="g"):
        found.c99({"L": 0.3})


# The four loops of the FlegX leg, from bond graph to C

LOOPS = ("lowerleg_flight", "upperleg_flight", "lowerleg_stance", "upperleg_stance")
COMPUTING = 0.0005
WORM_FRICTION = 0.4  # of the transmitted torque: an efficiency of 71 %


@dataclass(frozen=True)
class LegLoop:
    """One of the four loops: the linear plant, and what its worm drive needs."""

    plant: ZeroPoleGain
    printed: ZeroPoleGain
    torque_per_command: float
    drive: Drive
    weight: float


@cache
def leg_loop(name):
    graph = getattr(models, name)().finish()
    transfer = linearise(derive(graph)).transfer_function("theta", "T_motor")
    v = graph.parameters.values_by_name()
    rigid = zero_pole_gain(transfer, v)
    c = {n: p.value for n, p in CONTROL.items()}
    driver = ZeroPoleGain(
        zeros=(-c["zero_driver"],),
        poles=(-c["fast_pole_driver"], -c["slow_pole_driver"]),
        gain=c[f"numerator_{name}"] / rigid.gain,
    )
    ratio = v["K_gearbox"] * v["K_worm_gear"]
    inertia = ratio / rigid.gain
    motor_side = ratio**2 * (v["I_motor"] + v["I_gearbox"])
    motor_side += v["K_worm_gear"] ** 2 * v["I_worm"]
    joint, phase = name.split("_")
    leg = (hanging_leg if phase == "flight" else sliding_leg)().finish()
    place = "knee" if joint == "lowerleg" else "hip"
    held = gravity_feedforward(leg, ("hip", "knee")).at(
        leg.parameters.values_by_name(), {"q_hip": -math.pi / 6, "q_knee": math.pi / 6}
    )
    zero, pole = c[f"z_{name}"], c[f"p_{name}"]
    return LegLoop(
        plant=rigid * driver,
        printed=ZeroPoleGain(
            zeros=(-zero,), poles=(-pole,), gain=c[f"K_{name}"] * pole
        ),
        torque_per_command=ratio * driver.dc_gain,
        drive=Drive(
            ratio=ratio,
            inertia=inertia,
            joint_inertia=inertia - motor_side,
            viscous=v[f"c_friction_{joint}"],
            mu=WORM_FRICTION,
        ),
        weight=held[place],
    )


class WormDrive(AbstractPlant):
    """The leg with a worm that rubs in proportion to the torque it transmits."""

    def __init__(self, loop):
        self.loop = loop
        self.motion = Motion(0.0, 0.0)

    def output(self):
        return self.motion.theta

    def advance(self, command, duration):
        torque = self.loop.torque_per_command * command
        for _ in range(4):
            self.motion = advance(
                self.loop.drive, self.motion, torque, -self.loop.weight, duration / 4
            )


@cache
def designed(name):
    """Return the printed and the designed controller's record."""
    loop = leg_loop(name)
    late = ZeroPoleGain(delay=PERIOD / 2 + COMPUTING)
    around = Loop(plant=loop.plant * late, controller=loop.printed, feedback=FILTER)
    printed = measure(around, step=False)
    return optimise_controller(
        around,
        ControllerStructure(
            zeros=1, poles=1, slowest=abs(loop.printed.zeros[0]), fastest=400.0
        ),
        (
            PhaseMargin(printed.phase_margin),
            PeakSensitivity(printed.sensitivity.value),
        ),
        crossover=(5.0, 50.0),
        begin=[loop.printed],
        starts=2,
    )


def swing(name):
    """The test of section 6.1: fifth-order splines to and fro, each 0.35 s long."""
    size = math.radians(20 if name.startswith("lowerleg") else 10)

    def reference(t):
        half = CONTROL["period_test"].value / 2
        turn, phase = divmod(t / half, 1.0)
        way = 10 * phase**3 - 15 * phase**4 + 6 * phase**5
        return size * (way if turn % 2 == 0 else 1 - way)

    return reference


def driven(name, controller, plant, **choices):
    loop = leg_loop(name)
    made = digital_controller(
        controller,
        PERIOD,
        name=name,
        filter=FILTER,
        method=Tustin(prewarp=10.0),
        filter_method=Tustin(),
        limits=(-100.0, 100.0),
        **choices,
    )
    lift = loop.weight / loop.torque_per_command
    run = simulate_sampled(
        plant(loop),
        made,
        swing(name),
        2.8,
        computing_time=COMPUTING,
        encoder=Encoder(step=2 * math.pi / 2**14),
        feedforward=lambda _: lift,
    )
    return made, run


@pytest.mark.parametrize("name", LOOPS)
def test_designed_controller_beats_the_printed_one(name):
    """Faster at the same margins, and closer tracking with worm friction."""
    loop, found = leg_loop(name), designed(name)
    assert found.met
    runs, measures = [], []
    for controller in (loop.printed, found.controller):
        made, run = driven(name, controller, WormDrive)
        runs.append(run)
        around = sampled_loop(loop.plant, made, computing_time=COMPUTING)
        measures.append(measure(around, step=False))
    before, after = measures
    assert after.crossover > 1.15 * before.crossover
    assert after.phase_margin > before.phase_margin - 0.3
    assert after.sensitivity.value < 1.01 * before.sensitivity.value
    assert runs[1].rms_error < 0.9 * runs[0].rms_error


@needs_gcc
@pytest.mark.parametrize("name", LOOPS)
def test_four_loops_run_in_c_as_in_simulation(name, tmp_path):
    made, run = driven(name, designed(name).controller, WormDrive, arithmetic=Single())
    loop = leg_loop(name)
    lift = loop.weight / loop.torque_per_command
    rows = [[r, y, lift] for r, y in zip(run.reference, run.measured, strict=True)]
    commands = same_bits(made, tmp_path, rows)
    assert commands.tolist() == run.command.tolist()


def test_noise_gain_is_what_the_faster_crossover_costs():
    """At the printed controller's own noise gain there is next to nothing to win."""
    loop = leg_loop("lowerleg_flight")
    late = ZeroPoleGain(delay=PERIOD / 2 + COMPUTING)
    around = Loop(plant=loop.plant * late, controller=loop.printed, feedback=FILTER)
    printed = measure(around, step=False)
    noise = PeakNoiseGain(1.0).achieved(Assessment(around))
    found = optimise_controller(
        around,
        ControllerStructure(zeros=1, poles=1, slowest=0.18, fastest=400.0),
        (
            PhaseMargin(printed.phase_margin),
            PeakSensitivity(printed.sensitivity.value),
            PeakNoiseGain(noise),
        ),
        crossover=(5.0, 50.0),
        begin=[loop.printed],
        starts=2,
    )
    assert found.met
    assert found.value == pytest.approx(printed.crossover, rel=0.03)


def test_flying_leg_holds_gravity_with_nothing():
    with pytest.raises(LoopShapingError, match="holds gravity"):
        gravity_feedforward(flying_leg().finish(), ("hip", "knee"))
