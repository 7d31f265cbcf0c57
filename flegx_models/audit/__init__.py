"""The audit: every printed result of the thesis that can be computed again.

``python -m flegx_models.audit`` prints the table; ``--json FILE`` and ``--markdown
FILE`` write it. A result counts as reproduced where the interval that its data's
rounding allows meets the interval that its own rounding allows. Where it does not, a
correction may be named with which it does; nothing is fitted without saying so. Which
numbers would have to change is asked of `bondgraph.reconcile`, not of this package.
"""

from flegx_models.audit.records import Audit, Row, Verdict
from flegx_models.audit.whole import audit

__all__ = ["Audit", "Row", "Verdict", "audit"]
