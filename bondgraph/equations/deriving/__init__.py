"""Deriving: from a finished graph to its sorted assignments, a step in each module."""
