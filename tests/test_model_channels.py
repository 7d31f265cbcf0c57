"""What a model needs of a recording, found from the graph itself."""

from functools import partial

import numpy as np
import pytest

from bondgraph.diagnosis.diagnose import diagnose
from bondgraph.errors import RecordingError, StructureError
from bondgraph.fitting.estimate import fit
from bondgraph.recordings.model_channels import bind_to, channels_of, matched, read_for
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


def two_carts(first, second):
    graph = BondGraph("carts", domain="translation")
    for name in (first, second):
        graph.one(name, Se(f"force_{name}"), I(f"mass_{name}"))
    graph.one("rope", C("spring"))
    graph.zero("left")
    graph.join(first, "left")
    graph.join("left", "rope")
    graph.zero("right")
    graph.join("rope", "right")
    graph.join("right", second)
    for name in (first, second):
        graph.measure(f"v_{name}", flow=name)
        graph.parameter(f"mass_{name}", 1.0, "kg")
    graph.parameter("spring", 0.1, "m/N")
    return graph.finish()


def recorded_carts():
    wave = {"force_a": (np.sin(TIME), "N"), "force_b": (np.cos(TIME), "N")}
    read = {"v_a": (0.1 * TIME, "m/s"), "v_b": (-0.2 * TIME, "m/s")}
    return Recording.from_arrays("run", TIME, {**wave, **read})


def test_columns_are_taken_by_their_names():
    recording = recorded_carts()
    bound = bind_to(two_carts("a", "b"), recording)
    other = two_carts("b", "a")
    (found,) = matched(other, [bound])
    assert found.input_names == ("force_b", "force_a")
    assert np.array_equal(found.inputs, bind_to(other, recording).inputs)
    assert np.array_equal(found.outputs, bind_to(other, recording).outputs)
    (same,) = matched(two_carts("a", "b"), [bound])
    assert same is bound


def test_a_recording_of_another_model_is_refused():
    bound = bind_to(two_carts("a", "b"), recorded_carts())
    with pytest.raises(RecordingError, match="force_a, force_b, and this one has"):
        matched(cart("translation").finish(), [bound])
    turned = BondGraph("turned", domain="rotation")
    turned.one("joint", Se("force"), I("mass"))
    turned.measure("position", displacement="joint")
    metres = bind_to(cart("translation").finish(), in_metres())
    with pytest.raises(RecordingError, match="bound in 'N', and 'turned' has it in"):
        matched(turned.finish(), [metres])


def in_metres():
    channels = {"force": (np.sin(TIME), "N"), "position": (np.cos(TIME), "m")}
    return Recording.from_arrays("run", TIME, channels)


def test_no_recording_and_one_given_twice_are_refused():
    graph = cart("translation").finish()
    bound = bind_to(graph, in_metres())
    with pytest.raises(RecordingError, match="no recording of 'cart'"):
        fit(graph, [])
    for call in (fit, partial(diagnose, held_out=[bound])):
        with pytest.raises(RecordingError, match="'run' and 'run' hold the same"):
            call(graph, [bound, bound])


def test_a_channel_is_not_an_input_and_a_measurement():
    graph = cart("translation").finish()
    with pytest.raises(RecordingError, match="'force' would be the input 'force'"):
        bind_to(graph, in_metres(), mapping={"position": "force"})
    named_alike = cart("translation")
    named_alike.measure("force", effort="mass")
    with pytest.raises(StructureError, match="'force' is an input and a measurement"):
        named_alike.finish()


def test_a_recording_that_is_not_bound_yet_is_told_so_and_how():
    graph = cart("analogue").finish()
    for work in fit, partial(diagnose, held_out=[]):
        with pytest.raises(RecordingError, match="not bound to 'cart'") as told:
            work(graph, [pixels()])
        assert "bind_to(graph, recording)" in str(told.value)
        with pytest.raises(RecordingError, match=r"\[recording\]"):
            work(graph, bind_to(graph, pixels()))
        with pytest.raises(RecordingError, match=r"A str is no.*read_for"):
            work(graph, ["run.csv"])
