"""A slider that is pulled at known speeds: what laws of friction are searched on."""

from bondgraph import BondGraph, R, Sf
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.physics.places.everywhere import all_places


def slider():
    """Return the slider with a viscous damper; the force that pulls it is read."""
    g = BondGraph("slider", domain="translation")
    g.one("cart", Sf("speed"), R("damper"))
    g.measure("force", effort="speed")
    g.parameter("damper", 1.0, "N*s/m", bounds=(0, 100))
    return g.finish()


def place_of(fitted):
    """Return the cart as a place for hypotheses."""
    places = all_places(fitted.graph, measure_scales(fitted))
    (place,) = (place for place in places if place.name == "cart")
    return place


def proposed(fitted, physics):
    """Return the one hypothesis of a physics at the cart."""
    (hypothesis,) = physics.propose(place_of(fitted))
    return hypothesis
