"""``python -m bondgraph``: the command line, where ``bondgraph`` is not on the path."""

from bondgraph.cli import main

main()
