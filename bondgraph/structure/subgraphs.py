"""Sub-graphs: a copy of a graph inside another, joined at the junctions it exposes."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass

import sympy

from bondgraph.errors import StructureError, did_you_mean
from bondgraph.structure.elements import Node
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.nodes import parameters_of
from bondgraph.structure.renaming import Renaming
from bondgraph.structure.signals import parameters_in


@dataclass(frozen=True, slots=True)
class SubGraph(Mapping[str, str]):
    """Where an included graph can be joined: its own junction name gives the new one.

    ``wheel["hub"]`` is the name of the copy's junction ``hub``.
    """

    name: str
    ports: Mapping[str, str]

    def __getitem__(self, junction: str) -> str:
        try:
            return self.ports[junction]
        except KeyError:
            raise StructureError(
                f"{self.name!r} exposes no junction {junction!r}.",
                (self.name, junction),
                did_you_mean(junction, self.ports),
            ) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.ports)

    def __len__(self) -> int:
        return len(self.ports)


def renaming_of(
    nodes: Iterable[Node],
    measurements: Iterable[tuple[str, sympy.Expr, str | None]],
    name: str | None,
    shared: Collection[str],
) -> Renaming:
    """Return the renaming that puts `name` before every name but those `shared`.

    Raises
    ------
    StructureError
        If a shared name is no parameter of the graph.
    """
    nodes = list(nodes)
    parameters = {p: None for node in nodes for p in parameters_of(node)}
    parameters.update((p, None) for _, x, _ in measurements for p in parameters_in(x))
    for parameter in shared:
        if parameter not in parameters:
            raise StructureError(
                f"There is no parameter {parameter!r} to share.",
                (parameter,),
                did_you_mean(parameter, parameters),
            )
    if name is None:
        return Renaming({}, {})
    places = {node.name: f"{name}_{node.name}" for node in nodes}
    for node in nodes:
        if isinstance(node, MultiPort):
            for i in range(node.size):
                places[node.port(i + 1)] = f"{name}_{node.port(i + 1)}"
    return Renaming(
        places, {p: f"{name}_{p}" for p in parameters if p not in set(shared)}
    )
