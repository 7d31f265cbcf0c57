"""What is left out together: every fourth chunk, or a quarter in one piece."""

import numpy as np
import pytest
from carts import free_cart

from bondgraph import FitSettings, Recording, WholeRecordings, bind_to
from bondgraph.diagnosis.evidence import left_out
from bondgraph.diagnosis.evidence.left_out import FOLDS, left_out_errors
from bondgraph.fitting.estimate import fit_model

CHUNKS, COUNT = 8, 240


@pytest.fixture
def fitted():
    time = np.linspace(0.0, 6.0, COUNT)
    graph = free_cart()
    units = {
        **{one.name: graph.input_unit(one.name) for one in graph.inputs},
        **{one.name: one.unit for one in graph.measurements},
    }
    channels = {name: (np.sin(time), unit) for name, unit in units.items()}
    recording = bind_to(graph, Recording.from_arrays("made", time, channels))
    return fit_model(graph, [recording], FitSettings(horizon=WholeRecordings()))


@pytest.mark.parametrize(("in_one", "pieces"), [(False, 2), (True, 1)])
def test_a_quarter_is_left_out_in_one_piece_or_in_several(
    fitted, monkeypatch, in_one, pieces
):
    hidden = []

    def seen(_, test, __):
        hidden.append(test.copy())
        return np.zeros((COUNT, len(fitted.problem.model.output_names)))

    monkeypatch.setattr(left_out, "_fold_residuals", seen)
    left_out_errors(fitted, CHUNKS, in_one=in_one)
    assert len(hidden) == FOLDS
    assert np.all(np.sum(hidden, axis=0) == 1)
    for test in hidden:
        begun = np.diff(test.astype(int), prepend=0) == 1
        assert np.count_nonzero(test) == COUNT // FOLDS
        assert np.count_nonzero(begun) == pieces
