"""Where a curve was found, what is tried beside it leaves time to draw it."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from judged_candidates import judged

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search import one_round as module
from bondgraph.diagnosis.search.one_round import one_round
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.trials.judging import Verdicts
from bondgraph.diagnosis.work.limit import Limit

HOUR = 3600.0


@pytest.mark.parametrize("found", [True, False])
def test_half_of_the_time_that_is_left(monkeypatch, found):
    curve = judged(0.02, physics=CURVE, place="wagon", complexity=8)
    limit, ends = Limit.after(HOUR), []
    whole = limit.end
    chosen = curve if found else None
    seen = module._Seen(replace(Verdicts(), chosen=chosen), ())
    nothing = SimpleNamespace(promised=(), rejected=(), independent=1.0)
    for name, stand_in in {
        "considered": lambda _: [],
        "screen": lambda *_: nothing,
        "_led": lambda *_: seen,
        "_judged": lambda *_: seen,
        "explainable": lambda *_: 1.0,
        "run_away": lambda *_: {"mass": 0.0},
        "fit_whatever": lambda *_: ends.append(limit.end),
        "fit_remembering": lambda *_: ends.append(limit.end),
        "with_curve_drawn": lambda *_: (),
    }.items():
        monkeypatch.setattr(module, name, stand_in)
    monkeypatch.setattr(module.Bench, "of", lambda *_: None)
    setting = SimpleNamespace(
        base=None, options=Options(), number=1, is_first=True, noise=None,
        supported=frozenset(), is_piece=lambda _: True,
    )  # fmt: skip
    one_round(setting, SimpleNamespace(limit=limit))
    left = [(end - whole) / HOUR for end in ends]
    assert left == pytest.approx([-0.5, -0.5] if found else [0.0, 0.0], abs=0.05)
    assert limit.end == whole
