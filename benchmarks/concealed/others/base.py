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

ITERATIONS = 12
STEP = 1e-4
BEGINNINGS = (0.05, 0.2, 1.0)
"""Shares of the recordings that are fitted one after the other.

A swing whose frequency is 10 % wrong is out of step after a few periods, and least
squares of a whole recording then end anywhere; its beginning leads to the rest.
"""

USUAL = 0.3
"""What a nominal value is wrong by, at most usually: a weak prior, as a user has it."""


@dataclass(frozen=True, slots=True)
class Played:
    """A recording: the plan that plays its inputs again, and readings (N, ny)."""

    plan: Plan
    readings: Array

    def beginning(self, share: float) -> "Played":
        """Return the first part of it."""
        last = max(round(share * len(self.readings)), 1)
        signals = ("time", "feed", "reference", "noise", "early")
        cut = {name: getattr(self.plan, name)[:last] for name in signals}
        return Played(replace(self.plan, **cut), self.readings[:last])


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
    nominal = _values(base)
    for share in BEGINNINGS:
        shorter = tuple(one.beginning(share) for one in train)
        base = _fitted(replace(base, train=shorter), nominal)
    return replace(base, train=train)


def _fitted(base: FittedBase, nominal: Array) -> FittedBase:
    """Return the base after least squares of its training recordings and the prior."""
    count = len(base.machine.free)
    cost = _cost(base, nominal)
    for _ in range(ITERATIONS):
        rows = [base.tangents(p).reshape(count, -1).T for p in base.train]
        rest = [base.residual(p).reshape(-1) for p in base.train]
        moved = _values(base) / nominal
        step, *_ = np.linalg.lstsq(
            np.concatenate([*rows, np.diag(moved) / USUAL]),
            np.concatenate([*rest, (1.0 - moved) / USUAL]),
            rcond=1e-12,
        )
        step *= min(1.0, 0.5 / np.abs(step).max())
        base, cost, better = _along(base, step, cost, nominal)
        if not better:
            break
    return base


def _along(
    base: FittedBase, step: Array, cost: float, nominal: Array
) -> tuple[FittedBase, float, bool]:
    """Return the base moved along a step that is shortened until the cost falls."""
    for share in (1.0, 0.5, 0.2, 0.05):
        values = dict(base.values)
        for name, change in zip(base.machine.free, step, strict=True):
            values[name] *= 1.0 + share * change
        moved = replace(base, values=values)
        new = _cost(moved, nominal)
        if np.isfinite(new) and new < cost * (1.0 - 1e-4):
            return moved, new, True
    return base, cost, False


def _values(base: FittedBase) -> Array:
    return np.array([base.values[name] for name in base.machine.free])


def _cost(base: FittedBase, nominal: Array) -> float:
    data = sum(np.sum(base.residual(p) ** 2) for p in base.train)
    return float(data + np.sum(((_values(base) / nominal - 1.0) / USUAL) ** 2))


def _played(path: Path, machine: Machine) -> Played:
    columns = np.loadtxt(path, delimiter=",", skiprows=1)
    commands = np.ascontiguousarray(columns[:, 1 : 1 + len(machine.inputs)])
    readings = columns[:, 1 + len(machine.inputs) :]
    drawn = plan(
        replace(machine, samples=len(columns)), "multisine", 0, Nuisance(noise=0.0)
    )
    return Played(replayed(drawn, commands), readings)
