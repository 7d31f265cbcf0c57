"""The rows of the implicit system, a kind of node at a time.

All linear nodes of one kind are written by a few array operations; a node with a law of
its own becomes a `LawRow`. What a signal reads is looked up in `Readings`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import sympy
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array, csr_array

from bondgraph.numeric.implicit.laws import LawRow, Read
from bondgraph.numeric.implicit.places import Index, Places
from bondgraph.numeric.implicit.readings import Readings
from bondgraph.structure import signals
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Gyrator,
    Inertance,
    OneJunction,
    Resistance,
    Transformer,
    ZeroJunction,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.relations import Relation
from bondgraph.structure.signals import PortVariable

Array = NDArray[np.float64]


@dataclass(slots=True, eq=False)
class Entries:
    """Entries of a sparse matrix while they are being collected."""

    parts: list[tuple[Array, Index, Index]] = field(default_factory=list)

    def add(self, rows: ArrayLike, columns: ArrayLike, values: ArrayLike) -> None:
        """Add entries; the three are broadcast together."""
        r, c, v = np.broadcast_arrays(rows, columns, values)
        self.parts.append((v.ravel().astype(float), r.ravel(), c.ravel()))

    def matrix(self, n_rows: int, n_columns: int) -> csr_array:
        """Return the matrix; entries at one place are summed, zeros dropped."""
        if not self.parts:
            return csr_array((n_rows, n_columns))
        values, rows, columns = map(np.concatenate, zip(*self.parts, strict=True))
        found = coo_array((values, (rows, columns)), shape=(n_rows, n_columns)).tocsr()
        found.eliminate_zeros()
        return found


class Rows:
    """Collects rows, laws and readings of one graph."""

    def __init__(
        self,
        places: Places,
        columns: Index,
        n_powers: int,
        parameters: Mapping[str, float],
    ) -> None:
        self.places = places
        self.columns = columns
        self.parameters = parameters
        self.entries, self.input_entries, self.reading = Entries(), Entries(), Entries()
        self.laws: list[LawRow] = []
        self.reading_laws: list[LawRow] = []
        self.n_rows = 0
        self._owners: list[Index] = []
        self._names = [node.name for node in places.graph.nodes]
        self.readings = Readings(places, columns, n_powers)

    @property
    def n_states(self) -> int:
        """Number of stored quantities found so far."""
        return len(self.readings.state_names)

    @property
    def state_names(self) -> list[str]:
        """Names of the stored quantities."""
        return self.readings.state_names

    @property
    def state_units(self) -> list[str]:
        """Units of the stored quantities."""
        return self.readings.state_units

    @property
    def rate_columns(self) -> list[int]:
        """The column that each stored quantity integrates."""
        return self.readings.rate_columns

    @property
    def rate_signs(self) -> list[int]:
        """Its sign."""
        return self.readings.rate_signs

    def owners(self) -> Index:
        """Return the node of every row."""
        return np.concatenate(self._owners) if self._owners else np.zeros(0, np.int64)

    def _new(self, owners: Index) -> Index:
        """Return the numbers of new rows that belong to these nodes."""
        rows = self.n_rows + np.arange(len(owners))
        self.n_rows += len(owners)
        self._owners.append(owners)
        return rows

    def _incidences(self, nodes: Index) -> tuple[Index, Index]:
        """Return the incidences of these nodes and, for each, its place in `nodes`."""
        first = self.places.first
        sizes = first[nodes + 1] - first[nodes]
        which = np.repeat(np.arange(len(nodes)), sizes)
        begin = np.cumsum(sizes) - sizes
        return np.arange(len(which)) - begin[which] + first[nodes][which], which

    def equalities(self) -> None:
        """Add the rows ``common variable of bond 1 - that of bond j = 0``."""
        places = self.places
        for kind, offset in ((ZeroJunction, 0), (OneJunction, places.n_bonds)):
            nodes = places.of_kind(kind)
            here, which = self._incidences(nodes)
            leader = places.first[nodes][which]
            here, leader, which = (x[here != leader] for x in (here, leader, which))
            rows = self._new(nodes[which])
            bonds = places.bond_at
            self.entries.add(rows, self.columns[offset + bonds[leader]], 1.0)
            self.entries.add(rows, self.columns[offset + bonds[here]], -1.0)

    def balances(self) -> None:
        """Add the rows ``sum of efforts (flows) into a 1- (0-)junction = 0``."""
        places = self.places
        for kind, offset in ((ZeroJunction, places.n_bonds), (OneJunction, 0)):
            nodes = places.of_kind(kind)
            here, which = self._incidences(nodes)
            columns = self.columns[offset + places.bond_at[here]]
            self.entries.add(self._new(nodes)[which], columns, places.towards[here])

    def _port(self, incidence: Index, *, outward: bool = False) -> "_Ports":
        places = self.places
        bonds = places.bond_at[incidence]
        effort_sign, flow_sign = places.port_signs(incidence, outward=outward)
        flows = self.columns[places.n_bonds + bonds]
        return _Ports(self.columns[bonds], effort_sign, flows, flow_sign)

    def two_ports(self) -> None:
        """Add ``e_b = K e_a, f_a = K f_b`` and ``e_b = r f_a, e_a = r f_b``."""
        for kind in (Transformer, Gyrator):
            nodes = self.places.of_kind(kind)
            first = self.places.first[nodes]
            towards = self.places.towards
            swap = (towards[first] < 0) & (towards[first + 1] > 0)
            a = self._port(first + swap)
            b = self._port(first + 1 - swap, outward=True)
            if kind is Transformer:
                self._two_port(nodes, b.effort, a.effort)
                self._two_port(nodes, a.flow, b.flow)
            else:
                self._two_port(nodes, b.effort, a.flow)
                self._two_port(nodes, a.effort, b.flow)

    def _two_port(self, nodes: Index, left: "_Signed", right: "_Signed") -> None:
        """Add the rows ``left - modulus right = 0``."""
        rows = self._new(nodes)
        self.entries.add(rows, left.columns, left.signs)
        plain, values = self._plain(nodes)
        self.entries.add(
            rows[plain], right.columns[plain], -right.signs[plain] * values
        )
        for k in np.flatnonzero(~plain):
            law = self.places.graph.nodes[nodes[k]].law * signals.e
            own = {signals.e: Read(int(right.columns[k]), int(right.signs[k]))}
            self._law(int(rows[k]), law, own)

    def _plain(self, nodes: Index) -> tuple[NDArray[np.bool_], Array]:
        """Return which nodes are linear, and the parameter of each of them."""
        members = [self.places.graph.nodes[i] for i in nodes.tolist()]
        plain = np.array([node.law is None for node in members], bool)
        values = [self.parameters[node.name] for node in members if node.law is None]
        return plain, np.array(values, float)

    def _law(self, row: int, law: sympy.Expr, own: dict[sympy.Symbol, Read]) -> None:
        """Add ``- law`` to a row."""
        reads = {**own, **self.readings.of(law)}
        used = {symbol: reads[symbol] for symbol in law.free_symbols & reads.keys()}
        self.laws.append(LawRow(row, law, used))

    def one_ports(self) -> None:
        """Add one row per source, linear one-port, law and port of a field."""
        self._sources()
        states = self.readings.state_at
        for kind in (Inertance, Compliance, Resistance):
            nodes = self.places.of_kind(kind)
            rows = self._new(nodes)
            plain, values = self._plain(nodes)
            here = self.places.first[nodes]
            port = self._port(here[plain])
            if kind is Resistance:  # e = R f
                big, small = port.effort, port.flow
            else:  # p = I f, q = C e
                held = states[here[plain]]
                big = _Signed(held, np.ones_like(held))
                small = port.flow if kind is Inertance else port.effort
            self.entries.add(rows[plain], big.columns, big.signs)
            self.entries.add(rows[plain], small.columns, -small.signs * values)
            for k in np.flatnonzero(~plain):
                node = self.places.graph.nodes[nodes[k]]
                assert isinstance(node, kind)
                own = self._own(int(here[k]))
                self._relation(int(rows[k]), node.relation, own)
        self._fields()

    def _sources(self) -> None:
        """Add the rows ``own effort (flow) = input`` or ``= value``."""
        number = {s.name: j for j, s in enumerate(self.places.graph.inputs)}
        for kind in (EffortSource, FlowSource):
            nodes = self.places.of_kind(kind)
            rows = self._new(nodes)
            port = self._port(self.places.first[nodes], outward=True)
            given = port.effort if kind is EffortSource else port.flow
            self.entries.add(rows, given.columns, given.signs)
            for row, i in zip(rows.tolist(), nodes.tolist(), strict=True):
                value = self.places.graph.nodes[i].value
                if value is None:
                    self.input_entries.add(row, number[self._names[i]], 1.0)
                else:
                    self._law(row, value, {})

    def _fields(self) -> None:
        """Add the rows of multiports, each law in the variables of all ports."""
        for i in self.places.of_kind(*MultiPort.__args__).tolist():
            field = self.places.graph.nodes[i]
            assert isinstance(field, MultiPort)
            own: dict[sympy.Symbol, Read] = {}
            for k in range(field.size):
                one = self._own(int(self.places.first[i]) + k)
                own.update(
                    (PortVariable(symbol.name, k + 1), read)
                    for symbol, read in one.items()
                )
            rows = self._new(np.full(field.size, i))
            for row, relation in zip(rows.tolist(), field.relations, strict=True):
                self._relation(row, relation, own)

    def _own(self, incidence: int) -> dict[sympy.Symbol, Read]:
        """Return what a port's own variables e, f, p and q read."""
        port = self._port(np.array([incidence]))
        own = {
            signals.e: Read(int(port.effort.columns[0]), int(port.effort.signs[0])),
            signals.f: Read(int(port.flow.columns[0]), int(port.flow.signs[0])),
        }
        state = int(self.readings.state_at[incidence])
        if state >= 0:
            own[signals.p] = own[signals.q] = Read(state, 1)
        return own

    def _relation(
        self, row: int, relation: Relation, own: dict[sympy.Symbol, Read]
    ) -> None:
        """Add the row ``output - law = 0``."""
        output = own[relation.output]
        self.entries.add(row, output.column, output.sign)
        self._law(row, relation.expression, own)

    def measurements(self) -> None:
        """Add the outputs."""
        for j, measurement in enumerate(self.places.graph.measurements):
            law = measurement.expression
            reads = self.readings.of(law)
            if law in reads:
                self.reading.add(j, reads[law].column, reads[law].sign)
            else:
                self.reading_laws.append(LawRow(j, law, reads))


@dataclass(frozen=True, slots=True, eq=False)
class _Signed:
    """Columns with their signs."""

    columns: Index
    signs: Index


class _Ports:
    """The own effort and flow of many ports."""

    def __init__(self, e: Index, e_sign: Index, f: Index, f_sign: Index) -> None:
        self.effort = _Signed(e, e_sign)
        self.flow = _Signed(f, f_sign)
