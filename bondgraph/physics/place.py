"""A place: a junction of a graph with what a law needs to know of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy

from bondgraph.structure.domains import EnergyDomain, Quantity
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Node,
    OneJunction,
    OnePort,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Assumed, Parameter
from bondgraph.structure.signals import (
    displacement,
    parameter_symbol,
    parameters_in,
    signals_in,
)

E, F = Quantity.EFFORT, Quantity.FLOW


@dataclass(frozen=True, slots=True)
class Scales:
    """Typical sizes (root mean square) of signals in the base model's simulation."""

    sizes: Mapping[str, float] = field(default_factory=dict)

    def at(self, quantity: Quantity, place: str, default: float = 1.0) -> float:
        """Return the size of `quantity` at `place`, or `default` where unknown or 0."""
        return self.sizes.get(f"{quantity}({place})", 0.0) or default


@dataclass(frozen=True, slots=True)
class Place:
    """A junction of a graph, with what a law needs to know of it."""

    graph: FinishedGraph
    name: str
    scales: Scales

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain there."""
        return self.graph.domain_at(self.name)

    @property
    def is_one_junction(self) -> bool:
        """Whether the place is a 1-junction."""
        return isinstance(self.graph.node(self.name), OneJunction)

    @property
    def is_zero_junction(self) -> bool:
        """Whether the place is a 0-junction."""
        return isinstance(self.graph.node(self.name), ZeroJunction)

    @property
    def neighbours(self) -> tuple[Node, ...]:
        """The nodes that a bond joins to this place."""
        bonds = self.graph.bonds_at(self.name)
        return tuple(self.graph.node(bond.other(self.name)) for bond in bonds)

    @property
    def displacement_known(self) -> bool:
        """Whether the displacement is absolute here: measured, or that of a C.

        Elsewhere its origin would be free in every window, which explains too much.
        """
        own = displacement(self.name)
        if any(m.expression.has(own) for m in self.graph.measurements):
            return True
        return any(isinstance(node, Compliance) for node in self.neighbours)

    @property
    def has_free_bias(self) -> bool:
        """Whether a constant source with a fitted value sits here."""
        for node in self.neighbours:
            if isinstance(node, EffortSource | FlowSource) and node.value is not None:
                names = parameters_in(node.value)
                constant = names and not signals_in(node.value)
                if constant and any(not self.graph.parameters[n].exact for n in names):
                    return True
        return False

    def has_free_linear(self, kind: type) -> bool:
        """Return whether a linear element of `kind` with a fitted value sits here."""
        return any(
            isinstance(node, kind)
            and getattr(node, "law", None) is None
            and self.graph.parameters[node.name].std is None
            for node in self.neighbours
        )

    @property
    def flow(self) -> float:
        """Typical flow."""
        return self.scales.at(Quantity.FLOW, self.name)

    @property
    def effort(self) -> float:
        """Typical effort of the bonds there."""
        return self.scales.at(Quantity.EFFORT, self.name)

    @property
    def displacement(self) -> float:
        """Typical displacement."""
        return self.scales.at(Quantity.DISPLACEMENT, self.name)

    def a(self, quantity: Quantity) -> str:
        """Return what `quantity` is called here, with its article."""
        word = self.domain.word(quantity)
        return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"

    def unit(
        self, above: Quantity, below: Quantity | None = None, power: int = 1
    ) -> str:
        """Return the unit of ``above / below**power`` in this domain."""
        if not self.domain.checked:
            return "1"
        unit = self.domain.unit(above)
        if below is None:
            return unit
        exponent = "" if power == 1 else f"^{power}"
        return f"({unit})/({self.domain.unit(below)}){exponent}"

    def parameter(
        self,
        name: str,
        unit: str,
        *,
        low: float = float("-inf"),
        exact: float | None = None,
    ) -> Parameter:
        """Return a parameter of a hypothesis: fitted, or fixed at `exact`."""
        value = exact if exact is not None else max(low, 0.0)
        return Parameter(
            name=self.name_of(name),
            value=value,
            unit=unit,
            bounds=(low, float("inf")),
            std=0.0 if exact is not None else None,
            source=Assumed("hypothesis of a diagnosis"),
        )

    def name_of(self, stem: str) -> str:
        """Return a name for `stem` at this place that the graph does not use yet."""
        taken = {*self.graph.by_name, *self.graph.parameters}
        name = f"{stem}_{self.name}"
        while name in taken:
            name += "_2"
        return name

    def insert(self, element: OnePort, *parameters: Parameter) -> InsertElement:
        """Return the edit that hangs `element` here."""
        return InsertElement(self.name, element, parameters)


def symbols(*parameters: Parameter) -> tuple[sympy.Symbol, ...]:
    """Return the symbols of parameters, for writing a law."""
    return tuple(parameter_symbol(p.name) for p in parameters)
