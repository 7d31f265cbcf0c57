"""The JSON of a diagnosis keeps the contract, in JSON's own types only."""

import json
from dataclasses import replace
from pathlib import Path
from types import UnionType
from typing import Any

import numpy as np
import pytest
from handmade_diagnosis import cart_diagnosis

from bondgraph.diagnosis.records import Comparison, Diagnosis, Verdict
from bondgraph.errors import BondGraphError
from bondgraph.fitting.result import Score
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict, json_value, write_json

NUMBER = int | float | None
PARAMETERS = {str: {"value": NUMBER, "std": NUMBER, "unit": str}}
CANDIDATE = {
    "physics": str,
    "place": str,
    "law": str,
    "support": str,
    "gain": NUMBER,
    "gain_std": NUMBER,
    "train_nrmse": NUMBER,
    "held_out_nrmse": NUMBER,
    "reason": str,
    "parameters": PARAMETERS,
}
SCORE = {"nrmse": NUMBER, "rmse": {str: NUMBER}}
CONTRACT: dict[Any, Any] = {
    "schema": int,
    "verdict": str,
    "findings": [
        {
            "physics": str,
            "place": str,
            "element": str,
            "indistinguishable_places": [str],
            "alternatives": [CANDIDATE],
            "statement": str,
            "law": str,
            "parameters": PARAMETERS,
        }
    ],
    "fit": {
        "train": {"before": SCORE, "after": SCORE},
        "held_out": {"before": SCORE, "after": SCORE},
    },
    "noise_floor": {str: NUMBER},
    "false_alarm_probability": NUMBER,
    "next_experiment": {"statement": str},
    "candidates": [CANDIDATE],
    "model": str,
}
"""Keys that must be there, with their types; other keys are welcome."""


def violations(value: Any, shape: Any, where: str = "$") -> list[str]:
    """Return where `value` does not have the `shape`."""
    match shape:
        case type() | UnionType():
            fits = isinstance(value, shape) and not isinstance(value, bool)
            return [] if fits else [f"{where}: {value!r}"]
        case [item]:
            if not isinstance(value, list):
                return [f"{where}: no list"]
            return [
                v
                for k, x in enumerate(value)
                for v in violations(x, item, f"{where}[{k}]")
            ]
        case _ if not isinstance(value, dict):
            return [f"{where}: no object"]
    found = []
    for key, inner in shape.items():
        if key is str:
            for name, item in value.items():
                found += violations(item, inner, f"{where}.{name}")
        elif key not in value:
            found.append(f"{where}.{key}: missing")
        else:
            found += violations(value[key], inner, f"{where}.{key}")
    return found


def through_json(diagnosis: Diagnosis) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(
        json.dumps(diagnosis_to_dict(diagnosis), allow_nan=False)
    )
    return data


def test_the_contract_is_kept() -> None:
    data = through_json(cart_diagnosis())
    assert violations(data, CONTRACT) == []
    assert data["schema"] == 1
    assert data["verdict"] == "physics_missing"
    (finding,) = data["findings"]
    assert finding["physics"] == "coulomb_friction"
    assert finding["place"] == "carriage"
    assert finding["indistinguishable_places"] == ["pulley"]
    assert finding["alternatives"][0]["physics"] == "stribeck_friction"
    assert finding["parameters"]["F_c"]["value"] == 20.41
    assert data["fit"]["held_out"]["before"]["rmse"]["velocity"] == 0.032
    assert data["fit"]["after"]["parameters"]["mass"]["std"] == 0.2
    assert [c["support"] for c in data["candidates"]] == [
        "supported",
        "undecided",
        "refuted",
        "refuted",
    ]
    assert data["changes"][0] == "one R added at carriage"
    assert (
        'graph.put(R("coulomb", law=F_c*sympy.sign(f)), on="carriage")' in data["model"]
    )


def test_the_schema_test_can_fail() -> None:
    data = through_json(cart_diagnosis())
    del data["findings"][0]["law"]
    data["noise_floor"]["position"] = "small"
    assert violations(data, CONTRACT) == [
        "$.findings[0].law: missing",
        "$.noise_floor.position: 'small'",
    ]


@pytest.mark.parametrize("verdict", list(Verdict))
def test_every_verdict_has_the_same_form(verdict: Verdict) -> None:
    base = cart_diagnosis()
    empty = replace(
        base,
        verdict=verdict,
        findings=(),
        candidates=(),
        traces=(),
        recovered=(),
        fit_after=base.fit_before,
    )
    data = through_json(empty)
    assert violations(data, CONTRACT) == []
    assert data["verdict"] == verdict.value
    assert data["changes"] == []


def test_what_is_no_number_becomes_null() -> None:
    base = cart_diagnosis()
    diverged = Score(nrmse=float("nan"), rmse={"position": float("inf")})
    after = base.held_out.after
    data = through_json(
        replace(base, held_out=Comparison(before=diverged, after=after))
    )
    assert violations(data, CONTRACT) == []
    assert data["fit"]["held_out"]["before"] == {
        "nrmse": None,
        "rmse": {"position": None},
    }


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (np.float64(0.5), 0.5),
        (np.int64(3), 3),
        (np.bool_(True), True),
        (np.array([[1.0, np.nan], [np.inf, 2.0]]), [[1.0, None], [None, 2.0]]),
        ((1, "a", None), [1, "a", None]),
        ({1: {"x": Path("a/b")}}, {"1": {"x": "a/b"}}),
        (Verdict.ADEQUATE, "adequate"),
        ((k for k in range(2)), [0, 1]),
    ],
    ids=lambda case: type(case).__name__,
)
def test_values_become_json_types(value: object, expected: object) -> None:
    made = json_value(value)
    assert made == expected
    assert type(made) is type(expected)
    assert json.loads(json.dumps(made)) == expected


def test_the_file_is_json_and_keeps_every_letter(tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    diagnosis = replace(cart_diagnosis(), statement='Größe <b>"µ"</b>')
    write_json(diagnosis, path)
    text = path.read_text(encoding="utf-8")
    assert json.loads(text)["statement"] == 'Größe <b>"µ"</b>'
    assert "Größe" in text
    assert "NaN" not in text


def test_a_file_that_cannot_be_written_is_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(BondGraphError, match="cannot be written") as refusal:
        write_json(cart_diagnosis(), tmp_path / "absent" / "answer.json")
    assert "\n" not in str(refusal.value)
