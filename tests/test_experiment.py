"""The next experiment separates what the recordings so far leave close."""

import numpy as np
import pytest
import sympy
from concealed import cart

from bondgraph import (
    BondGraph,
    FitSettings,
    I,
    InsertElement,
    R,
    Recording,
    Se,
    Windows,
    bind_to,
    f,
    read_recording,
)
from bondgraph.diagnosis.experiment.next_experiment import next_experiment
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import fit_model
from bondgraph.structure.parameters import Parameter


def graph():
    made = BondGraph("cart", domain="translation")
    made.one("wheel", Se("force"), I("mass"), R("viscous"))
    made.measure("position", displacement="wheel")
    made.parameter("mass", 1.3, "kg", bounds=(0.01, 100))
    made.parameter("viscous", 2.0, "N*s/m", bounds=(0, 100))
    return made.finish()


def alternatives():
    """Return dry friction and drag, each fitted to a cart that has dry friction."""
    time, force, position = cart(1, duration=4.0, coulomb=0.3)
    channels = {"force": (force, "N"), "position": (position, "m")}
    recording = bind_to(graph(), Recording.from_arrays("cart", time, channels))
    size = sympy.Symbol("size", real=True)
    known = Parameter(name="size", value=0.1, unit="1", bounds=(0, 10))
    laws = (size * sympy.tanh(f / 0.01), size * f * sympy.Abs(f))
    fits = [
        fit_model(
            InsertElement("wheel", R("missing", law=law), (known,)).apply(graph()),
            [recording],
            FitSettings(horizon=Windows(100)),
        )
        for law in laws
    ]
    return fits, [recording]


def test_an_input_is_designed_that_beats_the_others_and_can_be_played(tmp_path):
    fits, recordings = alternatives()
    found = next_experiment(fits, recordings)
    assert found.sigmas == max(proposal.sigmas for proposal in found.inputs)
    assert found.sigmas > 10.0
    assert f"{float(f'{found.sigmas:.2g}'):.0f} sigmas" in found.statement
    force = found.input.channel("force").values
    assert force.min() >= recordings[0].inputs.min() - 1e-9
    assert force.max() <= recordings[0].inputs.max() + 1e-9
    path = tmp_path / "play.csv"
    found.write_csv(path)
    played = read_recording(path)
    np.testing.assert_allclose(played.channel("force").values, force, rtol=1e-7)


def test_models_that_do_the_same_are_separated_by_nothing():
    fits, recordings = alternatives()
    found = next_experiment([fits[0], fits[0]], recordings)
    assert found.sigmas == pytest.approx(0.0, abs=1e-3)
    assert "No input" in found.statement


def test_one_alternative_is_refused():
    fits, recordings = alternatives()
    with pytest.raises(FitError, match="at least two"):
        next_experiment(fits[:1], recordings)
