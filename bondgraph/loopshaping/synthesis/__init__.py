"""Controllers found by optimisation, for one plant or for all that a fit allows."""
