"""The rival methods: how much they may believe, and how their answers are counted."""

import json

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmarks.concealed.others.comparing import TOOL, of_the_tool, table
from benchmarks.concealed.others.stepwise import effective, worth_it


def test_coloured_noise_is_worth_fewer_samples():
    white = np.random.default_rng(1).standard_normal((200_000, 2))
    slow = lfilter([1], [1, -0.9], white, axis=0)
    assert effective(white.reshape(-1), 2) == pytest.approx(400_000, rel=0.02)
    # Bartlett: (1 - φ) / (1 + φ) of them.
    assert effective(slow.reshape(-1), 2) == pytest.approx(400_000 * 0.1 / 1.9, rel=0.1)


def test_an_effect_enters_where_schwarz_s_criterion_falls():
    white = np.random.default_rng(2).standard_normal(10_000)
    # n log(RSS / RSS') = 1e4 · 2 log(factor) against log(1e4) = 9.2
    assert worth_it(white * 1.0006, white, 1)
    assert not worth_it(white * 1.0003, white, 1)


def truth(name, *effects, strength=8.0):
    accepted = [{"words": ["coulomb_friction"], "places": ["cart", "mass"]}]
    told = [
        {"law": law, "place": "cart", "silent": False, "outside": law == "odd",
         "accepted": accepted}
        for law in effects
    ]  # fmt: skip
    return {"case": name, "effect_over_noise": strength, "effects": told,
            "machine": "cart", "achievable_held_out_rmse": {"x": 1.0}}  # fmt: skip


def answer(*findings, after=1.0):
    listed = [
        {"physics": physics, "place": place, "indistinguishable_places": [],
         "alternatives": [{"physics": "coulomb_friction", "place": "cart"}]}
        for physics, place in findings
    ]  # fmt: skip
    errors = {
        "before": {"nrmse": 4.0, "rmse": {}},
        "after": {"nrmse": after, "rmse": {}},
    }
    verdict = "physics_missing" if findings else "adequate"
    return {"verdict": verdict, "findings": listed, "fit": {"held_out": errors}}


def test_of_the_tool_counts_what_it_says_first_and_nothing_beside(tmp_path):
    answers, sealed = tmp_path / "answers", tmp_path / "truth"
    told = {
        "a": (truth("a", "coulomb_friction"), answer(("coulomb_friction", "mass"))),
        "b": (truth("b", "coulomb_friction"), answer(("spring", "cart"), after=4.4)),
        "c": (truth("c", "odd"), answer()),
        "d": (truth("d"), answer(("spring", "cart"))),
        "e": (truth("e", "coulomb_friction", strength=1.0), answer()),
    }
    for name, (true, said) in told.items():
        for folder, content in ((sealed, true), (answers, said)):
            folder.mkdir(exist_ok=True)
            (folder / f"{name}.json").write_text(json.dumps(content), "utf-8")
    rows = of_the_tool(answers, sealed, {*told, "not run"})
    assert [row["both"] for row in rows] == [True, False, False, False, False]
    assert [row["place"] for row in rows] == [True, True, False, False, False]
    (line,) = [text for text in table(rows).splitlines() if TOOL in text]
    # Two strong effects that have a name: one right, one worse on held-out data.
    cells = [cell.split(" (")[0].strip() for cell in line.split("|")[2:-1]]
    assert cells == ["2", "2", "1", "1", "1", "1", "68 %", "1"]
