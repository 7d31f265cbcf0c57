"""Energy: what every storage holds, and where its change comes from and goes to.

Junctions and two-ports neither make nor lose power, so the energy of all storages
changes by what the sources supply less what the resistances dissipate. The powers are
those of the bonds, in the symbols of the sorted equations; that each junction and each
two-port conserves power is shown from its own few assignments, so that the proof of
the whole balance costs no more than writing it down.

In a pseudo domain (thermal: temperature times heat flow) effort times flow is no power;
what lies there is listed, marked, and left out of the sums.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum

import sympy

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.inversion import Laws
from bondgraph.equations.insertion import Insertion, rate_of, signal_values
from bondgraph.equations.power.power_proof import PowerProof
from bondgraph.equations.power.stored_energy import (
    EnergyForm,
    EnergyFunction,
    energy_function,
)
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError
from bondgraph.structure.domains import THERMAL, EnergyDomain, Quantity
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Node,
    Resistance,
    Storage,
    letter,
)
from bondgraph.structure.fields import ResistanceField, StorageField
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.signals import PortVariable, signals_in, t


class BalanceStatus(StrEnum):
    """What is known of the power balance; the value is the sentence."""

    EXACT = "every junction and two-port conserves power exactly"
    PARTLY_SHOWN = "every junction and two-port but those named was shown to keep power"
    OPEN = "a modulated storage exchanges a power that has no formula here"


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredEnergy:
    """The energy in one storage.

    Parameters
    ----------
    energy
        In J (in a pseudo domain: effort times displacement), zero when empty.
    is_power
        Whether its effort times its flow is a power (not in a pseudo domain).
    """

    element: str
    letter: str
    energy: sympy.Expr
    form: EnergyForm
    is_power: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Power:
    """The power (W) of one element; `is_power` is False in a pseudo domain."""

    element: str
    letter: str
    power: sympy.Expr
    is_power: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyBalance:
    """``dH/dt = Σ supplied - Σ dissipated + Σ exchanged``.

    Parameters
    ----------
    stored
        The energy of every storage, dependent ones included.
    supplied
        The power out of every source.
    dissipated
        The power into every resistance; negative where one gives power.
    exchanged
        The power that enters by another way: into a storage whose law reads another
        place or time, or over a two-port from a pseudo domain.
    residual
        ``Σ supplied - Σ dissipated + Σ exchanged`` less the power into the storages,
        which vanishes when the assignments are inserted.
    status, unproven
        What is known of that, and the nodes for which no proof was found.
    """

    name: str
    stored: tuple[StoredEnergy, ...]
    supplied: tuple[Power, ...]
    dissipated: tuple[Power, ...]
    exchanged: tuple[Power, ...]
    residual: sympy.Expr
    status: BalanceStatus
    unproven: tuple[str, ...]
    equations: StateEquations

    @property
    def total(self) -> sympy.Expr:
        """The total energy H (J), pseudo domains left out."""
        return sympy.Add(*(s.energy for s in self.stored if s.is_power))

    @property
    def rate(self) -> sympy.Expr:
        """The rate dH/dt (W): supplied less dissipated, plus exchanged."""
        gained = _sum((*self.supplied, *self.exchanged))
        return gained - _sum(self.dissipated)

    @property
    def is_closed(self) -> bool:
        """Whether nothing supplies, dissipates or exchanges power."""
        return not any(
            power.is_power
            for power in (*self.supplied, *self.dissipated, *self.exchanged)
        )

    def in_states(self) -> "EnergyBalance":
        """Return the balance in terms of states, inputs, input rates and parameters.

        Unknowns that no formula gives stay as they are.
        """
        insert = Insertion(self.equations)

        def powers(listed: tuple[Power, ...]) -> tuple[Power, ...]:
            return tuple(replace(x, power=insert(x.power)) for x in listed)

        return replace(
            self,
            stored=tuple(replace(s, energy=insert(s.energy)) for s in self.stored),
            supplied=powers(self.supplied),
            dissipated=powers(self.dissipated),
            exchanged=powers(self.exchanged),
            residual=insert(self.residual),
        )

    def as_text(self) -> str:
        """Return the balance as plain text, one element per line."""
        lines = ["energy"]
        for s in self.stored:
            lines.append(f"  in {s.letter} {s.element}: {s.energy}{_mark(s.is_power)}")
        for title, powers in self._powers():
            lines += ["", title] if powers else []
            for x in powers:
                lines.append(f"  {x.letter} {x.element}: {x.power}{_mark(x.is_power)}")
        named = f": {', '.join(self.unproven)}" if self.unproven else ""
        lines += ["", f"balance: {self.status.value}{named}"]
        return "\n".join(lines) + "\n"

    def _powers(self) -> tuple[tuple[str, tuple[Power, ...]], ...]:
        return (
            ("power supplied", self.supplied),
            ("power dissipated", self.dissipated),
            ("power exchanged", self.exchanged),
        )

    def as_latex(self) -> str:
        """Return H and its rate as a LaTeX ``aligned`` block."""
        pairs = (("H", self.total), (r"\dot{H}", self.rate))
        lines = [f"{left} &= {sympy.latex(right)}" for left, right in pairs]
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.as_latex()}$"


def _sum(powers: Iterable[Power]) -> sympy.Expr:
    return sympy.Add(*(x.power for x in powers if x.is_power))


def _mark(is_power: bool) -> str:
    return "" if is_power else "   (pseudo domain: not an energy, left out of the sums)"


def energy(
    graph: FinishedGraph, equations: StateEquations | None = None
) -> EnergyBalance:
    """Return the energy stored in `graph` and the balance of its powers.

    Expressions are in the symbols of the sorted equations; ``in_states()`` inserts
    them.

    Parameters
    ----------
    equations
        The state equations of this graph, where they have been derived before.

    Raises
    ------
    CausalConflictError, EquationError
        If the graph has no state equations.
    """
    equations = derive(graph) if equations is None else equations
    return _Powers(graph, equations).balance()


class _Powers:
    """The powers of one graph's bonds, sorted by what the elements do with them."""

    def __init__(self, graph: FinishedGraph, equations: StateEquations) -> None:
        self.graph = graph
        self.equations = equations
        self.bonds: dict[str, list[tuple[int, Bond]]] = {
            n.name: [] for n in graph.nodes
        }
        for i, bond in enumerate(graph.bonds):
            self.bonds[bond.tail].append((i, bond))
            self.bonds[bond.head].append((i, bond))
        self.laws = Laws(graph)
        self.without_formula = False

    def balance(self) -> EnergyBalance:
        stored: list[StoredEnergy] = []
        supplied: list[Power] = []
        dissipated: list[Power] = []
        exchanged: list[Power] = []
        unproven: list[str] = []
        into_storages: list[sympy.Expr] = []
        prove = PowerProof(self.equations)
        for node in self.graph.nodes:
            match node:
                case EffortSource() | FlowSource():
                    supplied.append(self._power(node, -self._inflow(node)))
                case Resistance() | ResistanceField():
                    dissipated.append(self._power(node, self._inflow(node)))
                case _ if isinstance(node, Storage | StorageField):
                    function = energy_function(node, self.laws)
                    stored.append(self._stored(node, function))
                    if self._is_power(node):
                        into_storages.append(self._inflow(node))
                    exchanged += self._modulation(node, function)
                case _:
                    exchanged += self._boundary(node)
                    if not prove(self._inflow(node), node.name):
                        unproven.append(node.name)
        gained = _sum((*supplied, *exchanged)) - _sum(dissipated)
        modulated = _sum(x for x in exchanged if x.letter in ("I", "C"))
        return EnergyBalance(
            name=self.graph.name,
            stored=tuple(stored),
            supplied=tuple(supplied),
            dissipated=tuple(dissipated),
            exchanged=tuple(exchanged),
            residual=gained - modulated - sympy.Add(*into_storages),
            status=self._status(unproven),
            unproven=tuple(unproven),
            equations=self.equations,
        )

    def _status(self, unproven: list[str]) -> BalanceStatus:
        if self.without_formula:
            return BalanceStatus.OPEN
        return BalanceStatus.PARTLY_SHOWN if unproven else BalanceStatus.EXACT

    def _inflow(self, node: Node, *, only_power: bool = False) -> sympy.Expr:
        """Return the power that the bonds of `node` bring to it."""
        terms = []
        for i, bond in self.bonds[node.name]:
            if only_power and not is_power_domain(self.graph.domains[i]):
                continue
            effort = self.equations.signal(Quantity.EFFORT, bond.name)
            flow = self.equations.signal(Quantity.FLOW, bond.name)
            terms.append(effort * flow if bond.head == node.name else -effort * flow)
        return sympy.Add(*terms)

    def _is_power(self, node: Node) -> bool:
        return is_power_domain(self.graph.domains[self.bonds[node.name][0][0]])

    def _power(self, node: Node, power: sympy.Expr) -> Power:
        return Power(
            element=node.name,
            letter=letter(node),
            power=power,
            is_power=self._is_power(node),
        )

    def _stored(
        self, node: Storage | StorageField, function: EnergyFunction
    ) -> StoredEnergy:
        values = self._values(node, function)
        return StoredEnergy(
            element=node.name,
            letter=letter(node),
            energy=function.expression.xreplace(values),
            form=function.form,
            is_power=self._is_power(node),
        )

    def _values(
        self, node: Storage | StorageField, function: EnergyFunction
    ) -> dict[sympy.Symbol, sympy.Expr]:
        """Return what the variables of an energy function stand for."""
        values = {
            variable: self.equations.signal(*_port_variable(node, variable))
            for variable in function.variables
        }
        read = signals_in(function.expression)
        return {**values, **signal_values(self.graph, self.equations, read)}

    def _modulation(
        self, node: Storage | StorageField, function: EnergyFunction
    ) -> list[Power]:
        """Return the power by which a moving law changes the energy it stores."""
        if not function.is_modulated:
            return []
        values = self._values(node, function)
        terms = [
            function.expression.diff(signal) * rate
            for signal in signals_in(function.expression)
            for rate in [self._rate(values[signal])]
        ]
        terms.append(function.expression.diff(t))
        return [self._power(node, sympy.Add(*terms).xreplace(values))]

    def _rate(self, expression: sympy.Expr) -> sympy.Expr:
        """Return d(expression)/dt; a symbol of its own where there is no formula."""
        try:
            return rate_of(expression, self.equations)
        except EquationError:
            self.without_formula = True
            return sympy.Symbol(f"d({expression})/dt", real=True)

    def _boundary(self, node: Node) -> list[Power]:
        """Return the power that a node brings from a pseudo domain into a true one."""
        kinds = {
            is_power_domain(self.graph.domains[i]) for i, _ in self.bonds[node.name]
        }
        if len(kinds) < 2:
            return []
        power = -self._inflow(node, only_power=True)
        return [
            Power(element=node.name, letter=letter(node), power=power, is_power=True)
        ]


_QUANTITY = {
    "e": Quantity.EFFORT,
    "f": Quantity.FLOW,
    "p": Quantity.MOMENTUM,
    "q": Quantity.DISPLACEMENT,
}


def _port_variable(node: Node, variable: sympy.Symbol) -> tuple[Quantity, str]:
    """Return which quantity, and where, a variable of the laws of `node` is."""
    if isinstance(variable, PortVariable):
        assert isinstance(node, StorageField)
        return _QUANTITY[variable.letter], node.port(variable.number)
    return _QUANTITY[variable.name], node.name


def is_power_domain(domain: EnergyDomain) -> bool:
    """Return whether effort times flow is a power in `domain`."""
    return domain.name != THERMAL.name
