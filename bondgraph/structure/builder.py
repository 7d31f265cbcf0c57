"""`BondGraph`: the one place where a graph is still being written.

Junctions have names, one-ports hang on a junction, two-ports join junctions. The
author calls methods on a `BondGraph`; everything else works on the checked, frozen
`FinishedGraph` that ``finish()`` returns.
"""

import math
from collections.abc import Collection, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NoReturn

from bondgraph.errors import (
    ParameterError,
    StructureError,
    UnfinishedGraphError,
    did_you_mean,
)
from bondgraph.structure.detectors import Detector
from bondgraph.structure.domains import EnergyDomain, Quantity, domain_named
from bondgraph.structure.draft import Draft
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Junction,
    Node,
    OneJunction,
    OnePort,
    Transformer,
    TwoPort,
    ZeroJunction,
    is_one_port,
    letter,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import (
    Bond,
    CausalPreference,
    FinishedGraph,
    Wanted,
)
from bondgraph.structure.parameters import (
    Assumed,
    Parameter,
    ParameterSet,
    Provenance,
)
from bondgraph.structure.signals import Signal, canonical
from bondgraph.structure.subgraphs import SubGraph

_OF_FINISHED = frozenset(x for x in dir(FinishedGraph) if not x.startswith("_"))


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
        self._domain = domain_named(domain)
        self._draft = Draft(name)

    @property
    def name(self) -> str:
        """What the machine is called."""
        return self._draft.name

    def one(
        self, name: str, *elements: OnePort | Detector, domain: str | None = None
    ) -> str:
        """Add a 1-junction (common flow) with one-ports on it; return its name."""
        return self._junction(OneJunction(name), elements, domain)

    def zero(
        self, name: str, *elements: OnePort | Detector, domain: str | None = None
    ) -> str:
        """Add a 0-junction (common effort) with one-ports on it; return its name."""
        return self._junction(ZeroJunction(name), elements, domain)

    def _junction(
        self,
        junction: OneJunction | ZeroJunction,
        elements: tuple[OnePort | Detector, ...],
        domain: str | None,
    ) -> str:
        own = self._domain if domain is None else domain_named(domain)
        self._draft.nodes.append(junction)
        self._draft.junction_domains[junction.name] = own
        for element in elements:
            self.put(element, on=junction.name)
        return junction.name

    def put(
        self, element: OnePort | MultiPort | Detector, on: str | Sequence[str]
    ) -> None:
        """Hang a one-port on the junction called `on`, or a field on several.

        Power is positive out of a source and into everything else. The ports of a
        field are numbered in the order of `on`. A sensor (De, Df, Dp, Dq) takes no
        power: it adds an output channel of its name.
        """
        places = (on,) if isinstance(on, str) else tuple(on)
        if isinstance(element, Detector) and len(places) == 1:
            reading = Signal(element.quantity, places[0])
            self.measure(element.name, reading)
            return
        if not (isinstance(element, MultiPort) or is_one_port(element)):
            raise StructureError(
                f"{element!r} is not a one-port.", (), "Join two-ports with join(...)."
            )
        domains = [self._domain_of(place) for place in places]
        self._draft.nodes.append(element)
        name = element.name
        source = isinstance(element, EffortSource | FlowSource)
        for place, domain in zip(places, domains, strict=True):
            bond = Bond(name, place) if source else Bond(place, name)
            self._draft.bonds.append((bond, domain))

    def join(self, tail: str, *path: TwoPort | str) -> None:
        """Join junctions, through a two-port or directly.

        ``join("a", TF("K"), "b")`` puts the transformer between them, power positive
        from a to b; ``join("a", "b")`` is a plain bond.
        """
        match path:
            case (str() as head,):
                self._draft.bonds.append((Bond(tail, head), self._domain_of(tail)))
                self._domain_of(head)
            case (Transformer() | Gyrator() as two_port, str() as head):
                self._draft.nodes.append(two_port)
                first, second = Bond(tail, two_port.name), Bond(two_port.name, head)
                self._draft.bonds.append((first, self._domain_of(tail)))
                self._draft.bonds.append((second, self._domain_of(head)))
            case _:
                raise StructureError(
                    f"join({tail!r}, …) does not read as a bond.",
                    (tail,),
                    'Write join("a", "b") or join("a", TF("K"), "b").',
                )

    def add(self, *nodes: Node, domain: str | None = None) -> None:
        """Add junctions and elements without bonds, to be connected by `bond`."""
        own = self._domain if domain is None else domain_named(domain)
        for node in nodes:
            self._draft.nodes.append(node)
            if isinstance(node, Junction):
                self._draft.junction_domains[node.name] = own

    def bond(self, tail: str, head: str, domain: str | None = None) -> None:
        """Draw one bond between any two nodes, power positive from `tail` to `head`.

        ``put`` and ``join`` read better; this draws what they cannot, such as a half
        arrow out of an R or a bond between two elements.

        Parameters
        ----------
        domain
            Of a bond that touches no junction; the graph's own if not given.
        """
        if domain is not None:
            own = domain_named(domain)
        else:
            ends = (self._draft.junction_domains.get(end) for end in (tail, head))
            own = next((found for found in ends if found), self._domain)
        self._draft.bonds.append((Bond(tail, head), own))

    def _domain_of(self, junction: str) -> EnergyDomain:
        try:
            return self._draft.junction_domains[junction]
        except KeyError:
            raise StructureError(
                f"There is no junction {junction!r} in {self._draft.name!r} (yet).",
                (junction,),
                did_you_mean(junction, self._draft.junction_domains),
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
        self._draft.measurements.append((name, canonical(expression), unit))

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
        if name in self._draft.parameters:
            raise ParameterError(
                f"The parameter {name!r} is declared twice.", (name,), "Keep one."
            )
        self._draft.parameters[name] = Parameter(
            name=name,
            value=value,
            unit="1" if unit is None else unit,
            bounds=bounds,
            std=std,
            source=Assumed() if source is None else source,
        )

    def prefer(self, element: str, causality: Wanted | str) -> None:
        """Wish for the causality of an element, or of a field's port ``name[1]``.

        ``integral`` or ``derivative`` for an I or C, ``effort`` or ``flow`` (what it
        gives) for an R. The rest of the graph may not allow it; the assignment says so.
        """
        try:
            wanted = Wanted(causality)
        except ValueError:
            raise StructureError(
                f"{causality!r} is no causality.",
                (element,),
                did_you_mean(str(causality), (w.value for w in Wanted)),
            ) from None
        self._draft.preferences[element] = CausalPreference(element, wanted)

    def expose(self, *junctions: str) -> None:
        """Let other graphs that include this one join these junctions, and no others.

        Without a call every junction may be joined.
        """
        for junction in junctions:
            self._domain_of(junction)
            self._draft.exposed[junction] = None

    def include(
        self,
        graph: "BondGraph | FinishedGraph",
        name: str | None = None,
        *,
        shared: Collection[str] = (),
    ) -> SubGraph:
        """Copy another graph into this one; return where it can be joined.

        Parameters
        ----------
        name
            Put before the name of everything in the copy, ``left`` makes the junction
            ``hub`` be ``left_hub``. None keeps all names.
        shared
            Parameters that keep their names, so that all copies have the same.

        Examples
        --------
        ``car.join("axle", car.include(wheel, "left")["hub"])``
        """
        part = graph._draft if isinstance(graph, BondGraph) else Draft.of(graph)
        return self._draft.include(part, name, shared)

    def repeat(
        self,
        graph: "BondGraph | FinishedGraph",
        count: int,
        name: str,
        *,
        chain: tuple[str, str] | None = None,
        shared: Collection[str] = (),
    ) -> tuple[SubGraph, ...]:
        """Include `graph` `count` times, as ``name1``, ``name2``, …; return the parts.

        Parameters
        ----------
        chain
            ``(out, in)``: the junction of each part to join with the next part's.
        shared
            Parameters that all parts have in common.
        """
        if count < 1:
            raise StructureError(
                f"{name!r} is repeated {count} times.", (name,), "Repeat it once."
            )
        parts = tuple(
            self.include(graph, f"{name}{i + 1}", shared=shared) for i in range(count)
        )
        if chain is not None:
            leaving, entering = chain
            for part, following in pairwise(parts):
                self.join(part[leaving], following[entering])
        return parts

    def take(self, parameters: ParameterSet) -> None:
        """Take from `parameters` those that this graph uses and does not declare."""
        self._draft.library = self._draft.library.merged(parameters.members)

    def finish(self) -> FinishedGraph:
        """Return the checked, frozen graph.

        Raises
        ------
        StructureError, ParameterError, UnitError
            If the graph is not well formed.
        """
        return self._draft.finished()

    if not TYPE_CHECKING:  # Where types are checked, that says it better.

        def __getattr__(self, name: str) -> NoReturn:
            if name in _OF_FINISHED:
                raise UnfinishedGraphError(
                    f"{self.name!r} is still being written.",
                    (self.name,),
                    "Pass what its finish() returns.",
                )
            raise AttributeError(f"A BondGraph has no attribute {name!r}.")

    def __repr__(self) -> str:
        kinds = " ".join(f"{letter(n)}:{n.name}" for n in self._draft.nodes)
        return f"<BondGraph {self._draft.name!r}: {kinds}>"
