"""What a law adds has to be determined; what a curve leaves nothing of need not be."""

from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search.trials import determined as module
from bondgraph.diagnosis.search.trials.determined import REASON, determined
from bondgraph.physics.places.base import PROPOSED

NAMES = ("bearing", "drag", "height")
LOW = np.array([1e-6, 0.0, -np.inf])


def fitted(null, bearing, stated):
    """Return a fit of a bearing, a drag and a law's height; `null` tells nothing.

    The model alone tells a bearing of 1e-6 as little.
    """
    problem = SimpleNamespace(
        free_names=NAMES,
        free=np.arange(3),
        low=LOW,
        high=np.full(3, np.inf),
        start=np.array([stated, 8e-5, 0.0]),
        model=SimpleNamespace(parameter_names=NAMES),
    )
    units = {name: SimpleNamespace(unit="1", source=None) for name in NAMES}
    return SimpleNamespace(
        problem=problem,
        optimum=SimpleNamespace(theta=np.array([bearing, 8e-5, 0.3]), null=null),
        graph=SimpleNamespace(parameters=units),
        values=dict(zip(NAMES, (bearing, 8e-5, 0.3), strict=True)),
    )


@pytest.fixture
def told(monkeypatch):
    """Return a function that says why a law is left aside, if it is."""
    monkeypatch.setattr(
        module,
        "uncertainty",
        lambda _, optimum: SimpleNamespace(
            null=np.array(optimum.null, dtype=float).reshape(-1, 3),
            std=np.full(3, 1e-7),
        ),
    )

    def told(physics, null, bearing, *, stated=None, is_slip=False):
        stated = bearing if stated is None else stated
        law = SimpleNamespace(
            physics=physics,
            strengths=("height",),
            parameters=("height",),
            is_slip=is_slip,
        )
        own = fitted([null], bearing, stated)
        candidate = SimpleNamespace(hypothesis=law, fitted=own)
        kept, others = determined(fitted([], bearing, stated), [candidate])
        assert len(kept) + len(others) == 1
        return others[0].reason if others else None

    return told


def test_what_is_at_its_least_beside_a_curve_need_not_be_told(told):
    assert told(CURVE, (1.0, 0.0, 0.0), bearing=1e-6) is None
    assert told("drag", (1.0, 0.0, 0.0), bearing=1e-6) == REASON


def test_what_is_there_and_is_not_told_beside_a_curve_is_held_against_it(told):
    assert told(CURVE, (1.0, 0.0, 0.0), bearing=1e-3) == REASON


def test_a_curve_may_share_with_what_is_there(told):
    assert told(CURVE, (0.7, 0.0, 0.7), bearing=1e-3) is None
    assert told("drag", (0.7, 0.0, 0.7), bearing=1e-3) == REASON


def test_what_was_plugged_wrong_adds_no_number_to_be_determined(told):
    assert told("input_swap", (1.0, 0.0, 0.0), bearing=0.1, is_slip=True) is None
    assert told("input_scale", (1.0, 0.0, 0.0), bearing=0.1) == REASON


def test_of_what_has_run_away_nothing_was_told(told):
    # Twice what is stated is a number; a hundred times is what a law was missing for.
    assert told("drag", (1.0, 0.0, 0.0), bearing=0.2, stated=0.1) == REASON
    assert told("drag", (1.0, 0.0, 0.0), bearing=0.2, stated=2e-3) is None
    assert told("drag", (0.7, 0.0, 0.7), bearing=0.2, stated=2e-3) == REASON


@pytest.mark.parametrize(
    ("source", "lag", "mode", "hollow"),
    [
        (PROPOSED, 5.0, 5.0, True),
        (PROPOSED, 0.1, 5.0, False),
        (PROPOSED, 5.0, 0.1, False),
        (None, 5.0, 5.0, False),  # What the author's own numbers lose is nothing.
    ],
)
def test_a_law_may_not_leave_without_a_number_all_that_was_found(
    monkeypatch, source, lag, mode, hollow
):
    def fit(**errors):
        sources = {name: SimpleNamespace(source=None) for name in errors}
        sources["lag"] = SimpleNamespace(source=source)
        return SimpleNamespace(
            problem=SimpleNamespace(free_names=list(errors)),
            optimum=SimpleNamespace(theta=np.ones(len(errors)), std=[*errors.values()]),
            graph=SimpleNamespace(parameters=sources),
        )

    monkeypatch.setattr(module, "uncertainty", lambda _, optimum: optimum)
    law = SimpleNamespace(parameters=("mode",))
    candidate = SimpleNamespace(
        hypothesis=law, fitted=fit(gain=0.1, lag=lag, mode=mode)
    )
    before = fit(gain=0.1, lag=0.1)
    assert module._leaves_nothing_told(candidate, before) is hollow
