"""Fits of what surprises a Kalman filter, where a machine is shaken or in a loop."""
