"""Transfer: linear systems about an operating point, and their transfer functions."""
