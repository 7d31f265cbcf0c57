"""What every kind of place offers to a law: names, units, words and parameters."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace

import sympy

from bondgraph.physics.places.scales import Scales
from bondgraph.structure.domains import (
    ANALOGUE,
    ELECTRICAL,
    HYDRAULIC,
    ROTATION,
    THERMAL,
    TRANSLATION,
    EnergyDomain,
    Quantity,
)
from bondgraph.structure.elements import OneJunction
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Assumed, Parameter
from bondgraph.structure.signals import parameter_symbol

PROPOSED = Assumed("hypothesis of a diagnosis")
"""Where the numbers of a law begin that the library proposes."""

MOTION = frozenset({TRANSLATION, ROTATION})
MECHANICAL = MOTION | {ANALOGUE}
FLUID = frozenset({HYDRAULIC, ANALOGUE})
ELECTRIC = frozenset({ELECTRICAL, ANALOGUE})
HEAT = frozenset({THERMAL})
"""Domains in which a word is the right one; a model of no domain takes most."""

E, F = Quantity.EFFORT, Quantity.FLOW
P, Q = Quantity.MOMENTUM, Quantity.DISPLACEMENT


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A parameter that a hypothesis adds, with the values its fits start from.

    Parameters
    ----------
    starts
        Values to start from; hypotheses with several coefficients start from the first
        values of all, the second of all, and so on, a single one serving every time.
    strength
        Whether the hypothesis has no effect where this (and every other strength) is 0.
    smooths
        Whether it is the width of an edge that is sharp in truth.
    """

    parameter: Parameter
    starts: tuple[float, ...]
    strength: bool = False
    smooths: bool = False

    @property
    def name(self) -> str:
        """The parameter's name."""
        return self.parameter.name

    @property
    def symbol(self) -> sympy.Symbol:
        """The symbol that stands for it in a law."""
        return parameter_symbol(self.parameter.name)


@dataclass(frozen=True, slots=True)
class Place(ABC):
    """Somewhere in a graph where physics may have been left out.

    Parameters
    ----------
    graph
        The model without it.
    name
        What the user calls the place: a junction, element, input or output.
    scales
        Typical sizes of the signals around it.
    """

    graph: FinishedGraph
    name: str
    scales: Scales

    @property
    @abstractmethod
    def domain(self) -> EnergyDomain:
        """The energy domain there."""

    @property
    def also(self) -> tuple[str, ...]:
        """Other names in the user's model that mean this very place."""
        return ()

    def is_one_junction(self, name: str) -> bool:
        """Return whether the node called `name` is a 1-junction."""
        return isinstance(self.graph.node(name), OneJunction)

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
            return unit if power == 1 else f"({unit})^{power}"
        exponent = "" if power == 1 else f"^{power}"
        return f"({unit})/({self.domain.unit(below)}){exponent}"

    def per(self, unit: str, *quantities: Quantity) -> str:
        """Return ``unit`` divided by the units of `quantities`, here."""
        if not self.domain.checked:
            return "1"
        below = "".join(f"/({self.domain.unit(quantity)})" for quantity in quantities)
        return f"({unit}){below}"

    def strength(
        self,
        stem: str,
        unit: str,
        starts: Sequence[float] = (0.0,),
        *,
        low: float = -math.inf,
        high: float = math.inf,
    ) -> Coefficient:
        """Return a fitted coefficient at whose 0 the law has no effect."""
        return self._coefficient(stem, unit, starts, low, high, strength=True)

    def shape(
        self,
        stem: str,
        unit: str,
        starts: Sequence[float],
        *,
        low: float = -math.inf,
        high: float = math.inf,
    ) -> Coefficient:
        """Return a fitted coefficient that shapes a law: a width, a limit, a time."""
        return self._coefficient(stem, unit, starts, low, high, strength=False)

    def constant(self, stem: str, unit: str, value: float) -> Coefficient:
        """Return a coefficient that is not fitted, such as a scale."""
        parameter = Parameter(
            name=self.name_of(stem), value=value, unit=unit, std=0.0, source=PROPOSED
        )
        return Coefficient(parameter, ())

    def edge(self, stem: str, unit: str, width: float) -> Coefficient:
        """Return the width over which a sharp edge is smoothed; it is not fitted."""
        return replace(self.constant(stem, unit, width), smooths=True)

    def _coefficient(
        self,
        stem: str,
        unit: str,
        starts: Sequence[float],
        low: float,
        high: float,
        *,
        strength: bool,
    ) -> Coefficient:
        inside = tuple(min(max(start, low), high) for start in starts)
        parameter = Parameter(
            name=self.name_of(stem),
            value=inside[0],
            unit=unit,
            bounds=(low, high),
            source=PROPOSED,
        )
        return Coefficient(parameter, inside, strength)

    def name_of(self, stem: str) -> str:
        """Return a name for `stem` at this place that the graph does not use yet."""
        # A chain of signal states is called by what all their names begin with.
        chains = {node.removesuffix("_1_node") for node in self.graph.by_name}
        taken = {*self.graph.by_name, *self.graph.parameters, *chains}
        name = f"{stem}_{self.name}"
        while name in taken:
            name += "_2"
        return name
