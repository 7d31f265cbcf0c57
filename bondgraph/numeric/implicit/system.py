"""The implicit system: one row per local equation, one column per variable.

With z = (efforts and flows w, stored quantities x) the record means::

    constant z - laws(z, t) = inputs u      (rows: junctions, two-ports, one-ports)
    ẋ = sign * w[column]                    (one per stored quantity)
    y = reading z + reading_laws(z, t)

Merged, the efforts at a 0-junction are one column and the flows at a 1-junction too,
and the rows that said so are gone; otherwise nothing is eliminated.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from bondgraph.equations.hard_contact import refuse_hard_contact
from bondgraph.numeric.implicit.laws import LawGroup, grouped
from bondgraph.numeric.implicit.places import Index, Places, places_of
from bondgraph.numeric.implicit.rows import Rows
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.hard_contact import hard_contact
from bondgraph.structure.nodes import written_laws

Array = NDArray[np.float64]

STEEP = 1e12
"""What an infinite slope is capped to."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImplicitSystem:
    """A graph as sparse equations; see the module's head.

    Parameters
    ----------
    state_names, state_units
        Stored quantities: ``p_`` or ``q_`` and the storage, in the author's order,
        then integrals that a signal reads and no storage holds.
    storages
        The incidences of the ports that store; the first stored quantities are theirs.
    owners
        The node that each row comes from.
    columns
        The column of every effort and, after them, of every flow of a bond.
    rate_columns, rate_signs
        What each stored quantity integrates.
    """

    places: Places
    n_powers: int
    storages: Index
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    input_names: tuple[str, ...]
    input_units: tuple[str, ...]
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    owners: Index
    columns: Index
    constant: csr_array
    laws: tuple[LawGroup, ...]
    inputs: csr_array
    rate_columns: Index
    rate_signs: Array
    reading: csr_array
    reading_laws: tuple[LawGroup, ...]

    @property
    def name(self) -> str:
        """The graph's name."""
        return self.places.graph.name

    @property
    def n_states(self) -> int:
        """Number of stored quantities."""
        return len(self.state_names)

    def port_columns(self, incidences: Index) -> tuple[Index, Index]:
        """Return the effort and the flow column of the bonds at these incidences."""
        bonds = self.places.bond_at[incidences]
        return self.columns[bonds], self.columns[self.places.n_bonds + bonds]

    @property
    def storage_owners(self) -> Index:
        """The node of each stored quantity that a storage holds."""
        return self.places.owners(self.storages)

    @property
    def n_storages(self) -> int:
        """Number of stored quantities that a storage holds."""
        return len(self.storages)

    @property
    def linear(self) -> bool:
        """Whether every coefficient is constant (a term in t may be added)."""
        return all(group.linear for group in self.laws)

    def residual(self, z: Array, u: Array, t: float = 0.0) -> Array:
        """Return what is left of every row; zero where all equations hold."""
        left: Array = self.constant @ z - self.inputs @ u
        for group in self.laws:
            left[group.rows] -= group.values(z, t)
        return left

    def jacobian(self, z: Array, t: float = 0.0, *, capped: bool = False) -> csr_array:
        """Return the exact derivative of the residual to z.

        Capped, a slope is never infinite or undefined: good enough to step towards a
        solution from the edge of a law, such as a root at zero.
        """
        return _with_partials(self.constant, self.laws, z, t, -1.0, capped=capped)

    def time_partial(self, z: Array, t: float = 0.0) -> Array:
        """Return the exact derivative of the residual to t."""
        partial = np.zeros(len(self.owners))
        for group in self.laws:
            partial[group.rows] -= group.partials(z, t)[1]
        return partial

    def outputs(self, z: Array, t: float = 0.0) -> Array:
        """Return the measurements."""
        y: Array = self.reading @ z
        for group in self.reading_laws:
            y[group.rows] += group.values(z, t)
        return y

    def output_jacobian(self, z: Array, t: float = 0.0) -> csr_array:
        """Return the exact derivative of the measurements to z."""
        return _with_partials(self.reading, self.reading_laws, z, t, 1.0)


def _with_partials(
    constant: csr_array,
    laws: tuple[LawGroup, ...],
    z: Array,
    t: float,
    factor: float,
    *,
    capped: bool = False,
) -> csr_array:
    if not laws:
        return constant
    rows, columns, values = [], [], []
    for group in laws:
        partials = group.partials(z, t)[0]
        if capped:
            partials = np.nan_to_num(partials, nan=0.0, posinf=STEEP, neginf=-STEEP)
        rows.append(np.broadcast_to(group.rows, partials.shape).ravel())
        columns.append(group.columns.ravel())
        values.append(factor * partials.ravel())
    where = (np.concatenate(rows), np.concatenate(columns))
    added = coo_array((np.concatenate(values), where), shape=constant.shape)
    return csr_array(constant + added)


def implicit_system(graph: FinishedGraph, *, merged: bool = True) -> ImplicitSystem:
    """Return the implicit system of `graph` at its parameter values.

    Parameters
    ----------
    merged
        Whether the equal variables of a junction share one column.

    Raises
    ------
    ParameterError
        If a parameter has no value.
    EquationError
        If the graph has a hard contact.
    """
    contacts = tuple(
        node.name
        for node in graph.nodes
        if any(law.has(hard_contact) for law in written_laws(node))
    )
    if contacts:
        refuse_hard_contact(graph.name, contacts, "which sparse systems do not know")
    places = places_of(graph)
    n_powers = places.n_wires if merged else 2 * places.n_bonds
    columns = places.wire if merged else np.arange(n_powers)
    rows = Rows(places, columns, n_powers, graph.parameters.values_by_name())
    if not merged:
        rows.equalities()
    rows.balances()
    rows.two_ports()
    rows.one_ports()
    rows.measurements()
    n_columns = n_powers + rows.n_states
    inputs = graph.inputs
    parameters = rows.parameters
    return ImplicitSystem(
        places=places,
        n_powers=n_powers,
        storages=rows.readings.storages,
        state_names=tuple(rows.state_names),
        state_units=tuple(rows.state_units),
        input_names=tuple(source.name for source in inputs),
        input_units=tuple(graph.input_unit(source.name) for source in inputs),
        output_names=tuple(m.name for m in graph.measurements),
        output_units=tuple(m.unit for m in graph.measurements),
        owners=rows.owners(),
        columns=columns,
        constant=rows.entries.matrix(rows.n_rows, n_columns),
        laws=grouped(rows.laws, parameters),
        inputs=rows.input_entries.matrix(rows.n_rows, len(inputs)),
        rate_columns=np.array(rows.rate_columns, np.int64),
        rate_signs=np.array(rows.rate_signs, float),
        reading=rows.reading.matrix(len(graph.measurements), n_columns),
        reading_laws=grouped(rows.reading_laws, parameters),
    )
