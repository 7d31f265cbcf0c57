"""The energy audit of a large simulation: what came in is stored or dissipated.

Supplied and dissipated energy are integrated with the solver's own weights; stored
energy is a function of where the storages are, so the difference is what the solver's
steps have made of the balance, and nothing makes it vanish by construction.
"""

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.implicit.system import ImplicitSystem
from bondgraph.simulation.energy_audit import EnergyAudit
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Resistance,
)
from bondgraph.structure.fields import ResistanceField

Array = NDArray[np.float64]
Index = NDArray[np.int64]

POINTS = 32
"""Gauss points on the line between two states; exact for laws up to degree 63."""


class EnergyMeter:
    """Measures one run."""

    def __init__(self, system: ImplicitSystem) -> None:
        self._system = system
        self._sources = _Ports(system, (EffortSource, FlowSource), outward=True)
        self._resistances = _Ports(system, (Resistance, ResistanceField))
        self._contents = _Contents(system)
        self._supplied = self._dissipated = self._flowed = 0.0

    def add(self, z: Array, weight: float) -> None:
        """Count a solver's stage of so many seconds."""
        supplied = self._sources.powers(z) * weight
        dissipated = self._resistances.powers(z) * weight
        self._supplied += float(supplied.sum())
        self._dissipated += float(dissipated.sum())
        self._flowed += float(np.abs(supplied).sum() + np.abs(dissipated).sum())

    def audit(
        self, first: Array, last: Array, times: tuple[float, float]
    ) -> EnergyAudit:
        """Return the balance between two points of the run."""
        stored = self._contents.difference(first, last, times)
        left = stored + self._dissipated - self._supplied
        scale = max(abs(stored), self._flowed)
        return EnergyAudit(
            stored=stored,
            dissipated=self._dissipated,
            supplied=self._supplied,
            relative=abs(left) / scale if scale else 0.0,
        )


class _Ports:
    """The powers of all ports of some kinds."""

    def __init__(
        self, system: ImplicitSystem, kinds: tuple[type, ...], *, outward: bool = False
    ) -> None:
        places = system.places
        here = np.flatnonzero(
            np.isin(
                places.owners(np.arange(len(places.bond_at))), places.of_kind(*kinds)
            )
        )
        effort_sign, flow_sign = places.port_signs(here, outward=outward)
        self.effort, self.flow = system.port_columns(here)
        self.sign = effort_sign * flow_sign

    def powers(self, z: Array) -> Array:
        """Return the power of each port by its own convention."""
        found: Array = self.sign * z[self.effort] * z[self.flow]
        return found


class _Contents:
    """What the storages hold."""

    def __init__(self, system: ImplicitSystem) -> None:
        places = system.places
        here = system.storages
        owners = places.owners(here)
        effort, flow = system.port_columns(here)
        effort_sign, flow_sign = places.port_signs(here)
        self.system = system
        self.stored = system.n_powers + np.arange(len(here))
        rates = system.rate_columns[: len(here)]
        is_p = rates == effort
        self.co = np.where(is_p, flow, effort)
        self.co_sign = np.where(is_p, flow_sign, effort_sign)
        rows = np.flatnonzero(np.isin(system.owners, owners))
        self.rows = rows[np.argsort(system.owners[rows], kind="stable")]

    def difference(
        self, first: Array, last: Array, times: tuple[float, float]
    ) -> float:
        """Return the energy that the storages have gained, ∫ co d(stored)."""
        products = [z[self.stored] * z[self.co] * self.co_sign for z in (first, last)]
        total = 0.5 * (products[1] - products[0])
        has_law = np.zeros(len(self.system.owners), bool)
        for group in self.system.laws:
            has_law[group.rows] = True
        lawful = np.flatnonzero(has_law[self.rows])
        if len(lawful):
            total[lawful] = self._along(first, last, times)[lawful]
            # Where the law gives what is stored, its integral is the co-energy.
            gives_stored = self._gives_stored() & has_law[self.rows]
            whole = products[1] - products[0]
            total[gives_stored] = whole[gives_stored] - total[gives_stored]
        return float(total.sum())

    def _gives_stored(self) -> NDArray[np.bool_]:
        entries = self.system.constant.tocoo()
        own = np.full(len(self.system.owners), -1)
        own[self.rows] = self.stored
        found = np.zeros(len(self.system.owners), bool)
        i, j = entries.coords
        found[i[own[i] == j]] = True
        return found[self.rows]

    def _along(self, first: Array, last: Array, times: tuple[float, float]) -> Array:
        """Return each law integrated over its argument, on a straight line."""
        nodes, weights = np.polynomial.legendre.leggauss(POINTS)
        way = last - first
        argument = np.where(
            self._gives_stored(), self.co_sign * way[self.co], way[self.stored]
        )
        total = np.zeros(len(self.rows))
        values = np.zeros(len(self.system.owners))
        for node, weight in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
            here = first + node * way
            t = times[0] + node * (times[1] - times[0])
            for group in self.system.laws:
                values[group.rows] = group.values(here, t)
            total += weight * values[self.rows] * argument
        return total
