"""Making cases: what the tool may see in one folder, the truth in another."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from benchmarks.concealed.accepted import OUTSIDE, accepted
from benchmarks.concealed.cases import Case
from benchmarks.concealed.curves import true_curve
from benchmarks.concealed.effects import Effect, law_of
from benchmarks.concealed.excitation import HELD_OUT, TRAINING
from benchmarks.concealed.fitted import parameter_noise
from benchmarks.concealed.machine import Array, Machine
from benchmarks.concealed.recording import Plan, Run, plan, replayed, scales_of
from benchmarks.concealed.strength import (
    Absorbed,
    Truth,
    amplitude_for,
    noise_levels,
)

WRONG = 0.2
SPREAD = 0.1
"""Nominal values are up to 20 % wrong; individual machines differ by 10 %."""


def make(case: Case, public: Path, sealed: Path) -> None:
    """Write one case; nothing is done where it has been written already."""
    done = sealed / f"{case.name}.json"
    if done.exists():
        return
    random = np.random.default_rng(case.seed)
    truth = _truth(case, random)
    effects = _effects(case, truth)
    folder = public / case.name
    folder.mkdir(parents=True, exist_ok=True)
    runs: dict[str, tuple[Plan, Run]] = {}
    for i, one in enumerate(truth.plans, start=1):
        runs[f"train_{i}"] = one, truth.run(one, effects, exact=False)
    kind = HELD_OUT[int(random.integers(len(HELD_OUT)))]
    held_out = plan(case.machine, kind, case.seed + 7, case.nuisance)
    runs["held_out"] = held_out, truth.run(held_out, effects, exact=False)
    for name, (_, run) in runs.items():
        _write_csv(folder / f"{name}.csv", case.machine, run)
    nominal = _nominal(case.machine, truth.values, random)
    (folder / "model.py").write_text(_model(case.machine, nominal), "utf-8")
    _write_json(
        folder / "case.json",
        {
            "model": "model.py",
            "train": ["train_1.csv", "train_2.csv"],
            "held_out": ["held_out.csv"],
            "options": ["--hold", "zero"],
        },
    )
    sealed.mkdir(parents=True, exist_ok=True)
    _write_json(done, _sealed(case, truth, effects, runs, kind))


def _truth(case: Case, random: np.random.Generator) -> Truth:
    """Draw an individual machine and what is played on it."""
    machine = case.machine
    values = dict(machine.values)
    for name in machine.free:
        values[name] *= 1.0 + random.uniform(-SPREAD, SPREAD)
    plans = tuple(
        plan(machine, kind, case.seed + i, case.nuisance)
        for i, kind in enumerate(TRAINING)
    )
    return Truth(
        machine=machine,
        values=values,
        scales=scales_of(machine, plans),
        plans=plans,
    )


def _effects(case: Case, truth: Truth) -> tuple[Effect, ...]:
    """Choose amplitudes so that every effect alone has the case's strength."""
    if not case.sites:
        return ()
    if any(site.silent for site in case.sites):
        return tuple(Effect(site, 0.3 * site.largest) for site in case.sites)
    absorbed = Absorbed.of(truth)
    return tuple(
        Effect(site, amplitude_for(absorbed, site, case.strength))
        for site in case.sites
    )


