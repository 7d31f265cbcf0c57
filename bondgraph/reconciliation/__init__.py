"""Reconciliation: which printed numbers must be wrong for the others to agree."""

from bondgraph.reconciliation.published import (
    PublishedResult,
    as_printed,
    rounding_of,
)
from bondgraph.reconciliation.reconcile import reconcile
from bondgraph.reconciliation.records import (
    Change,
    Explanation,
    Reconciliation,
    ReconciliationStatus,
    ResultAtParameters,
)

__all__ = [
    "Change",
    "Explanation",
    "PublishedResult",
    "Reconciliation",
    "ReconciliationStatus",
    "ResultAtParameters",
    "as_printed",
    "reconcile",
    "rounding_of",
]
