"""The equations of a graph without causality: an e and an f per bond, nothing solved.

An independent route to the numbers. The constraints g(x, e, f, u, t) = 0 are the
junctions' balances and the elements' laws; their total derivative, with the storages'
own ẋ put in, supplies what a dependent storage needs. Both together are solved by
Newton's method; nothing of causality, sorting or elimination is shared with the
library.
"""

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field

import numpy as np
import sympy

from bondgraph.structure import elements as kinds
from bondgraph.structure.fields import MultiPort, ResistanceField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import (
    PORT_VARIABLES,
    PortVariable,
    Signal,
    parameter_symbol,
    t,
)

SMALL = 1e-7

_Function = Callable[[np.ndarray], np.ndarray]


@dataclass
class Raw:
    """The raw equations of one graph.

    ``efforts`` and ``flows`` are by bond, ``stored`` the p or q of each storage port
    and of each integrated signal by name, with ``stored_rates`` their ẋ.
    """

    graph: FinishedGraph
    efforts: list[sympy.Symbol] = field(default_factory=list)
    flows: list[sympy.Symbol] = field(default_factory=list)
    stored: dict[str, sympy.Symbol] = field(default_factory=dict)
    stored_rates: dict[str, sympy.Expr] = field(default_factory=dict)
    integrated: dict[str, Signal] = field(default_factory=dict)
    constraints: list[sympy.Expr] = field(default_factory=list)

    def __post_init__(self) -> None:
        for i in range(len(self.graph.bonds)):
            self.efforts.append(sympy.Symbol(f"raw_e{i}", real=True))
            self.flows.append(sympy.Symbol(f"raw_f{i}", real=True))
        self.at = {
            node.name: [
                i
                for i, bond in enumerate(self.graph.bonds)
                if node.name in (bond.tail, bond.head)
            ]
            for node in self.graph.nodes
        }
        nodes = sorted(self.graph.nodes, key=lambda n: not self._stores(n))
        for node in nodes:
            self._add_stored(node)
        for node in nodes:
            self._constrain(node)

    def _stores(self, node: object) -> bool:
        fields = isinstance(node, MultiPort) and not isinstance(node, ResistanceField)
        return fields or isinstance(node, kinds.Inertance | kinds.Compliance)

    def own(self, name: str, i: int, *, inward: bool) -> tuple[sympy.Expr, sympy.Expr]:
        """Return the effort and flow of an element's port at bond i.

        Turning the half arrow turns the sign of what the junction there balances.
        """
        bond = self.graph.bonds[i]
        sign = 1 if (bond.head == name) == inward else -1
        junction = self.graph.node(bond.other(name))
        if isinstance(junction, kinds.ZeroJunction):
            return self.efforts[i], sign * self.flows[i]
        return sign * self.efforts[i], self.flows[i]

    def _add_stored(self, node: kinds.Node) -> None:
        if not self._stores(node):
            return
        for number, i in enumerate(self.at[node.name], start=1):
            label = (
                f"{node.name}[{number}]" if isinstance(node, MultiPort) else node.name
            )
            momentum = (
                node.stored[number - 1].letter == "p"
                if isinstance(node, MultiPort)
                else isinstance(node, kinds.Inertance)
            )
            effort, flow = self.own(node.name, i, inward=True)
            self.stored[label] = sympy.Symbol(f"raw_x_{label}", real=True)
            self.stored_rates[label] = effort if momentum else flow

    def _constrain(self, node: kinds.Node) -> None:
        bonds = self.at[node.name]
        match node:
            case kinds.ZeroJunction() | kinds.OneJunction():
                zero = isinstance(node, kinds.ZeroJunction)
                common, balanced = self.efforts, self.flows
                if not zero:
                    common, balanced = balanced, common
                self.constraints += [common[bonds[0]] - common[i] for i in bonds[1:]]
                self.constraints.append(
                    sympy.Add(
                        *(
                            balanced[i] * (1 if self._points_to(i, node.name) else -1)
                            for i in bonds
                        )
                    )
                )
            case kinds.EffortSource() | kinds.FlowSource():
                effort, flow = self.own(node.name, bonds[0], inward=False)
                own = effort if isinstance(node, kinds.EffortSource) else flow
                value = (
                    parameter_symbol(node.name) if node.value is None else node.value
                )
                self.constraints.append(own - self.read(value))
            case kinds.Transformer() | kinds.Gyrator():
                self._two_port(node)
            case _ if isinstance(node, MultiPort):
                self._field(node)
            case _:
                effort, flow = self.own(node.name, bonds[0], inward=True)
                stored = self.stored.get(node.name)
                own = dict(zip("efpq", (effort, flow, stored, stored), strict=True))
                relation = node.relation
                law = self.read(relation.output - relation.expression)
                put = {x: own[x.name] for x in law.free_symbols & PORT_VARIABLES}
                self.constraints.append(law.xreplace(put))

    def _points_to(self, i: int, name: str) -> bool:
        return self.graph.bonds[i].head == name

    def _two_port(self, node: kinds.Transformer | kinds.Gyrator) -> None:
        first, second = self.at[node.name]
        if not self._points_to(first, node.name) and self._points_to(second, node.name):
            first, second = second, first
        effort_a, flow_a = self.own(node.name, first, inward=True)
        effort_b, flow_b = self.own(node.name, second, inward=False)
        modulus = self.read(node.modulus)
        if isinstance(node, kinds.Gyrator):
            flow_a, effort_a = effort_a, flow_a
        self.constraints += [effort_b - modulus * effort_a, flow_a - modulus * flow_b]

    def _field(self, node: MultiPort) -> None:
        own = {}
        for number, i in enumerate(self.at[node.name], start=1):
            effort, flow = self.own(node.name, i, inward=True)
            stored = self.stored.get(f"{node.name}[{number}]")
            for letter, value in zip(
                "efpq", (effort, flow, stored, stored), strict=True
            ):
                own[PortVariable(letter, number)] = value
        for relation in node.relations:
            law = self.read(relation.output - relation.expression)
            put = {x: own[x] for x in law.free_symbols if isinstance(x, PortVariable)}
            self.constraints.append(law.xreplace(put))

    def read(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with its signals replaced by raw variables."""
        signals = [x for x in expression.free_symbols if isinstance(x, Signal)]
        return expression.xreplace({x: self._value(x) for x in signals})

    def _value(self, signal: Signal) -> sympy.Expr:
        effort, flow = self._port_of(signal.place)
        if signal.quantity in ("effort", "flow"):
            return effort if signal.quantity == "effort" else flow
        is_momentum = signal.quantity == "momentum"
        node = self.graph.by_name.get(signal.place)
        if isinstance(node, kinds.Inertance if is_momentum else kinds.Compliance):
            return self.stored[signal.place]
        label = str(signal)
        if label not in self.stored:
            self.stored[label] = sympy.Symbol(f"raw_x_{label}", real=True)
            self.stored_rates[label] = effort if is_momentum else flow
            self.integrated[label] = signal
        return self.stored[label]

    def _port_of(self, place: str) -> tuple[sympy.Expr, sympy.Expr]:
        node = self.graph.by_name.get(place)
        if node is None:
            (i,) = (i for i, b in enumerate(self.graph.bonds) if b.name == place)
        elif kinds.is_one_port(node):
            source = isinstance(node, kinds.EffortSource | kinds.FlowSource)
            return self.own(place, self.at[place][0], inward=not source)
        else:
            i = self.at[place][0]
        return self.efforts[i], self.flows[i]

    # Solving ----------------------------------------------------------------------

    def system(
        self, free: list[str], numbers: Mapping[sympy.Symbol, float]
    ) -> tuple[list[sympy.Symbol], list[sympy.Expr]]:
        """Return unknowns and equations when the stored labels in `free` are unknown.

        The unknowns are e, f and the free stored, then the rates of e and f. The
        parameters are put in as `numbers`.
        """
        ports = [*self.efforts, *self.flows]
        rates = {x: sympy.Symbol(f"{x.name}_rate", real=True) for x in ports}
        follow: dict[sympy.Symbol, sympy.Expr] = dict(rates)
        follow |= {self.stored[n]: self.stored_rates[n] for n in self.stored}
        follow |= {
            parameter_symbol(u.name): sympy.Symbol(f"d{u.name}", real=True)
            for u in self.graph.inputs
        }
        follow[t] = sympy.S.One
        constraints = [g.xreplace(dict(numbers)) for g in self.constraints]
        derivatives = [
            sympy.Add(*(slope * follow[x] for x, slope in _slopes(g, follow).items()))
            for g in constraints
        ]
        unknowns = [*ports, *(self.stored[n] for n in free), *rates.values()]
        return unknowns, [*constraints, *derivatives]

    def solve(
        self, free: list[str], put: Mapping[sympy.Symbol, float], start: np.ndarray
    ) -> tuple[np.ndarray, bool]:
        """Return e, f and the free stored, and whether these are the only ones near."""
        named = {parameter_symbol(n) for n in self.graph.parameters}
        numbers = {x: value for x, value in put.items() if x in named}
        unknowns, equations = self.system(free, numbers)
        equations = [_without_kinks(g.xreplace(put)) for g in equations]
        values, jacobian = _as_functions(equations, unknowns)
        wanted = len(unknowns) - 2 * len(self.efforts)
        w = np.zeros(len(unknowns))
        w[:wanted] = start
        for _ in range(40):
            left = values(w)
            if np.max(np.abs(left)) < 1e-12 * (1 + np.max(np.abs(w))):
                break
            w = w - np.linalg.lstsq(jacobian(w), left, rcond=None)[0]
        assert np.max(np.abs(left)) < SMALL, "the raw equations were not solved"
        matrix = jacobian(w)
        size = np.max(np.abs(matrix), axis=1, keepdims=True)
        _, singular, modes = np.linalg.svd(matrix / np.where(size > 0, size, 1.0))
        rank = int(np.sum(singular > 1e-10 * singular[0]))
        undetermined = modes[rank:, :wanted]
        alone = undetermined.size == 0 or bool(np.max(np.abs(undetermined)) < SMALL)
        return w[:wanted], alone

    def is_regular(self, put: Mapping[sympy.Symbol, float]) -> bool:
        """Return whether a linear graph's variables follow from its inputs.

        They do if the equations, with s x in the place of ẋ, are regular at some s.
        """
        s = 0.71 + 0.83j
        names = [*self.stored]
        columns = [*self.efforts, *self.flows, *(self.stored[n] for n in names)]
        place = {x: j for j, x in enumerate(columns)}
        rows = [*self.constraints, *(self.stored_rates[n] for n in names)]
        matrix = np.zeros((len(rows), len(columns)), complex)
        for i, row in enumerate(rows):
            for x, slope in _slopes(row.xreplace(put), place).items():
                matrix[i, place[x]] = float(slope)
        for k, n in enumerate(names):
            matrix[len(self.constraints) + k, place[self.stored[n]]] -= s
        return bool(np.linalg.cond(matrix) < 1e11)


def _as_functions(
    equations: list[sympy.Expr], unknowns: list[sympy.Symbol]
) -> tuple[_Function, _Function]:
    """Return the values of the equations and their Jacobian, as functions of numbers.

    Text is made and compiled of what is curved alone; most rows are balances.
    """
    place = {x: j for j, x in enumerate(unknowns)}
    fixed, offset = np.zeros((len(equations), len(unknowns))), np.zeros(len(equations))
    curved, entries = [], []
    for i, g in enumerate(equations):
        if _is_straight(g):
            offset[i] = g.as_coefficients_dict().get(sympy.S.One, 0)
        else:
            curved.append(i)
        for x, exact in _slopes(g, g.free_symbols).items():
            slope = _without_kinks(exact)
            if slope.is_number:
                fixed[i, place[x]] = slope
            else:
                entries.append((i, place[x], slope))
    read = sympy.lambdify([unknowns], [equations[i] for i in curved], "numpy")
    slopes = sympy.lambdify([unknowns], [slope for _, _, slope in entries], "numpy")
    rows, columns = ([entry[k] for entry in entries] for k in (0, 1))

    def values(w: np.ndarray) -> np.ndarray:
        left = fixed @ w + offset
        left[curved] = read(w)
        return left

    def jacobian(w: np.ndarray) -> np.ndarray:
        matrix = fixed.copy()
        matrix[rows, columns] = slopes(w)
        return matrix

    return values, jacobian


def _slopes(
    expression: sympy.Expr, of: Container[sympy.Symbol]
) -> dict[sympy.Symbol, sympy.Expr]:
    """Return the derivatives of `expression` by its symbols in `of`."""
    if _is_straight(expression):
        terms = expression.as_coefficients_dict()
        return {x: factor for x, factor in terms.items() if x in of}
    return {x: expression.diff(x) for x in expression.free_symbols if x in of}


def _is_straight(expression: sympy.Expr) -> bool:
    """Return whether `expression` is a sum of symbols times numbers, and a number."""
    terms = expression.as_coefficients_dict()
    return all(x.is_Symbol or x is sympy.S.One for x in terms)


def _without_kinks(expression: sympy.Expr) -> sympy.Expr:
    """Return `expression` away from its kinks, where an impulse is nothing."""
    if not expression.has(sympy.DiracDelta):
        return expression
    return expression.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
