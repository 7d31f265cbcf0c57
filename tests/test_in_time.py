"""What changes with time, evenly or at one moment, where what passes comes back."""

import numpy as np
import pytest

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    Hold,
    I,
    R,
    Recording,
    Se,
    bind_to,
    diagnose,
    fit,
)
from bondgraph.diagnosis.lasting import lasting
from bondgraph.diagnosis.records import Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.bias import ConstantBias
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.in_time import ParameterDrift
from bondgraph.physics.moments import DisturbanceStep, ParameterStep
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.thermal import TemperatureDependentResistance

STEP, COUNT = 0.01, 2000
MOMENT = 8.3
MASS, DRAG, SPRING = 2.0, 6.0, 0.02
SETTINGS = FitSettings(hold=Hold.ZERO)


def cart():
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("push"), I("mass"), R("drag"), C("spring"))
    graph.parameter("mass", 1.1 * MASS, "kg")
    graph.parameter("drag", 0.8 * DRAG, "N*s/m")
    graph.parameter("spring", SPRING, "m/N")
    graph.measure("position", displacement="carriage")
    return graph.finish()


def pushed(
    seed,
    *,
    drag_grows=0.0,
    mass_grows=0.0,
    push_grows=0.0,
    drag_steps=0.0,
    held=0.0,
    mass_is=1.0,
    moment=MOMENT,
):
    """Return a recording of a cart of which a number grows by a share per second.

    Or of which the drag grows by a share, or that is held back by a force, from
    `moment` on. Or whose mass is so many times the usual one.
    """
    rng = np.random.default_rng(seed)
    push = np.repeat(rng.uniform(-30.0, 30.0, COUNT // 25), 25)
    fine = 20
    place = momentum = 0.0
    told = []
    for k, u in enumerate(push):
        told.append(place)
        for j in range(fine):
            now = STEP * (k + j / fine)
            speed = momentum / (MASS * (mass_is + mass_grows * now))
            late = now >= moment
            lost = DRAG * (1.0 + drag_grows * now + drag_steps * late) * speed
            lost += held * late
            momentum += STEP / fine * (u * (1.0 + push_grows * now) - lost)
            momentum -= STEP / fine * place / SPRING
            place += STEP / fine * momentum / (MASS * (mass_is + mass_grows * now))
    read = np.array(told) + 1e-3 * rng.normal(size=COUNT)
    channels = {"push": (push, "N"), "position": (read, "m")}
    time = STEP * np.arange(COUNT)
    return bind_to(cart(), Recording.from_arrays(f"run {seed}", time, channels))


@pytest.mark.parametrize(
    ("grows", "physics", "name"),
    [
        ({"drag_grows": 0.05}, TemperatureDependentResistance(), "drift_drag"),
        ({"mass_grows": 0.02}, ParameterDrift(), "drift_mass"),
        ({"push_grows": -0.01}, ParameterDrift(), "drift_push"),
    ],
    ids=["a loss", "a store", "a battery that sags"],
)
def test_a_number_that_grows_with_time_is_found_at_its_place(grows, physics, name):
    laws = (CoulombFriction(), QuadraticDrag(), TemperatureDependentResistance())
    options = Options(library=(*laws, ParameterDrift()), settings=SETTINGS)
    runs = [pushed(seed, **grows) for seed in (1, 2)]
    answer = diagnose(cart(), runs, held_out=[pushed(3, **grows)], options=options)
    assert answer.verdict is Verdict.PHYSICS_MISSING
    (found,) = answer.findings
    assert found.physics == physics.word
    (size,) = found.estimates
    assert size.name == name
    assert size.value == pytest.approx(sum(grows.values()), rel=0.1)


@pytest.mark.parametrize(
    ("happens", "word", "names"),
    [
        ({"drag_steps": 0.5}, "parameter_step", ("step_drag", "moment_drag")),
        ({"held": 4.0}, "disturbance_step", ("step_carriage", "moment_carriage")),
    ],
    ids=["a loss", "a load"],
)
def test_what_happens_at_one_moment_is_found_with_its_moment(happens, word, names):
    drifting = (TemperatureDependentResistance(), ParameterDrift(), ConstantBias())
    library = (CoulombFriction(), *drifting, ParameterStep(), DisturbanceStep())
    options = Options(library=library, settings=SETTINGS)
    runs = [pushed(seed, **happens) for seed in (1, 2)]
    answer = diagnose(cart(), runs, held_out=[pushed(3, **happens)], options=options)
    assert answer.verdict is Verdict.PHYSICS_MISSING
    (found,) = answer.findings
    assert found.physics == word
    size, moment = found.estimates
    assert (size.name, moment.name) == names
    assert abs(size.value) == pytest.approx(sum(happens.values()), rel=0.05)
    assert moment.value == pytest.approx(MOMENT, abs=STEP)


def test_nothing_is_told_to_happen_where_nothing_does():
    library = (CoulombFriction(), ParameterStep(), DisturbanceStep())
    options = Options(library=library, settings=SETTINGS)
    answer = diagnose(
        cart(), [pushed(1), pushed(2)], held_out=[pushed(3)], options=options
    )
    assert not answer.findings


def test_a_number_that_stays_is_not_told_to_drift():
    (law,) = _proposed(ParameterDrift(), "mass", frozenset({"flow(carriage)"}))
    graph = law.apply(cart())
    found = fit(graph, [pushed(1)], settings=SETTINGS).estimate("drift_mass")
    assert abs(found.value) < 3.0 * found.std


def test_it_is_not_asked_for_where_nothing_comes_back():
    often = frozenset({"flow(carriage)"})
    assert len(_proposed(ParameterDrift(), "spring", often)) == 1
    assert not _proposed(ParameterDrift(), "spring", frozenset())
    for physics, place in (ParameterStep(), "drag"), (DisturbanceStep(), "carriage"):
        assert _proposed(physics, place, often)
        assert not _proposed(physics, place, frozenset())
    warms = TemperatureDependentResistance()
    more = len(_proposed(warms, "drag", often)) - len(
        _proposed(warms, "drag", frozenset())
    )
    assert more == 2


def _proposed(physics, place, going_on):
    scales = Scales(lasting=going_on)
    (here,) = (p for p in all_places(cart(), scales) if p.name == place)
    return list(physics.propose(here))


def test_what_has_died_away_or_gone_one_way_does_not_come_back():
    time = np.concatenate([np.arange(2000) * 0.01] * 2)
    once = np.arange(2000) * 0.01
    shapes = {
        "swings": np.sin(3.0 * once),
        "dies": np.exp(-0.3 * once) * np.sin(3.0 * once),
        "rises": 1.0 - np.exp(-0.3 * once),
        "drifts": 0.05 * once + 1e-3 * np.sin(30.0 * once),
        "unknown": np.full(2000, np.nan),
    }
    signals = {name: np.tile(x, 2) for name, x in shapes.items()}
    assert lasting(time, signals) == {"swings"}
    # One recording in which it goes on is enough.
    mixed = np.concatenate([shapes["dies"], shapes["swings"]])
    assert lasting(time, {"mixed": mixed}) == {"mixed"}
