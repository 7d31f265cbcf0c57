"""Several edits as one, and the closed family of all edits."""

from dataclasses import dataclass

from bondgraph.structure.edits.bonds import (
    ConnectJunctions,
    CoupleJunctions,
    LoosenBond,
    ObstructBond,
)
from bondgraph.structure.edits.channels import (
    ReplaceMeasurement,
    SwapInputs,
    SwapMeasurements,
    WrapInput,
)
from bondgraph.structure.edits.elements import InsertElement, ReplaceRelation
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Parameter

SingleEdit = (
    InsertElement
    | ReplaceRelation
    | ReplaceMeasurement
    | SwapInputs
    | SwapMeasurements
    | WrapInput
    | LoosenBond
    | ObstructBond
    | ConnectJunctions
    | CoupleJunctions
)


@dataclass(frozen=True, slots=True)
class SeveralEdits:
    """Edits that make one hypothesis together, applied in their order."""

    edits: tuple[SingleEdit, ...]

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with all edits applied."""
        for edit in self.edits:
            graph = edit.apply(graph)
        return graph

    def describe(self) -> str:
        """Return the edits in words."""
        return "; ".join(edit.describe() for edit in self.edits)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters of all, each once."""
        found = {p.name: p for edit in self.edits for p in edit.parameters}
        return tuple(found.values())

    @property
    def subject(self) -> str:
        """The name of what the first adds or changes."""
        return self.edits[0].subject

    @property
    def nested(self) -> bool:
        """Whether the first values of all parameters give the graph before."""
        return all(edit.nested for edit in self.edits)


GraphEdit = SingleEdit | SeveralEdits
