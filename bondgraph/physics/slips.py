"""Channels recorded with the wrong sign or in the wrong unit: where such a fit begins.

A fit to a wrong sign or unit is no place to begin from: the user's own values are, and
no slope at a factor of one tells what a slip would explain.
"""

from collections.abc import Mapping

from bondgraph.physics.places.base import Place

SLIPS = {
    -1.0: "with the wrong sign",
    1e3: "in a unit a thousand times larger than it says",
    1e-3: "in a unit a thousand times smaller than it says",
}
"""Factors between what is there and what was recorded: wrong at one stroke."""

FACTORS = (1.0, 1.6, 0.6)
"""Where the fit of a gain begins: at none, and on either side. All other numbers may
have bent to a gain that is not there, and one fit does not find back from that.
"""


def own_values(place: Place) -> Mapping[str, float]:
    """Return the user's values of what is fitted without knowledge."""
    return {
        p.name: p.value
        for p in place.graph.parameters.values()
        if p.value is not None and p.std is None
    }
