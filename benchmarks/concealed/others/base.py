"""The base model fitted to a case's recordings, by least squares of the simulator."""

import json
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.concealed.machine import Array, Machine
from benchmarks.concealed.machines import MACHINES
from benchmarks.concealed.recording import Nuisance, Plan, plan, replayed, simulate
from benchmarks.concealed.strength import noise_levels

ITERATIONS = 6
STEP = 1e-4


@dataclass(frozen=True, slots=True)
class Played:
    """A recording: the plan that plays its inputs again, and readings (N, ny)."""

    plan: Plan
    readings: Array


@dataclass(frozen=True, slots=True)
class FittedBase:
    """Values of the base model after the fit, and what it leaves per recording."""

    machine: Machine
    values: dict[str, float]
    train: tuple[Played, ...]
    held_out: Played

    def simulated(self, played: Played, **change: float) -> Array:
        """Return the base model's readings."""
        values = {**self.values, **change}
        return simulate(self.machine, played.plan, values=values, exact=True).readings

    def residual(self, played: Played) -> Array:
        """Return measured minus simulated, over the noise."""
        error = played.readings - self.simulated(played)
        return error / noise_levels(self.machine)

    def tangents(self, played: Played) -> Array:
        """Return readings over noise per relative change, (free, N, ny)."""
        base = self.simulated(played)
        return np.array(
            [
                (self.simulated(played, **{n: self.values[n] * (1 + STEP)}) - base)
                / STEP
                / noise_levels(self.machine)
                for n in self.machine.free
            ]
        )


def fitted_base(case: Path) -> FittedBase:
    """Read a public case and fit its base model's free parameters."""
    told = json.loads((case / "case.json").read_text("utf-8"))
    machine = MACHINES[case.name.split("_", 2)[2]]
    text = (case / told["model"]).read_text("utf-8")
    found = re.findall(r'parameter\("(\w+)", ([-+.\deE]+),', text)
    values = {**machine.values, **{name: float(value) for name, value in found}}
    train = tuple(_played(case / name, machine) for name in told["train"])
    held_out = _played(case / told["held_out"][0], machine)
    base = FittedBase(machine, values, train, held_out)
    cost = _cost(base)
    for _ in range(ITERATIONS):
        rows = [base.tangents(p).reshape(len(machine.free), -1).T for p in train]
        rest = [base.residual(p).reshape(-1) for p in train]
        step, *_ = np.linalg.lstsq(
            np.concatenate(rows), np.concatenate(rest), rcond=1e-8
        )
        base, cost, moved = _along(base, np.clip(step, -0.5, 0.5), cost)
        if not moved:
            break
    return base


def _along(
    base: FittedBase, step: Array, cost: float
) -> tuple[FittedBase, float, bool]:
    """Return the base moved along a step that is halved until the cost falls."""
    for share in (1.0, 0.5, 0.25, 0.1):
        values = dict(base.values)
        for name, change in zip(base.machine.free, step, strict=True):
            values[name] *= 1.0 + share * change
        moved = replace(base, values=values)
        new = _cost(moved)
        if np.isfinite(new) and new < cost * (1.0 - 1e-6):
            return moved, new, True
    return base, cost, False


def _cost(base: FittedBase) -> float:
    return float(sum(np.sum(base.residual(p) ** 2) for p in base.train))


def _played(path: Path, machine: Machine) -> Played:
    columns = np.loadtxt(path, delimiter=",", skiprows=1)
    commands = np.ascontiguousarray(columns[:, 1 : 1 + len(machine.inputs)])
    readings = columns[:, 1 + len(machine.inputs) :]
    drawn = plan(
        replace(machine, samples=len(columns)), "multisine", 0, Nuisance(noise=0.0)
    )
    return Played(replayed(drawn, commands), readings)
