"""Stepwise regression with every law that can be concealed: the strongest rival here.

It is told what no user knows: the list from which effects are drawn, their laws with
all shape numbers, the simulator that made the recordings and the state of rest in which
they begin. Effects enter one by one; every candidate's size is fitted together with all
parameters, through the simulator, and the next one enters only while the Bayesian
information criterion falls (Schwarz 1978). Coloured residuals count as fewer samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.concealed.accepted import OUTSIDE
from benchmarks.concealed.effects import Effect, Scales, law_of
from benchmarks.concealed.machine import Array, Site
from benchmarks.concealed.others.base import FittedBase, Played
from benchmarks.concealed.others.said import Said, rms
from benchmarks.concealed.recording import scales_of, simulate
from benchmarks.concealed.strength import noise_levels

TRIED = (0.05, 0.4)
"""Shares of an effect's largest size at which it is tried."""

REFITTED, ITERATIONS, ENTERING = 3, 5, 3
"""Best candidates refitted, steps of a refit, effects at most."""

PROMISING = 3.0
"""Gain in the log likelihood's double to first order, below which none is refitted."""

STEP = 1e-3
LARGEST_STEP = 0.5
SETTLED = 1e-3
"""A refit ends where a step takes less than this share of the squares."""


@dataclass(frozen=True, slots=True)
class Believed:
    """A base model with effects of certain sizes.

    ``shares`` are sizes over the largest that makes sense, between 0 and 1.
    """

    base: FittedBase
    scales: Mapping[str, Scales]
    sites: tuple[Site, ...] = ()
    shares: tuple[float, ...] = ()

    def residual(self, played: Played) -> Array:
        """Return measured minus simulated over the noise, (N ny)."""
        pairs = zip(self.sites, self.shares, strict=True)
        effects = [Effect(site, share * site.largest) for site, share in pairs]
        run = simulate(
            self.base.machine, played.plan, effects, values=self.base.values,
            scales=self.scales, exact=True,
        )  # fmt: skip
        error = (played.readings - run.readings) / noise_levels(self.base.machine)
        return np.nan_to_num(error, nan=1e9, posinf=1e9, neginf=-1e9).reshape(-1)

    def residuals(self) -> Array:
        """Return those of both training recordings."""
        return np.concatenate([self.residual(p) for p in self.base.train])

    def moved(self, step: Array) -> "Believed":
        """Return it with relative changes of parameters and changes of shares."""
        free = self.base.machine.free
        values = dict(self.base.values)
        for name, change in zip(free, step, strict=False):
            values[name] *= 1.0 + change
        shares = np.clip(np.array(self.shares) + step[len(free) :], 1e-4, 1.0)
        base = replace(self.base, values=values)
        return replace(self, base=base, shares=tuple(map(float, shares)))

    def tangents(self, here: Array) -> Array:
        """Return changes of the residuals with parameters and shares, (N ny, k)."""
        count = len(self.base.machine.free) + len(self.shares)
        steps = STEP * np.eye(count)
        for i, share in enumerate(self.shares, start=len(self.base.machine.free)):
            steps[i] *= -1.0 if share > 0.5 else 1.0
        columns = [(self.moved(s).residuals() - here) / s.sum() for s in steps]
        return np.array(columns).T

    def refitted(self) -> "Believed":
        """Return it after least squares of parameters and shares."""
        best, rest = self, self.residuals()
        for _ in range(ITERATIONS):
            step, *_ = np.linalg.lstsq(best.tangents(rest), -rest, rcond=1e-8)
            size = np.abs(step).max()
            step *= min(1.0, LARGEST_STEP / size) if size > 0.0 else 1.0
            for share in (1.0, 0.3, 0.05):
                moved = best.moved(share * step)
                new = moved.residuals()
                if new @ new < rest @ rest:
                    break
            else:
                return best
            settled = new @ new > (1.0 - SETTLED) * (rest @ rest)
            best, rest = moved, new
            if settled:
                return best
        return best


def stepwise_by_bic(base: FittedBase) -> Said:
    """Let effects of the true list enter one by one while the criterion falls."""
    machine = base.machine
    library = [s for s in machine.sites if not s.silent and law_of(s) not in OUTSIDE]
    chosen = Believed(base, scales_of(machine, [p.plan for p in base.train]))
    for _ in range(ENTERING):
        ranked = _promising(chosen, [s for s in library if _may_enter(s, chosen)])
        tried = [one.refitted() for one in ranked[:REFITTED]]
        best = min(tried, key=lambda one: rms(one.residuals()), default=chosen)
        if not worth_it(chosen.residuals(), best.residuals(), len(machine.sensors)):
            break
        chosen = best
    before = base.residual(base.held_out)
    finding = (chosen.sites[0].word, chosen.sites[0].place) if chosen.sites else None
    after = chosen.residual(base.held_out)
    return Said(finding, rms(before), rms(after), len(chosen.sites))


def _may_enter(site: Site, chosen: Believed) -> bool:
    """Return whether it is not in yet; a machine is built in one other way at most."""
    built = site.variant and any(one.variant for one in chosen.sites)
    return not built and site not in chosen.sites


def worth_it(before: Array, after: Array, outputs: int) -> bool:
    """Return whether Schwarz's criterion falls with one number more."""
    count = effective(after, outputs)
    return 2.0 * count * np.log(rms(before) / rms(after)) > np.log(count)


def effective(residual: Array, outputs: int) -> float:
    """Return how many independent samples a residual is worth."""
    series = residual.reshape(-1, outputs)
    series = series - series.mean(axis=0)
    power = np.sum(series**2, axis=0)
    lag = np.sum(series[1:] * series[:-1], axis=0) / np.where(power > 0.0, power, 1.0)
    lag = np.clip(lag, 0.0, 0.999)
    return float(np.sum(len(series) * (1.0 - lag) / (1.0 + lag)))


def _promising(believed: Believed, sites: Sequence[Site]) -> list[Believed]:
    """Return the model with each site at its best trial size, the best first."""
    rest = believed.residuals()
    own, _ = np.linalg.qr(believed.tangents(rest))
    free = rest - own @ (own.T @ rest)
    count = effective(free, len(believed.base.machine.sensors))
    found = []
    for site in sites:
        trials = []
        for share in TRIED:
            more = (*believed.sites, site)
            one = replace(believed, sites=more, shares=(*believed.shares, share))
            change = one.residuals() - rest
            change -= own @ (own.T @ change)
            size = float(change @ change)
            scale = min(max(-float(change @ free) / size, 0.0), 3.0) if size else 0.0
            left = free + scale * change
            begin = min(max(scale * share, 1e-3), 1.0)
            start = replace(one, shares=(*believed.shares, begin))
            trials.append((float(left @ left), start))
        found.append(min(trials, key=lambda trial: trial[0]))
    enough = float(free @ free) * np.exp(-PROMISING / count)
    found = [one for one in found if one[0] < enough]
    return [one for _, one in sorted(found, key=lambda trial: trial[0])]
