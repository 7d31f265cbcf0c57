"""A diagnosis made by hand: a cart whose Coulomb friction its model leaves out.

The numbers come from a small simulation here, so that pictures and tables look like
those of a real answer; nothing of the diagnosis itself is used.
"""

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.diagnosis.records import (
    Comparison,
    Diagnosis,
    Evidence,
    Finding,
    RecoveredLaw,
    Support,
    Trace,
    Verdict,
)
from bondgraph.fitting.result import Estimate, FitResult, FitStatus, Score
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import TF, C, I, R, Se
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Fitted, Measured, Parameter
from bondgraph.structure.signals import f

STEP = 2e-3
MASS, VISCOUS, COULOMB = 95.1, 203.5, 20.4
Array = NDArray[np.float64]


def cart() -> FinishedGraph:
    """Return a cart driven through a belt, with viscous friction only."""
    graph = BondGraph("cart on a belt drive", domain="translation")
    graph.one("pulley", Se("T_motor"), I("J_motor"), domain="rotation")
    graph.one("carriage", I("mass"), R("viscous"), C("return_spring"))
    graph.join("pulley", TF("belt"), "carriage")
    graph.parameter("J_motor", 1e-4, "kg*m^2", std=0.0)
    graph.parameter("belt", 20.0, "1/m", std=0.0, source=Measured(method="counted"))
    graph.parameter("return_spring", 1e-3, "m/N", std=0.0)
    graph.parameter("mass", 96.0, "kg", bounds=(0.0, 500.0))
    graph.parameter("viscous", 240.0, "N*s/m", bounds=(0.0, 1e4))
    graph.measure("position", displacement="carriage")
    graph.measure("velocity", flow="carriage")
    return graph.finish()


def improved(graph: FinishedGraph) -> FinishedGraph:
    law = sympy.Symbol("F_c") * sympy.sign(f)
    f_c = Parameter(name="F_c", value=20.41, unit="N", std=0.12, source=Fitted(("a",)))
    return InsertElement("carriage", R("coulomb", law=law), (f_c,)).apply(graph)


def force(time: Array, phase: float) -> Array:
    sweep = np.sin(2 * np.pi * (0.2 * time + 0.03 * time**2) + phase)
    return np.asarray(90 * sweep + 25 * np.sign(np.sin(0.9 * time)))


def simulated(drive: Array, mass: float, viscous: float, coulomb: float) -> Array:
    """Return position and velocity, one row per sample, by short Euler steps."""
    state = np.zeros((len(drive), 2))
    x, v = 0.0, 0.0
    for k, push in enumerate(drive):
        state[k] = x, v
        friction = viscous * v + coulomb * np.tanh(v / 1e-3)
        v += STEP * (push - friction - 1e3 * x) / mass
        x += STEP * v
    return state


def traces(samples: int = 4000) -> tuple[Trace, ...]:
    time = STEP * np.arange(samples)
    noise = np.random.default_rng(1)
    result = []
    for number, name in enumerate(("bench 07, held out", "bench 08, held out")):
        drive = force(time, phase=float(number))
        truth = simulated(drive, MASS, VISCOUS, COULOMB)
        before = simulated(drive, 99.0, 291.0, 0.0)
        for column, (channel, unit, std) in enumerate(
            (("position", "m", 5e-4), ("velocity", "m/s", 4e-3))
        ):
            measured = truth[:, column] + std * noise.standard_normal(samples)
            result.append(
                Trace(
                    recording=name,
                    channel=channel,
                    unit=unit,
                    time=time,
                    measured=measured,
                    before=before[:, column],
                    after=truth[:, column],
                )
            )
    return tuple(result)


def recovered() -> RecoveredLaw:
    noise = np.random.default_rng(2)
    speed = 0.3 * np.sin(np.linspace(0, 40, 600)) * noise.uniform(0.2, 1, 600)
    grid = np.linspace(-0.31, 0.31, 401)
    return RecoveredLaw(
        place="carriage",
        argument_name="velocity",
        argument_unit="m/s",
        value_name="missing force",
        value_unit="N",
        argument=speed,
        value=COULOMB * np.tanh(speed / 4e-3) + 2.0 * noise.standard_normal(600),
        curve_argument=grid,
        curve_value=COULOMB * np.sign(grid),
    )


