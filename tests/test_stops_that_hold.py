"""A stop holds, or is hardly passed: losses that set in on the way are no end of it."""

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.candidates import Candidate, propose_all
from bondgraph.diagnosis.search.trials.impossible import STOPS_NOTHING, impossible
from bondgraph.diagnosis.search.trials.trying import Start, Trial, restored
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.position import EndStop

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


def stopped(base, at, stiffness, damping):
    """Return the sled with an upper stop of these numbers."""
    law = next(one for one in propose_all(base, [EndStop()]) if "upper" in one.words)
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
