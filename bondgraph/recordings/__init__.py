"""Recordings in: read, refused or repaired, bound to a model, cut, and judged."""
