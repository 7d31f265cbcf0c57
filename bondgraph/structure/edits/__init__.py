"""Edits: a hypothesis about a graph as data, which can be printed and compared.

Each edit is a frozen record with ``apply(graph) -> FinishedGraph``, ``describe()``, the
``parameters`` it brings, the ``subject`` it adds or changes, and ``nested``: whether
the first values of its parameters leave the model as it was, or nearly so. The family
`GraphEdit` is closed: diagnosis composes these and nothing else.
"""

from bondgraph.structure.edits.bonds import ConnectJunctions as ConnectJunctions
from bondgraph.structure.edits.bonds import CoupleJunctions as CoupleJunctions
from bondgraph.structure.edits.bonds import LoosenBond as LoosenBond
from bondgraph.structure.edits.bonds import ObstructBond as ObstructBond
from bondgraph.structure.edits.channels import ReplaceMeasurement as ReplaceMeasurement
from bondgraph.structure.edits.channels import SwapInputs as SwapInputs
from bondgraph.structure.edits.channels import SwapMeasurements as SwapMeasurements
from bondgraph.structure.edits.channels import WrapInput as WrapInput
from bondgraph.structure.edits.elements import InsertElement as InsertElement
from bondgraph.structure.edits.elements import ReplaceRelation as ReplaceRelation
from bondgraph.structure.edits.several import GraphEdit as GraphEdit
from bondgraph.structure.edits.several import SeveralEdits as SeveralEdits
from bondgraph.structure.edits.several import SingleEdit as SingleEdit
from bondgraph.structure.edits.signal_states import SignalState as SignalState
from bondgraph.structure.edits.signal_states import (
    carries_signals_only as carries_signals_only,
)
