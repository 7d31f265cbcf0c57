"""The controller for a drive with dry friction: where its zero and its gain belong.

In a test that repeats, a dry friction F acts to first harmonic as a viscous one of
4 F / (π V), V the amplitude of the joint's speed (`flegx_models.tuned_zeros`). With
that in its place the diagnosed model is linear: its friction pole is one of its own
poles, the lead's zero is laid on it (section 5.2), and the gain is the largest that the
prototype with ζ = 0.6 allows. Whatever else was found, a delay or a spring, is in the
plant that the gain is sized for.
"""

import math

from bondgraph import (
    Design,
    Lead,
    Loop,
    LoopMeasures,
    ReplaceRelation,
    SecondOrderPrototype,
    Specification,
    ZeroPoleGain,
    f,
    measure,
    shape,
    state_space,
    zero_pole_gain,
)
from bondgraph.structure.graph import FinishedGraph
from flegx_models.controllers import controller, printed_loop
from flegx_models.parameters_control import CONTROL
from flegx_models.tuned_zeros import tuning_tests

STILL = 1e-6  # rad/s: poles slower than this are the angle's integrator


def rubbed(
    graph: FinishedGraph, element: str, dry: float, speed: float
) -> FinishedGraph:
    """Return the graph with a dry friction replaced by the viscous one it acts as.

    Parameters
    ----------
    element
        The R of the friction.
    dry
        F in N·m, at its place.
    speed
        V in rad/s there: the joint's times the ratio from the place to the joint.
    """
    return ReplaceRelation(element, 4 * dry / (math.pi * speed) * f).apply(graph)


def plant_of(graph: FinishedGraph) -> ZeroPoleGain:
    """Return the plant from motor torque (N·m) to joint angle (rad)."""
    return zero_pole_gain(state_space(graph), output="theta", input="T_motor")


def friction_pole(plant: ZeroPoleGain) -> float:
    """Return the slowest real pole beside the integrator, as a magnitude in rad/s."""
    return min(real_poles(plant))


def real_poles(plant: ZeroPoleGain) -> list[float]:
    """Return the real poles beside the integrator, as magnitudes in rad/s."""
    real = [-p.real for p in plant.poles if abs(p.imag) <= STILL * abs(p)]
    return [pole for pole in real if pole > STILL]


def speed_of_the_test(model: str) -> float:
    """Return V of the joint in rad/s in the tuning test of a model (section 6.1)."""
    return next(test.speed for test in tuning_tests() if test.model == model)


def designed(model: str, plant: ZeroPoleGain, *, filtered: bool) -> Design:
    """Return the lead for a plant: zero on the friction pole, gain by the prototype.

    Parameters
    ----------
    filtered
        Whether to put the encoder's filter into the feedback; False where the plant
        has it already, as a diagnosed one that was recorded behind the filter.
    """
    lead = Lead(zero=friction_pole(plant), pole=controller(model).pole)
    prototype = SecondOrderPrototype(CONTROL.values_by_name()["damping_prototype"])
    return shape(
        plant,
        lead,
        Specification(prototype=prototype),
        feedback=printed_loop(model).loop.feedback if filtered else ZeroPoleGain(),
    )


def around(plant: ZeroPoleGain, design: Design) -> LoopMeasures:
    """Return what a design comes to around another plant than its own."""
    return measure(Loop(plant=plant, controller=design.controller.transfer), step=False)
