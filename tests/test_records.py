"""Records that hold arrays are compared as objects: arrays have no one truth value."""

import dataclasses
import importlib
import pkgutil

import numpy as np
import pytest

import bondgraph
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors


def _records():
    for found in pkgutil.walk_packages(bondgraph.__path__, "bondgraph."):
        if found.name.endswith("__main__"):
            continue
        module = importlib.import_module(found.name)
        for kind in vars(module).values():
            if isinstance(kind, type) and dataclasses.is_dataclass(kind):
                yield kind


def _holds_arrays(kind):
    types = (str(field.type) for field in dataclasses.fields(kind))
    return any("Array" in one or "ndarray" in one for one in types)


HOLD_ARRAYS = sorted(
    {kind for kind in _records() if _holds_arrays(kind)},
    key=lambda kind: (kind.__module__, kind.__name__),
)


def test_many_records_hold_arrays():
    assert LeftOutErrors in HOLD_ARRAYS
    assert len(HOLD_ARRAYS) > 50


@pytest.mark.parametrize("kind", HOLD_ARRAYS, ids=lambda kind: kind.__name__)
def test_a_record_that_holds_arrays_is_not_compared_value_by_value(kind):
    # `==`, `in` and `index` of a list would raise where two begin alike.
    assert not kind.__dataclass_params__.eq


def test_one_of_two_alike_is_found_in_a_list():
    errors = [LeftOutErrors(np.ones(3), np.zeros(0), 3, 0.0) for _ in range(2)]
    assert errors.index(errors[1]) == 1
    assert errors[0] != errors[1]
