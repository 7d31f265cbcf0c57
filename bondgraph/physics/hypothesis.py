"""A hypothesis: one piece of physics at one place, as an edit that can be undone."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import sympy

from bondgraph.structure.domains import EnergyDomain, Quantity
from bondgraph.structure.edits import GraphEdit, InsertElement
from bondgraph.structure.elements import OnePort
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Assumed, Parameter
from bondgraph.structure.signals import parameter_symbol


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """One (physics, place) with everything needed to insert, fit and tell it.

    Parameters
    ----------
    physics
        The word for it, from the vocabulary.
    place
        The junction, input or measurement it sits at.
    element
        The name of what the edit adds or changes.
    edit
        What it does to the graph.
    law
        The relation, readable.
    words
        A sentence without its numbers, for reports.
    depends_on
        The local variables the law reads, for data clouds and for advice.
    starts
        Start values of its new parameters; the first is that of weakest effect.
    extends
        Physics words of which this law is a superset at the same place.
    """

    physics: str
    place: str
    element: str
    edit: GraphEdit
    law: sympy.Expr
    words: str
    depends_on: tuple[str, ...]
    starts: tuple[Mapping[str, float], ...]
    extends: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters it adds and that are fitted."""
        return tuple(p.name for p in self.edit.parameters if not p.exact)

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the physics inserted."""
        return self.edit.apply(graph)


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


class AbstractPhysics(ABC):
    """One entry of the library; subclass it to add your own.

    ``word`` is the name in results, ``reference`` where the law comes from.
    """

    word: str
    reference: str

    @abstractmethod
    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield the hypotheses of this physics at `place`; none where it cannot sit."""


def symbols(*parameters: Parameter) -> tuple[sympy.Symbol, ...]:
    """Return the symbols of parameters, for writing a law."""
    return tuple(parameter_symbol(p.name) for p in parameters)
