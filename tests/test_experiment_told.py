"""The answer says what to play next and what sensors see; its model runs."""

import json
from dataclasses import replace
from functools import partial

import carts
import numpy as np
import pytest
from carts import free_cart
from handmade_diagnosis import cart_diagnosis
from test_experiment import alternatives

from bondgraph import read_recording
from bondgraph.diagnosis.answer.look_alikes import look_alikes
from bondgraph.diagnosis.answer.separating import Rivalry, designed, left_close
from bondgraph.diagnosis.candidates import Candidate, propose_all
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.evidence.gain import Gain
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support, Verdict
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Windows
from bondgraph.loading import load_model
from bondgraph.physics.library import LIBRARY
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict
from bondgraph.reporting.model_text import to_python
from bondgraph.reporting.report import report_html

NAMES = ("Coulomb (dry) friction at wheel", "quadratic drag at wheel")


recorded = partial(carts.recorded, duration=6.0)


def rivalry():
    fits, recordings = alternatives()
    return Rivalry(names=NAMES, models=tuple(fits)), recordings


def judged(fitted, word, support, gain):
    """Return a candidate at the wheel as if it had been judged."""
    library = tuple(physics for physics in LIBRARY if physics.word == word)
    hypothesis = next(h for h in propose_all(fitted, library) if h.place == "wheel")
    graph = hypothesis.apply(fitted.graph)
    values = {**fitted.values, **hypothesis.starts[-1]}
    known = {p.name: values[p.name] for p in graph.parameters.members if not p.exact}
    tried = fit_model(
        graph.with_parameters(known), [recorded(3)], FitSettings(horizon=Windows(200))
    )
    errors = LeftOutErrors(np.ones(8))
    told = Gain(gain, 0.1, 0.5)
    return Judged(Candidate(hypothesis, tried, 1), errors, told, support, "by hand")


def test_the_answer_names_what_the_experiment_separates(tmp_path):
    found, notes = designed(*rivalry())
    assert notes == ()
    assert found.between == NAMES
    assert found.statement.startswith(
        "To tell Coulomb (dry) friction at wheel from quadratic drag at wheel: play a "
    )
    assert found.sigmas > 2 * found.recorded_sigmas > 0.0
    answer = replace(
        cart_diagnosis(), next_experiment=found.statement, experiment=found
    )
    told = json.loads(json.dumps(diagnosis_to_dict(answer)))["next_experiment"]
    assert told["statement"] == found.statement
    assert told["sigmas"] == pytest.approx(found.sigmas)
    assert told["inputs"][0]["name"] == found.input.name
    # What the JSON says to play is what the file says to play.
    (tmp_path / "play.csv").write_text(found.csv, encoding="utf-8")
    played = read_recording(tmp_path / "play.csv")
    np.testing.assert_array_equal(
        told["recording"]["force [N]"], played.channel("force").values
    )
    np.testing.assert_array_equal(told["recording"]["time [s]"], played.time)
    page = report_html(answer)
    assert 'data-copy="experiment-csv"' in page
    assert found.csv.splitlines()[-1] in page
    assert "Velocity at wheel" in page  # the further sensor


def test_a_design_that_fails_says_why():
    close, (recording,) = rivalry()
    still = replace(recording, inputs=np.full_like(recording.inputs, 1.0))
    found, (note,) = designed(close, [still])
    assert found is None
    assert "No experiment was designed to tell Coulomb" in note
    assert "No input has a range to move in" in note


def test_a_table_of_operating_points_has_no_signal_to_design():
    close, (recording,) = rivalry()
    assert designed(close, [replace(recording, steady=True)]) == (None, ())


def test_undecided_laws_are_separated_from_nothing_more():
    settings = FitSettings(horizon=Windows(200))
    base = fit_model(free_cart(), [recorded(3)], settings)
    first = Round(
        base,
        judged=(
            judged(base, "coulomb_friction", Support.UNDECIDED, 0.1),
            judged(base, "quadratic_drag", Support.REFUTED, 0.0),
        ),
    )
    close = left_close([first], {}, Verdict.CANNOT_TELL)
    assert close.names == ("nothing more", "Coulomb (dry) friction at wheel")
    assert close.nested
    found, notes = designed(close, [recorded(3)])
    assert notes == ()
    # The friction, which is not there, was fitted to next to nothing.
    assert found.recorded_sigmas < 5.0
    assert left_close([first], {}, Verdict.ADEQUATE) is None


def test_places_that_free_signals_do_not_tell_apart_are_named_beside_a_finding():
    (finding,) = cart_diagnosis().findings
    recording = recorded(3)
    base = fit_model(free_cart(), [recording], FitSettings(horizon=Windows(200)))
    (note,) = look_alikes([replace(finding, place="wheel")], base, [recording])
    assert note == (
        "Before any law: free signals at wheel, force and position look alike to these "
        "sensors; measuring the velocity at wheel would tell wheel or force from "
        "position."
    )
    assert look_alikes([], base, [recording]) == ()


def test_the_improved_model_as_text_runs_and_is_adequate(tmp_path):
    friction = tuple(p for p in LIBRARY if p.word == "coulomb_friction")
    training, held_out = recorded(1, coulomb=1.0), recorded(2, coulomb=1.0)
    found = diagnose(
        free_cart(),
        [training],
        held_out=[held_out],
        options=Options(library=friction),
    )
    assert [finding.physics for finding in found.findings] == ["coulomb_friction"]
    text = diagnosis_to_dict(found)["model"]
    path = tmp_path / "improved.py"
    path.write_text(text, encoding="utf-8")
    improved = load_model(str(path))
    # As text once more it is the same text: nothing is lost on the way.
    assert to_python(improved) == text
    again = diagnose(improved, [training], held_out=[held_out])
    assert again.verdict is Verdict.ADEQUATE, again.statement
