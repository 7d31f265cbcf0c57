"""The cookbook: every law is told, shown, and its example is the law itself."""

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bondgraph import LIBRARY
from bondgraph.physics.descriptions import describe
from bondgraph.physics.hypothesis import AbstractPhysics, Passivity
from bondgraph.reporting.differences import describe_difference
from bondgraph.reporting.model_text import to_python

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs"))

from bookmaking.formulae import formula  # noqa: E402
from bookmaking.scenes import SCENES  # noqa: E402
from bookmaking.staging import Play, play  # noqa: E402

NAMES = [type(physics).__name__ for physics in LIBRARY]
BY_NAME: dict[str, AbstractPhysics] = dict(zip(NAMES, LIBRARY, strict=True))


@cache
def shown(name: str) -> Play:
    return play(BY_NAME[name], SCENES[name])


def test_every_law_is_told_and_shown_and_no_other():
    assert list(SCENES) == NAMES
    assert all(describe(physics) is not None for physics in LIBRARY)


def test_a_law_of_ones_own_has_no_description():
    class MyOwn(AbstractPhysics):
        word, reference = "my_own", "nobody"

        def propose(self, place):
            yield from ()

    assert describe(MyOwn()) is None


@pytest.mark.parametrize("name", NAMES)
def test_what_a_law_is_taken_for_is_another_law_of_the_library(name):
    told = describe(BY_NAME[name])
    assert told is not None
    assert told.confusions
    assert told.sources
    others = [confusion.other for confusion in told.confusions]
    assert len(set(others)) == len(others)
    assert set(others) <= set(NAMES) - {name}


@pytest.mark.parametrize("name", NAMES)
def test_the_law_is_seen_in_its_output(name):
    seen = shown(name)
    spread = np.ptp(seen.true) + np.ptp(seen.simple)
    assert np.abs(seen.true - seen.simple).max() > 0.02 * spread


@pytest.mark.parametrize("name", NAMES)
def test_the_example_of_a_page_is_the_machine_of_its_picture(name):
    seen = shown(name)
    namespace: dict[str, object] = {}
    exec(compile(to_python(seen.complete), name, "exec"), namespace)
    model = namespace["model"]
    assert callable(model)
    again = model().finish()
    assert not describe_difference(again, seen.complete)
    assert describe_difference(seen.without, seen.complete)


RESISTIVE = [
    name
    for name in NAMES
    if BY_NAME[name].passivity is Passivity.DISSIPATIVE
    and (SCENES[name].across, SCENES[name].up)
    in {("flow(carriage)", "effort(*)"), ("effort(tank)", "flow(*)")}
]


@pytest.mark.parametrize("name", RESISTIVE)
def test_the_curve_of_what_only_takes_power_lies_in_two_quadrants(name):
    seen = shown(name)
    assert (seen.across * seen.up >= -1e-9).all()
    assert (seen.across * seen.up).max() > 0.0


def test_formulas_have_the_letters_of_the_field():
    written = formula(shown("ViscousFriction"), SCENES["ViscousFriction"])
    assert written.block.splitlines()[1] == r"e &= f \, \mathrm{viscous}"
    assert written.letters == {"f": "the velocity there"}
    memory = formula(shown("DahlHysteresis"), SCENES["DahlHysteresis"]).block
    assert r"\dot{z} &=" in memory


def test_pictures_are_the_same_every_time_and_take_the_colour_of_the_page():
    pytest.importorskip("matplotlib")
    from bookmaking.signatures import INK, curve  # noqa: PLC0415

    drawn = [curve(shown("CoulombFriction"), ("v [m/s]", "F [N]")) for _ in range(2)]
    assert drawn[0] == drawn[1]
    assert drawn[0].startswith("<svg")
    assert INK not in drawn[0]
    assert "currentColor" in drawn[0]