def _sealed(
    case: Case,
    truth: Truth,
    effects: Sequence[Effect],
    runs: Mapping[str, tuple[Plan, Run]],
    kind: str,
) -> dict[str, object]:
    """Return what is true of a case, with what a perfect model would leave."""
    machine = case.machine
    absorbed = Absorbed.of(truth) if effects else None
    alone = [
        absorbed.strength([effect]).tolist() if absorbed else [] for effect in effects
    ]
    together = absorbed.strength(effects).tolist() if absorbed else []
    ideal = _floor(truth, effects, *runs["held_out"])
    curve = true_curve(truth, effects, absorbed) if absorbed else None
    silent = any(effect.site.silent for effect in effects)
    outside = any(law_of(effect.site) in OUTSIDE for effect in effects)
    return {
        "case": case.name,
        "machine": machine.name,
        "domains": machine.domains,
        "seed": case.seed,
        "expected": (
            "adequate"
            if silent or not effects
            else ("unexplained" if outside else "physics_missing")
        ),
        "wanted_strength": case.strength,
        "effect_over_noise": 0.0 if silent else max(together, default=0.0),
        "effect_over_noise_by_output": together,
        "nuisance": asdict(case.nuisance),
        "held_out_excitation": kind,
        "values": truth.values,
        "achievable_held_out_rmse": ideal,
        "fitted_held_out_rmse": (
            _fitted_floor(
                truth, effects, *runs["held_out"], np.array(list(ideal.values()))
            )
            if effects
            else ideal
        ),
        "effects": [
            {
                "physics": effect.site.word,
                "law": law_of(effect.site),
                "place": effect.site.place,
                "amplitude": effect.amplitude,
                "silent": effect.site.silent,
                "outside": law_of(effect.site) in OUTSIDE,
                "effect_over_noise": max(strength),
                "accepted": [asdict(one) for one in accepted(machine, effect.site)],
                "curve": curve,
            }
            for effect, strength in zip(effects, alone, strict=True)
        ],
    }


def _floor(
    truth: Truth, effects: Sequence[Effect], plan: Plan, run: Run
) -> dict[str, float]:
    """Return the rms error of the true machine on a recording: noise and rounding."""
    true = truth.run(replayed(plan, run.commands), effects, exact=True)
    error = run.readings - true.readings
    level = np.sqrt(np.mean(error**2, axis=0))
    level = np.where(np.isfinite(level), level, noise_levels(truth.machine))
    return _by_output(truth.machine, level)


def _by_output(machine: Machine, values: Array) -> dict[str, float]:
    names = [sensor.name for sensor in machine.sensors]
    return dict(zip(names, map(float, values), strict=True))


def _fitted_floor(
    truth: Truth, effects: Sequence[Effect], plan: Plan, run: Run, ideal: Array
) -> dict[str, float]:
    """Return the same for the true structure with fitted numbers."""
    added = parameter_noise(truth, effects, plan, run.commands)
    return _by_output(truth.machine, np.hypot(ideal, added))


def _nominal(
    machine: Machine, values: Mapping[str, float], random: np.random.Generator
) -> dict[str, float]:
    """Return what the user believes: free parameters up to 20 % wrong."""
    return {
        n.name: values[n.name] * (1 + random.uniform(-WRONG, WRONG) * n.free)
        for n in machine.numbers
        if not n.hidden
    }


def _model(machine: Machine, nominal: Mapping[str, float]) -> str:
    """Return the text of the base model."""
    lines = []
    for number in machine.numbers:
        if number.hidden:
            continue
        value = float(f"{nominal[number.name]:.3g}" if number.free else number.value)
        unit = f'"{number.unit}"'
        known = "std=0.0"
        if number.free:
            known = f"bounds=({value / 20:.1g}, {value * 20:.1g})"
        lines.append(
            f'    machine.parameter("{number.name}", {value!r}, {unit}, {known})'
        )
    return machine.model.replace("{parameters}", "\n".join(lines))


def _write_csv(path: Path, machine: Machine, run: Run) -> None:
    names = [f"{name} [{unit}]" for name, unit in machine.inputs]
    names += [f"{sensor.name} [{sensor.unit}]" for sensor in machine.sensors]
    columns = np.column_stack((run.time, run.commands, run.readings))
    np.savetxt(
        path,
        columns,
        fmt="%.9g",
        delimiter=",",
        header=",".join(("time [s]", *names)),
        comments="",
    )


def _write_json(path: Path, content: object) -> None:
    path.write_text(json.dumps(content, indent=1, default=float) + "\n", "utf-8")
