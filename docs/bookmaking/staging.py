"""A scene played: the machine without the law and with it, from the same rest."""

from dataclasses import dataclass, replace

import numpy as np
import sympy

from bondgraph import (
    FinishedGraph,
    Hypothesis,
    RunStatus,
    Scales,
    all_places,
    displacement,
    effort,
    flow,
    momentum,
    simulate_inputs,
)
from bondgraph.physics.hypothesis import AbstractPhysics
from bondgraph.structure.graph import Measurement
from bookmaking.scenes import Array, Drive, Scene

SIGNALS = {
    "effort": effort,
    "flow": flow,
    "momentum": momentum,
    "displacement": displacement,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Play:
    """What a scene shows.

    Parameters
    ----------
    hypothesis, without, complete
        The law as a diagnosis would insert it, the model that leaves it out, and the
        model with it and with the scene's numbers.
    time, simple, true
        Seconds; the output of the model without and with the law.
    across, up
        The law's own variables in the complete model.
    """

    hypothesis: Hypothesis
    without: FinishedGraph
    complete: FinishedGraph
    time: Array
    simple: Array
    true: Array
    across: Array
    up: Array


def forms(physics: AbstractPhysics, scene: Scene) -> tuple[Hypothesis, ...]:
    """Return every form in which the law is tried at the scene's place."""
    graph = scene.machine()
    places = all_places(graph, _scales(graph, scene))
    found = (h for p in places if p.name == scene.place for h in physics.propose(p))
    return tuple(found)


def play(physics: AbstractPhysics, scene: Scene) -> Play:
    """Return what is seen with and without the law.

    Raises
    ------
    ValueError
        If the scene names other parameters than the law has, or the run did not end.
    """
    hypothesis = forms(physics, scene)[0]
    own = {name: name.removesuffix(f"_{scene.place}") for name in hypothesis.parameters}
    if set(own.values()) != set(scene.values):
        raise ValueError(f"{physics.word} has the parameters {sorted(own.values())}")
    without = scene.machine()
    complete = hypothesis.apply(without).with_parameters(
        {name: scene.values[stem] for name, stem in own.items()}
    )
    time = np.arange(0.0, scene.seconds, scene.step)
    read = (_expression(scene.across, hypothesis), _expression(scene.up, hypothesis))
    probed = replace(
        complete,
        measurements=(
            *complete.measurements,
            *(Measurement(f"read_{i}", x, "1") for i, x in enumerate(read)),
        ),
    )
    simple = _run(without, time, scene)
    full = _run(probed, time, scene)
    return Play(
        hypothesis=hypothesis,
        without=without,
        complete=complete,
        time=time,
        simple=simple[scene.output],
        true=full[scene.output],
        across=full["read_0"],
        up=full["read_1"],
    )


def _run(graph: FinishedGraph, time: Array, scene: Scene) -> dict[str, Array]:
    drive = {name: _sampled(course, time) for name, course in scene.drive.items()}
    run = simulate_inputs(graph, time, inputs=drive)
    if run.status is not RunStatus.SUCCESSFUL:
        raise ValueError(f"{graph.name}: {run.reason}")
    return dict(zip(run.output_names, run.outputs.T, strict=True))


def _sampled(course: Drive, time: Array) -> Array:
    return np.array([course(t) for t in time])


def _expression(words: str, hypothesis: Hypothesis) -> sympy.Expr:
    """Return the signal that ``[-]quantity(place)`` names, or the law."""
    if words == "law":
        return hypothesis.law.xreplace(_at(hypothesis.element))
    sign = -1 if words.startswith("-") else 1
    quantity, _, place = words.removeprefix("-").removesuffix(")").partition("(")
    return sign * SIGNALS[quantity](place.replace("*", hypothesis.element))


def _at(element: str) -> dict[sympy.Symbol, sympy.Expr]:
    return {sympy.Symbol(q[0], real=True): s(element) for q, s in SIGNALS.items()}


def _scales(graph: FinishedGraph, scene: Scene) -> Scales:
    """Return sizes of everything that start values would be measured in."""
    sizes = {
        f"{quantity}({node.name})": 1.0 for quantity in SIGNALS for node in graph.nodes
    }
    return Scales(sizes, {}, scene.step, scene.seconds)
