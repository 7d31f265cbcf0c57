"""What does not matter to a diagnosis: workers, order, units, names of things."""

import json
from dataclasses import replace

import numpy as np
import pytest
from test_interrupted import LAWS, pulled, slider

from bondgraph import TF, BondGraph, R, Recording, Sf, bind_to
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.work import workers
from bondgraph.diagnosis.work.workers import Here, Processes
from bondgraph.physics.library import LIBRARY
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict

OPTIONS = Options(
    library=tuple(physics for physics in LIBRARY if physics.word in LAWS),
    most_findings=1,
    where=Here(),
)


def diagnosed(graph, recordings, options=OPTIONS):
    training, held_out = recordings
    return diagnose(graph, [training], held_out=[held_out], options=options)


def both(graph, change=lambda recording: recording):
    return [change(pulled(graph, 1, 600)), change(pulled(graph, 2, 300))]


def told(diagnosis, force=1.0):
    """Return what was found, and the viscosity and errors, with forces in `force` N."""
    (finding,) = diagnosis.findings
    viscosity = diagnosis.fit_after.estimates[0].value / force
    nrmse = (diagnosis.train.after.nrmse, diagnosis.held_out.after.nrmse)
    gains = [one.gain for one in diagnosis.candidates if one.gain > 0.1]
    return diagnosis.verdict, finding.physics, viscosity, nrmse, sorted(gains)


def assert_same(one, other, rel):
    assert one[:2] == other[:2]
    for a, b in zip(one[2:], other[2:], strict=True):
        assert b == pytest.approx(a, rel=rel, nan_ok=True)


@pytest.fixture(scope="module")
def plain():
    graph = slider()
    return diagnosed(graph, both(graph))


def test_one_worker_or_two_give_every_digit_the_same(plain, monkeypatch):
    monkeypatch.setattr(workers, "POOL_PAYS", 0.0)
    graph = slider()
    shared = diagnosed(graph, both(graph), replace(OPTIONS, where=Processes(2)))
    one, two = (json.dumps(diagnosis_to_dict(d)) for d in (plain, shared))
    assert one == two


def test_the_order_of_candidates_does_not_matter(plain):
    turned = replace(OPTIONS, library=OPTIONS.library[::-1])
    graph = slider()
    found = diagnosed(graph, both(graph), turned)
    assert_same(told(plain), told(found), rel=1e-9)


def rewritten(graph, units, scales):
    """Return a change to recordings: other units, and the channels turned round."""

    def change(recording):
        values = {
            "speed": recording.inputs[:, 0] * scales[0],
            "force": recording.outputs[:, 0] * scales[1],
        }
        channels = {name: (values[name], units[name]) for name in ("force", "speed")}
        return bind_to(
            graph, Recording.from_arrays(recording.name, recording.time, channels)
        )

    return change


def test_millimetres_that_say_so_and_the_order_of_channels_change_nothing(plain):
    graph = slider()
    units = {"speed": "mm/s", "force": "kN"}
    change = rewritten(graph, units, (1e3, 1e-3))
    found = diagnosed(graph, both(graph, change))
    assert_same(told(plain), told(found), rel=1e-6)


def test_a_machine_a_million_times_stronger_is_the_same_machine(plain):
    scaled = [
        replace(p, value=2e6, bounds=(0.0, 1e8)) if p.name == "rub" else p
        for p in slider().parameters.members
    ]
    strong = slider().with_parameters(scaled)
    change = rewritten(strong, {"speed": "m/s", "force": "N"}, (1.0, 1e6))
    found = diagnosed(strong, both(strong, change))
    assert_same(told(plain), told(found, force=1e6), rel=1e-6)


PLAIN = "motor speed bearing joint seal gear torque arm hinge tendon".split()
NAMES = {
    "as they are": PLAIN,
    "backward in the alphabet": [
        f"{chr(122 - sorted(PLAIN).index(name))}_{name}" for name in PLAIN
    ],
    "of no sense": "Zeta alpha _q9 beta Kappa nu rho omicron Delta mm".split(),
}


def geared(name):
    """A gear train whose friction none of its three places is told from the others."""
    graph = BondGraph("drive", domain="rotation")
    graph.one(name["motor"], Sf(name["speed"]), R(name["bearing"]))
    graph.one(name["joint"], R(name["seal"]))
    graph.one(name["arm"], R(name["hinge"]))
    graph.join(name["motor"], TF(name["gear"]), name["joint"])
    graph.join(name["joint"], TF(name["tendon"]), name["arm"])
    graph.measure(name["torque"], effort=name["speed"])
    graph.parameter(name["bearing"], 0.6, "N*m*s/rad", bounds=(0, 100))
    for part in ("seal", "hinge"):
        graph.parameter(name[part], 0.3, "N*m*s/rad", std=0.0)
    for part in ("gear", "tendon"):
        graph.parameter(name[part], 2.0, "1", std=0.0)
    return graph.finish()


def turned(graph, name, seed):
    random = np.random.default_rng(seed)
    speed = 0.05 * np.cumsum(random.standard_normal(400))
    speed -= speed.mean()
    torque = 2.2 * speed + 0.5 * np.sign(speed) + 0.01 * random.standard_normal(400)
    channels = {name["speed"]: (speed, "rad/s"), name["torque"]: (torque, "N*m")}
    time = 0.01 * np.arange(400)
    return bind_to(graph, Recording.from_arrays(f"turn {seed}", time, channels))


def told_of_the_gears(called):
    """Return what is found and what was tried, in the plain names."""
    name = dict(zip(PLAIN, called, strict=True))
    plain = {new: old for old, new in name.items()}
    graph = geared(name)
    found = diagnosed(graph, [turned(graph, name, seed) for seed in (1, 2)])
    findings = [
        (
            one.physics,
            plain[one.place],
            [plain[x] for x in one.indistinguishable_places],
        )
        for one in found.findings
    ]
    tried = {
        (one.physics, plain[one.place], one.support, round(one.gain, 9))
        for one in found.candidates
    }
    return found.verdict, findings, tried


def test_other_names_of_elements_and_channels_change_nothing():
    plain, *others = (told_of_the_gears(called) for called in NAMES.values())
    assert plain[1] == [("coulomb_friction", "motor", ["joint", "arm"])]
    assert len(plain[2]) > 5
    for other in others:
        assert other == plain
