"""The power structure of a graph: how its ports are joined, whatever their laws are.

Every law is replaced by a constant: a storage's effort (flow) by a symbol of its own, a
resistance and a two-port by a coefficient. What is then derived is linear in those
symbols, in the inputs, and in the rates of the dependent storages, with the bond
graph's junction structure as coefficients::

    ẋ  = K z + L u - Tᵀ ẋ_dependent        z: what the storages impose
    z_dependent = T z + T_u u
    y  = Y z + F u                         y: power-conjugate to the sources u

The coefficients are symbols too; `PowerStructure.coefficients` says what they are.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import sympy

from bondgraph.causality.records import CausalAssignment, CausalStroke
from bondgraph.equations.algebra.rational import Row, in_lowest_terms, solved
from bondgraph.equations.chain_rule import propagate, row_of, seeded
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.wires import SymbolNames, Wires
from bondgraph.equations.state_equations import State, StateEquations
from bondgraph.structure import signals
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Gyrator,
    Inertance,
    Node,
    Resistance,
    Transformer,
)
from bondgraph.structure.fields import ResistanceField, StorageField
from bondgraph.structure.graph import (
    Bond,
    FinishedGraph,
    Measurement,
    used_parameters,
)
from bondgraph.structure.parameters import Parameter, ParameterSet
from bondgraph.structure.signals import Signal, parameter_symbol

ZERO, ONE = sympy.S.Zero, sympy.S.One


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerStructure:
    """The rows of the equations at the module's head, as ``{symbol: coefficient}``.

    Parameters
    ----------
    imposed
        The symbol z of each independent storage, by name.
    dependent_rates
        The symbol of the rate of each dependent storage, by name.
    rates
        The row of ẋ of each independent storage, by name.
    dependents
        The row of z of each dependent storage, by name.
    conjugates
        The row of the flow (effort) of each source, by name.
    integrals
        The row of ẋ of each state that no storage holds, by the state's name.
    coefficients
        What each coefficient symbol stands for, in parameters and signals.
    """

    imposed: dict[str, sympy.Symbol]
    dependent_rates: dict[str, sympy.Symbol]
    inputs: dict[str, sympy.Symbol]
    rates: dict[str, Row]
    dependents: dict[str, Row]
    conjugates: dict[str, Row]
    integrals: dict[str, Row]
    coefficients: dict[sympy.Symbol, sympy.Expr]


def power_structure(
    graph: FinishedGraph, causality: CausalAssignment, integrals: Sequence[State]
) -> PowerStructure:
    """Return the power structure of `graph` in a causality.

    Parameters
    ----------
    integrals
        The states that no storage holds, whose rates are wanted as rows.

    Raises
    ------
    EquationError
        If the structure is singular.
    """
    bones = _Bones(graph, causality, integrals)
    equations = derive(bones.graph, causality=bones.causality)
    rates = {
        name: _own(equations, bones.node(name), _gains(bones.node(name)))
        for name in causality.derivative
    }
    rows = _Rows(equations, bones, rates)
    by_place = dict(
        zip((s.place for s in equations.states), equations.rates, strict=True)
    )
    signs = {name: (ONE if x.is_Symbol else -ONE) for name, x in rates.items()}
    symbols = {name: next(iter(x.free_symbols)) for name, x in rates.items() if x != 0}

    def conjugate(name: str) -> Row:
        node = bones.node(name)
        return rows.of(_own(equations, node, _sets(node)))

    return PowerStructure(
        imposed=bones.imposed,
        dependent_rates=symbols,
        inputs={u.name: u for u in equations.inputs},
        rates={
            name: _with_signs(rows.of(by_place[bones.node(name).name]), symbols, signs)
            for name in causality.integral
        },
        dependents={name: conjugate(name) for name in causality.derivative},
        conjugates={u.name: conjugate(u.name) for u in equations.inputs},
        integrals={
            state.symbol.name: rows.of(output.expression)
            for state, output in zip(integrals, equations.outputs, strict=True)
        },
        coefficients=bones.coefficients,
    )


def _with_signs(
    row: Row, symbols: dict[str, sympy.Symbol], signs: dict[str, sympy.Expr]
) -> Row:
    """Return the row in terms of own rates, where symbols are wires."""
    turned = {symbol: signs[name] for name, symbol in symbols.items()}
    return {s: x * turned.get(s, ONE) for s, x in row.items()}


def _own(equations: StateEquations, node: Node, quantity: Quantity) -> sympy.Expr:
    return equations.signal(quantity, node.name)


def _gains(node: Node) -> Quantity:
    """Return the port variable that is the rate of what a storage stores."""
    return Quantity.EFFORT if isinstance(node, Inertance) else Quantity.FLOW


def _sets(node: Node) -> Quantity:
    """Return a storage's co-energy variable, or what a source does not impose."""
    flow = isinstance(node, Inertance | EffortSource)
    return Quantity.FLOW if flow else Quantity.EFFORT