def evidence(
    physics: str, place: str, law: str, support: Support, numbers: tuple[float, ...]
) -> Evidence:
    gain, gain_std, train, held_out = numbers
    reasons = {
        Support.SUPPORTED: "Chosen: the largest gain on left-out blocks.",
        Support.UNDECIDED: "Within one standard error of the chosen one, with one "
        "parameter more.",
        Support.REFUTED: "Its gain on left-out blocks is not above what chance gives.",
    }
    return Evidence(
        physics=physics,
        place=place,
        law=law,
        support=support,
        gain=gain,
        gain_std=gain_std,
        train_nrmse=train,
        reason=reasons[support],
        held_out_nrmse=held_out,
        estimates=(Estimate(name="F_c", value=20.4, std=0.1, unit="N", start=1.0),),
    )


def fit(
    model: FinishedGraph, estimates: tuple[Estimate, ...], nrmse: float
) -> FitResult:
    return FitResult(
        status=FitStatus.CONVERGED,
        model=model,
        estimates=estimates,
        score=Score(nrmse=nrmse, rmse={"position": 0.1 * nrmse, "velocity": nrmse}),
        cost=nrmse**2,
        iterations=9,
        window=2.0,
    )


def estimate(
    name: str, value: float, std: float | None, unit: str, start: float
) -> Estimate:
    return Estimate(name=name, value=value, std=std, unit=unit, start=start)


def cart_diagnosis() -> Diagnosis:
    """Return the whole answer: Coulomb friction is missing on the carriage."""
    base = cart().with_parameters({"mass": 99.0, "viscous": 291.0})
    after = improved(cart().with_parameters({"mass": 95.1, "viscous": 203.5}))
    f_c = estimate("F_c", 20.41, 0.12, "N", 1.0)
    candidates = (
        evidence("coulomb_friction", "carriage", "F_c*sign(f)", Support.SUPPORTED,
                 (0.962, 0.011, 0.011, 0.012)),
        evidence("stribeck_friction", "carriage",
                 "F_c*sign(f) + F_s*exp(-(f/v_s)**2)*sign(f)", Support.UNDECIDED,
                 (0.963, 0.012, 0.011, 0.012)),
        evidence("quadratic_drag", "carriage", "c_2*f*Abs(f)", Support.REFUTED,
                 (0.031, 0.022, 0.166, 0.171)),
        evidence("gravity", "carriage", "m_g*sin(q)", Support.REFUTED,
                 (-0.004, 0.006, 0.171, 0.174)),
    )  # fmt: skip
    finding = Finding(
        physics="coulomb_friction",
        place="carriage",
        element="coulomb",
        statement="Coulomb friction of 20.41 ± 0.12 N acts on the carriage.",
        law="F_c*sign(f)",
        indistinguishable_places=("pulley",),
        alternatives=candidates[1:2],
        estimates=(f_c,),
    )
    return Diagnosis(
        verdict=Verdict.PHYSICS_MISSING,
        statement="Coulomb friction is missing on the carriage: with it the error on "
        "recordings the choice has not seen falls from 17.2 % to 1.2 %.",
        findings=(finding,),
        train=Comparison(
            before=Score(nrmse=0.17, rmse={"position": 0.0042, "velocity": 0.031}),
            after=Score(nrmse=0.011, rmse={"position": 0.0005, "velocity": 0.004}),
        ),
        held_out=Comparison(
            before=Score(nrmse=0.172, rmse={"position": 0.0043, "velocity": 0.032}),
            after=Score(nrmse=0.012, rmse={"position": 0.00051, "velocity": 0.0041}),
        ),
        noise_floor={"position": 5e-4, "velocity": 4e-3},
        false_alarm_probability=0.01,
        next_experiment="Move the cart at 1 to 10 mm/s: there Coulomb and Stribeck "
        "friction differ by more than the noise.",
        candidates=candidates,
        blame={"carriage": 0.93, "pulley": 0.91},
        fit_before=fit(
            base,
            (
                estimate("mass", 99.0, 0.9, "kg", 96.0),
                estimate("viscous", 291.0, 4.1, "N*s/m", 240.0),
            ),
            0.17,
        ),
        fit_after=fit(
            after,
            (
                estimate("mass", 95.1, 0.2, "kg", 99.0),
                estimate("viscous", 203.5, 0.8, "N*s/m", 291.0),
                f_c,
            ),
            0.011,
        ),
        traces=traces(),
        recovered=(recovered(),),
        notes=("The sign of the force channel was checked against the velocity.",),
        provenance={
            "bondgraph": "0.1.0",
            "seed": 1,
            "recordings": {"bench 07": "sha256 5f2c…", "bench 08": "sha256 91aa…"},
        },
    )
