"""What came first and explained little is chosen again beside what was found since."""

from dataclasses import replace

import numpy as np
import pytest
from test_search_exchange import added, car, driven, judged_beside, proposed, road

from bondgraph import Recording, bind_to
from bondgraph.diagnosis.evidence.gain import Gain
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.reconsidered import LITTLE, reconsidered
from bondgraph.diagnosis.search.round_found import Round, accepted, shares_of
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.physics.drag import QuadraticDrag, SpeedLimit
from bondgraph.physics.friction import CoulombFriction


def searched(first, gain):
    """Return the rounds of a search that found one law, then friction; and its data."""
    base = driven(road)
    law, friction = proposed(base, first), proposed(base, CoulombFriction())
    one = added(base, base, [law])
    both = added(base, one, [law, friction])
    judged = judged_beside(base, law, one)
    little = replace(judged, gain=Gain(gain, 0.01, 0.0))
    rounds = [
        Round(base, chosen=little, judged=(little,)),
        Round(one, chosen=judged_beside(one, friction, both)),
        Round(both),
    ]
    return rounds, law


@pytest.fixture
def choose_again():
    shots = driven(road).problem.shots
    channels = {
        "speed": (shots.inputs[:, 0], "m/s"),
        "force": (shots.outputs[:, 0], "N"),
    }
    recording = bind_to(car(), Recording.from_arrays("run", shots.time, channels))
    options = Options()
    with workshop(Here(), Journal(), lambda _: None) as shop:
        yield lambda rounds: reconsidered(
            rounds, [recording], np.zeros(1), options, shop
        )


def test_a_first_law_gives_way_to_what_fits_beside_the_second(choose_again):
    rounds, limit = searched(SpeedLimit(), gain=0.2)
    *_, again, last = choose_again(rounds)
    assert again.chosen.physics == "quadratic_drag"
    assert again.removed == (limit,)
    assert last.base is again.chosen.candidate.fitted
    assert last.base.values["quadratic_car"] == pytest.approx(0.42, rel=0.05)
    said = {one.chosen.physics for one in accepted([*rounds[:-1], again, last])}
    assert said == {"coulomb_friction", "quadratic_drag"}


def test_the_right_first_law_stays(choose_again):
    rounds, _ = searched(QuadraticDrag(), gain=0.2)
    assert choose_again(rounds) == rounds


def test_the_same_law_is_as_sure_as_it_is_beside_what_was_found_since(choose_again):
    rounds, drag = searched(QuadraticDrag(), gain=0.5)
    unsure = [replace(rounds[0], probability=0.2), *rounds[1:]]
    *_, again, _ = choose_again(unsure)
    assert (again.chosen.physics, again.removed) == ("quadratic_drag", (drag,))
    assert again.probability > 0.5
    # Beside friction it is no shape of that: without it nearly all of it is left.
    assert shares_of([*unsure[1:2], again])[-1] > 0.9


def test_a_fit_that_comes_less_far_says_how_sure_the_same_law_is(
    choose_again, monkeypatch
):
    rounds, drag = searched(QuadraticDrag(), gain=0.5)
    unsure = [replace(rounds[0], probability=0.2), *rounds[1:]]
    monkeypatch.setattr(
        "bondgraph.diagnosis.search.revising.reconsidered.as_good", lambda *_: False
    )
    *_, again, last = choose_again(unsure)
    assert (again.chosen.physics, again.removed) == ("quadratic_drag", (drag,))
    assert again.probability > 0.5
    assert last.base is unsure[-1].base


def test_another_law_that_fits_less_well_does_not_take_the_place(
    choose_again, monkeypatch
):
    rounds, _ = searched(SpeedLimit(), gain=0.2)
    monkeypatch.setattr(
        "bondgraph.diagnosis.search.revising.reconsidered.as_good", lambda *_: False
    )
    assert choose_again(rounds) == rounds


def test_what_explained_much_is_not_asked_again(choose_again):
    rounds, _ = searched(SpeedLimit(), gain=LITTLE)
    assert choose_again(rounds) == rounds


def standing_in():
    """Return rounds of drag, a limit that stood in for friction, and friction."""
    (first, second, last), drag = searched(QuadraticDrag(), gain=0.5)
    limit = proposed(first.base, SpeedLimit())
    stood_in = judged_beside(
        second.base, limit, added(first.base, second.base, [drag, limit])
    )
    unsure = replace(second, probability=0.01)
    return first, Round(second.base, chosen=stood_in), unsure, last


def test_a_choice_beside_a_law_that_was_taken_out_with_it_is_made_again(choose_again):
    first, beside, unsure, last = standing_in()
    assert choose_again([first, unsure, last]) == [first, unsure, last]
    taken = replace(unsure, removed=(beside.chosen.candidate.hypothesis,))
    *_, again, _ = choose_again([first, beside, taken, last])
    assert again.chosen.physics == "coulomb_friction"
    assert again.removed == (unsure.chosen.candidate.hypothesis,)
    assert again.probability > unsure.probability


def test_what_takes_the_place_of_another_was_judged_in_its_place(choose_again):
    first, beside, unsure, last = standing_in()
    law = beside.chosen.candidate.hypothesis
    instead = replace(unsure, removed=(law,), without=1.0)
    rounds = [first, beside, instead, last]
    assert choose_again(rounds) == rounds
