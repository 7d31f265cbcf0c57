"""Every hypothesis of the library about every small machine, made once."""

from physics_machines import MACHINES, scales_of

from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.everywhere import all_places

SCALES = {name: scales_of(graph) for name, graph in MACHINES.items()}

PROPOSED = [
    (name, place, physics, hypothesis)
    for name, graph in MACHINES.items()
    for place in all_places(graph, SCALES[name])
    for physics in LIBRARY
    for hypothesis in physics.propose(place)
]
"""The machine's name, the place, the entry of the library, what it proposes there."""
