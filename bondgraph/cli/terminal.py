"""How tables look on the terminal at hand: how wide, and whether coloured."""

import shutil
import sys
from typing import TypedDict

from bondgraph.cli.session import Session

WIDEST = 120


class TableStyle(TypedDict):
    """Keyword arguments of the table functions of `bondgraph.reporting.tables`."""

    colour: bool
    width: int


def table_style(session: Session) -> TableStyle:
    """Return the style for tables on stdout."""
    columns = shutil.get_terminal_size((100, 24)).columns
    return TableStyle(colour=session.coloured(sys.stdout), width=min(columns, WIDEST))
