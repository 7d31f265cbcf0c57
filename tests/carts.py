"""The cart that several tests diagnose: a model 20 % off, and its recordings."""

from concealed import cart

from bondgraph import BondGraph, I, R, Se
from bondgraph.recordings.binding import bind
from bondgraph.recordings.recording import Recording


def free_cart():
    """Nominal values 20 % off, as in life."""
    graph = BondGraph("cart", domain="translation")
    graph.one("wheel", Se("force"), I("mass"), R("viscous"))
    graph.measure("position", displacement="wheel")
    graph.parameter("mass", 1.05, "kg", bounds=(0.01, 100))
    graph.parameter("viscous", 2.4, "N*s/m", bounds=(0, 100))
    return graph.finish()


def recorded(seed, **concealed):
    """Return a simulated cart as a recording; see `concealed.cart`."""
    time, force, position = cart(seed, **concealed)
    channels = {"force": (force, "N"), "position": (position, "m")}
    recording = Recording.from_arrays(f"cart {seed}", time, channels)
    return bind(recording, {"force": "N"}, {"position": "m"})
