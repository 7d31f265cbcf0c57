"""bondgraph: from a drawn machine to its equations, its fit and what it leaves out.

The public names are imported on first use, so that ``import bondgraph`` stays quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_HOME = {
    "bondgraph.structure.builder": ("BondGraph",),
    "bondgraph.structure.graph": ("FinishedGraph",),
    "bondgraph.structure.elements": ("Se", "Sf", "I", "C", "R", "TF", "GY"),
    "bondgraph.structure.signals": (
        *("e", "f", "p", "q", "t"),
        *("effort", "flow", "momentum", "displacement"),
    ),
    "bondgraph.structure.parameters": (
        *("Parameter", "ParameterSet"),
        *("Assumed", "Measured", "Published", "Fitted", "Reconciled"),
    ),
    "bondgraph.structure.edits": (
        "InsertElement",
        "ReplaceRelation",
        "ReplaceMeasurement",
    ),
    "bondgraph.causality.assignment": ("assign_causality",),
    "bondgraph.equations.derivation": ("derive",),
    "bondgraph.equations.linear": ("linearise",),
    "bondgraph.errors": ("BondGraphError",),
}
_WHERE = {name: home for home, names in _HOME.items() for name in names}

__version__ = "0.1.0"
__all__ = sorted([*_WHERE, "__version__"])  # noqa: PLE0605

if TYPE_CHECKING:
    from bondgraph.causality.assignment import assign_causality as assign_causality
    from bondgraph.equations.derivation import derive as derive
    from bondgraph.equations.linear import linearise as linearise
    from bondgraph.errors import BondGraphError as BondGraphError
    from bondgraph.structure.builder import BondGraph as BondGraph
    from bondgraph.structure.edits import InsertElement as InsertElement
    from bondgraph.structure.edits import ReplaceMeasurement as ReplaceMeasurement
    from bondgraph.structure.edits import ReplaceRelation as ReplaceRelation
    from bondgraph.structure.elements import GY as GY
    from bondgraph.structure.elements import TF as TF
    from bondgraph.structure.elements import C as C
    from bondgraph.structure.elements import I as I
    from bondgraph.structure.elements import R as R
    from bondgraph.structure.elements import Se as Se
    from bondgraph.structure.elements import Sf as Sf
    from bondgraph.structure.graph import FinishedGraph as FinishedGraph
    from bondgraph.structure.parameters import Assumed as Assumed
    from bondgraph.structure.parameters import Fitted as Fitted
    from bondgraph.structure.parameters import Measured as Measured
    from bondgraph.structure.parameters import Parameter as Parameter
    from bondgraph.structure.parameters import ParameterSet as ParameterSet
    from bondgraph.structure.parameters import Published as Published
    from bondgraph.structure.parameters import Reconciled as Reconciled
    from bondgraph.structure.signals import displacement as displacement
    from bondgraph.structure.signals import e as e
    from bondgraph.structure.signals import effort as effort
    from bondgraph.structure.signals import f as f
    from bondgraph.structure.signals import flow as flow
    from bondgraph.structure.signals import momentum as momentum
    from bondgraph.structure.signals import p as p
    from bondgraph.structure.signals import q as q
    from bondgraph.structure.signals import t as t


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        return getattr(import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'bondgraph' has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
