"""What could not be tried, and what it would take: said where no cause was found.

Laws of position need a position: a displacement that is measured, or stored in a C. And
a channel that is recorded, but that nothing in the model depends on, may be the cause
that nobody thought of.
"""

from bondgraph.diagnosis.answer.wording import listed
from bondgraph.diagnosis.records import Verdict
from bondgraph.physics.places.base import MECHANICAL
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.physics.places.scales import Scales
from bondgraph.structure.edits import carries_signals_only
from bondgraph.structure.elements import Inertance
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.nodes import laws_of
from bondgraph.structure.signals import signals_in


def untried(graph: FinishedGraph, verdict: Verdict) -> tuple[str, ...]:
    """Return a sentence for each kind of law that this model leaves no way to try.

    Nothing where a cause was found, or nothing is missing.
    """
    if verdict in (Verdict.ADEQUATE, Verdict.PHYSICS_MISSING):
        return ()
    notes = []
    if moving := _without_position(graph):
        notes.append(
            f"Laws of position (gravity, end stops, cogging, springs) were not tried "
            f"at {listed(moving, 'and')}: no displacement is measured or stored there. "
            "Measure it to have them tried."
        )
    if idle := unread_inputs(graph):
        notes.append(
            f"Nothing in the model depends on {listed(idle, 'and')}, which "
            f"{'is' if len(idle) == 1 else 'are'} recorded: no law tried here does "
            "either."
        )
    return tuple(notes)


def unread_inputs(graph: FinishedGraph) -> tuple[str, ...]:
    """Return the inputs that drive nothing, and that no law and no sensor reads."""
    laws = [law for node in graph.nodes for law in laws_of(node)]
    laws += [measurement.expression for measurement in graph.measurements]
    read = {signal.place for law in laws for signal in signals_in(law)}
    return tuple(
        source.name
        for source in graph.inputs
        for bond in graph.bonds_at(source.name)
        if carries_signals_only(graph, bond.other(source.name))
        and not read & {source.name, bond.other(source.name)}
    )


def _without_position(graph: FinishedGraph) -> tuple[str, ...]:
    """Return the 1-junctions with inertia whose displacement is not known."""
    return tuple(
        place.name
        for place in all_places(graph, Scales())
        if isinstance(place, OneJunctionPlace)
        and place.domain in MECHANICAL
        and place.displacement_signal is None
        and any(isinstance(node, Inertance) for node in place.neighbours)
    )
