"""Inputs that follow with play: a linkage between what is asked and what acts.

What acts, x, stays where it is while the command s moves inside a gap about it, and is
taken along beyond: x' = beyond(s - x) / τ, where beyond is zero inside the gap of ± w
and τ half a sample. It is the play operator as soon as samples are short.
"""

from collections.abc import Iterator

from bondgraph.physics.gap import beyond
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Place
from bondgraph.physics.places.channels import InputPlace
from bondgraph.structure.domains import ANALOGUE, HYDRAULIC
from bondgraph.structure.edits import SignalState
from bondgraph.structure.signals import displacement

SHARES = (0.02, 0.07, 0.2)
"""Half gaps that fits start from, of the range of the command."""

SETTLING = 0.5
"""Of a sample: in such a time what acts is at the edge of the gap."""


class LostMotion(AbstractPhysics):
    """An input whose linkage has play: valves and their positioners, steering."""

    word = "backlash"
    reference = "play operator: Krasnosel'skii and Pokrovskii 1989"
    passivity = Passivity.SIGNAL
    signature = (
        "after each reversal nothing follows for the same part of the command; taken "
        "for a lag, and for friction of what is driven"
    )
    domains = frozenset({ANALOGUE, HYDRAULIC})

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every input that changes and is moved by a linkage."""
        if not isinstance(place, InputPlace) or place.is_constant:
            return
        if not self.suits(place):
            return
        low, high = place.range
        gaps = tuple(share * (high - low) for share in SHARES)
        gap = place.shape("half_gap", place.channel_unit, gaps, low=0.0)
        within = place.constant("play_settling", "s", SETTLING * place.scales.step)
        name = place.name_of("followed")
        ahead = place.signal - displacement(name)
        state = SignalState(name, beyond(ahead, gap.symbol) / within.symbol)
        words = f"{place.name} acts through play: inside a gap nothing follows it"
        edit = place.become(state.value, gap, within, states=(state,), nested=False)
        yield self.hypothesis(place, edit, state.value, (gap, within), words)
