"""Which places these sensors can tell apart, and which sensor would tell more."""