class _Bones:
    """The graph with a symbol in place of every law.

    A field of storages falls apart into one-ports: what its ports have in common is
    their law alone. ``node`` finds them under the names ``field[1]`` that they had.
    """

    def __init__(
        self,
        graph: FinishedGraph,
        causality: CausalAssignment,
        integrals: Iterable[State],
    ) -> None:
        self.imposed: dict[str, sympy.Symbol] = {}
        self.coefficients: dict[sympy.Symbol, sympy.Expr] = {}
        self._integral = set(causality.integral)
        self._whole = graph
        self._nodes: dict[str, Node] = {}
        self._field_end: dict[tuple[str, str], str] = {}
        for node in graph.nodes:
            if isinstance(node, StorageField):
                self._take_apart(node)
            else:
                self._nodes[node.name] = self._bare(node)
        bonds = tuple(map(self._joined, graph.bonds))
        names = {
            old.name: new.name for old, new in zip(graph.bonds, bonds, strict=True)
        }
        probes = tuple(
            Measurement(s.symbol.name, _integrand(graph, s, names), "1")
            for s in integrals
        )
        nodes = tuple(self._nodes.values())
        used = used_parameters(nodes, probes)
        self.graph = replace(
            graph,
            nodes=nodes,
            bonds=bonds,
            measurements=probes,
            parameters=ParameterSet(tuple(Parameter(name=name) for name in used)),
            preferences=(),
        )
        self.causality = self._renamed(causality, bonds)

    def node(self, name: str) -> Node:
        return self._nodes[name]

    def _take_apart(self, field: StorageField) -> None:
        bonds = self._whole.bonds_at(field.name)
        for i, (bond, stored) in enumerate(zip(bonds, field.stored, strict=True)):
            port = field.port(i + 1)
            kind = Inertance if stored.letter == "p" else Compliance
            name = f"{field.name}__{i + 1}"
            while self._whole.has_place(name):
                name += "_"
            self._field_end[bond.name, field.name] = name
            self._nodes[port] = kind(name, self._storage_law(port, kind is Inertance))

    def _joined(self, bond: Bond) -> Bond:
        ends = (self._field_end.get((bond.name, x), x) for x in (bond.tail, bond.head))
        return Bond(*ends)

    def _renamed(
        self, causality: CausalAssignment, bonds: tuple[Bond, ...]
    ) -> CausalAssignment:
        strokes = tuple(
            CausalStroke(bond, bond.tail if s.at == s.bond.tail else bond.head)
            for s, bond in zip(causality.strokes, bonds, strict=True)
        )
        return replace(
            causality,
            strokes=strokes,
            integral=tuple(self._nodes[name].name for name in causality.integral),
            derivative=tuple(self._nodes[name].name for name in causality.derivative),
            steps=(),
        )

    def _bare(self, node: Node) -> Node:
        match node:
            case Inertance() | Compliance():
                law = self._storage_law(node.name, isinstance(node, Inertance))
                return replace(node, law=law)
            case Resistance():
                relation = node.relation
                slope = relation.expression.diff(relation.argument)
                law = self._coefficient(node.name, slope) * relation.argument
                return replace(node, law=law)
            case ResistanceField():
                return replace(node, laws=tuple(self._field_laws(node)))
            case Transformer() | Gyrator():
                return replace(node, law=self._coefficient(node.name, node.modulus))
            case EffortSource() | FlowSource():
                return replace(node, value=None)
        return node

    def _storage_law(self, name: str, is_inertance: bool) -> sympy.Expr:
        if name in self._integral:
            symbol = parameter_symbol(f"z~{name}")
            self.imposed[name] = symbol
            return symbol
        return signals.f if is_inertance else signals.e

    def _field_laws(self, field: ResistanceField) -> Iterator[sympy.Expr]:
        arguments = [relation.argument for relation in field.relations]
        for i, relation in enumerate(field.relations):
            slopes = [relation.expression.diff(x) for x in arguments]
            yield sympy.Add(
                *(
                    self._coefficient(f"{field.name}[{i + 1},{j + 1}]", slope) * x
                    for j, (slope, x) in enumerate(zip(slopes, arguments, strict=True))
                    if slope != 0
                )
            )

    def _coefficient(self, name: str, value: sympy.Expr) -> sympy.Symbol:
        symbol = coefficient_symbol(name)
        self.coefficients[symbol] = value
        return symbol


