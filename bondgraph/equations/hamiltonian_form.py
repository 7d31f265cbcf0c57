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
from bondgraph.equations.chain_rule import Row
from bondgraph.equations.derivation import derive
from bondgraph.equations.insertion import Insertion, signal_values
from bondgraph.equations.inversion import Laws
from bondgraph.equations.power_structure import power_structure
from bondgraph.equations.rational import in_lowest_terms, solved
from bondgraph.equations.stored_energy import energy_function
from bondgraph.structure import signals
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Inertance,
    Resistance,
    letter,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import signals_in, t

ZERO, ONE = sympy.S.Zero, sympy.S.One
Sparse = dict[tuple[int, int], sympy.Expr]


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
        self._nodes = graph.by_name
        self._laws = Laws(graph)
        self._equations = derive(graph, causality=causality)
        self._insertion: Insertion | None = None
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
        self.inputs = tuple(self._structure.inputs)
        self._assemble()

    def _assemble(self) -> None:
        structure = self._structure
        z, u = structure.imposed.values(), structure.inputs.values()
        T = self._ratios()
        Tt = _transposed(T)
        B, B_u = self._rows(structure.integrals, z), self._rows(structure.integrals, u)
        K, L = self._rows(structure.rates, z), self._rows(structure.rates, u)
        Y = self._rows(structure.conjugates, z)
        self._check_integrals()

        imposed = [self._co_energy(name) for name in self._storages]
        followed = _applied(T, imposed, len(self._dependents))
        contents = [
            self._content(name, value)
            for name, value in zip(self._dependents, followed, strict=True)
        ]
        D = _derivatives(contents, self._symbols)
        D_free = _derivatives(contents, [s.symbol for s in self._free])
        inverse = _inverse(_product(Tt, D), len(self._storages))

        Q = _product(Tt, _product(D_free, B))
        passing = _combined((1, K), (-1, Q), (1, _transposed(Q)))
        across = _product(inverse, _transposed(B))
        drift = _product(_product(inverse, passing), _transposed(inverse))
        whole = _blocks(drift, across, len(self._storages))
        self.J, self.R = _skew_and_symmetric(whole)

        moved = _product(Tt, _product(D_free, B_u))
        gain = _combined((HALF, L), (HALF, _transposed(Y)), (-1, moved))
        self.G = _product(inverse, gain)
        n = len(self._storages)
        self.G.update({(n + i, j): x for (i, j), x in B_u.items()})
        feedthrough = _combined((HALF, _transposed(Y)), (-HALF, L))
        self.P = _product(inverse, feedthrough)
        self.D = self._rows(structure.conjugates, u)

        self.gradient = (
            *(
                sympy.Add(own, moved)
                for own, moved in zip(
                    imposed,
                    _applied(_transposed(D), followed, len(imposed)),
                    strict=True,
                )
            ),
            *_applied(_transposed(D_free), followed, len(self._free)),
        )
        self.H = self._energy(contents, followed)
        self.input_values = self._input_values()
        self.dissipation = {
            node.name: self._coefficients[_coefficient_symbol(node.name)]
            for node in self._graph.nodes
            if isinstance(node, Resistance)
        }

    def _in_states(self, value: sympy.Expr, name: str) -> sympy.Expr:
        """Return a modulation in terms of states, inputs and parameters."""
        read = signals_in(value)
        if not read:
            return value
        if self._insertion is None:
            self._insertion = Insertion(self._equations)
        what = signal_values(self._graph, self._equations, read)
        found = self._insertion(value.xreplace(what))
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
                    f"{letter(self._nodes[name])} {name!r} is dependent and follows "
                    f"more than the states: an input, time, or another rate."
                )
        self._check_power(T)
        return T

    def _check_power(self, T: Sparse) -> None:
        """Refuse where dependent storages act back otherwise than they follow."""
        structure = self._structure
        columns = [
            structure.dependent_rates.get(name, sympy.Dummy())
            for name in self._dependents
        ]
        back = self._rows(structure.rates, columns)
        if _combined((1, back), (1, _transposed(T))):
            raise NoForm(
                f"A dependent storage ({', '.join(self._dependents)}) is joined to the "
                f"others through a resistance."
            )

    def _check_integrals(self) -> None:
        rates = set(self._structure.dependent_rates.values())
        for name, row in self._structure.integrals.items():
            if rates & set(row):
                raise NoForm(
                    f"{name!r} integrates what a dependent storage gives, and is no "
                    f"state of an energy."
                )

    def _co_energy(self, name: str) -> sympy.Expr:
        """Return the flow of an I (effort of a C) as a function of its state."""
        node = self._nodes[name]
        assert isinstance(node, Inertance | Compliance)
        stored, co = _variables(node)
        law = self._laws.explicit(node, co)
        assert law is not None, f"{name} was refused before"
        symbol = self._symbols[self._storages.index(name)]
        return law.xreplace({stored: symbol})

    def _content(self, name: str, co_energy: sympy.Expr) -> sympy.Expr:
        """Return what a dependent storage holds as a function of the states."""
        node = self._nodes[name]
        assert isinstance(node, Inertance | Compliance)
        stored, co = _variables(node)
        law = self._laws.explicit(node, stored)
        assert law is not None, f"{name} was refused before"
        return law.xreplace({co: co_energy})

    def _energy(
        self, contents: list[sympy.Expr], followed: list[sympy.Expr]
    ) -> sympy.Expr:
        terms = []
        names = [*self._storages, *self._dependents]
        held = [*self._symbols, *contents]
        given = [*map(self._co_energy, self._storages), *followed]
        for name, content, co_energy in zip(names, held, given, strict=True):
            node = self._nodes[name]
            assert isinstance(node, Inertance | Compliance)
            function = energy_function(node, self._laws)
            value = content if function.reads_stored else co_energy
            terms.append(function.expression.xreplace({function.variables[0]: value}))
        return sympy.Add(*terms)

    def _input_values(self) -> dict[str, sympy.Expr]:
        return {
            node.name: self._in_states(node.value, node.name)
            for node in self._graph.nodes
            if isinstance(node, EffortSource | FlowSource) and node.value is not None
        }


