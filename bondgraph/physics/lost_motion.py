"""Signals that follow with play: a linkage between what is asked and what acts.

What acts, x, stays where it is while the command s moves inside a gap about it, and is
taken along beyond: x' = beyond(s - x) / τ, where beyond is zero inside the gap of ± w
and τ half a sample. It is the play operator as soon as samples are short. So is what a
pointer, a float or an encoder on a worn coupling reads of a place, which moves within
a sample as a command does not: x + beyond(s - x) is at the edge of the gap at once.
"""

from collections.abc import Iterator

from bondgraph.physics.gap import beyond
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MECHANICAL, Place, Q
from bondgraph.physics.places.channels import ChannelPlace, InputPlace
from bondgraph.structure.domains import ANALOGUE, HYDRAULIC
from bondgraph.structure.edits import SignalState
from bondgraph.structure.signals import Signal, displacement

SHARES = (0.02, 0.07, 0.2)
"""Half gaps that fits start from, of the range of the signal."""

READ = (0.03,)
"""The same of what a sensor reads; no more, as every position has one."""

SETTLING = 0.5
"""Of a sample: in such a time what acts is at the edge of the gap."""


def _is_way(place: ChannelPlace) -> bool:
    """Return whether a sensor reads a displacement of parts that move."""
    read = place.signal
    if not isinstance(read, Signal) or read.quantity is not Q:
        return False
    return place.graph.domain_at(read.place) in MECHANICAL


class LostMotion(AbstractPhysics):
    """A linkage with play at an input or a sensor: positioners, steering, pointers."""

    word = "backlash"
    reference = "play operator: Krasnosel'skii and Pokrovskii 1989"
    passivity = Passivity.SIGNAL
    signature = (
        "after each reversal nothing follows for the same part of the command; taken "
        "for a lag, and for friction of what is driven"
    )
    domains = frozenset({ANALOGUE, HYDRAULIC})

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for inputs that a linkage moves, and for readings of positions."""
        if not isinstance(place, ChannelPlace) or place.is_constant:
            return
        acts = isinstance(place, InputPlace)
        if not (self.suits(place) if acts else _is_way(place)):
            return
        low, high = place.range
        shares = SHARES if acts else READ
        gaps = tuple(share * (high - low) for share in shares)
        gap = place.shape("half_gap", place.channel_unit, gaps, low=0.0)
        within = place.constant("play_settling", "s", SETTLING * place.scales.step)
        name = place.name_of("followed")
        ahead = place.signal - displacement(name)
        state = SignalState(name, beyond(ahead, gap.symbol) / within.symbol)
        law = state.value if acts else state.value + beyond(ahead, gap.symbol)
        how = "acts" if acts else "reads"
        words = f"{place.name} {how} through play: inside a gap nothing follows it"
        edit = place.become(law, gap, within, states=(state,), nested=False)
        yield self.hypothesis(place, edit, law, (gap, within), words)
