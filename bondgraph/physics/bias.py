"""Constant efforts and flows: what pushes or feeds although nothing asks for it."""

from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import E, F, Place
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.junction import OneJunctionPlace, ZeroJunctionPlace
from bondgraph.structure.elements import EffortSource, FlowSource


class ConstantBias(AbstractPhysics):
    """A constant effort at a 1-junction, or flow at a 0-junction."""

    word = "constant_bias"
    reference = "offset of an actuator; gravity along a straight path; ambient gain"
    passivity = Passivity.SOURCE
    signature = (
        "the same error at rest and in motion, a stock that drifts by itself; taken "
        "for a sensor's offset"
    )

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at junctions that have no fitted constant source.

        Also at an input whose bias no junction can take: an effort on a 0-junction.
        """
        if isinstance(place, OneJunctionPlace) and not place.has_free_bias:
            b = place.strength("bias", place.unit(E))
            effort = EffortSource(place.name_of(self.word), value=b.symbol)
            words = f"a constant {place.domain.effort}"
            edit = place.insert(effort, b)
            yield self.hypothesis(place, edit, b.symbol, (b,), words)
        elif isinstance(place, ZeroJunctionPlace) and not place.has_free_bias:
            b = place.strength("bias", place.unit(F))
            flow = FlowSource(place.name_of(self.word), value=b.symbol)
            words = f"a constant {place.domain.flow}"
            yield self.hypothesis(place, place.insert(flow, b), b.symbol, (b,), words)
        elif isinstance(place, InputPlace):
            if place.is_one_junction(place.junction) is (place.quantity is E):
                return
            b = place.strength("input_bias", place.channel_unit)
            law = place.signal + b.symbol
            words = f"{place.name} acts with a constant offset"
            yield self.hypothesis(place, place.become(law, b), law, (b,), words)
