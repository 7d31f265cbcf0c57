"""A diagnosis as JSON: the contract that programs read.

The keys ``schema``, ``verdict``, ``findings``, ``fit``, ``noise_floor``,
``false_alarm_probability``, ``next_experiment``, ``candidates`` and ``model`` keep
their meaning within one schema number; the others may grow. Numbers are SI, finite or
null: JSON has no infinity, and a null says that there is no number.
"""

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bondgraph.diagnosis.experiment.records import DIGITS, Experiment
from bondgraph.diagnosis.records import (
    SCHEMA,
    Comparison,
    Diagnosis,
    Evidence,
    Finding,
    RecoveredLaw,
)
from bondgraph.fitting.result import Estimate, FitResult, Score
from bondgraph.reporting.files import write_text
from bondgraph.reporting.model_text import describe_difference, to_python

JsonValue = None | bool | int | float | str | list[Any] | dict[str, Any]


def diagnosis_to_dict(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return a diagnosis as dicts, lists, strings and finite numbers.

    Parameters
    ----------
    diagnosis
        Any diagnosis, whatever its verdict.
    """
    model = delivered(diagnosis).model
    return {
        "schema": SCHEMA,
        "verdict": diagnosis.verdict.value,
        "statement": diagnosis.statement,
        "complete": diagnosis.complete,
        "findings": [_finding(finding) for finding in diagnosis.findings],
        "fit": {
            "train": _comparison(diagnosis.train),
            "held_out": _comparison(diagnosis.held_out),
            "before": _fit(diagnosis.fit_before),
            "after": _fit(diagnosis.fit_after),
            "all": _fit(delivered(diagnosis)),
        },
        "noise_floor": json_value(diagnosis.noise_floor),
        "false_alarm_probability": json_value(diagnosis.false_alarm_probability),
        "next_experiment": {
            "statement": diagnosis.next_experiment,
            **_experiment(diagnosis.experiment),
        },
        "candidates": [_evidence(candidate) for candidate in diagnosis.candidates],
        "model": to_python(model),
        "changes": list(describe_difference(diagnosis.model_before, model)),
        "blame": json_value(diagnosis.blame),
        "recovered": [_recovered(law) for law in diagnosis.recovered],
        "notes": list(diagnosis.notes),
        "provenance": json_value(diagnosis.provenance),
    }


def delivered(diagnosis: Diagnosis) -> FitResult:
    """Return the fit whose model is the one to use from here.

    It is the improved model fitted to all recordings, where that was done, else to the
    training recordings.
    """
    return diagnosis.fit_all or diagnosis.fit_after


def write_json(diagnosis: Diagnosis, path: Path | str) -> None:
    """Write a diagnosis as JSON to the file at `path`.

    Raises
    ------
    BondGraphError
        If the file cannot be written.
    """
    data = diagnosis_to_dict(diagnosis)
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)
    write_text(path, f"{text}\n")


def json_value(value: object) -> JsonValue:
    """Return `value` in JSON's own types; what is not a finite number becomes null.

    Types that JSON does not have (a path, a date) become their string.
    """
    match value:
        case None | bool():
            return value
        case str():
            return str(value)  # an enumeration's word, without its class
        case np.generic() | np.ndarray():
            return json_value(value.tolist())
        case int():
            return int(value)
        case float():
            return float(value) if math.isfinite(value) else None
        case Mapping():
            return {str(key): json_value(item) for key, item in value.items()}
        case Iterable():
            return [json_value(item) for item in value]
        case _:
            return str(value)


def _experiment(experiment: Experiment | None) -> dict[str, Any]:
    """Return what was designed; nothing where nothing was."""
    if experiment is None:
        return {}
    return {
        "status": experiment.status.name.lower(),
        "between": list(experiment.between),
        "sigmas": json_value(experiment.sigmas),
        "recorded_sigmas": json_value(experiment.recorded_sigmas),
        "inputs": [
            {"name": one.name, "sigmas": json_value(one.sigmas)}
            for one in experiment.inputs
        ],
        "sensors": [
            {
                "quantity": one.quantity,
                "place": one.place,
                "sigmas": json_value(one.sigmas),
            }
            for one in experiment.sensors
        ],
        "recording": {
            name: [float(f"{value:.{DIGITS}g}") for value in values]
            for name, values in experiment.columns.items()
        },
    }


def _finding(finding: Finding) -> dict[str, Any]:
    # What joins two junctions is at the other one as much as at the first.
    ends = [finding.other_end] if finding.other_end else []
    return {
        "physics": finding.physics,
        "place": finding.place,
        "domain": finding.domain,
        "element": finding.element,
        "other_end": finding.other_end,
        "indistinguishable_places": [*finding.indistinguishable_places, *ends],
        "alternatives": [_evidence(a) for a in finding.alternatives],
        "statement": finding.statement,
        "law": finding.law,
        "parameters": _parameters(finding.estimates),
        "probability": json_value(finding.probability),
    }


def _evidence(evidence: Evidence) -> dict[str, Any]:
    return {
        "physics": evidence.physics,
        "place": evidence.place,
        "domain": evidence.domain,
        "law": evidence.law,
        "support": evidence.support.value,
        "gain": json_value(evidence.gain),
        "gain_std": json_value(evidence.gain_std),
        "train_nrmse": json_value(evidence.train_nrmse),
        "held_out_nrmse": json_value(evidence.held_out_nrmse),
        "reason": evidence.reason,
        "parameters": _parameters(evidence.estimates),
    }


def _parameters(estimates: Iterable[Estimate]) -> dict[str, Any]:
    return {
        estimate.name: {
            "value": json_value(estimate.value),
            "std": json_value(estimate.std),
            "unit": estimate.unit,
            "start": json_value(estimate.start),
        }
        for estimate in estimates
    }


def _comparison(comparison: Comparison) -> dict[str, Any]:
    return {"before": _score(comparison.before), "after": _score(comparison.after)}


def _score(score: Score) -> dict[str, Any]:
    return {"nrmse": json_value(score.nrmse), "rmse": json_value(score.rmse)}


def _fit(fit: FitResult) -> dict[str, Any]:
    return {
        "status": fit.status.name.lower(),
        "sentence": fit.status.value,
        "parameters": _parameters(fit.estimates),
        "unidentifiable": list(fit.unidentifiable),
        "cost": json_value(fit.cost),
        "iterations": fit.iterations,
        "window": json_value(fit.window),
    }


def _recovered(law: RecoveredLaw) -> dict[str, Any]:
    return {
        "place": law.place,
        "argument": {"name": law.argument_name, "unit": law.argument_unit},
        "value": {"name": law.value_name, "unit": law.value_unit},
        "points": [json_value(law.argument), json_value(law.value)],
        "curve": [json_value(law.curve_argument), json_value(law.curve_value)],
        "others": [
            {
                "physics": other.physics,
                "curve": [json_value(other.argument), json_value(other.value)],
            }
            for other in law.others
        ],
    }
