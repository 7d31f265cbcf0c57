"""FlegX's own mismatch: four drives of the simulated leg, recorded and diagnosed."""
