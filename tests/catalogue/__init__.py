"""A catalogue of graphs with hand-derived answers, for laws that hold on every graph.

Each answer was derived by hand from Newton's, Kirchhoff's or Lagrange's equations, or
is a published one, and never comes from the library. One file per topic; ``source``
says after whom. "KMR" is Karnopp, Margolis, Rosenberg, System Dynamics: Modeling,
Simulation and Control of Mechatronic Systems; chapters are those of its 5th edition.
"""

from catalogue import (  # noqa: F401  (imported for the cases they add)
    circuits,
    drives,
    fluids,
    linkages,
    machines,
    networks,
    thermal,
)
from catalogue.cases import CASES, Case, adder, agree, case, expression, somewhere
from catalogue.fields import FIELDS
from catalogue.random_graphs import random_graph, random_nonlinear_graph

__all__ = [
    "CASES",
    "FIELDS",
    "Case",
    "adder",
    "agree",
    "case",
    "expression",
    "random_graph",
    "random_nonlinear_graph",
    "somewhere",
]
