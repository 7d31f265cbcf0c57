"""A stop holds, or is hardly passed: losses that set in on the way are no end of it."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.candidates import Candidate, propose_all
from bondgraph.diagnosis.search.trials.impossible import STOPS_NOTHING, impossible
from bondgraph.diagnosis.search.trials.trying import Start, Trial, restored
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.position import EndStop
from bondgraph.structure.signals import f, parameter_symbol, q

TIME = np.arange(0.0, 10.0, 0.02)


@pytest.fixture(scope="module")
def base():
    """A sled on a spring that is pushed to and fro by some 30 mm, as fitted."""
    g = BondGraph("sled", domain="translation")
    g.one("sled", Se("push"), I("mass"), C("spring"), R("film"))
    g.measure("position", displacement="sled")
    g.parameter("mass", 1.0, "kg", std=0.0)
    g.parameter("spring", 0.02, "m/N", std=0.0)
    g.parameter("film", 4.0, "N*s/m", bounds=(0, 100))
    graph, push = g.finish(), 1.5 * np.sin(2.0 * TIME)
    moved = 0.03 * np.sin(2.0 * TIME - 0.2)
    channels = {"push": (push, "N"), "position": (moved, "m")}
    return fit_model(
        graph,
        [bind_to(graph, Recording.from_arrays("run", TIME, channels))],
        FitSettings(),
    )


@pytest.fixture(scope="module")
def behind_a_rod():
    """A sled far from its origin that a drive moves by a rod; the drive is read."""
    g = BondGraph("drive and sled", domain="translation")
    g.one("drive", Se("push"), I("armature"))
    g.zero("rod")
    g.one("stretch", C("rod_spring"), R("rod_loss"))
    g.one("sled", I("mass"), R("film"))
    for other in ("drive", "rod"), ("rod", "stretch"), ("rod", "sled"):
        g.join(*other)
    g.measure("position", displacement="drive")
    g.parameter("film", 4.0, "N*s/m", bounds=(0, 100))
    for name, value, unit in (
        ("armature", 0.5, "kg"),
        ("mass", 0.5, "kg"),
        ("rod_spring", 1e-3, "m/N"),
        ("rod_loss", 3.0, "N*s/m"),
    ):
        g.parameter(name, value, unit, std=0.0)
    graph, push = g.finish(), 1.5 * np.sin(2.0 * TIME)
    moved = 5.0 - 0.17 * np.sin(2.0 * TIME + 1.1)
    channels = {"push": (push, "N"), "position": (moved, "m")}
    return fit_model(
        graph,
        [bind_to(graph, Recording.from_arrays("run", TIME, channels))],
        FitSettings(),
    )


def stopped(base, at, stiffness, damping):
    """Return the sled with an upper stop of these numbers."""
    stops = (one for one in propose_all(base, [EndStop()]) if one.place == "sled")
    law = next(one for one in stops if "upper" in one.words)
    numbers = dict(zip(law.parameters, (at, stiffness, damping), strict=True))
    fitted = restored(base, Trial(law, (Start({**base.values, **numbers}),)))
    return Candidate(law, fitted, 3)


@pytest.mark.parametrize(
    ("at", "stiffness", "damping", "reason"),
    [
        pytest.param(0.0, 0.1, 3e3, STOPS_NOTHING, id="a film that grows thin"),
        pytest.param(0.0, 500.0, 3e3, None, id="a soft stop"),
        pytest.param(0.022, 0.1, 1e6, None, id="clay, hardly dented"),
        pytest.param(1.0, 500.0, 3e3, None, id="never reached"),
    ],
)
def test_a_stop_holds_or_is_hardly_passed(base, at, stiffness, damping, reason):
    assert impossible(stopped(base, at, stiffness, damping)) == reason


def test_where_it_is_follows_from_what_is_read(behind_a_rod):
    film, soft = (stopped(behind_a_rod, 5.0, k, 300.0) for k in (0.01, 500.0))
    assert impossible(film) == STOPS_NOTHING
    assert impossible(soft) is None


@pytest.mark.parametrize("at_once", [False, True], ids=["as pressed", "from touch"])
@pytest.mark.parametrize("side", [1, -1], ids=["upper", "lower"])
def test_a_stop_pushes_and_never_pulls(base, side, at_once):
    laws = propose_all(base, (EndStop(),))
    end = "upper" if side > 0 else "lower"
    own = [one for one in laws if f"{end}_stop_sled" in one.parameters]
    (law,) = (one.law for one in own if ("first touch" in one.words) == at_once)
    numbers = {"": 0.0, "_stiffness": 300.0, "_damping": 700.0}
    known = {
        parameter_symbol(f"{end}_stop{stem}_sled"): value
        for stem, value in numbers.items()
    }

    def push(speed):
        return side * float(law.subs({**known, q: side, f: side * speed}))

    assert push(0.0) == pytest.approx(300.0)
    assert push(0.1) == pytest.approx(370.0)
    assert push(-0.1) == pytest.approx(230.0)
    assert push(-5.0) == 0.0
