"""The matrices of the port-Hamiltonian form, from the power structure of a graph.

With z the co-energy variables of the independent storages, T the ratios at which
dependent ones follow (``z_d = T z``), and θ the states that no storage holds but a law
reads (``θ̇ = B z + B_u u``), a bond graph gives ``ẋ + Tᵀ ẋ_d = K z + L u``, where K less
its transpose passes power on and the rest dissipates. Since ``x_d`` is a function of x
and θ with derivatives D and D_θ, and ``M = 1 + Tᵀ D``, the energy has the gradient
``∂H/∂x = Mᵀ z``, ``∂H/∂θ = D_θᵀ T z``. Put in, with ``Q = Tᵀ D_θ B``::

    J - R = [ M⁻¹ (K - Q + Qᵀ) M⁻ᵀ   -M⁻¹ Bᵀ ]
            [ B M⁻ᵀ                   0      ]

which is as skew as K: a moving modulus adds only gyroscopic terms. Constant ratios
are in Golo, van der Schaft, Breedveld and Maschke, "Hamiltonian formulation of bond
graphs" (2003); the form itself in van der Schaft and Jeltsema, "Port-Hamiltonian
Systems Theory" (2014).
"""

from collections.abc import Iterable, Mapping

import sympy

from bondgraph.causality.records import CausalAssignment
from bondgraph.equations.algebra.rational import Row, in_lowest_terms
from bondgraph.equations.algebra.sparse_matrices import (
    HALF,
    Sparse,
    applied,
    bordered,
    combined,
    congruent,
    derivatives,
    inverse_of_one_plus,
    product,
    skew_and_symmetric,
    transposed,
)
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.inversion import Laws
from bondgraph.equations.insertion import (
    Insertion,
    in_terms_of_states,
    signal_values,
)
from bondgraph.equations.power.port_laws import port_law, port_place
from bondgraph.equations.power.power_structure import (
    coefficient_symbol,
    power_structure,
)
from bondgraph.equations.power.stored_energy import energy_function
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Resistance,
    Storage,
)
from bondgraph.structure.fields import ResistanceField, StorageField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import signals_in, t


class NoForm(Exception):  # noqa: N818  (an answer on its way to a record, no error)
    """Carries the reason why there is no form to where the answer is made."""


