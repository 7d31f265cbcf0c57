"""What a symbol stands for: the column, with its sign, behind a signal or a state.

A momentum or displacement is what a storage holds; where no storage integrates the
wire that a signal reads, a state of its own is added.
"""

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.numeric.implicit.laws import Read
from bondgraph.numeric.implicit.places import Index, Places
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Inertance,
    OneJunction,
    ZeroJunction,
)
from bondgraph.structure.fields import MultiPort, StorageField
from bondgraph.structure.signals import Signal, signals_in

_CONTENT = (Quantity.MOMENTUM, Quantity.DISPLACEMENT)
_EFFORTS = (Quantity.EFFORT, Quantity.MOMENTUM)


class Readings:
    """The stored quantities of a graph, and what signals read.

    ``state_names``, ``state_units``, ``rate_columns`` and ``rate_signs`` have one entry
    per stored quantity and grow while signals are read; ``state_at`` gives the storage
    state at an incidence.
    """

    def __init__(self, places: Places, columns: Index, n_powers: int) -> None:
        self.places = places
        self.columns = columns
        self.n_powers = n_powers
        self.state_names: list[str] = []
        self.state_units: list[str] = []
        self._taken = {"t", *places.graph.parameters}
        self._taken.update(source.name for source in places.graph.inputs)
        self._integrators: dict[int, int] = {}
        self._bonds: dict[str, int] = {}
        self._place_storages()

    def _place_storages(self) -> None:
        """Give every port of a storage its state, in the author's order."""
        places = self.places
        nodes = places.graph.nodes
        momenta = [places.first[places.of_kind(Inertance)]]
        displacements = [places.first[places.of_kind(Compliance)]]
        for i in places.of_kind(*StorageField.__args__):
            field = nodes[i]
            assert isinstance(field, StorageField)
            here = places.first[i] + np.arange(field.size)
            is_p = np.array([s.letter == "p" for s in field.stored])
            momenta.append(here[is_p])
            displacements.append(here[~is_p])
        p, q = np.concatenate(momenta), np.concatenate(displacements)
        order = np.argsort(np.concatenate([p, q]), kind="stable")
        here = np.concatenate([p, q])[order]
        is_p = order < len(p)
        effort_sign, flow_sign = places.port_signs(here)
        raw = places.bond_at[here] + np.where(is_p, 0, places.n_bonds)
        self.rate_columns: list[int] = self.columns[raw].tolist()
        self.rate_signs: list[int] = np.where(is_p, effort_sign, flow_sign).tolist()
        self.state_at = np.full(len(places.bond_at), -1)
        self.state_at[here] = self.n_powers + np.arange(len(here))
        self.storages = here
        self._storage_wires = places.wire[raw]
        self._name_storages(here, is_p)

    def _name_storages(self, here: Index, is_p: NDArray[np.bool_]) -> None:
        places = self.places
        owners = places.owners(here)
        bonds = places.bond_at[here].tolist()
        ports = (here - places.first[owners] + 1).tolist()
        for i, port, bond, momentum in zip(
            owners.tolist(), ports, bonds, is_p.tolist(), strict=True
        ):
            node = places.graph.nodes[i]
            label = f"{node.name}_{port}" if isinstance(node, MultiPort) else node.name
            self._add_name(label, bond, is_momentum=momentum)

    def _add_name(self, label: str, bond: int, *, is_momentum: bool) -> None:
        name = f"{'p' if is_momentum else 'q'}_{label}"
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        self.state_names.append(name)
        quantity = Quantity.MOMENTUM if is_momentum else Quantity.DISPLACEMENT
        self.state_units.append(self.places.graph.domains[bond].unit(quantity))

    def of(self, law: sympy.Expr) -> dict[sympy.Symbol, Read]:
        """Return what every signal in `law` reads."""
        return {signal: self.signal(signal) for signal in signals_in(law)}

    def signal(self, signal: Signal) -> Read:
        """Return the column that a signal reads, and its sign."""
        incidence, bond, outward = self._find(signal.place)
        is_effort = signal.quantity in _EFFORTS
        content = signal.quantity in _CONTENT
        if content and incidence is not None and self._holds(incidence, is_effort):
            return Read(int(self.state_at[incidence]), 1)
        sign = 1
        if incidence is not None:
            at = np.array([incidence])
            effort_sign, flow_sign = self.places.port_signs(at, outward=outward)
            sign = int((effort_sign if is_effort else flow_sign)[0])
        raw = bond if is_effort else self.places.n_bonds + bond
        if not content:
            return Read(int(self.columns[raw]), sign)
        found = self._integral(raw, is_effort=is_effort)
        return Read(found.column, sign * found.sign)

    def _holds(self, incidence: int, is_effort: bool) -> bool:
        """Return whether the port stores the integral of effort (flow) itself."""
        state = int(self.state_at[incidence])
        if state < 0:
            return False
        effort_column = self.columns[self.places.bond_at[incidence]]
        is_p = self.rate_columns[state - self.n_powers] == effort_column
        return bool(is_p == is_effort)

    def _find(self, place: str) -> tuple[int | None, int, bool]:
        """Return incidence (None unless a port), bond, and whether power comes out."""
        places = self.places
        name, _, port = place.partition("[")
        i = places.index.get(name if port else place)
        if i is None:
            return None, self._bond(place), False
        incidence = int(places.first[i]) + (int(port.rstrip("]")) - 1 if port else 0)
        bond = int(places.bond_at[incidence])
        kind = places.kinds[places.kind[i]]
        if kind in {ZeroJunction, OneJunction}:
            return None, bond, False
        return incidence, bond, kind in {EffortSource, FlowSource}

    def _bond(self, name: str) -> int:
        if not self._bonds:
            named = enumerate(self.places.graph.bonds)
            self._bonds = {b.name: i for i, b in reversed([*named])}
        return self._bonds[name]

    def _integral(self, raw: int, *, is_effort: bool) -> Read:
        """Return the integral of a wire: in a storage, or in a state of its own."""
        wire = int(self.places.wire[raw])
        stored = np.flatnonzero(self._storage_wires == wire)
        if len(stored):
            state = int(stored[0])
            return Read(self.n_powers + state, self.rate_signs[state])
        if wire not in self._integrators:
            label, sign = self._label(wire, raw, is_effort)
            self._integrators[wire] = len(self.state_names)
            bond = raw % self.places.n_bonds
            self._add_name(label, bond, is_momentum=is_effort)
            self.rate_columns.append(int(self.columns[raw]))
            self.rate_signs.append(sign)
        state = self._integrators[wire]
        return Read(self.n_powers + state, self.rate_signs[state])

    def _label(self, wire: int, raw: int, is_effort: bool) -> tuple[str, int]:
        """Return the place that a wire is named after, and the sign it has there."""
        places = self.places
        offset = 0 if is_effort else places.n_bonds
        kind = ZeroJunction if is_effort else OneJunction
        for i in places.of_kind(kind).tolist():
            if places.wire[offset + places.bond_at[places.first[i]]] == wire:
                return places.graph.nodes[i].name, 1
        label = places.bond_label(raw % places.n_bonds)
        if label not in places.index:
            return label, 1
        incidence, _, outward = self._find(label)
        assert incidence is not None
        signs = places.port_signs(np.array([incidence]), outward=outward)
        return label, int(signs[0 if is_effort else 1][0])
