"""What a model needs of a recording, found from the graph itself."""

import numpy as np
import pytest

from bondgraph.errors import RecordingError
from bondgraph.recordings.model_channels import bind_to, channels_of, read_for
from bondgraph.recordings.recording import Recording
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import C, I, R, Se
from bondgraph.structure.signals import displacement

TIME = 0.1 * np.arange(20)


def cart(domain):
    graph = BondGraph("cart", domain=domain)
    graph.one("carriage", Se("force"), I("mass"), C("spring"), R("viscous"))
    graph.measure("position", displacement="carriage")
    return graph


def pixels(unit="px"):
    channels = {"force": (np.sin(TIME), "V"), "position": (np.cos(TIME), unit)}
    return Recording.from_arrays("run", TIME, channels)


def test_a_domain_gives_the_units():
    channels = channels_of(cart("translation").finish())
    assert channels.inputs == {"force": "N"}
    assert channels.outputs == {"position": "m"}
    assert channels.unchecked == frozenset()


def test_the_analogue_domain_takes_the_units_of_the_recording():
    bound = bind_to(cart("analogue").finish(), pixels())
    assert (bound.input_units, bound.output_units) == (("V",), ("px",))
    assert np.array_equal(bound.output("position"), np.cos(TIME))


def test_a_unit_that_the_author_gave_is_checked_in_the_analogue_domain():
    graph = cart("analogue")
    graph.measure("pixels", displacement("spring"), unit="px")
    assert channels_of(graph.finish()).unchecked == {"force", "position"}
    mapping = {"pixels": "position"}
    assert bind_to(graph.finish(), pixels(), mapping=mapping).output_units[1] == "px"
    with pytest.raises(RecordingError, match="'pixels' of the model is in 'px'"):
        bind_to(graph.finish(), pixels("mm"), mapping=mapping)


def test_a_wrong_unit_is_refused_where_the_domain_has_one():
    with pytest.raises(RecordingError, match="does not convert") as caught:
        bind_to(cart("translation").finish(), pixels())
    assert "(force=force[N])" in str(caught.value)  # The way out can be typed.


def test_reading_converts_to_the_model_s_units_and_leaves_the_rest(tmp_path):
    path = tmp_path / "run.csv"
    rows = [f"{t:.1f},{100 * np.cos(t):.12g},1,broken" for t in TIME]
    header = "time [s],position [cm],force [N],note"
    path.write_text("\n".join([header, *rows]) + "\n")
    bound = read_for(cart("translation").finish(), path)
    assert bound.output("position") == pytest.approx(np.cos(TIME))
    assert "note" in bound.unused
