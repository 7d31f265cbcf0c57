"""The list of cases: machine, effects, strength, seeds, and which are empty.

Any beginning of the list is a fair sample: machines and effects are shuffled, strengths
go round, and every block of eight has two cases with nothing concealed.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.machine import Machine, Site
from benchmarks.concealed.machines import MACHINES
from benchmarks.concealed.recording import Nuisance
from benchmarks.concealed.seeds import SEED_SETS

STRENGTHS = (0.5, 2.0, 6.0, 12.0, 40.0, 150.0)
"""Wanted residual over noise; from far below what can be seen to dominant."""

BLOCK, EMPTY = 8, 2
DOUBLE_EVERY = 9
NUISANCES = (
    Nuisance(),
    Nuisance(),
    Nuisance(colour=0.9),
    Nuisance(jitter=0.05),
    Nuisance(outliers=0.002),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One case: no sites means that nothing is concealed."""

    name: str
    machine: Machine
    sites: tuple[Site, ...]
    strength: float
    seed: int
    nuisance: Nuisance


def cases(
    seed_set: str,
    *,
    machines: tuple[str, ...] = (),
    words: tuple[str, ...] = (),
) -> Iterator[Case]:
    """Yield the cases of a seed set in order, of some machines and words if given."""
    random = np.random.default_rng(SEED_SETS[seed_set])
    chosen = [MACHINES[name] for name in machines or MACHINES]
    effects = [
        (machine, site)
        for machine in chosen
        for site in machine.sites
        if not words or site.word in words
    ]
    order = [effects[i] for i in random.permutation(len(effects))]
    offset = int(random.integers(len(STRENGTHS)))
    index = 0
    for begin in range(0, len(order), BLOCK - EMPTY):
        block = list(order[begin : begin + BLOCK - EMPTY])
        empty = [
            (chosen[int(random.integers(len(chosen)))], None) for _ in range(EMPTY)
        ]
        mixed = [*block, *empty]
        for i in random.permutation(len(mixed)):
            machine, site = mixed[i]
            sites = () if site is None else (site,)
            if site is not None and index % DOUBLE_EVERY == DOUBLE_EVERY - 1:
                sites = _pair(machine, site, random)
            yield Case(
                name=f"{seed_set}_{index:03d}_{machine.name}",
                machine=machine,
                sites=sites,
                strength=STRENGTHS[(index + offset) % len(STRENGTHS)],
                seed=int(random.integers(2**31)),
                nuisance=NUISANCES[int(random.integers(len(NUISANCES)))],
            )
            index += 1


def _pair(
    machine: Machine, site: Site, random: np.random.Generator
) -> tuple[Site, ...]:
    """Return the site with another one of the machine at another place or law."""
    others = [
        other
        for other in machine.sites
        if other.word != site.word
        and not (other.silent or site.silent)
        and not (other.variant or site.variant)
        and other.place != site.place
    ]
    if not others:
        return (site,)
    return site, others[int(random.integers(len(others)))]
