"""A hypothesis: one piece of physics at one place, as an edit that can be undone."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import sympy

from bondgraph.physics.place import Place
from bondgraph.structure.edits import GraphEdit
from bondgraph.structure.graph import FinishedGraph


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


class AbstractPhysics(ABC):
    """One entry of the library; subclass it to add your own.

    ``word`` is the name in results, ``reference`` where the law comes from.
    """

    word: str
    reference: str

    @abstractmethod
    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield the hypotheses of this physics at `place`; none where it cannot sit."""