HALF = sympy.Rational(1, 2)


def _coefficient_symbol(name: str) -> sympy.Symbol:
    return signals.parameter_symbol(f"k~{name}")


def _variables(
    node: Inertance | Compliance,
) -> tuple[sympy.Symbol, sympy.Symbol]:
    if isinstance(node, Inertance):
        return signals.p, signals.f
    return signals.q, signals.e


def _transposed(matrix: Sparse) -> Sparse:
    return {(j, i): x for (i, j), x in matrix.items()}


def _product(left: Sparse, right: Sparse) -> Sparse:
    """Return the product of two matrices, entries in lowest terms."""
    rows: dict[int, list[tuple[int, sympy.Expr]]] = {}
    for (i, j), x in right.items():
        rows.setdefault(i, []).append((j, x))
    terms: dict[tuple[int, int], list[sympy.Expr]] = {}
    for (i, k), x in left.items():
        for j, y in rows.get(k, ()):
            terms.setdefault((i, j), []).append(x * y)
    return _lowest(terms)


def _combined(*parts: tuple[object, Sparse]) -> Sparse:
    """Return the sum of factor times matrix over `parts`."""
    terms: dict[tuple[int, int], list[sympy.Expr]] = {}
    for factor, matrix in parts:
        for key, x in matrix.items():
            terms.setdefault(key, []).append(factor * x)
    return _lowest(terms)


def _lowest(terms: Mapping[tuple[int, int], list[sympy.Expr]]) -> Sparse:
    found = {}
    for key, parts in terms.items():
        total = sympy.Add(*parts)
        if total.is_Add or total.has(sympy.Add):
            total = in_lowest_terms(parts)
        if total != 0:
            found[key] = total
    return found


def _applied(matrix: Sparse, column: list[sympy.Expr], size: int) -> list[sympy.Expr]:
    terms: list[list[sympy.Expr]] = [[] for _ in range(size)]
    for (i, j), x in matrix.items():
        terms[i].append(x * column[j])
    return [sympy.Add(*parts) for parts in terms]


def _derivatives(expressions: list[sympy.Expr], symbols: list[sympy.Symbol]) -> Sparse:
    place = {symbol: j for j, symbol in enumerate(symbols)}
    return {
        (i, place[s]): expression.diff(s)
        for i, expression in enumerate(expressions)
        for s in sorted(expression.free_symbols, key=str)
        if s in place
    }


def _inverse(added: Sparse, size: int) -> Sparse:
    """Return the inverse of the unit matrix plus `added`."""
    unknowns = [sympy.Dummy() for _ in range(size)]
    keys = [sympy.Dummy() for _ in range(size)]
    place = {key: j for j, key in enumerate(keys)}
    rows: list[Row] = [{unknown: ONE} for unknown in unknowns]
    for (i, j), x in added.items():
        rows[i][unknowns[j]] = rows[i].get(unknowns[j], ZERO) + x
    answer = solved(rows, unknowns, [{key: ONE} for key in keys])
    return {
        (i, place[key]): x
        for i, unknown in enumerate(unknowns)
        for key, x in answer[unknown].items()
    }


def _blocks(drift: Sparse, across: Sparse, size: int) -> Sparse:
    """Return ``[[drift, -across], [acrossᵀ, 0]]``."""
    whole = dict(drift)
    for (i, j), x in across.items():
        whole[i, size + j] = -x
        whole[size + j, i] = x
    return whole


def _skew_and_symmetric(matrix: Sparse) -> tuple[Sparse, Sparse]:
    """Return J and R with ``matrix = J - R``, each the mirror image of itself."""
    upper = {key: x for key, x in matrix.items() if key[0] < key[1]}
    lower = {(j, i): x for (i, j), x in matrix.items() if i > j}
    skew = _combined((HALF, upper), (-HALF, lower))
    symmetric = _combined((-HALF, upper), (-HALF, lower))
    diagonal = {key: -x for key, x in matrix.items() if key[0] == key[1]}
    return (
        {**skew, **{(j, i): -x for (i, j), x in skew.items()}},
        {**diagonal, **symmetric, **_transposed(symmetric)},
    )
