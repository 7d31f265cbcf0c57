"""`BondGraph`: the one place where a graph is still being written.

Junctions have names, one-ports hang on a junction, two-ports join junctions. The
author calls methods on a `BondGraph`; everything else works on the checked, frozen
`FinishedGraph` that ``finish()`` returns.
"""

import math

import sympy

from bondgraph.errors import ParameterError, StructureError, did_you_mean
from bondgraph.structure.domains import EnergyDomain, Quantity, domain_named
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Node,
    OneJunction,
    OnePort,
    Transformer,
    TwoPort,
    ZeroJunction,
    letter,
)
from bondgraph.structure.graph import (
    Bond,
    FinishedGraph,
    Measurement,
    is_one_port,
    used_parameters,
)
from bondgraph.structure.parameters import (
    Assumed,
    Parameter,
    ParameterSet,
    Provenance,
)
from bondgraph.structure.signals import Signal, canonical
from bondgraph.structure.units import si_unit


class BondGraph:
    """A bond graph being written.

    Parameters
    ----------
    name
        What the machine is called.
    domain
        Energy domain of junctions that do not name their own.

    Examples
    --------
    >>> from bondgraph import BondGraph, I, R, Se
    >>> cart = BondGraph("cart", domain="translation")
    >>> _ = cart.one("carriage", Se("force"), I("mass"), R("viscous"))
    >>> cart.measure("position", displacement="carriage")
    """

    def __init__(self, name: str, domain: str = "analogue") -> None:
        self.name = name
        self._domain = domain_named(domain)
        self._nodes: list[Node] = []
        self._bonds: list[tuple[Bond, EnergyDomain]] = []
        self._junction_domains: dict[str, EnergyDomain] = {}
        self._measurements: list[tuple[str, sympy.Expr, str | None]] = []
        self._parameters: dict[str, Parameter] = {}
        self._library = ParameterSet()

    def one(self, name: str, *elements: OnePort, domain: str | None = None) -> str:
        """Add a 1-junction (common flow) with one-ports on it; return its name."""
        return self._junction(OneJunction(name), elements, domain)

    def zero(self, name: str, *elements: OnePort, domain: str | None = None) -> str:
        """Add a 0-junction (common effort) with one-ports on it; return its name."""
        return self._junction(ZeroJunction(name), elements, domain)

    def _junction(
        self,
        junction: OneJunction | ZeroJunction,
        elements: tuple[OnePort, ...],
        domain: str | None,
    ) -> str:
        own = self._domain if domain is None else domain_named(domain)
        self._nodes.append(junction)
        self._junction_domains[junction.name] = own
        for element in elements:
            self.put(element, on=junction.name)
        return junction.name

    def put(self, element: OnePort, on: str) -> None:
        """Hang a one-port on the junction called `on`.

        Power is positive out of a source and into an I, C or R.
        """
        if not is_one_port(element):
            raise StructureError(
                f"{element!r} is not a one-port.", (), "Join two-ports with join(...)."
            )
        domain = self._domain_of(on)
        self._nodes.append(element)
        source = isinstance(element, EffortSource | FlowSource)
        bond = Bond(element.name, on) if source else Bond(on, element.name)
        self._bonds.append((bond, domain))

    def join(self, tail: str, *path: TwoPort | str) -> None:
        """Join junctions, through a two-port or directly.

        ``join("a", TF("K"), "b")`` puts the transformer between them, power positive
        from a to b; ``join("a", "b")`` is a plain bond.
        """
        match path:
            case (str() as head,):
                self._bonds.append((Bond(tail, head), self._domain_of(tail)))
                self._domain_of(head)
            case (Transformer() | Gyrator() as two_port, str() as head):
                self._nodes.append(two_port)
                first, second = Bond(tail, two_port.name), Bond(two_port.name, head)
                self._bonds.append((first, self._domain_of(tail)))
                self._bonds.append((second, self._domain_of(head)))
            case _:
                raise StructureError(
                    f"join({tail!r}, …) does not read as a bond.",
                    (tail,),
                    'Write join("a", "b") or join("a", TF("K"), "b").',
                )

    def _domain_of(self, junction: str) -> EnergyDomain:
        try:
            return self._junction_domains[junction]
        except KeyError:
            raise StructureError(
                f"There is no junction {junction!r} in {self.name!r} (yet).",
                (junction,),
                did_you_mean(junction, self._junction_domains),
            ) from None

    def measure(
        self,
        name: str,
        expression: object = None,
        *,
        unit: str | None = None,
        **quantity: str,
    ) -> None:
        """Add an output channel.

        ``measure("theta", displacement="joint")`` reads one port variable (``effort``,
        ``flow``, ``momentum`` or ``displacement``) at a junction, element or bond;
        ``measure("level", displacement("tank") / area, unit="m")`` reads an expression.
        """
        if len(quantity) + (expression is not None) != 1:
            raise StructureError(
                f"Measurement {name!r} needs exactly one thing to read.",
                (name,),
                'Write measure("theta", displacement="joint") or one expression.',
            )
        if expression is None:
            ((kind, place),) = quantity.items()
            kinds = tuple(q.value for q in Quantity)
            if kind not in kinds:
                raise StructureError(
                    f"Measurement {name!r} reads a {kind!r}.",
                    (name,),
                    did_you_mean(kind, kinds),
                )
            expression = Signal(kind, place)
        self._measurements.append((name, canonical(expression), unit))

    def parameter(
        self,
        name: str,
        value: float | None = None,
        unit: str | None = None,
        *,
        bounds: tuple[float, float] = (-math.inf, math.inf),
        std: float | None = None,
        source: Provenance | None = None,
    ) -> None:
        """Declare the value, unit and knowledge of a parameter that a law uses.

        ``std=0.0`` says the value is exact, a positive ``std`` how well it is known,
        ``None`` that it is a starting guess. ``unit=None`` is dimensionless.
        """
        if name in self._parameters:
            raise ParameterError(
                f"The parameter {name!r} is declared twice.", (name,), "Keep one."
            )
        self._parameters[name] = Parameter(
            name=name,
            value=value,
            unit="1" if unit is None else unit,
            bounds=bounds,
            std=std,
            source=Assumed() if source is None else source,
        )

    def take(self, parameters: ParameterSet) -> None:
        """Take from `parameters` those that this graph uses and does not declare."""
        self._library = self._library.merged(parameters.members)

    def finish(self) -> FinishedGraph:
        """Return the checked, frozen graph.

        Raises
        ------
        StructureError, ParameterError, UnitError
            If the graph is not well formed.
        """
        bonds = tuple(bond for bond, _ in self._bonds)
        domains = tuple(domain for _, domain in self._bonds)
        measurements = tuple(
            Measurement(name, expression, self._unit(expression, unit))
            for name, expression, unit in self._measurements
        )
        used = used_parameters(self._nodes, measurements)
        declared = self._library.restricted(used).merged(self._parameters.values())
        undeclared = tuple(Parameter(name=n) for n in used if n not in declared)
        return FinishedGraph(
            name=self.name,
            nodes=tuple(self._nodes),
            bonds=bonds,
            domains=domains,
            measurements=measurements,
            parameters=_si(declared.merged(undeclared)),
        )

    def _unit(self, expression: sympy.Expr, unit: str | None) -> str:
        """Return a measurement's unit: given, or that of the one signal it reads."""
        if unit is not None:
            return unit
        if not isinstance(expression, Signal):
            return "1"
        for bond, domain in self._bonds:
            if expression.place in (bond.tail, bond.head, bond.name):
                return domain.unit(expression.quantity)
        return "1"

    def __repr__(self) -> str:
        kinds = " ".join(f"{letter(n)}:{n.name}" for n in self._nodes)
        return f"<BondGraph {self.name!r}: {kinds}>"


def _si(parameters: ParameterSet) -> ParameterSet:
    """Return the parameters with prefixed and non-SI units converted."""
    return ParameterSet(tuple(_si_parameter(p) for p in parameters.members))


def _si_parameter(parameter: Parameter) -> Parameter:
    if parameter.value is None:
        return parameter
    unit = si_unit(parameter.unit)
    return parameter if unit == parameter.unit else parameter.to(unit)