def coefficient_symbol(name: str) -> sympy.Symbol:
    """Return the symbol in place of the coefficient of a resistance or two-port."""
    return parameter_symbol(f"k~{name}")


def _integrand(graph: FinishedGraph, state: State, names: dict[str, str]) -> Signal:
    """Return the flow (effort) whose integral `state` is.

    ``names`` gives what the bonds of the graph are called where it is read.
    """
    is_momentum = state.is_momentum
    quantity = Quantity.EFFORT if is_momentum else Quantity.FLOW
    wires = Wires(graph, SymbolNames())
    found = wires.effort if is_momentum else wires.flow
    label = [wires.label[wire] for wire in found]
    if state.place in graph.by_name:
        return Signal(quantity, state.place)
    return Signal(quantity, names[graph.bonds[label.index(state.place)].name])


class _Rows:
    """Rows of expressions in z, u and dependent rates, loops solved for."""

    def __init__(
        self, equations: StateEquations, bones: _Bones, rates: dict[str, sympy.Expr]
    ) -> None:
        dependent = {s for x in rates.values() for s in x.free_symbols}
        loops = [
            (z, residual)
            for z, residual in zip(equations.unknowns, equations.residuals, strict=True)
            if z not in dependent
        ]
        seeds = [*bones.imposed.values(), *equations.inputs, *dependent]
        rows = seeded([*seeds, *(z for z, _ in loops)], ONE)
        self._rows = propagate(
            rows, (*equations.assignments, *equations.further), lambda x: x
        )
        self._solutions = _solved_loops(loops, self._rows)

    def of(self, expression: sympy.Expr) -> Row:
        row = row_of(expression, self._rows, lambda x: x)
        terms: dict[sympy.Symbol, list[sympy.Expr]] = {}
        for key, value in row.items():
            for leaf, factor in self._solutions.get(key, {key: ONE}).items():
                terms.setdefault(leaf, []).append(value * factor)
        total = {leaf: in_lowest_terms(parts) for leaf, parts in terms.items()}
        return {leaf: value for leaf, value in total.items() if value != 0}


def _solved_loops(
    loops: list[tuple[sympy.Symbol, sympy.Expr]], rows: dict[sympy.Symbol, Row]
) -> dict[sympy.Symbol, Row]:
    unknowns = [z for z, _ in loops]
    known = set(unknowns)
    found = [row_of(residual, rows, lambda x: x) for _, residual in loops]
    matrix = [{s: x for s, x in row.items() if s in known} for row in found]
    right = [{s: -x for s, x in row.items() if s not in known} for row in found]
    return solved(matrix, unknowns, right)
