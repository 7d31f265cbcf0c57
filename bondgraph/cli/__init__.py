"""The command line: one file per command, each no more than words around the library.

A command reads its inputs, calls one public function and shows the answer. What went
wrong is one sentence on stderr; see `bondgraph.cli.program`.
"""

from bondgraph.cli.program import main

__all__ = ["main"]
