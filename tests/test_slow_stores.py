"""A state that hardly fades while anything is recorded is a constant, and no store."""

import numpy as np
from physics_machines import MACHINES, scales_of

from bondgraph import BondGraph, C, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.candidates import Candidate, propose_all
from bondgraph.diagnosis.search.trials.determined import REASON, determined
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.viscoelastic import RelaxingSpring

FADES = {"lag", "lag_each", "relaxation_time", "fill_time", "induced_time"}
STEP, SAMPLES = 0.01, 600
WHOLE = FitSettings(horizon=WholeRecordings())


def test_no_state_of_the_library_fades_later_than_ten_recordings():
    most = {}
    for graph in MACHINES.values():
        scales = scales_of(graph)
        for place in all_places(graph, scales):
            for physics in LIBRARY:
                for hypothesis in physics.propose(place):
                    fitted = hypothesis.apply(graph).parameters
                    for name in hypothesis.parameters:
                        stem = name.removesuffix(f"_{place.name}")
                        if stem in FADES:
                            bound = fitted[name].bounds[1]
                            most.setdefault(stem, set()).add(bound / scales.stretch)
    assert most == {stem: {10.0} for stem in FADES}


def arm():
    graph = BondGraph("arm on a spring", domain="rotation")
    graph.one("arm", Se("torque"), I("inertia"), R("bearing"), C("spring"))
    graph.measure("angle", displacement="arm")
    graph.parameter("inertia", 0.02, "kg*m^2", std=0.0)
    graph.parameter("bearing", 0.05, "N*m*s/rad")
    graph.parameter("spring", 1.0, "rad/(N*m)")
    return graph.finish()


def swung(graph, seed, biased):
    """Return a recording in which a constant torque acts beside the recorded one."""
    rng = np.random.default_rng(seed)
    time = STEP * np.arange(SAMPLES)
    torque = np.repeat(rng.uniform(-1.0, 1.0, SAMPLES // 60), 60)
    angle, speed, read = 0.0, 0.0, np.empty(SAMPLES)
    for i, acts in enumerate(torque + biased):
        read[i] = angle
        for _ in range(50):
            speed += STEP / 50 * (acts - 0.06 * speed - angle / 0.9) / 0.02
            angle += STEP / 50 * speed
    read += 1e-3 * rng.standard_normal(SAMPLES)
    channels = {"torque": (torque, "N*m"), "angle": (read, "rad")}
    return bind_to(graph, Recording.from_arrays(f"made {seed}", time, channels))


def error(fitted):
    return np.sqrt(np.mean(fitted.residuals() ** 2))


def test_a_spring_that_never_relaxes_is_left_aside():
    graph = arm()
    recordings = [swung(graph, 1, 0.4), swung(graph, 2, -0.3)]
    base = fit_model(graph, recordings, WHOLE)
    (relaxing,) = propose_all(base, (RelaxingSpring(),))
    never = {"relaxing_stiffness_arm": 0.5, "relaxation_time_arm": 50.0}
    fitted = fit_model(relaxing.apply(graph).with_parameters(never), recordings, WHOLE)
    assert error(fitted) < 0.1 * error(base)
    kept, others = determined(base, [Candidate(relaxing, fitted, complexity=2)])
    assert not kept
    assert [one.reason for one in others] == [REASON]
