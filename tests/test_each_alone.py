"""What happens at another moment in every recording is told of each by itself."""

import re

import pytest
from test_in_time import SETTINGS, STEP, cart, pushed

from bondgraph import diagnose
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.moments import DisturbanceStep
from bondgraph.physics.sensing import SensorBias

MOMENTS = {"run 1": 5.2, "run 2": 12.9, "run 3": 9.0}
HELD = 4.0


def answer_of(recordings):
    *train, last = recordings
    options = Options(library=(CoulombFriction(), DisturbanceStep()), settings=SETTINGS)
    return diagnose(cart(), train, held_out=[last], options=options)


def test_each_recording_is_told_with_its_own_moment():
    answer = answer_of(
        [
            pushed(seed, held=HELD, moment=moment)
            for seed, moment in enumerate(MOMENTS.values(), 1)
        ]
    )
    assert answer.verdict in (Verdict.UNEXPLAINED, Verdict.CANNOT_TELL)
    for name in ("run 1", "run 2"):
        told = re.search(
            rf"once in {name}, it is explained by itself by disturbance step at "
            r"carriage \(.*?"
            r"step_carriage = (\S+) N, moment_carriage = (\S+) s\)",
            answer.statement,
        )
        assert told is not None
        assert float(told[1]) == pytest.approx(-HELD, rel=0.05)
        assert float(told[2]) == pytest.approx(MOMENTS[name], abs=2 * STEP)
    assert "once in run 3" not in answer.statement


def test_what_is_explained_all_together_is_not_told_of_each():
    answer = answer_of([pushed(seed, held=HELD) for seed in (1, 2, 3)])
    assert answer.verdict is Verdict.PHYSICS_MISSING
    assert "explained by itself" not in answer.statement


def test_where_a_common_moment_leaves_much_each_is_told_with_its_own():
    own = (8.0, 9.4, 8.6)
    runs = [pushed(seed, held=HELD, moment=at) for seed, at in enumerate(own, 1)]
    answer = answer_of(runs)
    assert answer.verdict is Verdict.PHYSICS_MISSING
    told = re.findall(
        r"once in (run \d), .*?moment_carriage = (\S+) s", answer.statement
    )
    assert [name for name, _ in told] == ["run 1", "run 2"]
    assert [float(at) for _, at in told] == pytest.approx(own[:2], abs=2 * STEP)


def test_what_is_so_from_the_begin_did_not_happen_once():
    runs = [
        pushed(seed, held=held, moment=-1.0)
        for seed, held in enumerate((HELD, -HELD, HELD), 1)
    ]
    *train, last = runs
    options = Options(library=(SensorBias(), DisturbanceStep()), settings=SETTINGS)
    answer = diagnose(cart(), train, held_out=[last], options=options)
    assert answer.verdict in (Verdict.UNEXPLAINED, Verdict.CANNOT_TELL)
    assert "something happened once" not in answer.statement