class HamiltonianForm:
    """The form of a graph whose elements allow one.

    ``states`` are those of independent storages, then those that a law reads and no
    storage holds. Matrices are ``{(row, column): entry}``.

    Raises
    ------
    NoForm
        If the structure excludes the form; the message is the reason.
    """

    def __init__(self, graph: FinishedGraph, causality: CausalAssignment) -> None:
        self._graph = graph
        self._laws = Laws(graph)
        self._equations = derive(graph, causality=causality)
        self._insertion: Insertion | None = None
        self._solvable = {
            *self._equations.unknowns,
            *(s.rate for s in self._equations.states),
        }
        symbols = {s.place: s.symbol for s in self._equations.states}
        self._symbols = [symbols[name] for name in causality.integral]
        self._free = [
            s for s in self._equations.states if s.symbol not in self._symbols
        ]
        self._structure = power_structure(graph, causality, self._free)
        self._coefficients = {
            symbol: self._in_states(value, symbol.name[2:])
            for symbol, value in self._structure.coefficients.items()
        }
        self._storages = list(causality.integral)
        self._dependents = list(causality.derivative)
        self.states = tuple(
            s.name for s in (*self._symbols, *(s.symbol for s in self._free))
        )
        self.inputs = tuple(map(self._input_name, self._structure.inputs))
        self._assemble()

    def _assemble(self) -> None:
        structure = self._structure
        z, u = structure.imposed.values(), structure.inputs.values()
        T = self._ratios()
        Tt = transposed(T)
        B, B_u = self._rows(structure.integrals, z), self._rows(structure.integrals, u)
        K, L = self._rows(structure.rates, z), self._rows(structure.rates, u)
        Y = self._rows(structure.conjugates, z)
        self._check_integrals()

        imposed = self._co_energies()
        followed = applied(T, imposed, len(self._dependents))
        contents = self._contents(followed)
        D = derivatives(contents, self._symbols)
        D_free = derivatives(contents, [s.symbol for s in self._free])
        inverse = inverse_of_one_plus(product(Tt, D), len(self._storages))

        Q = product(Tt, product(D_free, B))
        skew, self.R = skew_and_symmetric(K)
        passing = combined((1, skew), (-1, Q), (1, transposed(Q)))
        size = len(self._storages)
        self.J = bordered(
            congruent(inverse, passing, -1),
            product(inverse, transposed(B)),
            size,
        )
        self.R = congruent(inverse, self.R, 1)

        moved = product(Tt, product(D_free, B_u))
        gain = combined((HALF, L), (HALF, transposed(Y)), (-1, moved))
        self.G = product(inverse, gain)
        self.G.update({(size + i, j): x for (i, j), x in B_u.items()})
        feedthrough = combined((HALF, transposed(Y)), (-HALF, L))
        self.P = product(inverse, feedthrough)
        self.D = self._rows(structure.conjugates, u)

        self.gradient = (
            *(
                sympy.Add(own, moved)
                for own, moved in zip(
                    imposed,
                    applied(transposed(D), followed, len(imposed)),
                    strict=True,
                )
            ),
            *applied(transposed(D_free), followed, len(self._free)),
        )
        self.H = self._energy(imposed, contents, followed)
        self.input_values = self._input_values()
        self.dissipation = self._dissipation()

    def _in_states(self, value: sympy.Expr, name: str) -> sympy.Expr:
        """Return a modulation in terms of states, inputs and parameters."""
        read = signals_in(value)
        if not read:
            return value
        what = signal_values(self._graph, self._equations, read)
        found = in_terms_of_states(value.xreplace(what), self._equations)
        if found.free_symbols & self._solvable:
            if self._insertion is None:
                self._insertion = Insertion(self._equations)
            found = self._insertion(found)
        equations = self._equations
        if found.free_symbols & {*equations.unknowns, *equations.input_rates}:
            raise NoForm(
                f"What {name!r} reads follows from an equation without a formula, or "
                f"from the rate of an input."
            )
        return found

    def _rows(self, rows: Mapping[str, Row], columns: Iterable[sympy.Symbol]) -> Sparse:
        """Return the matrix of some rows, with the coefficients put in."""
        place = {symbol: j for j, symbol in enumerate(columns)}
        return {
            (i, place[symbol]): value.xreplace(self._coefficients)
            for i, row in enumerate(rows.values())
            for symbol, value in row.items()
            if symbol in place
        }

    def _ratios(self) -> Sparse:
        """Return T, and refuse what does not follow the independent storages alone."""
        structure = self._structure
        T = self._rows(structure.dependents, structure.imposed.values())
        others = {*structure.inputs.values(), *structure.dependent_rates.values()}
        outside = {*structure.inputs.values(), t}
        for i, (name, row) in enumerate(structure.dependents.items()):
            ratios = [x for (k, _), x in T.items() if k == i]
            moved = {s for ratio in ratios for s in ratio.free_symbols} & outside
            if others & set(row) or moved:
                raise NoForm(
                    f"The storage {name!r} is dependent and follows more than the "
                    f"states: an input, time, or another rate."
                )
        self._check_power()
        return T

    def _check_power(self) -> None:
        """Refuse where dependent storages act back otherwise than they follow.

        Compared are the coefficients' symbols, so that equal is exactly equal.
        """
        structure = self._structure
        for name, row in structure.dependents.items():
            back = structure.dependent_rates.get(name)
            for storage, imposed in structure.imposed.items():
                parts = [row.get(imposed), structure.rates[storage].get(back)]
                found = [x for x in parts if x is not None]
                if found and in_lowest_terms(found) != 0:
                    raise NoForm(
                        f"The dependent storage {name!r} is joined to {storage!r} "
                        f"through a resistance."
                    )

    def _check_integrals(self) -> None:
        rates = set(self._structure.dependent_rates.values())
        for name, row in self._structure.integrals.items():
            if rates & set(row):
                raise NoForm(
                    f"{name!r} integrates what a dependent storage gives, and is no "
                    f"state of an energy."
                )

    def _co_energies(self) -> list[sympy.Expr]:
        """Return the flow of each I (effort of each C) as a function of the states."""
        held = dict(zip(self._storages, self._symbols, strict=True))
        return [
            law.xreplace({x: held[place] for x, place in reads.items()})
            for law, reads in map(self._law_of_co, self._storages)
        ]

    def _law_of_co(self, name: str) -> tuple[sympy.Expr, Mapping[sympy.Symbol, str]]:
        return port_law(self._graph, self._laws, name, wants_stored=False)

    def _contents(self, followed: list[sympy.Expr]) -> list[sympy.Expr]:
        """Return what each dependent storage holds as a function of the states."""
        given = dict(zip(self._dependents, followed, strict=True))
        found = []
        for name in self._dependents:
            law, reads = port_law(self._graph, self._laws, name, wants_stored=True)
            found.append(law.xreplace({x: given[place] for x, place in reads.items()}))
        return found

    def _energy(
        self,
        imposed: list[sympy.Expr],
        contents: list[sympy.Expr],
        followed: list[sympy.Expr],
    ) -> sympy.Expr:
        names = [*self._storages, *self._dependents]
        held = dict(zip(names, [*self._symbols, *contents], strict=True))
        given = dict(zip(names, [*imposed, *followed], strict=True))
        terms = []
        for node in self._graph.nodes:
            if isinstance(node, Storage | StorageField):
                function = energy_function(node, self._laws)
                values = held if function.reads_stored else given
                places = {x: values[port_place(node, x)] for x in function.variables}
                terms.append(function.expression.xreplace(places))
        return sympy.Add(*terms)

    def _dissipation(self) -> dict[str, sympy.Basic]:
        """Return what must not be negative: a coefficient, or a field's matrix."""
        found: dict[str, sympy.Basic] = {}
        for node in self._graph.nodes:
            if isinstance(node, Resistance):
                found[node.name] = self._coefficients[coefficient_symbol(node.name)]
            elif isinstance(node, ResistanceField):
                size = range(1, node.size + 1)
                matrix = sympy.ImmutableMatrix(
                    [[self._entry(node.name, i, j) for j in size] for i in size]
                )
                found[node.name] = (matrix + matrix.T) / 2
        return found

    def _entry(self, name: str, i: int, j: int) -> sympy.Expr:
        symbol = coefficient_symbol(f"{name}[{i},{j}]")
        return self._coefficients.get(symbol, sympy.S.Zero)

    def _input_name(self, source: str) -> str:
        """Return the name of a source's port: no parameter has it."""
        name = source
        while name in self._graph.parameters:
            name += "_"
        return name

    def _input_values(self) -> dict[str, sympy.Expr]:
        return {
            self._input_name(node.name): self._in_states(node.value, node.name)
            for node in self._graph.nodes
            if isinstance(node, EffortSource | FlowSource) and node.value is not None
        }
