"""What gives way between two motions: compliance, and play.

A bond that ties two motions is split; across the difference of the flows sit a spring
and a damper. At no compliance the model is the rigid one.
"""

from collections.abc import Iterator

import sympy

from bondgraph.physics.gap import beyond
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MECHANICAL, Coefficient, E, F, Place, Q
from bondgraph.physics.places.bond import BondPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import ZeroJunctionPlace
from bondgraph.structure.edits import ReplaceRelation, SeveralEdits
from bondgraph.structure.elements import Compliance, Resistance
from bondgraph.structure.signals import displacement, e, f, parameter_symbol, q

EDGE = 0.02
"""Of a spring's usual way: so far into the gap what is lost in contact has ended."""


class SeriesCompliance(AbstractPhysics):
    """A shaft, belt, hose or link that gives way, with its damping."""

    word = "compliance"
    reference = "Kelvin-Voigt body in series; flexible joint: Spong 1987"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "a resonance and phase lag that the rigid model lacks; taken for backlash at "
        "one amplitude, and for delay at low frequency"
    )
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it in every bond that ties two motions together."""
        if not isinstance(place, BondPlace) or not self.suits(place):
            return
        soft = place.displacement / place.effort
        starts = tuple(share * soft for share in (1e-3, 1e-2, 1e-1))
        c = place.shape("compliance", place.unit(Q, E), starts, low=1e-2 * starts[0])
        some = 0.02 * place.effort / place.flow
        d = place.shape("compliance_damping", place.unit(E, F), (some,), low=0.0)
        name = place.name_of("compliance")
        law = q / c.symbol
        elements = (
            Compliance(f"{name}_spring", law=law),
            Resistance(f"{name}_damper", law=d.symbol * f),
        )
        words = f"{place.name} gives way: its ends are tied by a spring and a damper"
        edit = place.loosen(name, elements, c, d)
        yield self.hypothesis(place, edit, law, (c, d), words)


class Backlash(AbstractPhysics):
    """Play between two motions: no effort inside a gap, a stiff contact beyond it."""

    word = "backlash"
    reference = "Nordin and Gutman, Automatica 38, 2002; Hunt and Crossley 1975"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "the far side stands still while the near side turns around; taken for "
        "friction, and for compliance at one amplitude"
    )
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where both sides of a bond can move on their own, and for a C."""
        if not self.suits(place):
            return
        if isinstance(place, BondPlace) and place.both_sides_resist:
            yield self._between(place)
        if isinstance(place, ElementPlace) and isinstance(place.element, Compliance):
            yield from self._before(place)

    def _before(self, place: ElementPlace) -> Iterator[Hypothesis]:
        """Yield a spring that touches only beyond a gap."""
        if q not in place.usual_law.free_symbols:
            return
        gaps = tuple(share * place.content for share in (0.0, 0.1, 0.3, 0.8))
        gap = place.strength("half_gap", place.unit(Q), gaps, low=0.0)
        law = place.usual_law.xreplace({q: beyond(q, gap.symbol)})
        words = f"{place.name} has play: it carries nothing inside a gap"
        edit = place.replace(law, gap)
        yield self.hypothesis(place, edit, law, (gap,), words, also=place.junctions)
        for damper in place.dampers_beside:
            yield self._with_losses(place, gap, edit, damper)

    def _with_losses(
        self, place: ElementPlace, gap: Coefficient, edit: ReplaceRelation, damper: str
    ) -> Hypothesis:
        """Let the damper beside the spring act in contact only, as the spring does."""
        edge = place.constant("half_gap_edge", place.unit(Q), EDGE * place.content)
        inside = gap.symbol - sympy.Abs(displacement(place.name))
        touching = sympy.Max(1 - sympy.Max(inside, 0) / edge.symbol, 0)
        loss = parameter_symbol(damper) * touching * f
        own = (gap.parameter, edge.parameter)
        both = SeveralEdits((edit, ReplaceRelation(damper, loss, own, nested=True)))
        words = f"{place.name} and {damper} have play: they carry nothing inside a gap"
        also = (*place.junctions, damper)
        return self.hypothesis(place, both, edit.law, (gap, edge), words, also=also)

    def _between(self, place: BondPlace) -> Hypothesis:
        way = place.displacement
        gaps = tuple(share * way for share in (0.0, 0.01, 0.03, 0.1, 0.3))
        gap = place.shape("half_gap", place.unit(Q), gaps, low=0.0)
        stiff = 300.0 * place.effort / way
        k = place.shape("contact_stiffness", place.unit(E, Q), (stiff,), low=0.0)
        unit = place.per(place.unit(E), Q, F)
        d = place.shape("contact_damping", unit, (stiff / place.flow,), low=0.0)
        name = place.name_of("backlash")
        law = k.symbol * beyond(q, gap.symbol)
        there = displacement(f"{name}_contact")
        pressed = sympy.Abs(beyond(there, gap.symbol))
        elements = (
            Compliance(f"{name}_contact", law=law),
            Resistance(f"{name}_losses", law=d.symbol * pressed * f),
        )
        words = f"{place.name} has play: its ends touch only beyond a gap"
        edit = place.loosen(name, elements, gap, k, d)
        return self.hypothesis(
            place, edit, law, (gap, k, d), words, extends=("compliance",)
        )


class AddedCompliance(AbstractPhysics):
    """A C at a 0-junction that the model does not have: what is there gives way."""

    word = "added_compliance"
    reference = "stray capacity; trapped air; thermal mass of a wall"
    passivity = Passivity.STORING
    signature = "an effort that follows late; taken for a lag of its sensor"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions without a freely fitted linear C."""
        if not isinstance(place, ZeroJunctionPlace):
            return
        if place.has_free_linear(Compliance):
            return
        low, high = place.effort_range
        some = 0.1 * place.displacement / (high - low)  # An effort may be far from 0.
        starts = (1e-3 * some, 0.1 * some, some)
        c = place.shape("added_compliance", place.unit(Q, E), starts, low=1e-4 * some)
        element = Compliance(place.name_of("added_compliance"))
        words = {
            "hydraulic": "a volume that gives way under pressure",
            "electrical": "a capacity that takes charge",
            "thermal": "a mass that takes heat",
        }.get(place.domain.name, "something elastic that gives way")
        edit = place.insert(element, c)
        yield self.hypothesis(place, edit, c.symbol * e, (c,), words)
