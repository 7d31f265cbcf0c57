"""A number that is another one from recording to recording is told as such."""

import re

import numpy as np
import pytest
from test_in_time import MASS, SETTINGS, cart, pushed

from bondgraph import diagnose
from bondgraph.diagnosis.answer.one_by_one import differs_between
from bondgraph.diagnosis.evidence.leftover import noise_floor
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.estimate import fit_model
from bondgraph.physics.friction import CoulombFriction


def told_of(recordings):
    base = fit_model(cart(), recordings, SETTINGS)
    return differs_between(base, recordings, noise_floor(recordings))


def heavier(seed):
    """Return a recording of a cart with an other mass than the usual one."""
    return pushed(seed, mass_is=1.5)


def test_the_number_is_told_that_makes_up_for_the_difference():
    told = told_of([pushed(1), heavier(2)])
    assert "By itself each recording is explained" in told
    needed = re.search(r"run 2 needs mass = (\S+) in place of (\S+)\.$", told)
    assert needed is not None
    there, here = map(float, needed.groups())
    assert (here, there) == pytest.approx((MASS, 1.5 * MASS), rel=0.01)


def test_recordings_of_one_machine_do_not_differ():
    assert told_of([pushed(1), pushed(2)]) == ""
    assert told_of([heavier(1)]) == ""


def test_what_is_missing_in_all_of_them_is_no_difference():
    held = {"held": 4.0}
    assert told_of([pushed(1, **held), pushed(2, **held)]) == ""


def test_a_diagnosis_says_so():
    options = Options(library=(CoulombFriction(),), settings=SETTINGS)
    runs = [pushed(1), heavier(2)]
    answer = diagnose(cart(), runs, held_out=[pushed(3)], options=options)
    assert "run 2 needs mass" in answer.statement
    assert np.isfinite(answer.held_out.after.nrmse)
